//! Cards of bulk data: lines of eight or sixteen columns a field, or with commas, and their continuations.

use crate::error::{Error, ErrorKind, Result};
use crate::mesh::lines::{Lines, real, whole};
use crate::mesh::reader::quoted;

/// A card: its name, and the fields after it.
pub(super) struct Card<'a> {
    /// In upper case, without the star of wide fields.
    pub name: String,
    /// Without blanks around; an empty field is blank.
    pub fields: Vec<&'a [u8]>,
    /// The line on which it begins.
    pub line: usize,
    /// What is wrong with its lines, if the card is of use.
    fault: Option<Error>,
}

/// One line, divided.
struct Row<'a> {
    head: &'a [u8],
    fields: Vec<&'a [u8]>,
    /// The mark of the continuation that follows.
    mark: &'a [u8],
}

/// Columns that a line has at most.
const WIDTH: usize = 72;

impl<'a> Card<'a> {
    /// The next card; `None` at the end of the file.
    pub fn next(lines: &mut Lines<'a>) -> Option<Card<'a>> {
        let mut fault = None;
        let row = loop {
            let line = content(lines.next()?);
            if !line.trim_ascii().is_empty() {
                break row(lines, line, &mut fault);
            }
        };
        let line = lines.number();
        let name = String::from_utf8_lossy(row.head).trim().trim_end_matches('*').trim_end().to_ascii_uppercase();
        let (mut fields, mut mark) = (row.fields, row.mark);
        while let Some(next) = lines.peek() {
            let next = content(next);
            if next.is_empty() {
                lines.next();
                continue;
            }
            if !continues(next) {
                break;
            }
            lines.next();
            let row = self::row(lines, next, &mut fault);
            let known = row.head.strip_prefix(b"+").or(row.head.strip_prefix(b"*")).unwrap_or(row.head).trim_ascii();
            let announced = mark.strip_prefix(b"+").or(mark.strip_prefix(b"*")).unwrap_or(mark).trim_ascii();
            if !known.is_empty() && !announced.is_empty() && known != announced {
                let expected = format!("the continuation {}", quoted(announced));
                fault.get_or_insert_with(|| lines.expected(&expected, &quoted(known)));
            }
            fields.extend(row.fields);
            mark = row.mark;
        }
        Some(Card { name, fields, line, fault })
    }

    /// That the lines of the card are as a card's are. Cards that are of no use may be otherwise.
    ///
    /// # Errors
    /// A line has more fields than a card, or a continuation has another mark than the line before announces.
    pub fn check(&self) -> Result<()> {
        self.fault.clone().map_or(Ok(()), Err)
    }

    /// The field with this index after the name; blank if the card is shorter.
    pub fn field(&self, index: usize) -> &'a [u8] {
        self.fields.get(index).copied().unwrap_or_default()
    }

    /// The whole number in a field.
    ///
    /// # Errors
    /// The field is blank or not a number.
    pub fn whole(&self, index: usize, what: &str) -> Result<u64> {
        whole(self.field(index)).ok_or_else(|| self.expected(what, self.field(index)))
    }

    /// The number in a field; zero if it is blank.
    ///
    /// # Errors
    /// It is no number.
    pub fn real(&self, index: usize, what: &str) -> Result<f64> {
        match self.field(index) {
            b"" => Ok(0.0),
            field => real(field).ok_or_else(|| self.expected(what, field)),
        }
    }

    pub fn expected(&self, expected: &str, found: &[u8]) -> Error {
        let found = if found.is_empty() { "a blank field".to_string() } else { quoted(found) };
        Error::expected(&self.name, expected, found).of_kind(ErrorKind::Syntax).on_line(self.line)
    }

    pub fn unsupported(&self, expected: &str, found: &str) -> Error {
        Error::expected(&self.name, expected, found).of_kind(ErrorKind::Unsupported).on_line(self.line)
    }
}

/// A line without its comment.
fn content(line: &[u8]) -> &[u8] {
    &line[..line.iter().position(|&b| b == b'$').unwrap_or(line.len())]
}

/// Whether the line continues the card before it.
fn continues(line: &[u8]) -> bool {
    matches!(line[0], b'+' | b'*' | b',' | b'\t') || line[..line.len().min(8)].iter().all(|&b| b == b' ')
}

fn row<'a>(lines: &Lines, line: &'a [u8], fault: &mut Option<Error>) -> Row<'a> {
    let separator = [b',', b'\t'].into_iter().find(|separator| line.contains(separator));
    let Some(separator) = separator else {
        let column = |from: usize, to: usize| line.get(from..to.min(line.len())).unwrap_or_default().trim_ascii();
        let head = column(0, 8);
        let width = if head.contains(&b'*') { 16 } else { 8 };
        let fields = (8..WIDTH).step_by(width).map(|from| column(from, from + width)).collect();
        return Row { head, fields, mark: column(WIDTH, WIDTH + 8) };
    };
    let mut parts = line.split(|&b| b == separator).map(<[u8]>::trim_ascii);
    let head = parts.next().unwrap_or_default();
    let most = if head.contains(&b'*') { 4 } else { 8 };
    let mut fields: Vec<&[u8]> = parts.collect();
    // The field after the last is the mark of a continuation.
    if fields.iter().skip(most + 1).any(|field| !field.is_empty()) {
        fault.get_or_insert_with(|| {
            lines.expected(&format!("at most {most} fields after the name"), &fields.len().to_string())
        });
    }
    let mark = fields.get(most).copied().unwrap_or_default();
    fields.resize(most, b"");
    Row { head, fields, mark }
}
