//! Runs again over the files that fuzzing has kept: each reaches code that no other does, or once went wrong.

#[path = "../fuzz/bodies/element.rs"]
mod element;
#[path = "../fuzz/bodies/expression.rs"]
mod expression;
#[path = "../fuzz/bodies/gmsh.rs"]
mod gmsh;
#[path = "../fuzz/bodies/meshes.rs"]
mod meshes;
#[path = "../fuzz/bodies/scene.rs"]
mod scene;
#[path = "../fuzz/bodies/vtk.rs"]
mod vtk;

use std::fs;
use std::panic::catch_unwind;
use std::path::Path;

fn replay(target: &str, check: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target);
    let (mut count, mut wrong) = (0, Vec::new());
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let bytes = fs::read(&path).unwrap();
        if catch_unwind(|| check(&bytes)).is_err() {
            wrong.push(path.file_name().unwrap().to_owned());
        }
        count += 1;
    }
    assert!(count > 10, "the corpus was not found");
    assert!(wrong.is_empty(), "{wrong:?}");
}

#[test]
fn expressions() {
    replay("expression", expression::check);
}

#[test]
fn elements_and_materials() {
    replay("element", element::check);
}

#[test]
fn scenes() {
    replay("scene", scene::check);
}

#[test]
fn gmsh_meshes() {
    replay("gmsh", gmsh::check);
}

#[test]
fn vtk_grids() {
    replay("vtk", vtk::check);
}
