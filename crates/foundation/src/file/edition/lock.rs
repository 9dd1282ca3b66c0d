//! The lock of a folder into which a process writes.

use crate::error::{Error, ErrorKind, Result};
use crate::file::identity::identity;
use crate::file::partial::{Begun, LOCK};
use crate::text::printable;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// The content of a lock begins so, and goes on with the number of the process and its command.
const OWNER: &str = "process ";
/// Characters of the command in the lock.
// They are enough to know it again, and a message quotes no more.
const LONGEST: usize = 120;

/// A lock that this process holds. It is released when the process ends, however it ends; the file may stay then, and is taken over.
#[derive(Debug)]
pub(super) struct Lock {
    path: PathBuf,
    _file: File,
    _begun: Begun,
}

impl Lock {
    /// Takes the lock of a folder.
    ///
    /// # Errors
    /// Another process holds it, which the error names; or it cannot be written.
    pub fn take(folder: &Path) -> Result<Lock> {
        let path = folder.join(LOCK);
        let failed = |e: io::Error| Error::io("cannot be written", e).in_file(&path);
        loop {
            let mut file = options().open(&path).map_err(failed)?;
            let locked = file.try_lock();
            let mut owner = String::new();
            // A lock of another system may not be readable while it is held.
            _ = (&mut file).take(4096).read_to_string(&mut owner);
            if !(owner.is_empty() || is_owner(&owner)) {
                let problem =
                    "expected the lock of a run, found a file of others: move it away, or choose another folder";
                return Err(Error::new(problem).in_file(&path));
            }
            if let Err(TryLockError::WouldBlock) = locked {
                let owner = if owner.is_empty() { "another process" } else { owner.trim_end() };
                let problem =
                    format!("{} writes into this folder: wait for its end, or choose another folder", printable(owner));
                return Err(Error::new(problem).of_kind(ErrorKind::Io).in_file(&path));
            }
            // The former owner may have removed it between.
            if !is_at(&file, &path) {
                continue;
            }
            let (_, begun) = Begun::make(|| Ok(path.clone()), |path| path).map_err(failed)?;
            let written =
                file.set_len(0).and_then(|()| rewind(&file)).and_then(|()| file.write_all(own_words().as_bytes()));
            let lock = Lock { path: path.clone(), _file: file, _begun: begun };
            return written.map_err(failed).map(|()| lock);
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        _ = fs::remove_file(&self.path);
    }
}

pub(super) fn is_lock(name: &str) -> bool {
    name == LOCK
}

/// Opens a file that may be there, and follows no link.
fn options() -> OpenOptions {
    let mut options = File::options();
    options.read(true).write(true).create(true).truncate(false);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags(rustix::fs::OFlags::NOFOLLOW.bits().cast_signed());
    }
    options
}

fn rewind(mut file: &File) -> io::Result<()> {
    io::Seek::rewind(&mut file)
}

/// Whether a text is that of a lock.
fn is_owner(text: &str) -> bool {
    let number =
        text.strip_prefix(OWNER).and_then(|rest| rest.strip_suffix(")\n")).and_then(|rest| rest.split_once(" ("));
    number.is_some_and(|(number, _)| !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit()))
}

/// Whether the path leads to the open file.
fn is_at(file: &File, path: &Path) -> bool {
    let (there, own) = (fs::symlink_metadata(path), file.metadata());
    there.is_ok_and(|there| own.is_ok_and(|own| identity(&own) == identity(&there)))
}

/// The process and its command.
fn own_words() -> String {
    let command: Vec<String> = std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect();
    let command = command.join(" ");
    let words: String = printable(&command).chars().take(LONGEST).collect();
    format!("{OWNER}{} ({words})\n", std::process::id())
}
