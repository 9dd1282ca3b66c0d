//! Runs again over the files that fuzzing has kept: each reaches code that no other does, or once went wrong.

mod door;
mod element;
mod expression;
pub mod formats;
mod gmsh;
mod meshes;
mod scene;
mod vtk;

use crate::kit::place;
use std::fs;
use std::panic::catch_unwind;

fn replay(target: &str, check: fn(&[u8])) {
    let fuzz = place("fuzz");
    if !fuzz.is_dir() {
        // A published package has no corpus.
        return;
    }
    let folder = fuzz.join("corpus").join(target);
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
fn calls_of_public_functions() {
    replay("door", door::check);
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

#[test]
fn meshes_of_every_format() {
    replay("formats", formats::check);
}
