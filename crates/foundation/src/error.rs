//! What is wrong with an input: where it stands, what was expected there and what was found.

use std::fmt;
use std::path::{Path, PathBuf};

pub type Result<T> = std::result::Result<T, Error>;

/// A fault of an input. It prints as one line: `file:line: key: what is wrong`.
///
/// An optimum that could not be reached, or a network that cannot stand, is not an `Error` but a status of the result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Error {
    file: Option<PathBuf>,
    line: Option<usize>,
    key: Option<String>,
    problem: String,
}

impl Error {
    /// A fault without a key, in words.
    pub fn new(problem: impl Into<String>) -> Self {
        Error { file: None, line: None, key: None, problem: on_one_line(problem.into()) }
    }

    /// A fault at `key`, in words.
    pub fn at(key: impl Into<String>, problem: impl Into<String>) -> Self {
        Error { key: Some(on_one_line(key.into())), ..Error::new(problem) }
    }

    /// A fault at `key`: `expected …, found …`.
    pub fn expected(key: impl Into<String>, expected: impl fmt::Display, found: impl fmt::Display) -> Self {
        Error::at(key, format!("expected {expected}, found {found}"))
    }

    /// Names the file, unless a deeper layer has named one already.
    pub fn in_file(mut self, file: &Path) -> Self {
        self.file.get_or_insert_with(|| file.to_path_buf());
        self
    }

    /// Names the line (from 1).
    pub fn on_line(mut self, line: usize) -> Self {
        self.line.get_or_insert(line);
        self
    }

    /// Puts `parent` before the key: `shape` under `nodes[3]` is `nodes[3].shape`.
    pub fn under(mut self, parent: impl fmt::Display) -> Self {
        self.key = Some(on_one_line(match self.key {
            Some(key) if key.starts_with('[') => format!("{parent}{key}"),
            Some(key) => format!("{parent}.{key}"),
            None => parent.to_string(),
        }));
        self
    }

    /// Places a fault that stands in no file yet; one with a file is complete.
    pub fn placed(self, place: impl FnOnce(Error) -> Error) -> Self {
        if self.file.is_some() { self } else { place(self) }
    }

    /// The same fault of a command-line option, which has no file: `young` is `--young`.
    pub fn of_option(mut self) -> Self {
        if self.file.is_none() {
            self.key = self.key.map(|key| format!("--{key}"));
        }
        self
    }

    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    pub fn key(&self) -> Option<&str> {
        self.key.as_deref()
    }

    pub fn problem(&self) -> &str {
        &self.problem
    }
}

/// Names and texts that are quoted from a file may have line ends in them.
fn on_one_line(text: String) -> String {
    if text.contains(char::is_control) { text.replace(char::is_control, "\u{fffd}") } else { text }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match (&self.file, self.line) {
            (Some(file), Some(line)) => write!(f, "{}:{line}: ", file.display())?,
            (Some(file), None) => write!(f, "{}: ", file.display())?,
            (None, Some(line)) => write!(f, "line {line}: ")?,
            (None, None) => {}
        }
        if let Some(key) = &self.key {
            write!(f, "{key}: ")?;
        }
        f.write_str(&self.problem)
    }
}

impl std::error::Error for Error {}
