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
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let identity = |path: &Path| fs::metadata(path).ok().map(|data| (data.dev(), data.ino()));
        // A file that does not exist is not the same as any other.
        identity(a).is_some_and(|a| identity(b) == Some(a))
    }
    #[cfg(not(unix))]
    {
        fs::canonicalize(a).is_ok_and(|a| fs::canonicalize(b).is_ok_and(|b| a == b))
    }
}
