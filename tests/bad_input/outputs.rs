//! Files and folders that cannot be written.

use super::inputs::{BRICK, unit_mesh};
use super::refusals::Refusals;

#[cfg(unix)]
#[test]
fn springs_that_cannot_be_written() {
    let mesh = unit_mesh();
    let files: [(&str, &[u8]); 3] = [("mesh.msh", mesh.as_bytes()), ("file", b""), ("folder.csv/", b"")];
    let mut refusals = Refusals::default();
    for (output, words) in [
        ("missing/springs.csv", "its folder does not exist"),
        ("file/springs.json", "its folder does not exist"),
        ("folder.csv", "found a folder"),
    ] {
        let arguments = ["fit", "mesh.msh", "--young", "10kPa", "--poisson", "0.3", "-o", output];
        refusals.expect(&files, &arguments, output, words);
    }
    refusals.finish();
}

#[cfg(unix)]
#[test]
fn report_folders_that_cannot_be_made() {
    let scene: (&str, &[u8]) = ("scene.toml", BRICK.as_bytes());
    let words = "a file stands in the way";
    let mut refusals = Refusals::default();
    for out in ["file", "file/report"] {
        refusals.expect(&[scene, ("file", b"")], &["run", "scene.toml", "--out", out], out, words);
    }
    refusals.expect(&[scene, ("out", b"")], &["run", "scene.toml"], "out/scene", words);
    refusals.finish();
}
