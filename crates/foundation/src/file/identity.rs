//! Whether two paths are one file.

use super::unwritable;
use crate::error::Result;
use std::fs;
use std::path::{Path, PathBuf};

/// That no output is one of the inputs, by its name or by a link, hard or symbolic: asked before long work. Outputs and inputs
/// that do not exist are none.
///
/// # Errors
/// Names the output.
pub fn check_apart<'a>(outputs: &[PathBuf], inputs: impl IntoIterator<Item = &'a PathBuf>) -> Result<()> {
    for input in inputs {
        if let Some(output) = outputs.iter().find(|output| is_same(output, input)) {
            let problem = format!("would replace {}, which is an input: expected another place", input.display());
            return Err(unwritable(&problem, output));
        }
    }
    Ok(())
}

/// Whether both are there and are one file.
fn is_same(a: &Path, b: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let identity = |path: &Path| fs::metadata(path).ok().map(|data| (data.dev(), data.ino()));
        // What is not there is not the same as anything.
        identity(a).is_some_and(|a| identity(b) == Some(a))
    }
    #[cfg(not(unix))]
    {
        fs::canonicalize(a).is_ok_and(|a| fs::canonicalize(b).is_ok_and(|b| a == b))
    }
}
