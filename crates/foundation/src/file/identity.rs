//! Checks whether two paths lead to the same file.

use super::unwritable;
use crate::error::Result;
use std::fs;
use std::path::{Path, PathBuf};

/// Checks that no output is one of the inputs, whether by its name or through a hard or symbolic link. It is called
/// before long work starts. Outputs and inputs that do not exist cannot be the same file.
///
/// # Errors
/// An output is one of the inputs. The error names the output.
pub fn check_apart<'a>(outputs: &[PathBuf], inputs: impl IntoIterator<Item = &'a PathBuf>) -> Result<()> {
    for input in inputs {
        if let Some(output) = outputs.iter().find(|output| is_same(output, input)) {
            let problem = format!("would replace {}, which is an input: expected another place", input.display());
            return Err(unwritable(&problem, output));
        }
    }
    Ok(())
}

/// Whether both files exist and are the same file.
fn is_same(a: &Path, b: &Path) -> bool {
    // A file that does not exist is not the same as any other.
    let (Ok(of_a), Ok(of_b)) = (fs::metadata(a), fs::metadata(b)) else { return false };
    match identity(&of_a) {
        Some(identity_of_a) => identity(&of_b) == Some(identity_of_a),
        None => fs::canonicalize(a).is_ok_and(|a| fs::canonicalize(b).is_ok_and(|b| a == b)),
    }
}

/// The device on which a file is, and its number there; none where the system does not tell them.
pub(super) fn identity(data: &fs::Metadata) -> Option<[u64; 2]> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        Some([data.dev(), data.ino()])
    }
    #[cfg(not(unix))]
    {
        let _ = data;
        None
    }
}
