#![no_main]

#[path = "../../tests/corpora/meshes.rs"]
mod meshes;
#[path = "../../tests/corpora/vtk.rs"]
mod vtk;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| vtk::check(bytes));
