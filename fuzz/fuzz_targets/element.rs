#![no_main]

#[path = "../../tests/corpora/element.rs"]
mod element;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| element::check(bytes));
