#![no_main]

#[path = "../bodies/meshes.rs"]
mod meshes;
#[path = "../bodies/vtk.rs"]
mod vtk;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| vtk::check(bytes));
