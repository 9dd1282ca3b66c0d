//! The temporary file beside a file that it replaces once its content is complete, and the folder in which an edition is prepared.
//!
//! Their names cannot be guessed, they are created new, and no link is followed. A lock on each shows that the process that writes it is
//! alive: what killed processes left is removed by the next one that writes there.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;
use tempfile::{Builder, TempDir, TempPath};

/// Begins the names of files that are not results. The leading dot hides them in listings.
pub(super) const PREFIX: &str = ".springfit.";
/// Ends the name of a temporary file or folder, so that those of killed processes are recognised.
const SUFFIX: &str = ".partial";
/// The file in a folder that the process which writes there holds locked.
pub(super) const LOCK: &str = ".springfit.lock";

/// How often a folder is removed in which something is being written, and the time between.
// A thread that was about to make a file makes it within the first moments. All trials together take a tenth of a second, for which
// whoever interrupts a program waits at most.
const TRIALS: usize = 20;
const MOMENT: Duration = Duration::from_millis(5);

/// What this process has begun, and has to remove if it is interrupted.
static BEGUN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
/// Held while files are given their places.
static PLACING: Mutex<()> = Mutex::new(());

fn locked<T>(mutex: &'static Mutex<T>) -> MutexGuard<'static, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes what this process has begun and not ended, for a program that is about to be ended. Files that are being given their places
/// come there first. Nothing can be written afterwards.
pub fn abandon() {
    let (placing, begun) = (locked(&PLACING), locked(&BEGUN));
    // What is written at this moment may come into a folder while that is removed; nothing comes after it.
    for path in begun.iter() {
        for _ in 0..TRIALS {
            let _ = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
            if path.symlink_metadata().is_err() {
                break;
            }
            thread::sleep(MOMENT);
        }
    }
    // Never released: a thread that still writes must not begin another file.
    std::mem::forget((placing, begun));
}

/// Does work that must not come after [`abandon`], such as making a folder that was removed there. After it the work never begins: its thread
/// waits until the program ends.
pub(super) fn not_abandoned<T>(work: impl FnOnce() -> T) -> T {
    let _begun = locked(&BEGUN);
    work()
}

/// Does what an interrupt must not break off.
pub(super) fn unbroken<T>(work: impl FnOnce() -> T) -> T {
    let _placing = locked(&PLACING);
    work()
}

/// A path that an interrupted program removes.
#[derive(Debug)]
pub(super) struct Begun(PathBuf);

impl Begun {
    /// Makes something, and keeps its path; an interrupt cannot come between.
    pub fn make<T>(make: impl FnOnce() -> io::Result<T>, path: impl Fn(&T) -> &Path) -> io::Result<(T, Begun)> {
        let mut begun = locked(&BEGUN);
        let made = make()?;
        let path = path(&made).to_path_buf();
        begun.insert(path.clone());
        Ok((made, Begun(path)))
    }
}

impl Drop for Begun {
    fn drop(&mut self) {
        locked(&BEGUN).remove(&self.0);
    }
}

/// A new file beside another one.
pub(super) struct Partial {
    pub file: File,
    path: TempPath,
    _begun: Begun,
}

impl Partial {
    /// Creates a file beside `target` and removes what earlier processes left in that folder.
    pub fn beside(target: &Path) -> io::Result<Partial> {
        let folder = folder_of(target);
        sweep(folder);
        loop {
            let (made, begun) = Begun::make(|| builder(0o666).tempfile_in(folder), |made| made.path())?;
            let (file, path) = made.into_parts();
            // On a file system without locks no file is ever swept.
            let _ = file.lock();
            // Another process may have swept the file between its creation and its lock.
            if path.exists() {
                return Ok(Partial { file, path, _begun: begun });
            }
        }
    }

    pub fn remove(self) -> io::Result<()> {
        match self.path.close() {
            Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(()),
            removed => removed,
        }
    }

    /// Renames the temporary file to `target`.
    pub fn rename(self, target: &Path) -> io::Result<()> {
        fs::rename(&self.path, target)?;
        // There is nothing left to remove.
        self.path.keep().map(drop).map_err(|e| e.error)
    }
}

/// A new folder for files that are not in their places yet.
#[derive(Debug)]
pub(super) struct PartialFolder {
    folder: TempDir,
    /// Its lock shows that the process is alive.
    _held: File,
    _begun: Begun,
}

impl PartialFolder {
    /// Creates a folder in `parent` and removes what earlier processes left there.
    pub fn within(parent: &Path) -> io::Result<PartialFolder> {
        sweep(parent);
        loop {
            let (folder, begun) = Begun::make(|| builder(0o777).tempdir_in(parent), TempDir::path)?;
            let held = match File::create_new(folder.path().join(LOCK)) {
                Ok(held) => held,
                // Another process has swept it.
                Err(e) if e.kind() == io::ErrorKind::NotFound => continue,
                Err(e) => return Err(e),
            };
            let _ = held.lock();
            if folder.path().join(LOCK).exists() {
                return Ok(PartialFolder { folder, _held: held, _begun: begun });
            }
        }
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

/// Whether a file or folder of this name is temporary.
fn is_partial(name: &OsStr) -> bool {
    name.to_str().is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX))
}

/// The folder of a file.
pub(super) fn folder_of(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Makes what anyone may read and write but for the mask of the user.
fn builder(mode: u32) -> Builder<'static, 'static> {
    let mut builder = Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(mode));
    #[cfg(not(unix))]
    let _ = mode;
    builder
}

/// Removes the temporary files and folders of killed processes: those that nobody has locked. One that cannot be removed does no harm.
pub(super) fn sweep(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        // Only a regular file can be one: opening a pipe may wait forever.
        let Some(kind) = entry.file_type().ok().filter(|_| is_partial(&entry.file_name())) else { continue };
        let path = entry.path();
        let held = if kind.is_dir() { path.join(LOCK) } else { path.clone() };
        let is_dead = match held.symlink_metadata() {
            Ok(data) if data.is_file() => {
                File::options().write(true).open(&held).is_ok_and(|file| file.try_lock().is_ok())
            }
            Ok(_) => false,
            // The process ended while it removed the folder. One that has made it just now makes another.
            Err(e) => kind.is_dir() && e.kind() == io::ErrorKind::NotFound,
        };
        if is_dead {
            let _ = if kind.is_dir() { fs::remove_dir_all(&path) } else { fs::remove_file(&path) };
        }
    }
}
