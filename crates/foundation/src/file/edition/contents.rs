//! The list of the files of an edition.

use crate::error::{Error, Result};
use crate::file::partial::PREFIX;
use crate::file::{Sum, read, unwritable, write_whole};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::io;
use std::path::{Component, Path};

/// The name of the list in the folder.
const LIST: &str = ".springfit.files";
/// The first line of the list: the format and its version.
const HEAD: &str = "springfit files 1";

/// The files of an edition, and what is known of them: one line each of a text.
///
/// A line is `file SUM NAME` with the [`Sum`] of the bytes, or `leaves NAME` for a file of the former edition that goes when this one
/// comes. Names are relative to the folder.
#[derive(Debug, Default)]
pub(super) struct Contents {
    /// The sum of the bytes; none if only the name is known.
    files: BTreeMap<String, Option<String>>,
    leaving: Vec<String>,
}

impl Contents {
    /// Files of which only the names are known.
    pub fn known(names: &[String]) -> Contents {
        let files = names.iter().filter(|name| is_name(name)).map(|name| (name.clone(), None)).collect();
        Contents { files, leaving: Vec::new() }
    }

    /// The list in a folder, if it has one.
    ///
    /// # Errors
    /// It is of another version.
    pub fn of_folder(folder: &Path) -> Result<Option<Contents>> {
        let path = folder.join(LIST);
        if !path.symlink_metadata().is_ok_and(|data| data.is_file()) {
            return Ok(None);
        }
        let text = String::from_utf8_lossy(&read(&path)?).into_owned();
        let mut lines = text.lines();
        let head = lines.next().unwrap_or_default();
        if head != HEAD {
            let problem =
                format!("expected the files of a run, \"{HEAD}\", found another first line: choose another folder");
            return Err(Error::new(problem).in_file(&path));
        }
        let mut contents = Contents::default();
        for (number, line) in lines.enumerate() {
            let known = match line.split_once(' ') {
                Some(("file", rest)) => rest.split_once(' ').filter(|(_, name)| is_name(name)).map(|(sum, name)| {
                    contents.files.insert(name.into(), Some(sum.into()));
                }),
                Some(("leaves", name)) if is_name(name) => {
                    contents.leaving.push(name.into());
                    Some(())
                }
                _ => None,
            };
            if known.is_none() {
                let problem = "expected \"file SUM NAME\" or \"leaves NAME\", found another line";
                return Err(Error::new(problem).on_line(number + 2).in_file(&path));
            }
        }
        Ok(Some(contents))
    }

    /// Lists the files in `folder` with these names, with their sums.
    ///
    /// # Errors
    /// A file cannot be read.
    pub fn of_files(folder: &Path, names: &[String], leaving: Vec<String>) -> Result<Contents> {
        let sum = |name: &String| {
            let path = folder.join(name);
            let sum = Sum::of_file(&path).map_err(|e| Error::io("cannot be read", e).in_file(&path))?;
            Ok((name.clone(), Some(sum.to_string())))
        };
        Ok(Contents { files: names.iter().map(sum).collect::<Result<_>>()?, leaving })
    }

    /// Writes the list into a folder that stands for `place`.
    pub fn write(&self, folder: &Path, place: &Path) -> Result<()> {
        let mut text = format!("{HEAD}\n");
        for (name, sum) in &self.files {
            writeln!(text, "file {} {name}", sum.as_deref().unwrap_or("-")).expect("a String grows");
        }
        self.leaving.iter().for_each(|name| writeln!(text, "leaves {name}").expect("a String grows"));
        let path = folder.join(LIST);
        write_whole(&path, text.as_bytes()).map_err(|error| error.about(&path, &place.join(LIST)))
    }

    /// Moves the list from one folder into another.
    pub fn replace(&self, from: &Path, to: &Path) -> io::Result<()> {
        fs::rename(from.join(LIST), to.join(LIST))
    }

    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.files.keys().map(String::as_str)
    }

    pub fn has(&self, name: &str) -> bool {
        self.files.contains_key(name)
    }

    /// Files of the former edition that go.
    pub fn leaving(&self) -> &[String] {
        &self.leaving
    }

    /// Whether the file of this name in the folder is as the edition has it.
    pub fn is_own(&self, folder: &Path, name: &str) -> bool {
        let path = folder.join(name);
        let is_file = path.symlink_metadata().is_ok_and(|data| data.is_file());
        is_file
            && self.files.get(name).is_some_and(|sum| {
                sum.as_ref().is_none_or(|sum| Sum::of_file(&path).is_ok_and(|found| found.to_string() == *sum))
            })
    }
}

/// Checks that there is no file of this name in the folder, or one as the former edition had it, and that only folders lead to it.
pub(super) fn expect_own(folder: &Path, name: &str, former: &Contents) -> Result<()> {
    let above = Path::new(name).ancestors().skip(1).filter(|above| !above.as_os_str().is_empty());
    for place in above.map(|above| folder.join(above)) {
        if place.symlink_metadata().is_ok_and(|data| !data.is_dir()) {
            return Err(unwritable("the folder cannot be created: a file stands in the way", &place));
        }
    }
    let path = folder.join(name);
    if path.symlink_metadata().is_err() || former.is_own(folder, name) {
        return Ok(());
    }
    let found = match former.has(name) {
        true => "would be replaced, and was changed since it was written",
        false => "would be replaced, and is not of a former run in this folder",
    };
    Err(unwritable(&format!("{found}: move it away, or choose another folder"), &path))
}

pub(super) fn is_contents(name: &str) -> bool {
    name == LIST
}

/// Whether a name leads to a file of an edition: into the folder, and not to a file that only editions have.
fn is_name(name: &str) -> bool {
    let is_plain =
        |part: Component| matches!(part, Component::Normal(part) if !part.to_string_lossy().starts_with(PREFIX));
    !name.is_empty() && Path::new(name).components().all(is_plain)
}
