//! The memory that work will take, compared with what the system has left.

use crate::error::{Error, ErrorKind, Result};
use std::fs;
use std::path::Path;

/// That `what` fits into memory, which takes so many bytes; `advice` says what to try where it does not. Where the system does not
/// say how much memory it has left, everything fits.
///
/// # Errors
/// It does not fit; kind `Limit`.
pub fn require(what: &str, bytes: u64, advice: &str) -> Result<()> {
    let Some(left) = available().filter(|left| *left < bytes) else { return Ok(()) };
    let (needed, left) = (gigabytes(bytes), gigabytes(left));
    let problem = format!("{what} takes {needed} of memory, of which {left} is left: {advice}");
    Err(Error::new(problem).of_kind(ErrorKind::Limit))
}

/// The bytes that this process may still ask for: what the machine has left, with its swap space, or what the limits of the
/// process leave, if that is less. `None` where the system does not say.
pub fn available() -> Option<u64> {
    let read = |name: &str| fs::read_to_string(Path::new("/proc").join(name)).ok();
    let machine =
        read("meminfo").and_then(|text| Some(kilobytes(&text, "MemAvailable:")? + kilobytes(&text, "SwapFree:")?));
    let process = || {
        let (limits, status) = (read("self/limits")?, read("self/status")?);
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
