//! Texts from outside the program, made safe to print, and numbers as text.

mod grammar;
mod length;
mod numerals;

pub use grammar::{comment, csv, latex, markdown, of_csv, toml, xml};
pub use length::{cut, cut_path};
pub use numerals::{push_exponential, push_list, push_number, push_whole};

use std::borrow::Cow;

/// The text on one line, without characters that a terminal interprets: each becomes U+FFFD.
///
/// Every name, title and path that comes from a file goes through this function before it is printed or written.
pub fn printable(text: &str) -> Cow<'_, str> {
    replaced(text, acts_on_terminal)
}

/// The text without characters that a terminal interprets; line ends are kept.
pub fn printable_lines(text: &str) -> Cow<'_, str> {
    replaced(text, |c| c != '\n' && acts_on_terminal(c))
}

/// Keys of files whose texts are expressions or quantities, which may have several lines, as may what is inside a table of such a name.
/// All other texts are names and titles.
const EXPRESSIONS: [&str; 24] = [
    // Keys of elements and materials.
    "shape",
    "measure",
    "energy",
    "let",
    "at",
    "points",
    "weights",
    // Keys of scenes.
    "where",
    "young",
    "poisson",
    "density",
    "thickness",
    "area",
    "parameters",
    "stiffness",
    "axes",
    "fibre",
    "traction",
    "body",
    "force",
    "displacement",
    // Keys that files of networks have beside these.
    "expression",
    "law",
    "over",
];

/// Whether the texts of a key of a file are expressions: those may have line ends and tabs.
pub fn is_expression(key: &str) -> bool {
    EXPRESSIONS.contains(&key)
}

/// What keeps a text from being one printable line, in words: its first character that ends a line or acts on a terminal. Line ends and
/// tabs are allowed in expressions.
///
/// Every text of a file of elements, materials, scenes and networks is checked by this function when it is read.
pub fn not_a_line(text: &str, is_expression: bool) -> Option<String> {
    let is_wrong = |c: char| acts_on_terminal(c) && !(is_expression && matches!(c, '\n' | '\r' | '\t'));
    let (place, wrong) = text.chars().enumerate().find(|(_, c)| is_wrong(*c))?;
    let what = if matches!(wrong, '\n' | '\r' | '\u{85}' | '\u{2028}' | '\u{2029}') { "a line end, " } else { "" };
    Some(format!(
        "expected one line of printable characters, found {what}U+{:04X} after {place} characters of \"{text}\"",
        u32::from(wrong)
    ))
}

/// The number with so many significant digits at most, such as `0.0123` or `1.5e-7`.
pub fn rounded(value: f64, digits: usize) -> String {
    // The digits are rounded in decimal, and read again so that the fewest of them are printed.
    let short = format!("{:.*e}", digits - 1, value).parse::<f64>().unwrap_or(value);
    match short.abs() {
        0.0 | 1e-4..1e6 => format!("{short}"),
        _ => format!("{short:e}"),
    }
}

/// A time for people: `0.20 s`, `45 s`, `12 min` or `3 h`.
pub fn time_in_words(seconds: f64) -> String {
    match seconds {
        s if s < 1.0 => format!("{:.2} s", s.max(0.01)),
        s if s < 10.0 => format!("{s:.1} s"),
        s if s < 100.0 => format!("{s:.0} s"),
        s if s < 6000.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.0} h", s / 3600.0),
    }
}

/// A number of bytes for people: `0.4 MB`, `35 MB` or `1.5 GB`.
pub fn memory_in_words(bytes: f64) -> String {
    match bytes / 1e6 {
        mega if mega < 10.0 => format!("{mega:.1} MB"),
        mega if mega < 1000.0 => format!("{mega:.0} MB"),
        mega => format!("{:.1} GB", mega / 1e3),
    }
}

/// Control characters, marks that change the direction of writing, and characters that end a line.
fn acts_on_terminal(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}' | '\u{2029}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

fn replaced(text: &str, is_wrong: impl Fn(char) -> bool) -> Cow<'_, str> {
    match text.contains(&is_wrong) {
        true => Cow::Owned(text.replace(is_wrong, "\u{fffd}")),
        false => Cow::Borrowed(text),
    }
}
