#![no_main]

#[path = "../../tests/corpora/gmsh.rs"]
mod gmsh;
#[path = "../../tests/corpora/meshes.rs"]
mod meshes;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gmsh::check(bytes));
