//! Parses and validates files of WGSL: `springfit-shaders FILE …`. The exit code is 1 if one is wrong, and its fault is printed.
//!
//! This is a program of its own, and no part of the tests: naga asks for features of packages that the library shares, which
//! would all be compiled once more for the tests.

#![forbid(unsafe_code)]

use naga::front::wgsl;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// What every device has: no capability that a program would have to ask for.
const CAPABILITIES: Capabilities = Capabilities::empty();

fn check(path: &Path) -> Result<(), String> {
    let name = path.display().to_string();
    let text = std::fs::read_to_string(path).map_err(|e| format!("{name}: cannot be read: {e}"))?;
    let module = wgsl::parse_str(&text).map_err(|e| e.emit_to_string_with_path(&text, &name))?;
    let valid = Validator::new(ValidationFlags::all(), CAPABILITIES).validate(&module);
    valid.map(|_| ()).map_err(|e| e.emit_to_string_with_path(&text, &name))
}

fn main() -> ExitCode {
    let paths = std::env::args_os().skip(1).map(PathBuf::from);
    let faults: Vec<String> = paths.filter_map(|path| check(&path).err()).collect();
    faults.iter().for_each(|fault| eprintln!("{fault}"));
    if faults.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
