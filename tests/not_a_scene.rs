//! Commands of scenes say of another file what it is, and which command takes it.

use crate::kit::{prints, refused};
use std::fs;
use std::path::Path;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

#[test]
fn the_command_for_another_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let shipped = |name: &str| fs::read_to_string(Path::new(ROOT).join(name)).unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write(
        "square.toml",
        "[mesh]\nbox = { element = \"tri3\", size = [1, 1], cells = [1, 1] }\n[material]\nyoung = 1\npoisson = 0.3\n[[fit]]\nname = \"k\"\nobjective = \"exact\"\n",
    );
    prints(folder.path(), &["run", "square.toml"]);
    write("body.stl", "solid body\nendsolid body\n");
    write("norms.toml", "[compare]\nelements = [\"tet4\"]\n");
    write("own.toml", &shipped("elements/tet4.toml"));
    write("law.toml", &shipped("materials/neo-hookean.toml"));
    write("keys.json", "{\"mesh\": {}, \"material\": {}}");
    for (file, found, command) in [
        ("body.stl", "found a mesh", "springfit new body.stl"),
        ("norms.toml", "found a comparison", "springfit compare norms.toml"),
        ("own.toml", "found an element", "springfit check own.toml"),
        ("law.toml", "found an energy", "law = \"law.toml\""),
        ("out/square/k.json", "found a network", "springfit measure out/square/k.json"),
        ("out/square/report.json", "found a report", "springfit plot out/square"),
        ("out/square", "found the folder of a run", "springfit plot out/square"),
        ("keys.json", "in JSON", "TOML"),
    ] {
        for of in ["run", "sweep", "calibrate", "converge"] {
            let error = refused(folder.path(), &[of, file]);
            let begin = format!("error: {file}: expected a scene, ");
            assert!(
                error.starts_with(&begin) && error.contains(found) && error.contains(command),
                "{of} {file}: {error}"
            );
        }
    }
    // A scene with a fault, and what nobody knows, keep their errors.
    write("wrong.toml", "[mesh]\nfile = 3\n");
    assert!(refused(folder.path(), &["run", "wrong.toml"]).starts_with("error: wrong.toml:2: mesh.file: "));
    write("text.toml", "once upon a time\n");
    assert!(refused(folder.path(), &["run", "text.toml"]).starts_with("error: text.toml:1: expected TOML"));
    assert!(refused(folder.path(), &["run", "none.toml"]).contains("cannot be read"));
}
