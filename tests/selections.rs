//! What a condition selects is chosen once, on the mesh of the scene, and is the same part of the body on every finer mesh.

use crate::shapes::{elements, loaded};
use springfit_foundation::symbolic::{Predicate, Scope};
use springfit_mesh::mesh::{BoxMesh, Group, Mesh, Selection};
use springfit_studies::study::{Outcome, Scene, converge, run};
use std::path::Path;
use std::sync::Arc;

/// Ten ways to hold the points of the first column of cells of a bar with cells of 1 cm.
const CONDITIONS: [&str; 10] = [
    "x < 0.0101",
    "x < 0.0125",
    "x < 0.015",
    "x < 0.0175",
    "x < 0.0199",
    "x <= 0.01 + 1e-9",
    "x < 1e-9 || (x > 0.0099 && x < 0.0101)",
    "x*x < 2e-4",
    "x + 0.01*y < 0.011",
    "!(x > 0.013)",
];

fn bar(element: &str, condition: &str, poisson: f64, more: &str) -> Scene {
    let text = format!(
        "[mesh]\nscale = \"cm\"\nbox = {{ element = \"{element}\", size = [5, 2, 2], cells = [5, 2, 2] }}\n\
         [material]\nyoung = 5e3\npoisson = {poisson}\n[[fit]]\nobjective = \"exact\"\n[[fix]]\nwhere = \"{condition}\"\n\
         [[load]]\nname = \"bend\"\ngroup = \"xmax\"\ntraction = [0, 0, 5]\n{more}"
    );
    Scene::parse(&text, Path::new("bar.toml")).unwrap()
}

/// The errors of the network, percent: rms, largest, at the tip, of the compliance.
fn errors(outcome: &Outcome) -> [f64; 4] {
    let load = &outcome.fits[0].loads[0];
    let error = load.error.unwrap();
    [error.rms, error.max, error.tip, load.work_error.unwrap()]
}

#[test]
fn ten_conditions_for_one_support_have_the_same_errors() {
    for element in ["tet4", "hex8"] {
        for (poisson, more) in [
            (0.3, "[reference]\nrefine = 1\n"),
            (0.3, "[reference]\nfrom = \"quadratic\"\n"),
            (
                0.3,
                "[reference]\nmesh = { box = { element = \"hex8\", size = [5, 2, 2], cells = [15, 6, 6] }, scale = \"cm\" }\n",
            ),
            (0.45, ""),
        ] {
            let found = |condition| errors(&run(&bar(element, condition, poisson, more), &mut |_| {}).unwrap());
            let first = found(CONDITIONS[0]);
            assert!(first.iter().all(|error| error.abs() > 0.1), "{element} {more}: {first:?}");
            for condition in &CONDITIONS[1..] {
                for (a, b) in first.iter().zip(found(condition)) {
                    assert!((a - b).abs() <= 1e-6 * a.abs(), "{element} {more} {condition}: {a} and {b}");
                }
            }
        }
    }
}

#[test]
fn ten_conditions_for_one_support_have_the_same_levels() {
    for element in ["tet4", "hex8"] {
        let found =
            |condition| converge(&bar(element, condition, 0.3, ""), Some(3), &mut |_| {}).unwrap().loads.remove(0);
        let first = found(CONDITIONS[0]);
        for condition in &CONDITIONS[1..] {
            for (a, b) in first.models.iter().zip(found(condition).models) {
                for (a, b) in a.steps.iter().zip(b.steps) {
                    let (a, b) = (a.compliance.unwrap(), b.compliance.unwrap());
                    assert!((a - b).abs() <= 1e-8 * a, "{element} {condition}: {a} and {b}");
                }
            }
        }
    }
}

fn predicate(text: &str, dimension: usize) -> Predicate {
    Scope::new(&["x", "y", "z"][..dimension]).predicate(text).unwrap()
}

fn content(mesh: &Mesh) -> f64 {
    springfit_bodies::model::masses(mesh, 1.0, 1.0).iter().sum()
}

/// Halved cells and cells with quadratic functions fill the same body, for every element whose nodes are corners; a condition between the points
/// of the coarse mesh and a group of the same points alone select what the coarse mesh has: no further cell, side or layer of points.
#[test]
fn finer_meshes_have_the_parts_of_the_coarse_one() {
    let mut elevated = 0;
    for element in elements() {
        let name = element.name.clone();
        let d = element.dimension();
        let linear = element.nodes() == element.cell.corners().len();
        let mesh = BoxMesh {
            element: Arc::new(element),
            size: [1.0, 1.0, 1.0][..d].to_vec(),
            cells: [3, 2, 2][..d].to_vec(),
            origin: vec![0.0; d],
        };
        let (Ok(mut mesh), true) = (mesh.build(), d > 1) else { continue };
        let condition = predicate("x < 0.5", d);
        let points = Selection::Where(condition.clone()).points(&mesh).unwrap();
        mesh.groups.insert("some".into(), Group { points, ..Group::default() });
        mesh.choose([(condition.clone(), true)]);
        let selection = Selection::Where(condition);
        let cells = |mesh: &Mesh| selection.cells(mesh).unwrap().len();
        let reach = |mesh: &Mesh| {
            let chosen = selection.points(mesh).unwrap();
            chosen.iter().map(|&p| mesh.point(p)[0]).fold(0.0, f64::max)
        };
        let held = cells(&mesh);
        let finer = |fine: Mesh, factor: usize| {
            assert!((content(&fine) - content(&mesh)).abs() < 1e-12, "{name}");
            let chosen = selection.points(&fine).unwrap();
            assert_eq!(chosen, Selection::Group("some".into()).points(&fine).unwrap(), "{name}");
            assert!((reach(&fine) - reach(&mesh)).abs() < 1e-12, "{name}: {} and {}", reach(&fine), reach(&mesh));
            assert_eq!(cells(&fine), factor * held, "{name}");
        };
        let growth = if name.starts_with("pyramid") { 10 } else { 1 << d };
        finer(mesh.refined().unwrap(), growth);
        if linear && name != "pentagon5" {
            let fine = mesh.elevated().unwrap();
            assert!(
                fine.blocks.iter().all(|block| block.element.nodes() > block.element.cell.corners().len()),
                "{name}"
            );
            finer(fine, 1);
            elevated += 1;
        } else {
            assert!(mesh.elevated().is_err(), "{name}");
        }
    }
    assert_eq!(elevated, 6);
    let quadratic = loaded("tet10");
    assert_eq!(quadratic.nodes(), 10);
}

/// A fit to the whole object under these supports, beside a finer body.
fn whole(keys: &str) -> springfit_foundation::error::Result<Outcome> {
    let text = format!(
        "[mesh]\nscale = \"cm\"\nbox = {{ element = \"tet4\", size = [5, 2, 2], cells = [5, 2, 2] }}\n\
         [material]\nyoung = 5e3\npoisson = 0.3\n[reference]\nrefine = 1\n[[fix]]\ngroup = \"xmin\"\n\
         [[fit]]\nobjective = \"whole\"\nstart = \"exact\"\niterations = 2\n{keys}"
    );
    run(&Scene::parse(&text, Path::new("bar.toml"))?, &mut |_| {})
}

/// Median and largest error of each model under each support.
fn held_out(keys: &str) -> Vec<[f64; 2]> {
    let outcome = whole(keys).unwrap();
    let all = &outcome.fits[0].kind.whole().unwrap().held_out;
    all.iter().flat_map(|held| held.models.iter().map(|m| [m.median.unwrap(), m.worst.unwrap()])).collect()
}

#[test]
fn a_list_of_supports_has_groups_or_conditions() {
    let keys = |held: &str, chosen: &str, others: &str| {
        format!("supports = [[{held}]]\nvalidate_supports = [[{chosen}]]\nother_supports = [[{others}]]\n")
    };
    let groups = held_out(&keys("\"xmin\"", "\"xmin\", \"xmax\"", "\"ymin\""));
    assert!(groups.len() == 3 * 6 && groups[0][0] > 0.01, "{groups:?}");
    // The points of the mesh of the scene decide, so that what a finer mesh has between them changes nothing.
    for (low, high, side) in [("x < 1e-6", "x > 0.0499", "y < 1e-6"), ("x < 0.0099", "x > 0.041", "y < 0.0099")] {
        let [low, high, side] = [low, high, side].map(|condition| format!("\"{condition}\""));
        let found = held_out(&keys(&low, &format!("\"xmin\", {high}"), &side));
        for (a, b) in groups.iter().flatten().zip(found.iter().flatten()) {
            assert!((a - b).abs() <= 1e-6 * a.abs().max(1e-3), "{low}: {a} and {b}");
        }
    }
}

#[test]
fn what_no_list_of_supports_can_hold_is_an_error() {
    for (keys, words) in [
        ("supports = [[\"xmim\"]]", "supports[0]: expected groups of the mesh (body, xmax, xmin"),
        ("supports = [[\"x < 0.01 &&\"]]", "fit[0].supports[0]: "),
        (
            "supports = [[\"x < -1\"]]",
            "supports[0]: expected points to hold, found none with \"x < -1\": the body extends",
        ),
        ("other_supports = [[\"x > -1\"]]", "other_supports[0]: expected groups that leave points free to move"),
        ("supports = [[\"x < 1e-6 && y < 1e-6\"]]", "supports[0]: expected groups that hold every body"),
    ] {
        let found = whole(keys).err().unwrap().to_string();
        assert!(found.contains(words), "{keys}: {found}");
    }
}
