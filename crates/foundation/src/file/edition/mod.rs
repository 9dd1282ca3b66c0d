//! Editions: the files that a command writes into a folder, which come there together and replace those of the former edition.
//!
//! They are written into a new folder beside. At the end the two folders change their names, which is one operation of the file system:
//! whoever looks sees the former edition or the new one. Where the folder has files of others, or the system cannot exchange folders,
//! the new folder is moved into the other one under the name [`NEXT`], and its files take their places from there; the next command that
//! opens the folder goes on with that if it was broken off.
//!
//! A list of the files and their sums ([`Contents`]) tells what is of the former edition. All else is of others, and is never touched.

mod contents;
mod exchange;
mod lock;

use super::identity::identity;
use super::partial::{PartialFolder, folder_of, sweep, unbroken};
use super::{check_apart, check_folder, check_replaceable, create_folder, unwritable};
use crate::error::{Error, Result};
use contents::{Contents, expect_own};
use lock::Lock;
use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The folder of a complete edition whose files take their places.
const NEXT: &str = ".springfit.next";

/// Files on their way into a folder. If it is dropped before [`Edition::publish`], the folder is as it was.
#[derive(Debug)]
pub struct Edition {
    folder: PathBuf,
    /// None if nothing will be written, and nothing is there.
    work: Option<Work>,
    /// In the order in which they were written, relative to the folder.
    names: Vec<String>,
}

/// The fields are dropped in this order: the folders that were made go last, if they are empty.
#[derive(Debug)]
struct Work {
    staging: PartialFolder,
    lock: Lock,
    former: Contents,
    /// The inputs of the command, which stay.
    inputs: BTreeSet<PathBuf>,
    _made: Made,
}

/// Folders that were made, the innermost first, and are removed if nothing came into them.
#[derive(Debug)]
struct Made(Vec<PathBuf>);

impl Edition {
    /// Opens a folder, which is made if it is not there, for files of these names and for others of names that come from them. `former`
    /// are the names of files of an edition that has no list of them.
    ///
    /// # Errors
    /// Another process writes into the folder; a file of such a name is an input or is not of the former edition; or the folder cannot be
    /// written to.
    pub fn begin(folder: &Path, names: &[&str], inputs: &[PathBuf], former: &[String]) -> Result<Edition> {
        check_folder(folder)?;
        let places: Vec<PathBuf> = names.iter().map(|name| folder.join(name)).collect();
        check_apart(&places, inputs)?;
        let mut edition = Edition { folder: folder.to_path_buf(), work: None, names: Vec::new() };
        if names.is_empty() && !folder.exists() {
            return Ok(edition);
        }
        let missing = |place: &&Path| !place.as_os_str().is_empty() && !place.exists();
        let made = Made(folder.ancestors().take_while(missing).map(Path::to_path_buf).collect());
        create_folder(folder)?;
        let lock = Lock::take(folder)?;
        finish(folder)?;
        let former = Contents::of_folder(folder)?.unwrap_or_else(|| Contents::known(former));
        places.iter().try_for_each(|place| check_replaceable(place))?;
        let next = folder.join(NEXT);
        if next.symlink_metadata().is_ok() {
            return Err(foreign(&next));
        }
        names.iter().try_for_each(|name| expect_own(folder, name, &former))?;
        sweep(folder);
        let is_alone = is_alone(folder, |name| former.has(name));
        let parent = parent_of(folder).filter(|parent| is_alone && is_near(parent, folder));
        let beside = parent.and_then(|parent| PartialFolder::within(&parent).ok());
        let staging = beside.map_or_else(|| PartialFolder::within(folder), Ok);
        let staging = staging.map_err(|e| Error::io("nothing can be written there", e).in_file(folder))?;
        let inputs = inputs.iter().filter_map(|path| path.canonicalize().ok()).collect();
        edition.work = Some(Work { staging, lock, former, inputs, _made: made });
        Ok(edition)
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Where the files are until they are published.
    ///
    /// # Panics
    /// If the edition was opened without names in a folder that is not there.
    pub fn staging(&self) -> &Path {
        self.work.as_ref().expect("names of files open the folder").staging.path()
    }

    /// Writes the file of this name, which may lead into a folder.
    ///
    /// # Errors
    /// It cannot be written; the error names the place where it would have come.
    pub fn write(&mut self, name: &str, write: impl FnOnce(&Path) -> Result<()>) -> Result<()> {
        let (path, place) = (self.staging().join(name), self.folder.join(name));
        create_folder(folder_of(&path)).and_then(|()| write(&path)).map_err(|error| error.about(&path, &place))?;
        self.names.push(name.into());
        Ok(())
    }

    /// Takes in what is in the folder of this name of [`Edition::staging`].
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn take_folder(&mut self, name: &str) -> Result<()> {
        let path = self.staging().join(name);
        let found = names_below(&path).map_err(|e| Error::io("cannot be read", e).in_file(&path))?;
        let files = found.into_iter().filter(|within| !within.ends_with('/'));
        self.names.extend(files.map(|within| format!("{name}/{within}")));
        Ok(())
    }

    /// The names of the files that were written.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Puts the files in their places, removes those of the former edition that are not in this one, except inputs, and returns the paths.
    ///
    /// # Errors
    /// A file of others has come where a file would go; or a file cannot be written. The former edition stays.
    pub fn publish(self) -> Result<Vec<PathBuf>> {
        let Edition { folder, work, names } = self;
        let Some(work) = work else { return Ok(Vec::new()) };
        let failed = |e: io::Error| Error::io("the files cannot be put in their places", e).in_file(&folder);
        for name in names.iter().filter(|name| !work.former.has(name)) {
            expect_own(&folder, name, &work.former)?;
        }
        let is_input = |name: &str| folder.join(name).canonicalize().is_ok_and(|path| work.inputs.contains(&path));
        let leaves = work.former.names().filter(|name| !names.iter().any(|new| new == name) && !is_input(name));
        let contents = Contents::of_files(work.staging.path(), &names, leaves.map(String::from).collect())?;
        contents.write(work.staging.path(), &folder)?;
        let is_beside = work.staging.path().parent() != Some(&folder);
        let input_is_there = work.former.names().any(is_input);
        unbroken(|| {
            let is_alone = || is_alone(&folder, |name| work.former.is_own(&folder, name));
            if is_beside && !input_is_there && is_alone() && exchange::folders(work.staging.path(), &folder).is_ok() {
                return Ok(());
            }
            fs::rename(work.staging.path(), folder.join(NEXT)).map_err(failed)?;
            finish(&folder)
        })?;
        drop(work.lock);
        Ok(names.iter().map(|name| folder.join(name)).collect())
    }
}

impl Drop for Made {
    fn drop(&mut self) {
        // A folder with a file in it stays.
        self.0.iter().all(|folder| fs::remove_dir(folder).is_ok());
    }
}

/// Gives the files of an edition their places if a process ended while it did so. A folder in which another process writes is left to it.
///
/// # Errors
/// A file cannot be moved.
pub fn finish_edition(folder: &Path) -> Result<()> {
    if !folder.join(NEXT).is_dir() {
        return Ok(());
    }
    match Lock::take(folder) {
        Ok(_lock) => finish(folder),
        Err(_) => Ok(()),
    }
}

/// Gives the files of an edition their places, for a process that holds the lock of the folder.
fn finish(folder: &Path) -> Result<()> {
    let next = folder.join(NEXT);
    if !next.symlink_metadata().is_ok_and(|data| data.is_dir()) {
        return Ok(());
    }
    let failed = |e: io::Error| Error::io("the files of an edition cannot be put in their places", e).in_file(folder);
    // Without a list all files have their places, or it is not of an edition.
    if let Some(new) = Contents::of_folder(&next)? {
        let former = Contents::of_folder(folder)?;
        for name in new.names() {
            let (from, to) = (next.join(name), folder.join(name));
            if from.symlink_metadata().is_ok() {
                fs::create_dir_all(folder_of(&to)).and_then(|()| fs::rename(&from, &to)).map_err(failed)?;
            }
        }
        for name in new.leaving() {
            remove_own(folder, name, former.as_ref()).map_err(failed)?;
        }
        new.replace(&next, folder).map_err(failed)?;
    }
    // Empty folders are left, and the lock.
    let left = names_below(&next).map_err(failed)?;
    match left.iter().find(|name| !name.ends_with('/') && !lock::is_lock(name)) {
        None => fs::remove_dir_all(&next).map_err(failed),
        Some(name) => Err(foreign(&next.join(name))),
    }
}

fn foreign(path: &Path) -> Error {
    unwritable("stands in the way, and is not of a run: move it away, or choose another folder", path)
}

/// Removes a file of the former edition if it is as it was written, and its folder if that is empty then.
fn remove_own(folder: &Path, name: &str, former: Option<&Contents>) -> io::Result<()> {
    let path = folder.join(name);
    if former.is_some_and(|former| !former.is_own(folder, name)) {
        return Ok(());
    }
    match fs::remove_file(&path) {
        Err(e) if e.kind() != io::ErrorKind::NotFound => return Err(e),
        _ => {}
    }
    let mut above = Path::new(name).parent();
    while let Some(place) = above.filter(|place| !place.as_os_str().is_empty()) {
        if fs::remove_dir(folder.join(place)).is_err() {
            break;
        }
        above = place.parent();
    }
    Ok(())
}

/// Whether the folder has nothing of others, and no process such as this one works in it.
fn is_alone(folder: &Path, is_former: impl Fn(&str) -> bool) -> bool {
    let is_here =
        || std::env::current_dir().is_ok_and(|here| folder.canonicalize().is_ok_and(|own| here.starts_with(own)));
    let is_link = || folder.symlink_metadata().map_or(true, |data| data.is_symlink());
    let is_own = |name: &String| lock::is_lock(name) || contents::is_contents(name) || is_former(name);
    !is_link() && !is_here() && names_below(folder).is_ok_and(|names| names.iter().all(is_own))
}

/// The folder around a folder.
fn parent_of(folder: &Path) -> Option<PathBuf> {
    folder.canonicalize().ok()?.parent().map(Path::to_path_buf)
}

/// Whether a folder can be renamed to another place without its content being copied.
fn is_near(parent: &Path, folder: &Path) -> bool {
    let device = |path: &Path| fs::metadata(path).ok().and_then(|data| identity(&data)).map(|[device, _]| device);
    device(parent).is_some_and(|own| device(folder) == Some(own))
}

/// The names of all that is in a folder and in the folders in it and is not a folder, relative to it; links are not followed. The name
/// of an empty folder is there, too, and ends with a slash.
fn names_below(folder: &Path) -> io::Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if !entry.file_type()?.is_dir() {
            names.push(name);
            continue;
        }
        let below = names_below(&entry.path())?;
        if below.is_empty() {
            names.push(format!("{name}/"));
        }
        names.extend(below.into_iter().map(|within| format!("{name}/{within}")));
    }
    names.sort();
    Ok(names)
}
