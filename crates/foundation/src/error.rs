//! The error type of springfit: what kind of fault an input has, where it is, what was expected there and what was
//! found.

use crate::text::{cut, cut_path, printable};
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A result whose error is an [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

/// The kind of fault that an [`Error`] reports, for programs that react to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A file, a folder or a stream cannot be read or written.
    Io,
    /// A text is not TOML or not an expression, or a file is not one of its format: it is malformed, damaged or cut short.
    Syntax,
    /// A value, a key, a name or an array is wrong.
    Invalid,
    /// The input is well formed, but the program has no such feature.
    Unsupported,
    /// The input is larger than a stated bound.
    Limit,
    /// The input is valid, but the problem that it states has no answer.
    Infeasible,
}

/// A fault of an input: its kind, its place and the problem.
///
/// It prints as one line, `file:line: key: problem`, without the parts that it does not have; a line without a file is
/// `line 3: key: problem`. Lines count from 1. The key is the path of a value in its file (`fit[0].higher`), the name of
/// an argument, or a part of a mesh (`$Nodes`, `node 4`). The wording of the problem may change between versions; programs
/// use [`kind`](Error::kind), [`file`](Error::file), [`line`](Error::line) and [`key`](Error::key).
///
/// Names, values and expressions that are quoted are on one line, without characters that a terminal interprets. The error shows
/// the beginning of a long one and states its length.
///
/// An optimum that the solver does not reach and a network that is not stable are not errors but a status of the result.
///
/// Two errors are equal if their kind, place and problem are equal; the source is not compared.
#[derive(Debug, Clone)]
pub struct Error {
    kind: ErrorKind,
    file: Option<PathBuf>,
    line: Option<usize>,
    key: Option<String>,
    problem: String,
    source: Option<Arc<io::Error>>,
}

impl Error {
    /// A fault without a key, in words; [`ErrorKind::Invalid`] unless [`of_kind`](Error::of_kind) changes it.
    pub fn new(problem: impl Into<String>) -> Self {
        let problem = cut(&line(problem.into())).into_owned();
        Error { kind: ErrorKind::Invalid, file: None, line: None, key: None, problem, source: None }
    }

    /// A failure of the system to do something with a file or a stream: `cannot be read: …`. The failure is the source.
    pub fn io(problem: impl fmt::Display, source: io::Error) -> Self {
        let error = Error::new(format!("{problem}: {source}")).of_kind(ErrorKind::Io);
        Error { source: Some(Arc::new(source)), ..error }
    }

    /// A fault at `key`, in words.
    pub fn at(key: impl Into<String>, problem: impl Into<String>) -> Self {
        Error { key: Some(line(key.into())), ..Error::new(problem) }
    }

    /// A fault at `key`: `expected …, found …`.
    pub fn expected(key: impl Into<String>, expected: impl fmt::Display, found: impl fmt::Display) -> Self {
        Error::at(key, format!("expected {expected}, found {found}"))
    }

    /// Sets the kind of the fault.
    pub fn of_kind(mut self, kind: ErrorKind) -> Self {
        self.kind = kind;
        self
    }

    /// Sets the key of the fault.
    pub fn at_key(mut self, key: impl Into<String>) -> Self {
        self.key = Some(line(key.into()));
        self
    }

    /// Adds words after the problem of the fault.
    pub fn followed_by(mut self, words: impl fmt::Display) -> Self {
        self.problem = cut(&line(format!("{}{words}", self.problem))).into_owned();
        self
    }

    /// Names the file, unless a deeper layer has named one already.
    pub fn in_file(mut self, file: &Path) -> Self {
        self.file.get_or_insert_with(|| file.to_path_buf());
        self
    }

    /// Names `place` where the error names `file`, which stands for it until it is complete.
    #[must_use]
    pub fn about(mut self, file: &Path, place: &Path) -> Self {
        if self.file.as_deref() == Some(file) {
            self.file = Some(place.to_path_buf());
        }
        self
    }

    /// Names the line (from 1).
    pub fn on_line(mut self, line: usize) -> Self {
        self.line.get_or_insert(line);
        self
    }

    /// Puts `parent` before the key: `shape` under `nodes[3]` is `nodes[3].shape`.
    pub fn under(mut self, parent: impl fmt::Display) -> Self {
        self.key = Some(line(match self.key {
            Some(key) if key.starts_with('[') => format!("{parent}{key}"),
            Some(key) => format!("{parent}.{key}"),
            None => parent.to_string(),
        }));
        self
    }

    /// Applies `place` to an error that names no file yet. An error with a file is complete and is returned as it is.
    pub fn placed(self, place: impl FnOnce(Error) -> Error) -> Self {
        if self.file.is_some() { self } else { place(self) }
    }

    /// Makes the fault one of a command-line option, which has no file: the key `young` becomes `--young`.
    pub fn of_option(mut self) -> Self {
        if self.file.is_none() {
            self.key = self.key.map(|key| format!("--{key}"));
        }
        self
    }

    /// The kind of fault.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// The file that has the fault, or that cannot be read or written.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// The line of the file, from 1.
    pub fn line(&self) -> Option<usize> {
        self.line
    }

    /// The path of the value in its file, the name of an argument, or a part of a mesh.
    pub fn key(&self) -> Option<&str> {
        self.key.as_deref()
    }

    /// What is wrong, in words on one line.
    pub fn problem(&self) -> &str {
        &self.problem
    }
}

/// Checks that none of these keys is given: each has to do with something else, as the problem says.
///
/// # Errors
/// One is given; the error has the first.
pub fn expect_none<'a>(given: impl IntoIterator<Item = (&'a str, bool)>, problem: impl Into<String>) -> Result<()> {
    match given.into_iter().find(|(_, is_given)| *is_given) {
        Some((key, _)) => Err(Error::at(key, problem)),
        None => Ok(()),
    }
}

/// Puts the text on one line: names and texts that are quoted from a file may contain line ends.
fn line(text: String) -> String {
    printable(&text).into_owned()
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let file = self.file.as_ref().map(|file| file.display().to_string());
        match (file.as_deref().map(printable), self.line) {
            (Some(file), Some(line)) => write!(f, "{}:{line}: ", cut_path(&file))?,
            (Some(file), None) => write!(f, "{}: ", cut_path(&file))?,
            (None, Some(line)) => write!(f, "line {line}: ")?,
            (None, None) => {}
        }
        if let Some(key) = &self.key {
            write!(f, "{}: ", cut(key))?;
        }
        f.write_str(&self.problem)
    }
}

impl PartialEq for Error {
    fn eq(&self, other: &Error) -> bool {
        let Error { kind, file, line, key, problem, source: _ } = self;
        (kind, file, line, key, problem) == (&other.kind, &other.file, &other.line, &other.key, &other.problem)
    }
}

impl Eq for Error {}

impl std::error::Error for Error {
    /// The failure of the system, where there was one.
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.source.as_deref().map(|source| source as _)
    }
}
