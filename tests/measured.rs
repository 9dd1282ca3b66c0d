//! Networks of anyone as materials: lattices against published closed forms, exact networks against their material, files of other programs
//! against what was written, matrices against elements.

use crate::kit::{self, holding, place, prints};
use crate::shapes::{elements, loaded};
use nalgebra::DMatrix;
use springfit_element::element::Element;
use springfit_element::material::{Hooke, Material, State};
use springfit_element::springs::Springs;
use springfit_fit::fit::{Fit, GivenStiffness, Objective, Weight, condense, fit_element, reference_fit};
use springfit_report::report::{SpecimenOptions, read_matrix, read_specimen};
use springfit_studies::study::{MeasureOptions, MeasuredNetwork, NamedLattice, measure};
use std::fs;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;

fn refused(folder: &Path, arguments: &[&str], words: &str) {
    let found = kit::refused(folder, arguments);
    assert!(found.contains(words), "{arguments:?}: {found}");
}

fn of_file(path: &Path, options: &MeasureOptions) -> MeasuredNetwork {
    let file = read_specimen(path, &SpecimenOptions::default()).unwrap();
    measure(&file.specimen, options).unwrap()
}

/// Names, constants, and C11, C12, C44 with the spacing 2.
type Published = (&'static str, &'static [f64], [f64; 3]);

/// Born's cubic lattice and the cubic crystals with first and second neighbours (Born and Huang, *Dynamical Theory of Crystal Lattices*, 1954),
/// triangles and squares with diagonals (Ostoja-Starzewski, Applied Mechanics Reviews 55, 2002; of the honeycomb a side of a/√3 has the modulus of
/// area k/(2√3) and no shear). C44 in the plane is C66.
#[test]
fn lattices_have_their_published_moduli() {
    let root = 3f64.sqrt();
    let a = 2.0;
    let published: [Published; 7] = [
        ("cubic", &[3.0, 5.0], [(3.0 + 10.0) / a, 5.0 / a, 5.0 / a]),
        ("cubic", &[3.0], [3.0 / a, 0.0, 0.0]),
        ("bcc", &[3.0, 5.0], [(2.0 + 10.0) / a, 2.0 / a, 2.0 / a]),
        ("fcc", &[3.0, 5.0], [(6.0 + 20.0) / a, 3.0 / a, 3.0 / a]),
        ("triangular", &[4.0], [3.0 * root, root, root]),
        ("square", &[3.0, 5.0], [8.0, 5.0, 5.0]),
        ("honeycomb", &[4.0], [4.0 / (2.0 * root), 4.0 / (2.0 * root), 0.0]),
    ];
    for (name, constants, expected) in published {
        let lattice = NamedLattice::named(name).unwrap();
        let d = lattice.dimension();
        let closed = lattice.closed(constants.len()).unwrap();
        let found = closed.entries.each_ref().map(|entry| closed.value(entry, constants, a, d).unwrap());
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12 * expected.abs().max(1.0), "{name}: {found} {expected}");
        }
    }
    // E = 2k/√3 and ν = 1/3 of triangles.
    let closed = NamedLattice::named("triangular").unwrap().closed(1).unwrap();
    let young = closed.value(closed.young.as_ref().unwrap(), &[1.0], 1.0, 2).unwrap();
    let poisson = closed.ratio(closed.poisson.as_ref().unwrap(), &[1.0]).unwrap();
    assert!((young - 2.0 / root).abs() < 1e-15 && (poisson - 1.0 / 3.0).abs() < 1e-15, "{young} {poisson}");
}

/// The unit cell problem in numbers knows nothing of the formulas.
#[test]
fn closed_forms_are_the_homogenised_tensors() {
    for lattice in NamedLattice::all() {
        let d = lattice.dimension();
        for shells in 1..=lattice.shells.len() {
            let constants: Vec<f64> = [2.0, 0.7, 0.3][..shells].to_vec();
            let closed = lattice.closed(shells).unwrap();
            let specimen = lattice.specimen(1.5, &constants).unwrap();
            let measured = measure(&specimen, &MeasureOptions::default()).unwrap();
            let found = measured.relaxed.unwrap().matrix();
            let [c11, c12, c44] =
                closed.entries.each_ref().map(|entry| closed.value(entry, &constants, 1.5, d).unwrap());
            let expected = DMatrix::from_fn(found.nrows(), found.nrows(), |i, j| match (i == j, i < d, j < d) {
                (true, true, _) => c11,
                (false, true, true) => c12,
                (true, false, _) => 2.0 * c44,
                _ => 0.0,
            });
            assert!(
                (&found - &expected).amax() < 1e-9 * expected.amax(),
                "{} {shells}: {found} {expected}",
                lattice.name
            );
            assert!((lattice.content(1.5) - measured.volume).abs() < 1e-12 * measured.volume);
        }
    }
}

/// The exact network of a mesh, whatever its element, is the material: affine and relaxed, to ten digits (the file has all digits).
#[test]
fn exact_networks_are_the_material_they_came_from() {
    let folder = TempDir::new().unwrap();
    let meshes =
        [("cube_tet.msh", "0.3"), ("specimen_hex.msh", "0.45"), ("tissue_quad.msh", "0.3"), ("tissue_tri.msh", "0.2")];
    for (mesh, poisson) in meshes {
        let mesh = place("scenes/meshes").join(mesh);
        let name = format!("{}.json", mesh.file_stem().unwrap().to_string_lossy());
        let arguments = [
            "fit",
            mesh.to_str().unwrap(),
            "--scale",
            "0.01",
            "--young",
            "10kPa",
            "--poisson",
            poisson,
            "--density",
            "1000",
            "-o",
            &name,
        ];
        prints(folder.path(), &arguments);
        let measured =
            of_file(&folder.path().join(&name), &MeasureOptions { frequencies: 3, ..MeasureOptions::default() });
        let poisson: f64 = poisson.parse().unwrap();
        for found in [Some(&measured.affine), measured.relaxed.as_ref()].into_iter().flatten() {
            let (young, ratio) = (found.young.unwrap(), found.poisson.unwrap());
            assert!((young - 1e4).abs() < 1e-10 * 1e4 && (ratio - poisson).abs() < 1e-10, "{name}: {young} {ratio}");
            assert!(found.anisotropy < 1e-10 && (found.zener.unwrap() - 1.0).abs() < 1e-9);
        }
        assert!(measured.relaxed.is_some() && measured.stability.is_stable(), "{name}: {:?}", measured.stability);
        assert!((measured.density.unwrap() - 1000.0).abs() < 1e-6, "{name}");
        assert!(measured.tension.as_ref().unwrap().is_balanced(), "{name}: {:?}", measured.tension);
        let frequencies = measured.frequencies.unwrap();
        assert!(
            frequencies.len() == 3
                && frequencies[0] > 0.0
                && frequencies.windows(2).all(|f| f[0] <= f[1] * (1.0 + 1e-9))
        );
    }
}

/// Springs alone, pulled and held: what PhysTwin, LAMMPS, arrays and a table say is what the JSON file says.
#[test]
fn files_of_other_programs_hold_the_same_network() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let scene = "title = \"block\"\nmesh = { box = { element = \"tet4\", size = [0.1, 0.1, 0.2], cells = [2, 2, 4] } }\n\
                 material = { young = 1e7, poisson = 0.25, density = 1000 }\n\
                 fit = [{ name = \"springs\", objective = \"offdiag\", nonnegative = true }]\nfix = [{ group = \"zmin\" }]\n";
    fs::write(at.join("s.toml"), scene).unwrap();
    prints(at, &["run", "s.toml", "--out", "out"]);
    let network = fs::read_dir(at.join("out"))
        .unwrap()
        .map(|e| e.unwrap().path())
        .find(|p| p.extension().is_some_and(|e| e == "json") && !p.ends_with("report.json"));
    let json = network.unwrap();
    let truth = of_file(&json, &MeasureOptions::default());
    let volume = Some(truth.volume);
    let gravity = ["--gravity", "0 0 -9.8"];
    for (target, file) in [("phystwin", "phystwin.npz"), ("lammps", "network.data"), ("npz", "network.npz")] {
        prints(at, &[&["export", json.to_str().unwrap(), "--to", target, "--out", target][..], &gravity].concat());
        let path: PathBuf = at.join(target).join(file);
        let found = of_file(&path, &MeasureOptions { volume, ..MeasureOptions::default() });
        let apart = (found.affine.matrix() - truth.affine.matrix()).amax() / truth.affine.matrix().amax();
        // LAMMPS' file has all digits, and the logarithms of PhysTwin too.
        assert!(apart < 1e-13, "{target}: {apart}");
        assert!(
            (found.mass.unwrap() - truth.mass.unwrap()).abs() < 1e-12 && found.springs == truth.springs,
            "{target}"
        );
    }
    // Contradictory numbers of points are no such file: an archive with another number is as long as it was.
    let bytes = fs::read(at.join("phystwin/phystwin.npz")).unwrap();
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(bytes)).unwrap();
    for wrong in [-1i32, 1000] {
        let mut other = zip::ZipWriter::new(fs::File::create(at.join("wrong.npz")).unwrap());
        for index in 0..archive.len() {
            let mut file = archive.by_index(index).unwrap();
            let name = file.name().unwrap().into_owned();
            let mut content = Vec::new();
            file.read_to_end(&mut content).unwrap();
            if name == "num_object_points.npy" {
                let number = content.len() - 4;
                content[number..].copy_from_slice(&wrong.to_le_bytes());
            }
            other.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
            other.write_all(&content).unwrap();
        }
        other.finish().unwrap();
        refused(
            at,
            &["measure", "wrong.npz"],
            &format!("num_object_points: expected a number of points from 0 to 45, found {wrong}"),
        );
    }
    refused(at, &["measure", "lammps/network.data"], "volume");
    refused(at, &["measure", "phystwin/phystwin.npz", "--engine", "nonsense", "--hull"], "--engine");
}

/// A chain of two bonds, in the units of the title.
fn chain(title: &str, more: &str) -> String {
    format!(
        "{title}\n\n4 atoms\n6 bonds\n1 atom types\n1 bond types\n{more}\nMasses\n\n1 2.0\n\nBond Coeffs # harmonic\n\n1 1.5 1.0\n\n\
         Atoms # bond\n\n1 1 1 0 0 0\n2 1 1 1 0 0\n3 1 1 0 1 0\n4 1 1 0 0 1\n\n\
         Bonds\n\n1 1 1 2\n2 1 1 3\n3 1 1 4\n4 1 2 3\n5 1 2 4\n6 1 3 4\n"
    )
}

/// What the units of a file are is that of its first line, and what it promises or holds beside bonds is told.
#[test]
fn files_of_lammps_keep_their_units_and_promises() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let read = |text: &str| {
        fs::write(at.join("n.data"), text).unwrap();
        read_specimen(&at.join("n.data"), &SpecimenOptions::default()).unwrap()
    };
    let si = read(&chain("units = si", ""));
    assert_eq!(si.notes[0], "the units of the file are si");
    assert!(read(&chain("a title", "")).notes[0].contains("names no units"));
    // NIST: a kilocalorie for a mole is 6.947 695e-21 J, an electron volt 1.602 176 634e-19 J, a hartree 27.211 386 245 988 eV, a Bohr
    // radius 0.529 177 210 903 Å, and an atomic mass unit 1.660 539e-27 kg.
    let units = [
        ("real", 1e-10, 6.947695e-21, 1.660539e-27),
        ("metal", 1e-10, 1.602176634e-19, 1.660539e-27),
        ("electron", 0.529177210903e-10, 27.211386245988 * 1.602176634e-19, 1.660539e-27),
        ("cgs", 0.01, 1e-7, 1e-3),
        ("micro", 1e-6, 1e-15, 1e-15),
        ("nano", 1e-9, 1e-21, 1e-21),
        ("lj", 1.0, 1.0, 1.0),
    ];
    for (name, length, energy, mass) in units {
        let title = format!("LAMMPS data file via write_data, version 2 Aug 2023, timestep = 0, units = {name}");
        let found = read(&chain(&title, ""));
        let near = |found: f64, expected: f64| (found - expected).abs() < 3e-7 * expected.abs();
        assert!(near(found.specimen.network.lengths[0].constant, 3.0 * energy / (length * length)), "{name}");
        assert!(
            near(found.specimen.network.lengths[0].rest, length) && near(found.specimen.points[3], length),
            "{name}"
        );
        assert!(near(found.specimen.masses.as_ref().unwrap()[0], 2.0 * mass), "{name}");
        assert!(found.notes[0].contains(name), "{:?}", found.notes);
    }
    let with_angles = read(&(chain("units si", "") + "\nAngle Coeffs\n\n1 3.0 90\n\nAngles\n\n1 1 2 1 3\n2 1 2 1 4\n"));
    assert!(with_angles.notes.iter().any(|note| note.contains("Angles (2 lines)")), "{:?}", with_angles.notes);
    for (text, words) in [
        (chain("units = furlongs", ""), "n.data:1: units: expected one of lj, si, cgs"),
        (chain("", "").replace("6 bonds", "7 bonds"), "Bonds: expected 7 lines, as line 4 says, found 6"),
        (chain("", "").replace("\n2 1 1 1 0 0", "\n1 1 1 1 0 0"), "a number of its own for each atom, found 1"),
    ] {
        fs::write(at.join("n.data"), text).unwrap();
        refused(at, &["measure", "n.data", "--hull"], words);
    }
}

/// Rows of a table of points in any order, with the numbers by which springs name them.
#[test]
fn points_of_a_table_have_their_numbers() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let springs = |first: usize| {
        let ends = [(0, 1, 50), (0, 2, 5), (0, 3, 6), (1, 2, 7), (1, 3, 8), (2, 3, 1)];
        let row = |(i, j, k): (usize, usize, i32)| format!("{},{},{k}\n", i + first, j + first);
        "i,j,k\n".to_string() + &ends.map(row).concat()
    };
    let measured = |points: &str, first: usize| {
        fs::write(at.join("s.csv"), springs(first)).unwrap();
        fs::write(at.join("p.csv"), points).unwrap();
        let options = SpecimenOptions { points: Some(at.join("p.csv")), ..SpecimenOptions::default() };
        let file = read_specimen(&at.join("s.csv"), &options).unwrap();
        measure(&file.specimen, &MeasureOptions { hull: true, ..MeasureOptions::default() }).unwrap().affine.matrix()
    };
    let plain = measured("x,y,z\n0,0,0\n1,0,0\n0,1,0\n0,0,1\n", 0);
    for name in ["point", "id", "node", "Number", "index"] {
        let points = format!("{name},x,y,z\n3,0,0,1\n0,0,0,0\n2,0,1,0\n1,1,0,0\n");
        assert!((measured(&points, 0) - &plain).amax() < 1e-12 * plain.amax(), "{name}");
    }
    let later = "id,x,y,z\n11,0,0,0\n12,1,0,0\n13,0,1,0\n14,0,0,1\n";
    assert!((measured(later, 11) - &plain).amax() < 1e-12 * plain.amax());
    fs::write(at.join("p.csv"), later).unwrap();
    fs::write(at.join("s.csv"), springs(10)).unwrap();
    refused(at, &["measure", "s.csv", "--points", "p.csv", "--hull"], "the number of a point in p.csv, found 10");
    fs::write(at.join("p.csv"), later.replace("12,", "11,")).unwrap();
    refused(
        at,
        &["measure", "s.csv", "--points", "p.csv", "--hull"],
        "a number of its own, found 11, which line 2 has as well",
    );
}

/// The thickness, the mean of one that varies, and the settings of an engine go with the network into its files.
#[test]
fn files_keep_the_thickness_and_the_engine() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let scene = |thickness: &str, more: &str| {
        format!(
            "mesh = {{ box = {{ element = \"tri3\", size = [40, 20], cells = [4, 3] }}, scale = \"mm\" }}\n\
             material = {{ young = 2e4, poisson = 0.3, plane = \"strain\", thickness = {thickness}, density = 1100 }}\n\
             fit = [{{ name = \"net\", {more} }}]\nfix = [{{ group = \"xmin\" }}]\n"
        )
    };
    let run = |text: &str| {
        fs::write(at.join("s.toml"), text).unwrap();
        prints(at, &["run", "s.toml", "--out", "out"]);
        prints(at, &["export", "out/net.json", "--to", "npz", "--out", "arrays", "--gravity", "0 0"]);
    };
    let json_of = |arguments: &[&str]| -> serde_json::Value { serde_json::from_str(&prints(at, arguments)).unwrap() };
    for (thickness, mean) in [("\"3 mm\"", 0.003), ("\"0.003*(1 + 10*x)\"", 0.0036)] {
        run(&scene(thickness, "objective = \"exact\""));
        for file in ["out/net.json", "arrays/network.npz"] {
            let found = json_of(&["measure", file, "--json"]);
            let number = |value: &serde_json::Value| value.as_f64().unwrap();
            assert!((number(&found["affine"]["young"]) / 2e4 - 1.0).abs() < 1e-9, "{file}: {}", found["affine"]);
            assert!(
                (number(&found["affine"]["poisson"]) - 0.3).abs() < 1e-9
                    && (number(&found["density"]) / 1100.0 - 1.0).abs() < 1e-9
            );
            assert!((number(&found["volume"]) / (0.0008 * mean) - 1.0).abs() < 1e-9, "{file}");
        }
        let notes = json_of(&["measure", "out/net.json", "--json"])["notes_of_file"].to_string();
        assert_eq!(notes.contains("the thickness differs from cell to cell"), mean > 0.003, "{notes}");
    }
    run(&scene(
        "\"3 mm\"",
        "objective = \"offdiag\", nonnegative = true, engine = { method = \"xpbd\", substeps = 10 }",
    ));
    for file in ["out/net.json", "arrays/network.npz"] {
        let notes = json_of(&["measure", file, "--json"])["notes"].to_string();
        assert!(notes.contains("the constants belong to"), "{file}: {notes}");
    }
    // A table says no thickness.
    fs::write(at.join("p.csv"), "x,y\n0,0\n1,0\n0,1\n").unwrap();
    fs::write(at.join("s.csv"), "i,j,k\n0,1,1\n1,2,1\n0,2,1\n").unwrap();
    let notes = json_of(&["measure", "s.csv", "--points", "p.csv", "--hull", "--json"])["notes"].to_string();
    assert!(notes.contains("no thickness is known"), "{notes}");
}

/// A face-centred lattice in a periodic box of LAMMPS, whose bonds cross the box: the tensor of the crystal, by the file alone.
#[test]
fn a_periodic_box_is_homogenised() {
    let folder = TempDir::new().unwrap();
    let n = 3i64;
    let sites = [[0, 0, 0], [0, 1, 1], [1, 0, 1], [1, 1, 0]];
    let mut atoms: Vec<[i64; 3]> = Vec::new();
    for cell in 0..n * n * n {
        let corner = [cell % n, cell / n % n, cell / (n * n)];
        atoms.extend(sites.iter().map(|site| [0, 1, 2].map(|k| 2 * corner[k] + site[k])));
    }
    let place =
        |x: [i64; 3]| atoms.iter().position(|own| (0..3).all(|k| (own[k] - x[k]).rem_euclid(2 * n) == 0)).unwrap();
    let mut bonds = Vec::new();
    for (i, x) in atoms.iter().enumerate() {
        for step in [[0, 1, 1], [1, 0, 1], [1, 1, 0], [0, 1, -1], [1, 0, -1], [1, -1, 0]] {
            bonds.push([i, place([0, 1, 2].map(|k| x[k] + step[k]))]);
        }
    }
    // Half of a cube of edge 2 is the unit: k = 3 N/m, so that K = 1.5; C11 = 2k/a, C12 = C44 = k/a.
    let mut text = format!("fcc\n\n{} atoms\n{} bonds\n1 atom types\n1 bond types\n\n", atoms.len(), bonds.len());
    text += &["x", "y", "z"].map(|axis| format!("0 {} {axis}lo {axis}hi\n", 2 * n)).concat();
    text += &format!("\nMasses\n\n1 2.0\n\nBond Coeffs # harmonic\n\n1 1.5 {}\n\nAtoms # bond\n\n", 2f64.sqrt());
    atoms.iter().enumerate().for_each(|(i, x)| text += &format!("{} 1 1 {} {} {}\n", i + 1, x[0], x[1], x[2]));
    text += "\nBonds\n\n";
    bonds.iter().enumerate().for_each(|(s, [i, j])| text += &format!("{} 1 {} {}\n", s + 1, i + 1, j + 1));
    let path = folder.path().join("fcc.data");
    fs::write(&path, text).unwrap();
    let found = of_file(&path, &MeasureOptions::default());
    assert_eq!((found.volume_of.as_str(), found.stability.rigid), ("period", 3));
    let c = found.relaxed.unwrap();
    let expected = [3.0, 1.5, 3.0];
    for (value, expected) in [c.stiffness[0][0], c.stiffness[0][1], c.stiffness[3][3]].iter().zip(expected) {
        assert!((value - expected).abs() < 1e-9, "{value} {expected}");
    }
    assert!((c.zener.unwrap() - 2.0).abs() < 1e-9 && (found.density.unwrap() - 1.0).abs() < 1e-12);
    // Taken as a body, it is not said that no bond crosses the box.
    let body = SpecimenOptions { is_periodic: Some(false), ..SpecimenOptions::default() };
    let notes = read_specimen(&path, &body).unwrap().notes;
    assert_eq!(notes[1..], ["bonds cross the box of the file, with which the network does not repeat itself"]);
    // As a body the same bonds would cross it: a cell of one lattice spacing leaves two images equally near.
    let small = SpecimenOptions { cell: Some(DMatrix::identity(3, 3) * 2.0), ..SpecimenOptions::default() };
    assert!(read_specimen(&path, &small).is_err());
}

/// The area of the hull of points that are far from the origin.
#[test]
fn hulls_may_be_far_from_the_origin() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    fs::write(at.join("s.csv"), "i,j,k\n0,1,1\n1,2,1\n2,3,1\n3,0,1\n0,2,1\n").unwrap();
    let corners = [[0.0, 0.0], [0.01, 0.0], [0.01, 0.005], [0.0, 0.005]];
    let row = |[x, y]: [f64; 2]| format!("{},{}\n", 1234567.875 + x, 1234567.875 + y);
    fs::write(at.join("p.csv"), "x,y\n".to_string() + &corners.map(row).concat()).unwrap();
    let text = prints(at, &["measure", "s.csv", "--points", "p.csv", "--hull", "--json"]);
    let found: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert!((found["volume"].as_f64().unwrap() / 5e-5 - 1.0).abs() < 1e-6, "{}", found["volume"]);
}

/// A lattice whose cells give way together is not stable, one point that repeats itself has no step, and a piece has the volume of its cells.
#[test]
fn lattices_are_judged_as_a_whole() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let text = prints(at, &["measure", "--lattice", "fcc", "--density", "1000"]);
    assert!(!text.contains("longest stable"), "{text}");
    let negative = prints(at, &["measure", "--lattice", "fcc", "--constants", "-1"]);
    assert!(
        negative.contains("unstable: 6 uniform strains release energy") && !negative.contains("stable: every"),
        "{negative}"
    );
    let cubic = prints(at, &["measure", "--lattice", "cubic"]);
    assert!(
        cubic.contains("not stiff: 3 uniform strains meet no resistance") && !cubic.contains("stable: every"),
        "{cubic}"
    );
    let piece = prints(
        at,
        &["measure", "--lattice", "fcc", "--cells", "4,4,4", "--spacing", "2mm", "-o", "fcc.json", "--json"],
    );
    let piece: serde_json::Value = serde_json::from_str(&piece).unwrap();
    // A cell has one point: a quarter of the cube.
    let volume = 64.0 * 2e-3f64.powi(3) / 4.0;
    assert!((piece["volume"].as_f64().unwrap() / volume - 1.0).abs() < 1e-12, "{piece}");
    assert!(at.join("fcc.json").exists());
}

/// A flex whose edges are springs, and one of finite elements, which has its material in the file.
#[test]
fn flexes_of_mujoco_are_networks_of_their_edges() {
    let folder = TempDir::new().unwrap();
    let flex = |inner: &str| {
        format!(
            "<mujoco><worldbody><body pos=\"1 2 3\"><flexcomp name=\"f\" type=\"direct\" dim=\"2\" mass=\"3\"\n\
             point=\"0 0 0  1 0 0  0.5 0.8660254037844386 0  1.5 0.8660254037844386 0\" element=\"0 1 2  1 3 2\">{inner}</flexcomp>\
             </body></worldbody></mujoco>"
        )
    };
    let path = folder.path().join("f.xml");
    fs::write(&path, flex("<edge stiffness=\"10\"/>")).unwrap();
    let found = of_file(&path, &MeasureOptions::default());
    assert_eq!((found.points, found.springs, found.dimension), (4, 5, 2));
    assert!((found.mass.unwrap() - 3.0).abs() < 1e-15 && found.volume_of == "cells");
    // The energy of the five springs by hand: edges along x (two of length 1), and three at ±60°, over √3/2 m².
    let area = 3f64.sqrt() / 2.0;
    let xx = 10.0 * (2.0 + 3.0 / 16.0) / area;
    assert!((found.affine.stiffness[0][0] - xx).abs() < 1e-12 * xx, "{:?}", found.affine);
    fs::write(&path, flex("<elasticity young=\"1e4\"/>")).unwrap();
    refused(folder.path(), &["measure", "f.xml"], "elasticity");
    fs::write(&path, flex("<edge stiffness=\"10\"/>").replace("1 3 2\"", "1 3 4\"")).unwrap();
    refused(folder.path(), &["measure", "f.xml"], "a point from 0 to 3");
}

/// Springs whose rest lengths are not those of the shape are told first.
#[test]
fn springs_that_pull_at_rest_are_told_first() {
    let folder = holding("p.csv", "x,y,z\n0,0,0\n1,0,0\n0,1,0\n0,0,1\n");
    fs::write(folder.path().join("s.csv"), "i,j,k,rest\n0,1,5,0.9\n0,2,5,1\n0,3,5,1\n1,2,5,1.4142135623730951\n1,3,5,1.4142135623730951\n2,3,5,1.4142135623730951\n").unwrap();
    let text = prints(folder.path(), &["measure", "s.csv", "--points", "p.csv", "--hull"]);
    let second = text.lines().nth(1).unwrap();
    assert!(second.contains("not at rest in this shape"), "{text}");
    assert!(text.contains("volume 0.166667"), "{text}");
    refused(folder.path(), &["measure", "s.csv"], "--points");
    refused(folder.path(), &["measure", "s.csv", "--points", "p.csv"], "--hull");
    fs::write(folder.path().join("bad.csv"), "i,j,k\n0,1,5\n0,4,5\n").unwrap();
    refused(folder.path(), &["measure", "bad.csv", "--points", "p.csv", "--hull"], "are points numbered from 1?");
}

/// What an engine reaches at its settings is what the fits for engines print of the same body, to the loads.
#[test]
fn the_limit_of_an_engine_is_measured() {
    let folder = TempDir::new().unwrap();
    prints(
        folder.path(),
        &[
            "measure",
            "--lattice",
            "cubic",
            "--constants",
            "100,50,20",
            "--spacing",
            "1cm",
            "--cells",
            "4,4,10",
            "--hull",
            "-o",
            "b.json",
        ],
    );
    let path = folder.path().join("b.json");
    let file = read_specimen(&path, &SpecimenOptions::default()).unwrap();
    let setting = springfit_bodies::engine::Setting::usual(springfit_bodies::engine::Engine::Xpbd);
    let count = file.specimen.count();
    let options = MeasureOptions {
        hull: true,
        point_volumes: Some(vec![1e-6; count]),
        density: Some(1000.0),
        ..MeasureOptions::default()
    };
    let limit = |substeps: usize| {
        let options = MeasureOptions { engine: Some(setting.with_substeps(substeps)), ..options.clone() };
        measure(&file.specimen, &options).unwrap().engine.unwrap()
    };
    let (few, many) = (limit(2), limit(40));
    assert!(few.ceiling.unwrap() < many.ceiling.unwrap(), "{few:?} {many:?}");
    let least = few.least_substeps.unwrap();
    assert_eq!(Some(least), many.least_substeps);
    assert!(limit(least).ceiling.unwrap() >= 1.0 && (least == 1 || limit(least - 1).ceiling.unwrap() < 1.0));
}

fn shifted(element: &Element) -> Vec<f64> {
    // The reference cell, stretched and sheared.
    let d = element.dimension();
    element
        .positions
        .chunks_exact(d)
        .flat_map(|x| (0..d).map(move |k| (1.0 + 0.2 * k as f64) * x[k] + 0.1 * x[(k + 1) % d]))
        .collect()
}

/// R of each shipped element, written as a matrix and read back, has the constants of the element's own fit.
#[test]
fn matrices_of_elements_have_the_constants_of_the_elements() {
    let folder = TempDir::new().unwrap();
    let mut seen = 0;
    for element in elements().into_iter().map(Arc::new) {
        let d = element.dimension();
        let Ok(springs) = Springs::select(&element, None) else { continue };
        let x = shifted(&element);
        let state = match d {
            1 => State::Rod { area: 1.0 },
            2 => State::PlaneStress { thickness: 1.0 },
            _ => State::Solid,
        };
        let material = Material::new(1e4, 0.3, state).unwrap();
        let Ok(r) = reference_fit::stiffness(&element, &x, &Hooke::Isotropic(material.moduli())) else { continue };
        if springs.pairs().len() != springs.len() {
            continue;
        }
        let path = folder.path().join("r.mtx");
        let mut text = format!(
            "%%MatrixMarket matrix coordinate real symmetric\n{0} {0} {1}\n",
            r.nrows(),
            r.nrows() * (r.nrows() + 1) / 2
        );
        for (i, j) in (0..r.nrows()).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            text += &format!("{} {} {:e}\n", i + 1, j + 1, r[(i, j)]);
        }
        fs::write(&path, text).unwrap();
        let given = GivenStiffness::new(read_matrix(&path).unwrap(), x.clone(), d).unwrap();
        let mut objectives = vec![Objective::Frobenius(Weight::None), Objective::Frobenius(Weight::OffDiagonal)];
        if element.nodes() <= 8 {
            objectives.push(Objective::Spectral(springfit_fit::fit::MotionWeight::None));
        }
        for objective in objectives {
            let fit = Fit::new(objective);
            let own = fit_element(&element, &springs, &x, material.moduli(), &fit).unwrap();
            let found = given.fit(springs.pairs(), &fit).unwrap();
            let largest = own.iter().fold(0.0f64, |largest, k| largest.max(k.abs()));
            let apart = own.iter().zip(&found.constants).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest;
            // An optimum of the 2-norm is known to its gap, and may be one of several.
            let enough = if matches!(objective, Objective::Spectral(_)) { 1e-4 } else { 1e-12 };
            assert!(apart < enough || !found.is_unique, "{} {}: {apart:e}", element.name, objective.title());
        }
        seen += 1;
    }
    assert!(seen > 10, "{seen}");
}

#[test]
fn a_matrix_is_proved_before_it_is_fitted() {
    let element = loaded("hex8");
    let x = shifted(&element);
    let material = Material::new(1e4, 0.3, State::Solid).unwrap();
    let r = reference_fit::stiffness(&element, &x, &Hooke::Isotropic(material.moduli())).unwrap();
    let key = |r: DMatrix<f64>, x: Vec<f64>| GivenStiffness::new(r, x, 3).unwrap_err().key().unwrap().to_string();
    let mut skew = r.clone();
    skew[(0, 5)] += 100.0;
    assert_eq!(key(skew, x.clone()), "symmetry");
    let mut held = r.clone();
    held[(0, 0)] += 1e3;
    assert_eq!(key(held, x.clone()), "rigid motions");
    // A rotation of other points is none of these.
    let mut moved = x.clone();
    moved[0] += 0.5;
    assert_eq!(key(r.clone(), moved), "rigid motions");
    assert_eq!(key(r.clone(), x[..21].to_vec()), "matrix");
    let mut odd = r.clone();
    odd[(2, 3)] = f64::NAN;
    assert_eq!(key(odd, x.clone()), "matrix[2][3]");
    // The tangent of a solver whose sign is turned round.
    assert_eq!(key(-r.clone(), x.clone()), "matrix");
    // Two hexahedra on each other, whose middle points are condensed, are a superelement: R_kk − R_kc R_cc⁻¹ R_ck.
    let kept: Vec<usize> = (0..12).collect();
    let own = condense(&r, &kept).unwrap();
    let at = |rows: std::ops::Range<usize>, columns: std::ops::Range<usize>| {
        r.view((rows.start, columns.start), (rows.len(), columns.len())).into_owned()
    };
    let expected = at(0..12, 0..12) - at(0..12, 12..24) * at(12..24, 12..24).try_inverse().unwrap() * at(12..24, 0..12);
    assert!((own - &expected).amax() < 1e-9 * expected.amax());
    assert!(condense(&r, &[0, 0]).is_err() && condense(&r, &[24]).is_err());
}
