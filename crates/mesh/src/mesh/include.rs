//! Decks that include others: their lines in one text, and the file and the line of each.

use super::reader::quoted;
use crate::error::{Error, ErrorKind, Result};
use std::path::{Path, PathBuf};

/// The largest number of files that a deck includes, because each may include others.
const MOST_FILES: usize = 1000;

/// The lines of a deck and of all that it includes.
pub(super) struct Included {
    pub text: Vec<u8>,
    /// The files, that of the deck first.
    pub files: Vec<PathBuf>,
    /// Where each run of lines begins in the text, from 1: its first line, its file and the line there.
    runs: Vec<(usize, usize, usize)>,
    lines: usize,
}

/// What a line of a deck includes.
pub(super) enum Inclusion {
    /// The file in place of this line and of as many after it.
    Instead(String, usize),
    /// The file after this line and as many after it, which are kept.
    After(String, usize),
}

/// Finds what the lines that follow include: of the first, and of those after it that continue it.
pub(super) type FindInclusion = fn(&[&[u8]]) -> Option<Inclusion>;

impl Included {
    /// Reads a deck and all that it includes; names are relative to the file that has them, or else to the deck.
    ///
    /// # Errors
    /// A file cannot be read, includes itself, or too many are included.
    pub fn read(path: &Path, find: FindInclusion) -> Result<Included> {
        let bytes = crate::file::read(path)?;
        let mut all = Included { text: Vec::new(), files: Vec::new(), runs: Vec::new(), lines: 0 };
        let lines: Vec<&[u8]> = bytes.split_inclusive(|&b| b == b'\n').collect();
        if (0..lines.len()).all(|at| find(&lines[at..]).is_none()) {
            return Ok(Included { text: bytes, files: vec![path.to_path_buf()], runs: vec![(1, 0, 1)], ..all });
        }
        all.add(path, &lines, find, &mut Vec::new())?;
        Ok(all)
    }

    fn add(&mut self, path: &Path, lines: &[&[u8]], find: FindInclusion, open: &mut Vec<PathBuf>) -> Result<()> {
        let file = self.files.len();
        self.files.push(path.to_path_buf());
        open.push(path.canonicalize().unwrap_or_else(|_| path.to_path_buf()));
        self.runs.push((self.lines + 1, file, 1));
        let mut at = 0;
        while at < lines.len() {
            let Some(inclusion) = find(&lines[at..]) else {
                self.push(lines[at]);
                at += 1;
                continue;
            };
            let (name, kept, count) = match inclusion {
                Inclusion::Instead(name, count) => (name, 0, count),
                Inclusion::After(name, count) => (name, count, count),
            };
            let fault = |problem: String| Error::new(problem).of_kind(ErrorKind::Syntax).on_line(at + 1).in_file(path);
            lines[at..at + kept].iter().for_each(|line| self.push(line));
            let included = found(&name, path, &self.files[0]);
            let real = included.canonicalize().unwrap_or_else(|_| included.clone());
            if open.contains(&real) {
                return Err(fault(format!("includes {}, which includes this file", quoted(name.as_bytes()))));
            }
            if self.files.len() >= MOST_FILES {
                return Err(fault(format!("expected at most {MOST_FILES} included files, found more"))
                    .of_kind(ErrorKind::Limit));
            }
            let content = crate::file::read(&included).map_err(|error| {
                fault(format!("includes {}, which {}", quoted(name.as_bytes()), error.problem())).of_kind(error.kind())
            })?;
            let content: Vec<&[u8]> = content.split_inclusive(|&b| b == b'\n').collect();
            self.add(&included, &content, find, open)?;
            at += count;
            self.runs.push((self.lines + 1, file, at + 1));
        }
        open.pop();
        Ok(())
    }

    fn push(&mut self, line: &[u8]) {
        self.text.extend_from_slice(line);
        if !line.ends_with(b"\n") {
            self.text.push(b'\n');
        }
        self.lines += 1;
    }

    /// The error, which names a line of the text, as one of the file that has this line.
    pub fn placed(&self, error: Error) -> Error {
        let Some(line) = error.line() else { return error.in_file(&self.files[0]) };
        let run = self.runs.partition_point(|(first, ..)| *first <= line).saturating_sub(1);
        let (first, file, line_there) = self.runs[run];
        let mut placed = Error::new(error.problem()).of_kind(error.kind());
        if let Some(key) = error.key() {
            placed = placed.at_key(key);
        }
        placed.on_line(line_there + (line - first)).in_file(&self.files[file])
    }
}

/// The path that a name in a deck means: beside the file that has it, or else beside the first deck.
fn found(name: &str, from: &Path, deck: &Path) -> PathBuf {
    let name = name.replace('\\', "/");
    let beside = |file: &Path| file.parent().unwrap_or(Path::new("")).join(&name);
    let own = beside(from);
    match own.exists() {
        true => own,
        false => Some(beside(deck)).filter(|path| path.exists()).unwrap_or(own),
    }
}
