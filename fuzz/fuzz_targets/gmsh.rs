#![no_main]

#[path = "../bodies/gmsh.rs"]
mod gmsh;
#[path = "../bodies/meshes.rs"]
mod meshes;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gmsh::check(bytes));
