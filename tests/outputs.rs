//! The files that a run writes.

use crate::kit::outcome;
use springfit_bodies::model::{Lumping, lumped_masses};
use springfit_report::report::{NetworkFile, notes, open_scene_outputs, tables, write_outputs};
use springfit_studies::study::{Scene, run};
use std::path::Path;

const SCENE: &str = r#"[mesh]
box = { element = "tri3", size = [1, 1], cells = [1, 1] }
[material]
young = 10e3
poisson = 0.3
plane = "strain"
[output]
csv = true
json = false
report = false
"#;

#[test]
fn each_fit_has_a_file_of_its_own() {
    let names = ["modal 0.1 +bulk", "modal 0.1 bulk", "mesh", "±", "..", "A", "a"];
    let fits = names.map(|name| format!("[[fit]]\nname = \"{name}\"\nobjective = \"frobenius\"\n"));
    let scene = Scene::parse(&[SCENE, &fits.concat()].concat(), Path::new("scene.toml")).unwrap();
    let outcome = run(&scene, &mut |_| {}).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let written = write_outputs(&outcome, scene.output(), open_scene_outputs(&scene, folder.path()).unwrap()).unwrap();
    let written: Vec<&str> = written.iter().map(|path| path.file_name().unwrap().to_str().unwrap()).collect();
    let modal = ["modal-0.1-bulk.csv", "modal-0.1-bulk-2.csv"];
    let others = ["mesh-2.csv", "fit.csv", "fit-2.csv", "A.csv", "a-2.csv", "points.csv"];
    assert_eq!(written, [&modal[..], &others].concat());
}

/// The row sums of corners of quadratic tetrahedra are negative: files, frequencies and notes are of the masses of the HRZ method. Those
/// of linear cells are row sums, and no note speaks of them.
#[test]
fn files_have_the_masses_with_which_the_run_computes() {
    for (element, is_hrz) in [("tet10", true), ("tri6", true), ("tet4", false), ("quad4", false)] {
        let size = if element.starts_with("te") { "[2, 1, 1]" } else { "[2, 1]" };
        let text = format!(
            "[mesh]\nbox = {{ element = \"{element}\", size = {size}, cells = {size} }}\n[material]\nyoung = 10e3\npoisson = 0.3\n\
             density = 1000\n[[fit]]\nobjective = \"exact\"\n[[fix]]\ngroup = \"xmin\"\n[output]\nfrequencies = 1\n"
        );
        let scene = Scene::parse(&text, Path::new("scene.toml")).unwrap();
        let outcome = run(&scene, &mut |_| {}).unwrap();
        let file = NetworkFile::of(&outcome, &outcome.fits[0]);
        let lumping = if is_hrz { Lumping::Hrz } else { Lumping::RowSum };
        let material = &outcome.material;
        let expected = lumped_masses(&outcome.mesh, material.densities(), material.thicknesses(), lumping);
        assert_eq!(file.masses().unwrap(), expected, "{element}");
        assert!(expected.iter().all(|mass| *mass > 0.0) && file.record().largest_step.is_some(), "{element}");
        assert_eq!(notes(&outcome).join(" ").contains("HRZ"), is_hrz, "{element}");
        // The frequencies of the same springs with the masses of the file.
        let (support, d) = (outcome.support.as_ref().unwrap(), outcome.mesh.dimension);
        let entries = outcome.fits[0].network.stiffness(&outcome.mesh.points);
        let system = springfit_bodies::solve::System::new(&entries, support).unwrap();
        let factor = system.cholesky().unwrap().unwrap();
        let modes = springfit_bodies::solve::lowest_modes(&system, &factor, file.masses().unwrap(), d, 1).unwrap();
        let found = outcome.frequencies[1].frequencies.as_ref().unwrap()[0];
        assert!((modes.frequencies()[0] / found - 1.0).abs() < 1e-9, "{element}");
    }
}

/// Where a fit finds its own masses, the points of each network are a file; where all have the same, there is one.
#[test]
fn each_file_of_points_has_the_masses_of_its_network() {
    let text = |more: &str| {
        format!(
            "[mesh]\nbox = {{ element = \"tri3\", size = [3, 1], cells = [4, 2] }}\n[material]\nyoung = 10e3\npoisson = 0.3\n\
             density = 1000\nthickness = 0.1\n[[fit]]\nobjective = \"whole\"\nstart = \"offdiag\"\n\
             iterations = 1\nname = \"found\"\n{more}[[fit]]\nobjective = \"offdiag\"\nname = \"given\"\n[[fix]]\ngroup = \"xmin\"\n\
             [[load]]\ngroup = \"xmax\"\ntraction = [10, 0]\n[output]\ncsv = true\njson = false\nreport = false\n"
        )
    };
    for (more, expected) in [
        ("", &["found.csv", "given.csv", "points.csv"][..]),
        ("masses = 2\n", &["found.csv", "given.csv", "points-found.csv", "points-given.csv"]),
    ] {
        let scene = Scene::parse(&text(more), Path::new("scene.toml")).unwrap();
        let outcome = run(&scene, &mut |_| {}).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let written =
            write_outputs(&outcome, scene.output(), open_scene_outputs(&scene, folder.path()).unwrap()).unwrap();
        let names: Vec<&str> = written.iter().map(|path| path.file_name().unwrap().to_str().unwrap()).collect();
        assert_eq!(names, expected);
        for (path, fit) in written[2..].iter().zip(&outcome.fits) {
            let table = std::fs::read_to_string(path).unwrap();
            let mass = |line: &str| line.split(',').nth(4).unwrap().parse::<f64>().unwrap();
            let masses: Vec<f64> = table.lines().skip(1).map(mass).collect();
            assert_eq!(masses, NetworkFile::of(&outcome, fit).masses().unwrap());
        }
    }
}

/// Networks, loads and files are the same, and the table has a dash.
#[test]
fn errors_that_are_not_asked_for_are_not_computed() {
    let text = SCENE.replace("json = false", "errors = false") + "[[fit]]\nname = \"one\"\nobjective = \"frobenius\"\n";
    let (without, with) = (outcome(&text), outcome(&text.replace("errors = false", "errors = true")));
    let fits = [&without, &with].map(|outcome| &outcome.fits[0]);
    assert_eq!(fits[0].network.lengths, fits[1].network.lengths);
    assert!(fits[0].frobenius().is_none() && fits[0].spectral().is_none());
    assert!(fits[1].frobenius().unwrap().max > 0.0 && fits[1].spectral().unwrap().max > 0.0);
    // The second table has the errors of the matrices.
    let row = |outcome| {
        let is_row = |line: &&str| line.trim_start().starts_with("one");
        tables(outcome).lines().filter(is_row).nth(1).unwrap().to_string()
    };
    let words = |outcome| row(outcome).split_whitespace().map(String::from).collect::<Vec<_>>();
    assert_eq!(words(&without)[2..4], ["-", "-"]);
    assert_eq!(words(&with)[3], "/");
}
