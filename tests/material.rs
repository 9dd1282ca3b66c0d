//! What a network is as a material: the elasticity tensor from samples of its cells.

use crate::kit::outcome_in;
use crate::shapes::bodies::vtk_text;
use crate::shapes::{Random, elements, loaded, materials, single, valid};
use nalgebra::{DMatrix, DVector, Rotation3, Vector3};
use springfit_bodies::model::Network;
use springfit_element::element::Element;
use springfit_element::material::Material;
use springfit_element::springs::Springs;
use springfit_fit::fit::{CellFits, ExactFit, fit_exact};
use springfit_mesh::mesh::{BoxMesh, CellBlock, Mesh};
use springfit_report::report;
use springfit_studies::study::{
    FitEntry, FitOutcome, Lattice, NetworkMaterial, Outcome, Recipe, Reference, Scene, SpringOwners, fit_mesh,
    network_material, run,
};
use std::path::Path;
use std::sync::Arc;

fn grid(element: &Arc<Element>, cells: usize) -> Option<Mesh> {
    let d = element.dimension();
    let (size, origin) = ([1.0, 1.3, 0.7][..d].to_vec(), vec![0.0; d]);
    (element.space() == d).then_some(())?;
    BoxMesh { element: element.clone(), size, cells: vec![cells; d], origin }.build().ok()
}

/// A rod of unit length.
fn rod(element: &Arc<Element>, cells: usize) -> Mesh {
    let points = (0..=cells).map(|i| i as f64 / cells as f64).collect();
    let connectivity = (0..cells).flat_map(|i| [i, i + 1]).collect();
    let blocks = vec![CellBlock { element: element.clone(), connectivity }];
    Mesh { points, blocks, ..single(element, &[]) }
}

fn shipped(name: &str) -> Arc<Element> {
    loaded(name)
}

/// The points that are not on the boundary of a box, each moved by up to a fifth of the size of its cells.
fn jittered(mut mesh: Mesh, cells: usize) -> Mesh {
    let (d, mut random) = (mesh.dimension, Random(3));
    let size = [1.0, 1.3, 0.7];
    for point in mesh.points.chunks_exact_mut(d) {
        let is_inside = point.iter().zip(size).all(|(x, size)| *x > 1e-9 && *x < size - 1e-9);
        let moves: Vec<f64> = size[..d].iter().map(|size| 0.2 * size / cells as f64 * random.next()).collect();
        point.iter_mut().zip(moves).filter(|_| is_inside).for_each(|(x, by)| *x += by);
    }
    mesh
}

/// The same mesh in a space of one more dimension, in which it is bent like a parabola, or flat in a plane at a slant.
fn lifted(mesh: &Mesh, is_bent: bool) -> Mesh {
    let d = mesh.dimension;
    let element = Arc::new(mesh.blocks[0].element.as_ref().clone().in_space(d + 1));
    let height = |x: &[f64]| if is_bent { x[0] * x[0] } else { 0.7 * x[0] };
    let points = mesh.points.chunks_exact(d).flat_map(|x| x.iter().copied().chain([height(x)])).collect();
    let blocks = vec![CellBlock { element, ..mesh.blocks[0].clone() }];
    Mesh { dimension: d + 1, points, blocks, ..mesh.clone() }
}

fn fitted(mesh: &Mesh, material: Material, entry: FitEntry) -> FitOutcome {
    let named = entry.fits(Path::new("")).unwrap().remove(0);
    fit_mesh(mesh, material, &Reference::default(), &named, &mut |_| {}).unwrap()
}

fn solid(poisson: f64) -> Material {
    Material::for_body(3, 1e4, poisson, None, None).unwrap()
}

/// Within a share of 1e-9: constants of some hundred springs are added up and a stiffness of a few hundred equations is solved.
fn is_material(found: &NetworkMaterial, asked: Material, name: &str) {
    assert!(found.largest_distance < 1e-9, "{name}: {found:?}");
    assert!((found.young.unwrap() / asked.young() - 1.0).abs() < 1e-9, "{name}: {found:?}");
    match found.poisson {
        Some(poisson) => assert!((poisson - asked.poisson()).abs() < 1e-9, "{name}: {found:?}"),
        None => assert_eq!(asked.state().dimension(), 1, "{name}"),
    }
}

/// Of every element, in boxes where its cells fill them, and of one cell of any shape.
#[test]
fn exact_networks_are_the_material() {
    let mut random = Random(11);
    for element in elements().into_iter().map(Arc::new) {
        let x = valid(&element, &mut random);
        let meshes = grid(&element, 3).map(|mesh| jittered(mesh, 3)).into_iter();
        // Moved points fold cells with nodes on their edges.
        let meshes = meshes.filter(|_| element.nodes() == element.cell.corners().len());
        for mesh in meshes.chain(grid(&element, 2)).chain([single(&element, &x)]) {
            // Cells of many nodes have many springs: one material will do.
            let some = if element.nodes() > 9 { 2..3 } else { 0..usize::MAX };
            for material in materials(element.dimension()).into_iter().skip(some.start).take(some.len()) {
                is_material(&fitted(&mesh, material, FitEntry::new("exact")).as_material, material, &element.name);
            }
        }
    }
}

/// Affine displacements have one volume ratio, whatever it is the mean of.
#[test]
fn volume_springs_on_cells_and_patches_are_the_material() {
    let (tet4, hex8) =
        (jittered(grid(&shipped("tet4"), 6).unwrap(), 6), jittered(grid(&shipped("hex8"), 4).unwrap(), 4));
    let material = solid(0.49);
    let exact = |volume: &str| FitEntry::new("exact").with("volume", Some(volume));
    for volume in ["points", "cells", "patches"] {
        is_material(&fitted(&tet4, material, exact(volume)).as_material, material, volume);
    }
    is_material(&fitted(&hex8, material, exact("cells")).as_material, material, "hex8");
}

/// Of bent surfaces every cell has its own tensor; in flat ones the points inside a sample move in its plane.
#[test]
fn exact_networks_of_surfaces_and_curves_are_the_material() {
    for (name, is_bent) in [("tri3", true), ("tri3", false), ("quad4", false), ("bar2", true), ("bar2", false)] {
        let element = shipped(name);
        let mesh = if element.dimension() == 1 { rod(&element, 5) } else { grid(&element, 5).unwrap() };
        let mesh = lifted(&jittered(mesh, 5), is_bent);
        for material in materials(element.dimension()) {
            is_material(&fitted(&mesh, material, FitEntry::new("exact")).as_material, material, name);
        }
    }
}

/// Constants 1.3 times too large are a modulus 1.3 times too large, and a tensor that is off by 30 %.
#[test]
fn wrong_constants_are_measured() {
    let mesh = jittered(grid(&shipped("tet4"), 4).unwrap(), 4);
    let material = solid(0.3);
    let block = &mesh.blocks[0];
    let fit = ExactFit::default();
    let mut fits: CellFits =
        fit_exact(&block.element, &mesh.points, &block.connectivity, material, &fit, &mut |_| {}).unwrap();
    fits.constants.iter_mut().chain(&mut fits.parameters).for_each(|k| *k *= 1.3);
    let network = Network::assemble(&mesh, std::slice::from_ref(&fits));
    let found = network_material(&mesh, material, SpringOwners::Cells(&[fits]), &network);
    for distance in [found.distance, found.mean_distance, found.largest_distance] {
        assert!((distance - 0.3).abs() < 1e-9, "{found:?}");
    }
    assert!(
        (found.young.unwrap() / 1.3e4 - 1.0).abs() < 1e-9 && (found.poisson.unwrap() - 0.3).abs() < 1e-9,
        "{found:?}"
    );
}

/// Equal cells in a row without end have no better places than those of an affine strain: every sample is the lattice, whose moduli
/// are worked out by periodic displacements. The network without its cells, too: each spring belongs to its cells alike. Of the ways
/// in which simplices lie in a box a sample does not have equally many: they are the lattice within a hundredth.
#[test]
fn boxes_of_equal_cells_are_their_lattices() {
    for name in ["tri3", "quad4", "tet4", "hex8"] {
        let element = shipped(name);
        let d = element.dimension();
        let mesh = grid(&element, 6).unwrap();
        let material = materials(d)[2];
        let named = FitEntry::new("frobenius").fits(Path::new("")).unwrap().remove(0);
        let Recipe::Stiffness(fit) = &named.recipe else { unreachable!() };
        let springs = Springs::select(&element, None).unwrap();
        let size: Vec<f64> = [1.0, 1.3, 0.7][..d].iter().map(|size| size / 6.0).collect();
        let known = Lattice::fit(&element, &springs, &size, material, fit).unwrap().of_springs().unwrap().stiffness;
        let kelvin = |i: usize| if i < d { 1.0 } else { f64::sqrt(2.0) };
        let known = DMatrix::from_fn(known.nrows(), known.ncols(), |i, j| kelvin(i) * kelvin(j) * known[(i, j)]);
        let outcome = fitted(&mesh, material, FitEntry::new("frobenius"));
        let whole = network_material(&mesh, material, SpringOwners::Body, &outcome.network);
        let off = |found: &NetworkMaterial| (&found.stiffness - &known).norm() / known.norm();
        let is_simplex = element.nodes() == d + 1;
        let tolerance = if is_simplex { 1e-2 } else { 1e-9 };
        assert!(off(&outcome.as_material) < tolerance, "{name}: {known} {:?}", outcome.as_material);
        assert!(is_simplex || off(&whole) < tolerance, "{name}: {known} {whole:?}");
    }
}

/// A body that is turned is the same material.
#[test]
fn the_axes_do_not_matter() {
    let mesh = jittered(grid(&shipped("tet4"), 6).unwrap(), 6);
    let turn = Rotation3::from_scaled_axis(Vector3::new(0.4, -1.1, 0.7));
    let mut turned = mesh.clone();
    for point in turned.points.chunks_exact_mut(3) {
        let x = turn * Vector3::new(point[0], point[1], point[2]);
        point.copy_from_slice(DVector::from_column_slice(x.as_slice()).as_slice());
    }
    for objective in ["offdiag", "frobenius", "divergence"] {
        let [a, b] = [&mesh, &turned].map(|mesh| fitted(mesh, solid(0.3), FitEntry::new(objective)).as_material);
        let same = |a: f64, b: f64| assert!((a - b).abs() < 1e-9 * a.abs(), "{objective}: {a} {b}");
        same(a.distance, b.distance);
        same(a.largest_distance, b.largest_distance);
        same(a.young.unwrap(), b.young.unwrap());
        same(a.poisson.unwrap(), b.poisson.unwrap());
    }
}

/// A sheet of the plane in space, with heights, turned.
fn in_space(mesh: &Mesh, height: impl Fn(&[f64]) -> f64, turn: &Rotation3<f64>) -> Mesh {
    let element = Arc::new(mesh.blocks[0].element.as_ref().clone().in_space(3));
    let place = |x: &[f64]| -> [f64; 3] { (turn * Vector3::new(x[0], x[1], height(x))).into() };
    let points = mesh.points.chunks_exact(2).flat_map(place).collect();
    let blocks = vec![CellBlock { element, ..mesh.blocks[0].clone() }];
    Mesh { dimension: 3, points, blocks, ..mesh.clone() }
}

/// In whatever plane it lies, and however it is turned there: the tensors of samples have axes in common. Those of a plane that is turned
/// about x by less than a right angle are x and what was y.
#[test]
fn a_flat_sheet_in_space_is_the_material_that_it_is_in_the_plane() {
    let mesh = jittered(grid(&shipped("tri3"), 16).unwrap(), 16);
    let material = materials(2)[2];
    let entry = || FitEntry::new("offdiag").with("nonnegative", Some(true));
    let plane = fitted(&mesh, material, entry()).as_material;
    assert!(plane.samples > 1);
    for (axis, degrees) in [
        ([1.0, 0.0, 0.0], 0.0),
        ([1.0, 0.0, 0.0], 40.0),
        ([1.0, 0.0, 0.0], 45.0),
        ([0.0, 1.0, 0.0], 90.0),
        ([0.4, -1.1, 0.7], 75.0),
    ] {
        let along = nalgebra::Unit::new_normalize(Vector3::from(axis));
        let turn = Rotation3::from_axis_angle(&along, f64::to_radians(degrees));
        let found = fitted(&in_space(&mesh, |_| 0.0, &turn), material, entry()).as_material;
        // Constants of cells that are turned have errors of rounding.
        let same = |what: &str, a: f64, b: f64| assert!((a - b).abs() < 1e-8 * a.abs(), "{degrees}° {what}: {a} {b}");
        same("E", plane.young.unwrap(), found.young.unwrap());
        same("nu", plane.poisson.unwrap(), found.poisson.unwrap());
        same("distance", plane.distance, found.distance);
        same("mean", plane.mean_distance, found.mean_distance);
        if axis[0] == 1.0 {
            let off = (&found.stiffness - &plane.stiffness).norm();
            assert!(off < 1e-8 * plane.stiffness.norm(), "{degrees}°: {} {}", plane.stiffness, found.stiffness);
        }
    }
}

/// Samples of a sheet that is bent a little move in their planes, with as many points as those of a flat one. Slopes of up to 1/20 change
/// stiffnesses by some parts in a thousand; a sample of one cell does not relax, and would be off by a third.
#[test]
fn a_sheet_that_is_bent_a_little_is_the_material_of_a_flat_one() {
    let mesh = jittered(grid(&shipped("tri3"), 16).unwrap(), 16);
    let material = materials(2)[2];
    let entry = || FitEntry::new("offdiag").with("nonnegative", Some(true));
    let flat = fitted(&mesh, material, entry()).as_material;
    for (bend, tolerance) in [(1e-6, 1e-8), (0.03, 0.01)] {
        let bent = in_space(&mesh, |x| bend * (x[0] * x[0] + x[1] * x[1]), &Rotation3::identity());
        let found = fitted(&bent, material, entry()).as_material;
        for (a, b) in [
            (flat.young.unwrap(), found.young.unwrap()),
            (flat.poisson.unwrap(), found.poisson.unwrap()),
            (flat.distance, found.distance),
        ] {
            assert!((a / b - 1.0).abs() < tolerance, "{bend}: {flat:?} {found:?}");
        }
    }
}

/// Squares of their four edges resist no shear.
#[test]
fn mechanisms_have_no_modulus() {
    let mesh = grid(&shipped("quad4"), 4).unwrap();
    let material = materials(2)[2];
    let entry = FitEntry::new("offdiag").with_springs(Some(vec!["edge".into()]));
    let outcome = fitted(&mesh, material, entry);
    assert_eq!((outcome.as_material.young, outcome.as_material.poisson), (None, None));
    assert!(outcome.as_material.distance > 0.1);
    let outcome = Outcome::of_fit("squares".into(), mesh, material, None, outcome);
    assert!(report::notes(&outcome).iter().any(|note| note.contains("a strain has no stiffness")));
}

/// The classical fit of a box of tetrahedra, every cube of which is cut alike, couples tension with shear.
#[test]
fn structured_tetrahedra_are_warned_of() {
    for (objective, is_wrong) in [("offdiag", true), ("exact", false)] {
        let mesh = grid(&shipped("tet4"), 6).unwrap();
        let entry = FitEntry::new(objective).with("nonnegative", is_wrong.then_some(true));
        let outcome = fitted(&mesh, solid(0.3), entry);
        assert_eq!(outcome.as_material.distance > 0.3, is_wrong, "{:?}", outcome.as_material);
        let outcome = Outcome::of_fit("box".into(), mesh, solid(0.3), None, outcome);
        let notes = report::notes(&outcome);
        assert_eq!(notes.iter().any(|note| note.contains("The objective \"exact\"")), is_wrong, "{notes:?}");
        let table = report::tables(&outcome);
        let mut row =
            table.lines().skip_while(|line| !line.contains("as materials")).skip_while(|line| !line.starts_with("---"));
        let row = row.nth(1).unwrap();
        let words: Vec<&str> = row.split_whitespace().collect();
        assert_eq!(words[words.len() - 3..] == ["10000", "0.300", "0.0"], !is_wrong, "{table}");
    }
}

/// The keys of the report, each with a finite number.
#[test]
fn the_report_has_the_material() {
    let mesh = grid(&shipped("tet4"), 3).unwrap();
    let outcome = fitted(&mesh, solid(0.3), FitEntry::new("exact"));
    let outcome = Outcome::of_fit("box".into(), mesh, solid(0.3), None, outcome);
    let report: serde_json::Value = serde_json::from_str(&report::report(&outcome)).unwrap();
    let record = report["fits"][0]["as_material"].as_object().unwrap();
    let numbers = [
        ("young", 1e4),
        ("poisson", 0.3),
        ("asked_young", 1e4),
        ("asked_poisson", 0.3),
        ("tensor_distance", 0.0),
        ("mean_tensor_distance", 0.0),
        ("largest_tensor_distance", 0.0),
    ];
    for (key, expected) in numbers {
        assert!((record[key].as_f64().unwrap() - expected).abs() < 1e-9 * expected.max(1.0), "{key}: {record:?}");
    }
    let stiffness: Vec<Vec<f64>> = serde_json::from_value(record["stiffness"].clone()).unwrap();
    // 2μ, twice the shear modulus, is the eigenvalue of shears.
    assert!(stiffness.len() == 6 && (stiffness[5][5] - 1e4 / 1.3).abs() < 1e-5, "{stiffness:?}");
    assert!(record["samples"].as_u64().unwrap() > 1 && record["seconds"].as_f64().unwrap() >= 0.0);
    assert_eq!(record.len(), numbers.len() + 3);
}

/// On 100 000 tetrahedra it takes less than 50 ms, and less than a quarter of a second on a machine that has five times as much
/// other work as cores.
#[test]
fn it_costs_next_to_nothing() {
    let mesh = grid(&shipped("tet4"), 26).unwrap();
    assert!(mesh.cell_count() > 100_000);
    let material = solid(0.3);
    let block = &mesh.blocks[0];
    let fits =
        fit_exact(&block.element, &mesh.points, &block.connectivity, material, &ExactFit::default(), &mut |_| {});
    let fits = [fits.unwrap()];
    let network = Network::assemble(&mesh, &fits);
    let seconds = (0..10).map(|_| network_material(&mesh, material, SpringOwners::Cells(&fits), &network).seconds);
    let least = seconds.fold(f64::INFINITY, f64::min);
    assert!(least < 0.25, "{least} s");
}

/// Young's modulus of a sheet whose thickness varies is that of its material, whatever the thickness of its first cell is.
#[test]
fn a_thickness_that_varies_is_no_modulus() {
    let sheet = "box = { element = \"quad4\", size = [2, 1], cells = [4, 2] }";
    for (plane, thickness) in [("stress", "0.1*(1+x)"), ("stress", "0.1*(3-x)"), ("strain", "0.1*(3-x)")] {
        let text = format!(
            "[mesh]\n{sheet}\n[material]\nyoung = 1e4\npoisson = 0.3\nplane = \"{plane}\"\nthickness = \"{thickness}\"\n\
             [[fit]]\nobjective = \"exact\"\n[[fit]]\nobjective = \"frobenius\"\n"
        );
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, text).unwrap();
        let outcome = run(&Scene::load(&path).unwrap(), &mut |_| {}).unwrap();
        let [exact, frobenius] = [0, 1].map(|fit| outcome.fits[fit].as_material.clone());
        assert!(
            (exact.young.unwrap() / 1e4 - 1.0).abs() < 1e-9 && exact.distance < 1e-9,
            "{plane} {thickness}: {exact:?}"
        );
        assert!((exact.asked_young.unwrap() / 1e4 - 1.0).abs() < 1e-9, "{plane} {thickness}: {exact:?}");
        assert!((exact.poisson.unwrap() - exact.asked_poisson.unwrap()).abs() < 1e-9, "{plane} {thickness}: {exact:?}");
        // Squares of springs in plane stress at ν = 0.3 err by a few percent.
        assert!((frobenius.young.unwrap() / 1e4 - 1.0).abs() < 0.1, "{plane} {thickness}: {frobenius:?}");
    }
}

/// Sheets that meet in a T: 14 points of a narrow sheet with a stub across it, as one of the cells (of which the plane through all points
/// crosses the others), and a patch of a second layer on a sheet, whose rim is not in equilibrium under an affine strain. The exact network
/// is the material at any thickness, and is not recommended about itself.
#[test]
fn sheets_that_meet_or_lie_over_others_are_the_material() {
    let z = 0.166667;
    let mut tee: Vec<[f64; 3]> =
        [4.0, 6.0, 8.0, 10.0, 12.0, 14.0].iter().flat_map(|y| [[2.0, *y, z], [2.0, *y, -z]]).collect();
    tee.extend([[4.0, 12.0, z], [4.0, 12.0, -z]]);
    let mut of_tee: Vec<[usize; 4]> = (0..5).map(|i| [2 * i + 1, 2 * i, 2 * i + 2, 2 * i + 3]).collect();
    of_tee.push([9, 8, 12, 13]);
    // 5 x 5 cells whose last column is bent up; the second layer has one point of its own.
    let mut sheet: Vec<[f64; 3]> = Vec::new();
    for j in 0..6 {
        sheet.extend((0..7).map(|i| [f64::from(i.min(5)), f64::from(j), f64::from((i - 5).max(0))]));
    }
    let place = |i: usize, j: usize| 7 * j + i;
    let cell = |(i, j): (usize, usize)| [place(i, j), place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)];
    let mut of_sheet: Vec<[usize; 4]> = (0..5).flat_map(|j| (0..6).map(move |i| (i, j))).map(cell).collect();
    sheet.push([2.1, 2.1, 0.0]);
    for (i, j) in [(1, 1), (2, 1), (1, 2), (2, 2)] {
        of_sheet.push(cell((i, j)).map(|p| if p == place(2, 2) { 42 } else { p }));
    }
    let folder = tempfile::tempdir().unwrap();
    for (name, points, cells) in [("tee", &tee, &of_tee), ("sheet", &sheet, &of_sheet)] {
        let cells: Vec<_> = cells.iter().map(|nodes| (9, nodes.to_vec())).collect();
        std::fs::write(folder.path().join("m.vtk"), vtk_text(points.as_flattened(), &cells)).unwrap();
        for thickness in ["1e-6", "1e-3", "0.1", "10"] {
            let text = format!(
                "[mesh]\nfile = \"m.vtk\"\n[material]\nyoung = 1e4\npoisson = 0.3\nthickness = {thickness}\n\
                 [[fit]]\nobjective = \"exact\"\n"
            );
            let outcome = outcome_in(folder.path(), &text).unwrap();
            let material = Material::for_body(2, 1e4, 0.3, None, Some(1.0)).unwrap();
            is_material(&outcome.fits[0].as_material, material, &format!("{name} {thickness}"));
            let notes = springfit_report::report::notes(&outcome).join("\n");
            assert!(!notes.contains("is not the material"), "{notes}");
            // The four cells of the second layer and those below them; sheets that meet are not told.
            assert_eq!(outcome.mesh.quality.overlapping, if name == "sheet" { 8 } else { 0 });
        }
    }
}
