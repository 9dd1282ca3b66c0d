//! The memory that a computation needs, compared with what the system has left.
//!
//! Without this check the operating system may end the process in the middle of the work.

use crate::error::{Error, ErrorKind, Result};
use std::fs;
use std::path::Path;

/// Fewer bytes are not worth a look at the system's files, which takes longer than what a small body does with them.
const SMALL: u64 = 1 << 16;

/// Checks that `what`, which needs `bytes` bytes, fits into memory. `advice` is printed if it does not. If the system
/// does not report its free memory, everything is accepted.
///
/// # Errors
/// It does not fit; the kind is `Limit`.
pub fn require(what: &str, bytes: u64, advice: &str) -> Result<()> {
    if bytes < SMALL {
        return Ok(());
    }
    let Some(left) = available().filter(|left| *left < bytes) else { return Ok(()) };
    let (needed, left) = (gigabytes(bytes), gigabytes(left));
    let problem = format!("{what} takes {needed} of memory, of which {left} is left: {advice}");
    Err(Error::new(problem).of_kind(ErrorKind::Limit))
}

/// The number of bytes that this process may still allocate: the free memory of the machine with its swap space, or the
/// rest that the limits of the process leave, whichever is less. `None` if the system does not report it.
pub fn available() -> Option<u64> {
    let read = |name: &str| fs::read_to_string(Path::new("/proc").join(name)).ok();
    let machine =
        read("meminfo").and_then(|text| Some(kilobytes(&text, "MemAvailable:")? + kilobytes(&text, "SwapFree:")?));
    let process = || {
        let (limits, status) = (read("self/limits")?, read("self/status")?);
        // A limit may have been lowered below what is in use.
        let left = |limit: &str, used: &str| Some(bytes(&limits, limit)?.saturating_sub(kilobytes(&status, used)?));
        left("Max address space", "VmSize:").into_iter().chain(left("Max data size", "VmData:")).min()
    };
    machine.into_iter().chain(process()).min()
}

/// The value of a line `Name:  123 kB`, in bytes.
fn kilobytes(text: &str, name: &str) -> Option<u64> {
    let value = text.lines().find_map(|line| line.strip_prefix(name))?;
    value.split_whitespace().next()?.parse::<u64>().ok()?.checked_mul(1024)
}

/// The first value of a line of limits, in bytes; `None` for `unlimited`.
fn bytes(text: &str, name: &str) -> Option<u64> {
    text.lines().find_map(|line| line.strip_prefix(name))?.split_whitespace().next()?.parse().ok()
}

/// `1.5 GB`.
fn gigabytes(bytes: u64) -> String {
    format!("{:.1} GB", bytes as f64 / 1e9)
}
