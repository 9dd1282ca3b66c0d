//! Lines of a text file, with errors that name the line.

use super::reader::quoted;
use crate::error::{Error, ErrorKind, Result};

/// A position between the lines of a text.
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    /// The number of the last line that was read, from 1.
    number: usize,
    section: String,
}

impl<'a> Lines<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Lines { rest: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), number: 0, section: String::new() }
    }

    /// Names the section for later errors.
    pub fn enter(&mut self, section: impl Into<String>) {
        self.section = section.into();
    }

    pub fn number(&self) -> usize {
        self.number
    }

    /// The next line without its end; `None` at the end of the file.
    pub fn next(&mut self) -> Option<&'a [u8]> {
        let (line, rest) = self.split()?;
        self.rest = rest;
        self.number += 1;
        Some(line)
    }

    /// The next line without its end, which is read again.
    pub fn peek(&self) -> Option<&'a [u8]> {
        self.split().map(|(line, _)| line)
    }

    fn split(&self) -> Option<(&'a [u8], &'a [u8])> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.iter().position(|&b| b == b'\n').unwrap_or(self.rest.len());
        let line = &self.rest[..end];
        Some((line.strip_suffix(b"\r").unwrap_or(line), self.rest.get(end + 1..).unwrap_or_default()))
    }

    /// The words before a comment in the next line that has any; `None` at the end of the file.
    pub fn next_words(&mut self) -> Option<Vec<&'a [u8]>> {
        while let Some(line) = self.next() {
            let found: Vec<&[u8]> = words(before_comment(line)).collect();
            if !found.is_empty() {
                return Some(found);
            }
        }
        None
    }

    /// That the file goes on after what its header counts; `None` if it does not.
    pub fn beyond(&mut self, counted: &str) -> Option<String> {
        let mut count = 0;
        while self.next_words().is_some() {
            count += 1;
        }
        let lines = if count == 1 { "1 line".to_string() } else { format!("{count} lines") };
        (count > 0).then(|| format!("{lines} after the {counted} that the header counts were left out"))
    }

    /// A fault of the last line.
    pub fn fault(&self, problem: impl Into<String>) -> Error {
        let error = if self.section.is_empty() { Error::new(problem) } else { Error::at(&self.section, problem) };
        error.of_kind(ErrorKind::Syntax).on_line(self.number.max(1))
    }

    /// A fault of the last line: `expected …, found …`.
    pub fn expected(&self, expected: &str, found: &str) -> Error {
        self.fault(format!("expected {expected}, found {found}"))
    }

    /// Something that the program does not read, in the last line.
    pub fn unsupported(&self, problem: impl Into<String>) -> Error {
        self.fault(problem).of_kind(ErrorKind::Unsupported)
    }

    /// The error for a file that is cut short.
    pub fn ends(&self) -> Error {
        let section = if self.section.is_empty() { "its header" } else { &self.section };
        Error::new(format!("the file ends inside {section}")).of_kind(ErrorKind::Syntax)
    }

    /// The whole number in a field of the last line.
    pub fn whole(&self, field: &[u8], what: &str) -> Result<u64> {
        whole(field).ok_or_else(|| self.expected(what, &quoted(field)))
    }

    /// The number in a field of the last line.
    pub fn real(&self, field: &[u8], what: &str) -> Result<f64> {
        real(field).ok_or_else(|| self.expected(what, &quoted(field)))
    }
}

/// The words of a line, between blanks.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// The part of a line before a comment such as `# …`.
pub(super) fn before_comment(line: &[u8]) -> &[u8] {
    &line[..line.iter().position(|&b| b == b'#').unwrap_or(line.len())]
}

/// A whole number of at least zero.
pub(super) fn whole(field: &[u8]) -> Option<u64> {
    std::str::from_utf8(field.trim_ascii()).ok()?.parse().ok()
}

/// A number as C, Fortran (`1.0D3`) and Nastran (`1.0-3`) write it.
pub(super) fn real(field: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(field.trim_ascii()).ok()?;
    if let Ok(number) = text.parse() {
        return Some(number);
    }
    let bytes = text.as_bytes();
    // The sign of an exponent without a letter, or the letter D.
    let at = (1..bytes.len()).find(|&i| matches!(bytes[i], b'd' | b'D' | b'+' | b'-'))?;
    let exponent = &text[at..];
    let exponent = exponent.strip_prefix(['d', 'D']).unwrap_or(exponent);
    let is_digit_before = bytes[at - 1].is_ascii_digit() || bytes[at - 1] == b'.';
    is_digit_before.then(|| format!("{}e{exponent}", &text[..at]).parse().ok()).flatten()
}
