//! Files on disk. A file is read with an error that names it, and is written whole or not at all.
//!
//! TOML is read into structures with errors that name the key and the line.

mod edition;
mod forms;
mod identity;
mod node;
mod partial;
mod sum;

pub use edition::{Edition, finish_edition};
pub use forms::{Forms, PlainForms};
pub use identity::check_apart;
pub use partial::abandon;
pub use sum::Sum;

use crate::error::{Error, ErrorKind, Result};
use crate::named::suggestion;
use node::Fault;
use partial::{Partial, not_abandoned};
use std::fs;
use std::io::{self, BufWriter, Read, Seek, Write};
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

/// The largest file that is read, in bytes. A mesh of this size would not fit into memory together with its model, and
/// a path that is not a regular file (a pipe, a device) may never end.
const LARGEST_FILE: u64 = 4_000_000_000;
/// The longest TOML text, in bytes. Files of elements with hundreds of nodes are shorter.
const LONGEST_TOML: usize = 1_000_000;

/// Reads the file's bytes.
///
/// # Errors
/// The file is missing or unreadable, or larger than 4 GB.
pub fn read(path: &Path) -> Result<Vec<u8>> {
    let (length, bytes) = content(path, LARGEST_FILE).map_err(|e| Error::io("cannot be read", e).in_file(path))?;
    let found = length.max(bytes.len() as u64);
    if found > LARGEST_FILE {
        let error = Error::new(format!("expected a file of at most 4 GB, found {found} bytes"));
        return Err(error.of_kind(ErrorKind::Limit).in_file(path));
    }
    Ok(bytes)
}

/// The length of the file by its metadata, and its bytes if they are not more than `most`.
fn content(path: &Path, most: u64) -> std::io::Result<(u64, Vec<u8>)> {
    let file = fs::File::open(path)?;
    let length = file.metadata()?.len();
    let mut bytes = Vec::new();
    if length <= most {
        bytes.reserve_exact(usize::try_from(length).unwrap_or(0));
        file.take(most + 1).read_to_end(&mut bytes)?;
    }
    Ok((length, bytes))
}

/// Reads the file's text.
///
/// # Errors
/// The file is missing, unreadable or not UTF-8.
pub fn read_text(path: &Path) -> Result<String> {
    let not_text = || Error::new("expected UTF-8 text, found other bytes").of_kind(ErrorKind::Syntax).in_file(path);
    String::from_utf8(read(path)?).map_err(|_| not_text())
}

/// The extension of the path without its dot, in lower case; empty if the path has none.
pub fn ending(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}

/// Creates `path` with `content`, or replaces it.
///
/// The content goes to a temporary file beside `path`, which is then renamed, so that a failure leaves the old file as
/// it was. A symbolic link stays a link, and a replaced file keeps its permissions. A path that is not a regular file,
/// such as a device, is written to directly. Temporary files that killed processes left in the folder are removed.
///
/// # Errors
/// The folder does not exist or is read-only, the file is read-only, or the disk is full.
pub fn write_whole(path: &Path, content: &[u8]) -> Result<()> {
    write_with(path, |file| file.write_all(content))
}

/// Writes a file as [`write_whole`] does, with content that is produced while it is written.
///
/// # Errors
/// The same as those of [`write_whole`], and failures of `content`.
pub fn write_with(path: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    replace(path, |file, _| {
        let mut buffer = BufWriter::new(file);
        content(&mut buffer)?;
        buffer.flush()
    })
}

/// What can be written to at any place.
pub trait WriteSeek: Write + Seek {}

impl<W: Write + Seek> WriteSeek for W {}

/// Writes a file as [`write_with`] does, with content that goes back to what it has written. For a device, which cannot go back, the
/// content is held in memory.
///
/// # Errors
/// Those of [`write_with`].
pub fn write_seekable(path: &Path, content: impl FnOnce(&mut dyn WriteSeek) -> io::Result<()>) -> Result<()> {
    replace(path, |mut file, is_file| {
        if !is_file {
            let mut all = io::Cursor::new(Vec::new());
            content(&mut all)?;
            return file.write_all(all.get_ref());
        }
        let mut buffer = BufWriter::new(file);
        content(&mut buffer)?;
        buffer.flush()
    })
}

/// Writes a new file by `write` and replaces the old one with it. The second argument of `write` is false if the path is a device or a pipe.
fn replace(path: &Path, write: impl FnOnce(&fs::File, bool) -> io::Result<()>) -> Result<()> {
    if path.file_name().is_none() {
        return Err(unwritable("expected the name of a file to write, found a folder", path));
    }
    check_replaceable(path)?;
    // A file that does not exist yet has no other name.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let old = fs::metadata(&target).ok();
    let written = if old.as_ref().is_some_and(|old| !old.is_file()) {
        fs::File::options().write(true).open(&target).and_then(|file| write(&file, false))
    } else {
        Partial::beside(&target).and_then(|partial| {
            old.map_or(Ok(()), |old| partial.file.set_permissions(old.permissions()))
                .and_then(|()| write(&partial.file, true))
                // On the disk before it replaces the old file: whatever happens, one of the two is whole.
                .and_then(|()| partial.file.sync_all())
                .and_then(|()| partial.rename(&target))
        })
    };
    written.map_err(|e| Error::io("cannot be written", e).in_file(path))
}

/// The error for a path that is known to be unwritable before the system is asked.
fn unwritable(problem: &str, path: &Path) -> Error {
    Error::new(problem).of_kind(ErrorKind::Io).in_file(path)
}

/// Refuses to replace read-only files and symbolic links whose target does not exist.
fn refuse_protected(path: &Path) -> Result<()> {
    let problem = match (fs::metadata(path), fs::symlink_metadata(path)) {
        (Ok(old), _) if old.is_file() && old.permissions().readonly() => "cannot be written: the file is read-only",
        (Err(_), Ok(_)) => "cannot be written: it is a link to what is not there",
        _ => return Ok(()),
    };
    Err(unwritable(problem, path))
}

/// Checks that files could be written into `path`, which may not exist yet. It is called before long work starts and
/// leaves nothing behind.
///
/// # Errors
/// A file is in the place of a folder, or the folder is read-only.
pub fn check_folder(path: &Path) -> Result<()> {
    probe(path, path)
}

/// Checks the folder `path`; errors name the file `name`.
fn probe(path: &Path, name: &Path) -> Result<()> {
    let exists = |p: &&Path| !p.as_os_str().is_empty() && p.exists();
    let place = path.ancestors().find(exists).unwrap_or(Path::new("."));
    if !place.is_dir() {
        return Err(unwritable("the folder cannot be created: a file stands in the way", name));
    }
    let tried = Partial::beside(&place.join("probe")).and_then(Partial::remove);
    tried.map_err(|e| Error::io("nothing can be written there", e).in_file(name))
}

/// Checks that what is at this place, if anything, is a file that may be replaced.
fn check_replaceable(path: &Path) -> Result<()> {
    match path.is_dir() {
        true => Err(unwritable("expected the name of a file to write, found a folder", path)),
        false => refuse_protected(path),
    }
}

/// Checks that [`write_whole`] could write this file.
///
/// # Errors
/// The path is a folder, or its folder does not exist or is read-only.
pub fn check_file(path: &Path) -> Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match path.is_dir() {
        true => check_replaceable(path),
        false if !folder.is_dir() => Err(unwritable("cannot be written: its folder does not exist", path)),
        false if path.exists() && !path.is_file() => Ok(()),
        false => {
            check_replaceable(path)?;
            probe(folder, path)
        }
    }
}

/// The files in `folder` with the extension `ending`, sorted by name.
///
/// # Errors
/// The folder cannot be read.
pub fn files_in(folder: &Path, ending: &str) -> Result<Vec<PathBuf>> {
    let failed = |e: std::io::Error| Error::io("cannot be read", e).in_file(folder);
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.extension().is_some_and(|e| e == ending) && path.is_file() {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// Creates the folder and those above it.
///
/// # Errors
/// A file is in the place of a folder, or the folder above is read-only.
pub fn create_folder(path: &Path) -> Result<()> {
    not_abandoned(|| fs::create_dir_all(path)).map_err(|e| Error::io("the folder cannot be created", e).in_file(path))
}

/// Reads TOML into a structure. Errors name the key and the line.
///
/// # Errors
/// The text is too long or not TOML, or a key is unknown, missing or of the wrong type.
pub fn parse_toml<T: serde::de::DeserializeOwned>(text: &str) -> Result<T> {
    if text.len() > LONGEST_TOML {
        let problem = format!("expected at most {LONGEST_TOML} bytes of TOML, found {}", text.len());
        return Err(Error::new(problem).of_kind(ErrorKind::Limit));
    }
    let line = |at: usize| text[..at].matches('\n').count() + 1;
    let place = |error: Error, at: Option<usize>| at.into_iter().fold(error, Error::on_line);
    let not_toml = |e: toml::de::Error| {
        let error = Error::new(format!("expected TOML: {}", one_line(e.message()))).of_kind(ErrorKind::Syntax);
        place(error, e.span().map(|span| line(span.start)))
    };
    let root = DeTable::parse(text).map_err(not_toml)?;
    let start = root.span().start;
    node::structure_of_text(root.into_inner(), start)
        .map_err(|fault| on_line_of_key(place(keyed(&fault), fault.place.map(line)), text))
}

/// Reads a table that is parsed already into a structure, as [`parse_toml`] does. Errors name the key but no line.
///
/// # Errors
/// A key is unknown, missing or of the wrong type.
pub fn parse_table<T: serde::de::DeserializeOwned>(table: toml::Table) -> Result<T> {
    node::structure_of_table(table).map_err(|fault| keyed(&fault))
}

/// Adds to `error` the line of the value that its key leads to in the TOML text, or of the nearest table around that
/// value. An error that has a line or a file already is returned as it is.
pub fn on_line_of_key(error: Error, text: &str) -> Error {
    if error.line().is_some() || error.file().is_some() {
        return error;
    }
    let line = error.key().and_then(|key| line_of_key(text, key));
    line.into_iter().fold(error, Error::on_line)
}

/// The line (from 1) of the value of `key` in the TOML text, or of the nearest table around it.
pub fn line_of_key(text: &str, key: &str) -> Option<usize> {
    place_of(text, key).map(|place| text[..place].matches('\n').count() + 1)
}

/// The byte at which the value of a key such as `nodes[3].shape`, or the nearest table around it, begins.
fn place_of(text: &str, key: &str) -> Option<usize> {
    let root = DeTable::parse(text).ok()?;
    let mut place = None;
    let mut entry = next_entry(root.get_ref(), key);
    while let Some((name, value, rest)) = entry {
        // A table that exists only because headers below it name it has no position of its own.
        place = Some(if value.get_ref().is_table() {
            name.span().start.min(value.span().start)
        } else {
            value.span().start
        });
        let (mut value, mut rest) = (value, rest);
        while let (DeValue::Array(items), Some((number, after))) =
            (value.get_ref(), rest.strip_prefix('[').and_then(|r| r.split_once(']')))
        {
            let Some(item) = number.parse::<usize>().ok().and_then(|i| items.get(i)) else { return place };
            place = Some(item.span().start);
            (value, rest) = (item, after);
        }
        entry = value.get_ref().as_table().and_then(|table| next_entry(table, rest.strip_prefix('.').unwrap_or(rest)));
    }
    place
}

/// The longest table name with which `key` begins, its value, and the rest of the key.
fn next_entry<'t, 'i, 'k>(
    table: &'t DeTable<'i>,
    key: &'k str,
) -> Option<(&'t Spanned<DeString<'i>>, &'t Spanned<DeValue<'i>>, &'k str)> {
    let fits = |(name, value): (&'t Spanned<DeString<'i>>, &'t Spanned<DeValue<'i>>)| {
        let rest = key.strip_prefix(name.get_ref().as_ref())?;
        (rest.is_empty() || rest.starts_with(['.', '['])).then_some((name, value, rest))
    };
    table.iter().filter_map(fits).min_by_key(|(.., rest)| rest.len())
}

fn keyed(fault: &Fault) -> Error {
    let problem = one_line(&fault.message) + &meant(&fault.message);
    match fault.key.as_deref() {
        None | Some("") => Error::new(problem),
        Some(key) => Error::at(key, problem),
    }
}

/// A suggestion for an unknown key or name. The message of serde quotes the unknown name first and the known names
/// after it.
fn meant(message: &str) -> String {
    let is_unknown = ["unknown field", "unknown variant"].iter().any(|words| message.starts_with(words));
    let mut quoted = message.split('`').skip(1).step_by(2);
    match quoted.next().filter(|_| is_unknown) {
        Some(found) => suggestion(quoted, found),
        None => String::new(),
    }
}

fn one_line(message: &str) -> String {
    // The messages of serde use the names of Rust types.
    let words = [("expected f64", "expected a number"), ("expected usize", "expected a whole number")];
    let words =
        words.iter().chain(&[("expected u64", "expected a whole number"), ("expected a sequence", "expected a list")]);
    words
        .fold(message.replace('`', "\""), |text, (rust, plain)| text.replace(rust, plain))
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
}
