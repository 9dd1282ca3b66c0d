//! The temporary file beside a file that it replaces once its content is complete.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Begins the name of a temporary file. The leading dot hides it in listings.
const PREFIX: &str = ".springfit.";
/// Ends the name of a temporary file, so that a sweep recognises those of killed processes.
const SUFFIX: &str = ".partial";

/// A new file beside another one. A lock on it shows that the process that writes it is alive.
pub(super) struct Partial {
    pub file: File,
    path: PathBuf,
}

impl Partial {
    /// Creates a file beside `target` and removes what earlier processes left in that folder.
    pub fn beside(target: &Path) -> io::Result<Partial> {
        sweep(target.parent().unwrap_or(Path::new("")));
        loop {
            let path = name_beside(target);
            let file = File::create(&path)?;
            // On a file system without locks no file is ever swept.
            let _ = file.lock();
            // Another process may have swept the file between its creation and its lock.
            if path.exists() {
                return Ok(Partial { file, path });
            }
        }
    }

    pub fn remove(self) -> io::Result<()> {
        match fs::remove_file(&self.path) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(()),
            removed => removed,
        }
    }

    /// Renames the temporary file to `target`.
    pub fn rename(&self, target: &Path) -> io::Result<()> {
        fs::rename(&self.path, target)
    }
}

/// A name that differs in each process and thread, and that is short whatever the file is called.
fn name_beside(path: &Path) -> PathBuf {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    path.with_file_name(format!("{PREFIX}{}.{count}{SUFFIX}", std::process::id()))
}

/// Removes the temporary files of killed processes: those that nobody has locked. A file that cannot be removed does no
/// harm.
fn sweep(folder: &Path) {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let is_partial = name.to_str().is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX));
        // Only a regular file can be one: opening a pipe may wait forever.
        if !is_partial || !entry.file_type().is_ok_and(|kind| kind.is_file()) {
            continue;
        }
        let Ok(file) = File::options().write(true).open(entry.path()) else { continue };
        if file.try_lock().is_ok() {
            let _ = fs::remove_file(entry.path());
        }
    }
}
