#![no_main]

#[path = "../../tests/corpora/scene.rs"]
mod scene;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| scene::check(bytes));
