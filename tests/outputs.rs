//! The files that a run writes.

use springfit::report::write_outputs;
use springfit::study::{Scene, run};
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
    let names = ["modal 0.1 +bulk", "modal 0.1 bulk", "mesh", "±"];
    let fits = names.map(|name| format!("[[fit]]\nname = \"{name}\"\nobjective = \"frobenius\"\n"));
    let scene = Scene::parse(&[SCENE, &fits.concat()].concat(), Path::new("scene.toml")).unwrap();
    let outcome = run(&scene, &mut |_| {}).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let written = write_outputs(&outcome, scene.output(), folder.path()).unwrap();
    let written: Vec<&str> = written.iter().map(|path| path.file_name().unwrap().to_str().unwrap()).collect();
    assert_eq!(written, ["modal-0.1-bulk.csv", "modal-0.1-bulk-2.csv", "mesh-2.csv", "-2.csv", "points.csv"]);
}
