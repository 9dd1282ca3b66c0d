//! `command_line`: the program inside of the module.

use pyo3::prelude::*;
use std::ffi::OsString;
use std::process::ExitCode;

/// Runs the program with these arguments; the exit code. Help, and arguments that are wrong, end the process.
#[pyfunction]
pub fn command_line(py: Python, arguments: Vec<OsString>) -> u8 {
    let code = py.detach(|| springfit::program::run(arguments));
    // Codes are compared alone; the program has these.
    [0, 1].into_iter().find(|known| code == ExitCode::from(*known)).unwrap_or(2)
}
