#![no_main]

#[path = "../../tests/corpora/formats.rs"]
mod formats;
#[path = "../../tests/corpora/meshes.rs"]
mod meshes;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| formats::check(bytes));
