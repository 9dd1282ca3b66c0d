//! Scenes as people write them: regions, materials by other constants, data in another unit, and the first scene of any file.

use super::springfit;
use crate::kit::{outcome, outcome_in};
use springfit_studies::study::Outcome;
use std::fmt::Write;
use std::fs;
use std::path::Path;

const BOX: &str = "[mesh]\nbox = { element = \"hex8\", size = [4, 1, 1], cells = [4, 1, 1] }\n";
const REST: &str =
    "[[fit]]\nobjective = \"exact\"\n[[fix]]\ngroup = \"xmin\"\n[[load]]\ngroup = \"xmax\"\nforce = [1, 0, 0]\n";

fn refused(text: &str, folder: &Path) -> String {
    outcome_in(folder, text).unwrap_err().to_string()
}

/// Any two constants state the material; those of the other pairs are worked out by hand for E = 10 kPa and ν = 0.25: μ = 4 kPa, λ = 4 kPa, K = 20/3 kPa.
#[test]
fn two_constants_state_a_material() {
    let all = [("young", 1e4), ("poisson", 0.25), ("shear_modulus", 4e3), ("bulk_modulus", 2e4 / 3.0), ("lambda", 4e3)];
    let mut pairs = 0;
    for i in 0..all.len() {
        for j in 0..all.len() {
            if i == j {
                continue;
            }
            let material = [all[i], all[j]].map(|(key, value)| format!("{key} = {value:?}\n")).concat();
            let found = outcome(&format!("{BOX}[material]\n{material}{REST}")).material.uniform().unwrap().moduli();
            assert!((found.lambda - 4e3).abs() < 1e-8 && (found.mu - 4e3).abs() < 1e-8, "{material}: {found:?}");
            pairs += 1;
        }
    }
    assert_eq!(pairs, 20);
    let here = Path::new("");
    for (material, said) in [
        ("young = 1e4\nshear_modulus = 1e3\n", "expected constants of a material"),
        ("young = 1e4\npoisson = 0.3\nlambda = 1e3\n", "expected two of \"young\""),
        ("lambda = 1e3\n", "expected two of \"young\""),
        ("lambda = 1e3\npoisson = 0\n", "expected constants of a material"),
        ("shear_modulus = \"1e3*x\"\npoisson = 0.3\n", "shear_modulus: expected a number"),
    ] {
        let said_then = refused(&format!("{BOX}[material]\n{material}{REST}"), here);
        assert!(said_then.contains(said), "{material}: {said_then}");
    }
}

/// A condition of a material chooses cells by their middle: no layer is lost, and each cell is in one of two parts.
#[test]
fn a_region_has_the_cells_whose_middle_is_in_it() {
    for cut in ["2", "1.7", "2.3"] {
        let text = format!(
            "{BOX}[[material]]\nwhere = \"x > {cut}\"\nyoung = 1e4\npoisson = 0\n[[material]]\nwhere = \"x <= {cut}\"\nyoung = 2e4\npoisson = 0\n{REST}\
             [reference]\nfrom = \"quadratic\"\nrefine = 1\n"
        );
        let outcome = outcome(&text);
        // Two cubes of each: u = 2 F/(E₁ A) + 2 F/(E₂ A), on these cells and on those of the reference.
        let largest = outcome.loads[0].fem.iter().fold(0.0, |a: f64, u| a.max(u.abs()));
        assert!((largest - 3e-4).abs() < 1e-12, "{cut}: {largest}");
        assert!(outcome.fits[0].loads[0].error.unwrap().max < 1e-6, "{cut}");
    }
}

#[test]
fn conditions_that_select_nothing_or_all_are_told() {
    let material = "[material]\nyoung = 1e4\npoisson = 0.3\n";
    let at = |condition: &str| {
        format!("{BOX}{material}{}", REST.replace("group = \"xmin\"", &format!("where = \"{condition}\"")))
    };
    let said = refused(&at("x > 100"), Path::new(""));
    assert!(
        said.contains("fix[0]: holds nothing")
            && said.contains("the body extends from 0 to 4 m along x, from 0 to 1 m along y"),
        "{said}"
    );
    let notes = |text: &str| springfit_report::report::notes(&outcome(text)).join("\n");
    let load = REST.replace("group = \"xmax\"\nforce", "name = \"all\"\nwhere = \"x > -1\"\nforce");
    let said = notes(&format!("{BOX}{material}{load}"));
    assert!(said.contains("where = \"x > -1\" of the load all holds at all points of the body"), "{said}");
    let said = notes(&at("x < 0.7"));
    assert!(said.contains("of fix[0] cuts through 1 cell"), "{said}");
    assert!(!notes(&at("x < 0.3")).contains("cuts"), "{said}");
}

/// A thickness that the deck states is offered where none is given.
#[test]
fn the_thickness_of_a_deck_is_offered() {
    let folder = tempfile::tempdir().unwrap();
    let deck = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n*ELEMENT, TYPE=S4, ELSET=P\n1,1,2,3,4\n*SHELL SECTION, ELSET=P, MATERIAL=S\n0.002\n";
    fs::write(folder.path().join("plate.inp"), deck).unwrap();
    let text = "[mesh]\nfile = \"plate.inp\"\n[material]\nyoung = 1e9\npoisson = 0.3\n[[fit]]\nobjective = \"exact\"\n";
    let said = |text: &str| springfit_report::report::notes(&outcome_in(folder.path(), text).unwrap()).join("\n");
    let words = "assumed to be 1 m; \"thickness\" in the material sets it, and the file states 0.002 in its unit";
    assert!(said(text).contains(words), "{}", said(text));
    assert!(!said(&text.replace("poisson", "thickness = 0.002\npoisson")).contains("assumed"), "{}", said(text));
}

/// A grid of E from 10 to 40 kPa along x, in the unit of the file, on a body of 40 mm.
fn map(unit: f64, steps: usize) -> String {
    let mut text = String::from("x,y,z,E\n");
    for i in 0..=steps {
        for (y, z) in [(0.0, 0.0), (10.0, 0.0), (0.0, 10.0), (10.0, 10.0)] {
            let x = 40.0 * i as f64 / steps as f64;
            writeln!(text, "{},{},{},{}", x * unit, y * unit, z * unit, 1e4 + 3e4 * i as f64 / steps as f64).unwrap();
        }
    }
    text
}

#[test]
fn material_data_in_another_unit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let scene = |data: &str| {
        format!(
            "[mesh]\nbox = {{ element = \"hex8\", size = [40, 10, 10], cells = [8, 2, 2] }}\nscale = \"mm\"\n\
             [material]\nyoung = {{ file = \"map.csv\"{data} }}\npoisson = 0.3\n{REST}"
        )
    };
    let range = |outcome: &Outcome| {
        let all: Vec<f64> = outcome.material.materials().unwrap().values().map(|m| m.young()).collect();
        (all.iter().copied().fold(f64::INFINITY, f64::min), all.iter().copied().fold(0.0, f64::max))
    };
    for steps in [1, 2, 8] {
        write("map.csv", &map(1.0, steps));
        let (least, most) = range(&outcome_in(folder.path(), &scene(", scale = \"mm\"")).unwrap());
        assert!((least - 11875.0).abs() < 2000.0 && (most - 38125.0).abs() < 2000.0, "{steps}: {least} to {most}");
        let far = "map.csv: scale: expected places about as far apart as the body is long";
        let near = "expected values around every cell";
        for (scale, words) in
            [("", far), (", scale = \"cm\"", far), (", scale = \"km\"", far), (", scale = \"um\"", near)]
        {
            let said = refused(&scene(scale), folder.path());
            assert!(said.contains(words), "{scale}: {said}");
        }
    }
    // Data of half of the body.
    let half: String = map(0.5, 40).lines().fold(String::new(), |all, line| all + line + "\n");
    write("map.csv", &half);
    assert!(refused(&scene(", scale = \"mm\""), folder.path()).contains("expected values around every cell"));
    // Values that no modulus has, and the number that says so.
    write("map.csv", &(map(1.0, 8) + "20,5,5,-9999\n"));
    let said = refused(&scene(", scale = \"mm\""), folder.path());
    assert!(
        said.contains("map.csv:38: points[36]: expected a number above 0, found -9999; missing = -9999.0"),
        "{said}"
    );
    let told = outcome_in(folder.path(), &scene(", scale = \"mm\", missing = -9999")).unwrap();
    let said = springfit_report::report::notes(&told).join("\n");
    assert!(said.contains("1 place of map.csv without a value (-9999) were left out"), "{said}");
    // Data in the file of the mesh have its unit.
    let grid = "# vtk DataFile Version 3.0\nm\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 12 double\n0 0 0 10 0 0 20 0 0 0 10 0 10 10 0 20 10 0 0 0 10 10 0 10\n\
                20 0 10 0 10 10 10 10 10 20 10 10\nCELLS 2 18\n8 0 1 4 3 6 7 10 9\n8 1 2 5 4 7 8 11 10\nCELL_TYPES 2\n12 12\nCELL_DATA 2\nSCALARS E double 1\n\
                LOOKUP_TABLE default\n5000 50000\n";
    write("own.vtk", grid);
    let text = "[mesh]\nfile = \"own.vtk\"\nscale = \"mm\"\n[material]\nyoung = { file = \"own.vtk\", array = \"E\" }\npoisson = 0.3\n[[fit]]\nobjective = \"exact\"\n";
    assert_eq!(range(&outcome_in(folder.path(), text).unwrap()), (5000.0, 50000.0));
}

/// The scene that `new` writes for a file, which runs.
fn drafted(folder: &Path, file: &str, text: &str, more: &str) -> String {
    fs::write(folder.join(file), text).unwrap();
    let _ = fs::remove_file(folder.join("s.toml"));
    let (output, said) = springfit(folder, &format!("new {file} -o s.toml{more}"));
    assert!(output.status.success(), "{file}: {said}");
    let scene = fs::read_to_string(folder.join("s.toml")).unwrap();
    let (output, said) = springfit(folder, "run s.toml --out o");
    assert!(output.status.success(), "{file}: {said}\n{scene}");
    scene
}

#[test]
fn the_first_scene_of_a_file_runs_and_says_what_the_file_says() {
    let folder = tempfile::tempdir().unwrap();
    let bent = "v 0 0 0\nv 1 0 0\nv 1 1 0.1\nv 0 1 0\nv 2 0 0.1\nv 2 1 0\nf 1 2 3 4\nf 2 5 6 3\n";
    let scene = drafted(folder.path(), "bent.obj", bent, "");
    assert!(
        scene.contains("objective = \"frobenius\"") && scene.contains("# The body extends from 0 to 2 m along x"),
        "{scene}"
    );
    let cubes = "*NODE\n1,0,0,0\n2,10,0,0\n3,10,10,0\n4,0,10,0\n5,0,0,10\n6,10,0,10\n7,10,10,10\n8,0,10,10\n9,20,0,0\n10,20,10,0\n11,20,0,10\n12,20,10,10\n\
                 *ELEMENT, TYPE=C3D8, ELSET=SOFT\n1,1,2,3,4,5,6,7,8\n*ELEMENT, TYPE=C3D8, ELSET=HARD\n2,2,9,10,3,6,11,12,7\n\
                 *SOLID SECTION, ELSET=SOFT, MATERIAL=RUBBER\n*SOLID SECTION, ELSET=HARD, MATERIAL=STEEL\n\
                 *MATERIAL, NAME=RUBBER\n*ELASTIC\n0.01, 0.45\n*DENSITY\n1.1e-9\n*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.3\n*DENSITY\n7.85e-9\n";
    let scene = drafted(folder.path(), "cubes.inp", cubes, " --scale mm");
    let table: toml::Table = scene.parse().unwrap();
    let materials = table["material"].as_array().unwrap();
    let number = |i: usize, key: &str| {
        materials[i][key].as_float().or(materials[i][key].as_integer().map(|x| x as f64)).unwrap()
    };
    assert_eq!(materials.len(), 2, "{scene}");
    assert_eq!((materials[0]["group"].as_str(), materials[1]["group"].as_str()), (Some("SOFT"), Some("HARD")));
    for (found, expected) in [
        (number(0, "young"), 1e4),
        (number(0, "poisson"), 0.45),
        (number(0, "density"), 1100.0),
        (number(1, "young"), 2.1e11),
        (number(1, "density"), 7850.0),
    ] {
        assert!((found - expected).abs() < 1e-6 * expected, "{found} and {expected}");
    }
    // Hexahedra that lock get volume springs on cells.
    assert!(scene.contains("volume    = \"cells\""), "{scene}");
    let plate = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n*ELEMENT, TYPE=S4, ELSET=P\n1,1,2,3,4\n*SHELL SECTION, ELSET=P, MATERIAL=S\n0.002\n*MATERIAL, NAME=S\n*ELASTIC\n7e10, 0.33\n";
    let scene = drafted(folder.path(), "plate.inp", plate, "");
    assert!(scene.contains("thickness = 0.002") && scene.contains("1 S4 element is membranes"), "{scene}");
}

/// A scan with a fragment beside it: the support is that of the large piece, and the fragment is held as a whole.
#[test]
fn a_fragment_does_not_hold_the_body() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::from("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n64\n");
    for i in 0..60 {
        let (x, y, z) = (i / 4, [0, 1, 1, 0][i % 4], [0, 0, 1, 1][i % 4]);
        writeln!(text, "{} {x} {y} {z}", i + 1).unwrap();
    }
    for (i, [x, y, z]) in [[20.0, 0.0, 0.0], [20.5, 0.0, 0.0], [20.0, 0.5, 0.0], [20.0, 0.0, 0.5]].iter().enumerate() {
        writeln!(text, "{} {x} {y} {z}", 61 + i).unwrap();
    }
    writeln!(text, "$EndNodes\n$Elements\n15").unwrap();
    for i in 0..14 {
        let at = |plane: usize, a: usize| 4 * (i + plane) + a + 1;
        let nodes =
            [at(0, 0), at(1, 0), at(1, 1), at(0, 1), at(0, 3), at(1, 3), at(1, 2), at(0, 2)].map(|n| n.to_string());
        writeln!(text, "{} 5 2 0 1 {}", i + 1, nodes.join(" ")).unwrap();
    }
    writeln!(text, "15 4 2 0 1 61 62 63 64\n$EndElements").unwrap();
    let scene = drafted(folder.path(), "scan.msh", &text, "");
    let table: toml::Table = scene.parse().unwrap();
    let held = table["fix"].as_array().unwrap();
    assert_eq!(held.len(), 2, "{scene}");
    let first = held[0]["where"].as_str().unwrap();
    let limit: f64 = first.strip_prefix("x < ").unwrap().parse().unwrap();
    assert!(limit < 3.0, "{first}");
    assert!(held[1]["where"].as_str().unwrap().starts_with("x > 19.99"), "{scene}");
}

/// A cloth at z = 0 and one at y = 0 hang alike.
#[test]
fn a_flat_sheet_hangs_whatever_its_axis() {
    let folder = tempfile::tempdir().unwrap();
    let largest: Vec<f64> = [("z", "x y 0", "[0, 0, -9.81]"), ("y", "x 0 y", "[0, -9.81, 0]")]
        .into_iter()
        .map(|(name, place, gravity)| {
            let mut text = String::new();
            for i in 0..=4 {
                for j in 0..=4 {
                    let at = place.replace('x', &format!("{}", 0.1 * i as f64)).replace('y', &format!("{}", 0.1 * j as f64));
                    writeln!(text, "v {at}").unwrap();
                }
            }
            for i in 0..4 {
                for j in 0..4 {
                    let n = |a: usize, b: usize| 5 * (i + a) + j + b + 1;
                    writeln!(text, "f {} {} {}\nf {} {} {}", n(0, 0), n(1, 0), n(1, 1), n(0, 0), n(1, 1), n(0, 1)).unwrap();
                }
            }
            fs::write(folder.path().join(format!("{name}.obj")), text).unwrap();
            let scene = format!(
                "mesh = {{ file = \"{name}.obj\" }}\nmaterial = {{ young = \"1 MPa\", poisson = 0.3, density = 300, thickness = 0.0005 }}\n\
                 fit = [{{ objective = \"offdiag\", nonnegative = true }}]\nfix = [{{ where = \"x < 1e-9\" }}]\n\
                 [motion]\nduration = \"0.1 s\"\nstep = \"5 ms\"\ngravity = {gravity}\nfinite_elements = false\n"
            );
            let outcome = outcome_in(folder.path(), &scene).unwrap();
            outcome.motion.unwrap().models[0].records.last().unwrap().account.kinetic
        })
        .collect();
    assert!(largest[0] > 0.0 && (largest[0] - largest[1]).abs() < 1e-9 * largest[0], "{largest:?}");
}

/// A pressure on all sides of a block without a side along the axes: by `u = −p (1 − 2ν)/E x` it shrinks evenly.
#[test]
fn a_pressed_block_shrinks() {
    let folder = tempfile::tempdir().unwrap();
    let points = "0 0 0\n1 0 0\n1.2 1 0.1\n0 1 0\n0.1 0 1\n1 0.2 1.1\n1 1 1.3\n0 1.1 0.9\n";
    let cells =
        ["0 1 2 6", "0 2 3 6", "0 3 7 6", "0 7 4 6", "0 4 5 6", "0 5 1 6"].map(|nodes| format!("4 {nodes}\n")).concat();
    let text = format!(
        "# vtk DataFile Version 3.0\nblock\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n{points}CELLS 6 30\n{cells}\
         CELL_TYPES 6\n{}",
        "10\n".repeat(6)
    );
    fs::write(folder.path().join("block.vtk"), text).unwrap();
    let scene = "mesh = { file = \"block.vtk\" }\nmaterial = { young = 1e4, poisson = 0.3 }\nfit = [{ objective = \"exact\" }]\n\
                 fix = [{ where = \"x < 1e-9 && y < 1e-9 && z < 1e-9\" }, { where = \"x > 0.99 && x < 1.01 && y < 1e-9\", axes = [\"y\", \"z\"] },\n\
                 { where = \"x < 1e-9 && y > 0.99 && y < 1.01\", axes = [\"z\"] }]\n\
                 load = [{ name = \"pressure\", where = \"x > -100\", pressure = 100 }]\n";
    let outcome = outcome_in(folder.path(), scene).unwrap();
    let fem = &outcome.loads[0].fem;
    let worst =
        fem.iter().zip(&outcome.mesh.points).map(|(u, x)| (u + 100.0 * 0.4 / 1e4 * x).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-15, "{worst:e}");
    assert!((outcome.loads[0].largest_displacement(&outcome.mesh) - 7.684e-3).abs() < 5e-7);
}
