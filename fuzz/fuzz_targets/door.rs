#![no_main]

#[path = "../../tests/corpora/door.rs"]
mod door;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| door::check(bytes));
