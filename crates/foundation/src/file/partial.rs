//! The beginning of a file that replaces another one once it is whole.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

const PREFIX: &str = ".springfit.";
const SUFFIX: &str = ".partial";

/// A new file beside another one. A lock on it shows that its process is alive.
pub(super) struct Partial {
    pub file: File,
    path: PathBuf,
}

impl Partial {
    /// Beside `target`; what earlier programs left in that folder is removed.
    pub fn beside(target: &Path) -> io::Result<Partial> {
        sweep(target.parent().unwrap_or(Path::new("")));
        loop {
            let path = name_beside(target);
            let file = File::create(&path)?;
            // A file system without locks has none to be swept.
            let _ = file.lock();
            // Between the two lines above another process may have swept it.
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

    /// Gives it its name.
    pub fn rename(&self, target: &Path) -> io::Result<()> {
        fs::rename(&self.path, target)
    }
}

/// A name of its own in each process and thread, short whatever the file is called.
fn name_beside(path: &Path) -> PathBuf {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    path.with_file_name(format!("{PREFIX}{}.{count}{SUFFIX}", std::process::id()))
}

/// Removes the beginnings of files whose process was killed: those that nobody has locked. What cannot be removed harms nothing.
fn sweep(folder: &Path) {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let is_partial = name.to_str().is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX));
        // Only a file can be one: to open a pipe may wait forever.
        if !is_partial || !entry.file_type().is_ok_and(|kind| kind.is_file()) {
            continue;
        }
        let Ok(file) = File::options().write(true).open(entry.path()) else { continue };
        if file.try_lock().is_ok() {
            let _ = fs::remove_file(entry.path());
        }
    }
}
