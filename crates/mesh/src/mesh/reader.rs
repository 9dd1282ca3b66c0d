//! Reads words, lines and numbers from the bytes of a mesh file, in text or in binary.

use crate::error::{Error, ErrorKind, Result};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    Binary { big_endian: bool },
}

/// A number of a mesh file.
pub(super) trait Number: Copy {
    const NAME: &'static str;
    const BYTES: usize;
    fn from_word(word: &str) -> Option<Self>;
    fn from_bytes(bytes: &[u8], big_endian: bool) -> Option<Self>;
}

macro_rules! number {
    ($name:literal: $($kind:ty),*) => {$(
        impl Number for $kind {
            const NAME: &'static str = $name;
            const BYTES: usize = size_of::<$kind>();

            fn from_word(word: &str) -> Option<Self> {
                word.parse().ok()
            }

            fn from_bytes(bytes: &[u8], big_endian: bool) -> Option<Self> {
                let bytes = bytes.try_into().ok()?;
                Some(if big_endian { <$kind>::from_be_bytes(bytes) } else { <$kind>::from_le_bytes(bytes) })
            }
        }
    )*};
}

number!("a whole number": i8, i16, i32, i64, u8, u16, u32, u64);
number!("a number": f32, f64);

/// How much of a counted list has been read.
struct Progress {
    what: &'static str,
    expected: u64,
    found: u64,
}

/// A position in a file.
pub(super) struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    pub encoding: Encoding,
    section: String,
    progress: Option<Progress>,
}

impl<'a> Reader<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Reader::starting_at(bytes, 0)
    }

    /// Reads text from the byte `at`; errors give the line in all of `bytes`.
    pub fn starting_at(bytes: &'a [u8], at: usize) -> Self {
        Reader { bytes, at, encoding: Encoding::Text, section: String::new(), progress: None }
    }

    /// Names the section for later errors.
    pub fn enter(&mut self, section: impl Into<String>) {
        self.section = section.into();
        self.progress = None;
    }

    /// Sets the number of items that the section announces; `count_one` counts them.
    pub fn announce(&mut self, what: &'static str, expected: u64) {
        self.progress = Some(Progress { what, expected, found: 0 });
    }

    pub fn count_one(&mut self) {
        if let Some(progress) = &mut self.progress {
            progress.found += 1;
        }
    }

    pub fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at..).unwrap_or_default()
    }

    /// The next word, without consuming it; empty at the end of the file.
    pub fn peek(&mut self) -> &'a [u8] {
        let rest = self.rest();
        let blank = rest.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(rest.len());
        self.at += blank;
        let rest = self.rest();
        &rest[..rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len())]
    }

    pub fn word(&mut self) -> &'a [u8] {
        let word = self.peek();
        self.at += word.len();
        word
    }

    /// Whether the next word is this keyword, in upper or lower case. Consumes nothing, because binary data may follow.
    pub fn next_is(&self, keyword: &str) -> bool {
        let rest = self.rest().trim_ascii_start();
        let Some(word) = rest.get(..keyword.len()) else { return false };
        word.eq_ignore_ascii_case(keyword.as_bytes()) && rest.get(keyword.len()).is_none_or(u8::is_ascii_whitespace)
    }

    /// The rest of this line, without consuming it.
    pub fn rest_of_line(&self) -> &'a [u8] {
        let rest = self.rest();
        &rest[..rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len())]
    }

    /// The rest of this line.
    pub fn line(&mut self) -> &'a [u8] {
        let line = self.rest_of_line();
        self.at = (self.at + line.len() + 1).min(self.bytes.len());
        line
    }

    /// Moves to the first byte of binary data, which follows the end of a line of text.
    pub fn start_data(&mut self) -> Result<()> {
        if self.encoding == Encoding::Text {
            return Ok(());
        }
        let line = self.line();
        if line.iter().all(u8::is_ascii_whitespace) {
            Ok(())
        } else {
            Err(self.expected("the end of the line", &quoted(line)))
        }
    }

    /// Passes over so many bytes.
    pub fn pass(&mut self, count: usize) {
        // Counts come from the file and may be any number; the place stays within the bytes.
        self.at = self.at.saturating_add(count).min(self.bytes.len());
    }

    /// The next `count` bytes.
    pub fn take(&mut self, count: usize) -> Result<&'a [u8]> {
        let Some(taken) = self.rest().get(..count) else {
            self.at = self.bytes.len();
            return Err(self.ends());
        };
        self.at += count;
        Ok(taken)
    }

    pub fn number<T: Number>(&mut self) -> Result<T> {
        match self.encoding {
            Encoding::Text => self.text_number(),
            Encoding::Binary { big_endian } => {
                let bytes = self.take(T::BYTES)?;
                T::from_bytes(bytes, big_endian).ok_or_else(|| self.ends())
            }
        }
    }

    /// A number that is written as text in binary files too.
    pub fn text_number<T: Number>(&mut self) -> Result<T> {
        let word = self.peek();
        match std::str::from_utf8(word).ok().and_then(T::from_word) {
            Some(number) => {
                self.at += word.len();
                Ok(number)
            }
            None => Err(self.unexpected(T::NAME)),
        }
    }

    /// How many items of `numbers` numbers of type `T` the rest of the file can hold, but at most `count`.
    pub fn capacity<T: Number>(&self, count: u64, numbers: usize) -> usize {
        // Even a short number of text has a digit and a blank.
        let bytes = if self.encoding == Encoding::Text { 2 } else { T::BYTES };
        let room = self.rest().len() / bytes / numbers.max(1) + 1;
        usize::try_from(count).map_or(room, |count| count.min(room))
    }

    /// The error for a next word that was not expected.
    pub fn unexpected(&mut self, expected: &str) -> Error {
        let word = self.peek();
        if word.len() == self.rest().len() {
            return self.ends();
        }
        match &self.progress {
            Some(p) if word.starts_with(b"$") && p.found != p.expected => {
                let (expected, found) = (format!("{} {}", p.expected, p.what), p.found.to_string());
                self.expected(&expected, &found)
            }
            _ => self.expected(expected, &quoted(word)),
        }
    }

    /// The error for something before this position that was not expected.
    pub fn expected(&self, expected: &str, found: &str) -> Error {
        self.fault(format!("expected {expected}, found {found}"))
    }

    /// The error for a fault before this position.
    pub fn fault(&self, problem: String) -> Error {
        let error = if self.section.is_empty() { Error::new(problem) } else { Error::at(&self.section, problem) };
        let error = error.of_kind(ErrorKind::Syntax);
        match self.encoding {
            Encoding::Text => error.on_line(self.line_number()),
            Encoding::Binary { .. } => error,
        }
    }

    /// The error for a file that is cut short.
    pub fn ends(&self) -> Error {
        let section = if self.section.is_empty() { "its header" } else { &self.section };
        let problem = match &self.progress {
            Some(p) if p.found < p.expected => {
                format!("the file ends inside {section}: expected {} {}, found {}", p.expected, p.what, p.found)
            }
            _ => format!("the file ends inside {section}"),
        };
        Error::new(problem).of_kind(ErrorKind::Syntax)
    }

    fn line_number(&self) -> usize {
        let before = self.bytes.get(..self.at).unwrap_or(self.bytes);
        1 + before.iter().filter(|&&b| b == b'\n').count()
    }
}

/// At most the first 40 characters, in quotes, on one line.
pub(super) fn quoted(bytes: &[u8]) -> String {
    // Forty characters have at most 160 bytes in UTF-8: the rest of a long line is not looked at.
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(160)]);
    let shown: String = text.chars().take(40).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    let dots = if shown.len() < bytes.len() && text.chars().count() > 40 { "…" } else { "" };
    format!("\"{shown}{dots}\"")
}
