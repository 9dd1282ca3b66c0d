//! The program that makes PDF and PNG of figures. It is one of its own because the packages that it is made of take minutes to build.

use crate::error::{Error, Result};
use std::env;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::thread;

/// The name of the program of the package in `crates/pictures`.
pub(super) const CONVERTER: &str = "springfit-pictures";

/// Where it is: beside the running program, or in a folder of PATH; `None` if it is in neither.
pub(super) fn converter() -> Option<PathBuf> {
    let name = format!("{CONVERTER}{}", env::consts::EXE_SUFFIX);
    let own = env::current_exe().ok().and_then(|program| Some(program.parent()?.to_path_buf()));
    let listed = env::var_os("PATH").unwrap_or_default();
    // An empty entry would mean the folder in which the program happens to run.
    let folders = own.into_iter().chain(env::split_paths(&listed).filter(|folder| !folder.as_os_str().is_empty()));
    folders.map(|folder| folder.join(&name)).find(|path| path.is_file())
}

/// What the program makes of a figure.
///
/// # Errors
/// It is not there, cannot be started, or cannot convert the figure; the error has its words.
pub(super) fn converted(svg: &str, format: &str) -> Result<Vec<u8>> {
    let program = converter().ok_or_else(|| Error::new(format!("the program {CONVERTER} is not there")))?;
    let name = program.display();
    let failed = |e| Error::io(format!("the program {name} cannot be started"), e);
    let pipes =
        Command::new(&program).arg(format).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut child = pipes.map_err(failed)?;
    let mut input = child.stdin.take().expect("it is piped");
    // Sent by a thread, so that neither waits for the other, whatever is on PATH by this name.
    let (sent, output) = thread::scope(|scope| {
        let sent = scope.spawn(move || input.write_all(svg.as_bytes()));
        let output = child.wait_with_output();
        (sent.join().expect("writing does not panic"), output)
    });
    let output = output.map_err(|e| Error::io(format!("the program {name} cannot be read"), e))?;
    if !output.status.success() {
        let words = String::from_utf8_lossy(&output.stderr);
        let words: Vec<&str> = words.lines().map(|line| line.trim_start_matches("error: ").trim()).collect();
        return Err(Error::new(format!("{name} has failed ({}): {}", output.status, words.join("; "))));
    }
    sent.map_err(|e| Error::io(format!("the program {name} has not read the figure"), e))?;
    Ok(output.stdout)
}
