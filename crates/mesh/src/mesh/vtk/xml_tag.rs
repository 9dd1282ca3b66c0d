//! The tags of an XML file, and the text between them.

use crate::error::{Error, Result};
use std::ops::Range;

/// The length of the longest entity that is replaced, `&#x10FFFF;`, without its ampersand.
const LONGEST_ENTITY: usize = 9;

/// A tag, its position in the file and its content.
pub(super) struct Tag<'a> {
    pub start: usize,
    pub end: usize,
    /// The name, with a slash before it for an end tag.
    pub name: &'a [u8],
    attributes: &'a [u8],
    /// Whether the element ends with its start tag.
    pub empty: bool,
}

/// The first tag from `at`; comments and declarations are skipped.
pub(super) fn next_tag(bytes: &[u8], mut at: usize) -> Option<Tag<'_>> {
    loop {
        let start = text_after(bytes, at).end;
        let rest = bytes.get(start + 1..)?;
        // A comment may have brackets, and ends at its own mark alone.
        if rest.starts_with(b"!--") {
            at = start + 4 + rest.windows(3).position(|w| w == b"-->")?;
            continue;
        }
        // A bracket between quotes does not end the tag.
        let mut quote = None;
        let length = rest.iter().position(|&b| match quote {
            None if b == b'"' || b == b'\'' => {
                quote = Some(b);
                false
            }
            None => b == b'>',
            Some(open) => {
                if b == open {
                    quote = None;
                }
                false
            }
        })?;
        let end = start + length + 2;
        let content = &rest[..length];
        if content.starts_with(b"?") || content.starts_with(b"!") {
            at = end;
            continue;
        }
        let empty = content.ends_with(b"/");
        let content = content.strip_suffix(b"/").unwrap_or(content);
        let name = content.iter().position(u8::is_ascii_whitespace).unwrap_or(content.len());
        let (name, attributes) = content.split_at(name);
        return Some(Tag { start, end, name, attributes, empty });
    }
}

/// The text from `start` to the next tag or the end.
pub(super) fn text_after(bytes: &[u8], start: usize) -> Range<usize> {
    let rest = bytes.get(start..).unwrap_or_default();
    start..start + rest.iter().position(|&b| b == b'<').unwrap_or(rest.len())
}

impl Tag<'_> {
    /// The value of an attribute, with the characters that its entities denote.
    pub fn attribute(&self, name: &str) -> Option<String> {
        let mut rest = self.attributes;
        loop {
            let equals = rest.iter().position(|&b| b == b'=')?;
            let (key, after) = (rest[..equals].trim_ascii(), rest[equals + 1..].trim_ascii_start());
            let (&quote, after) = after.split_first().filter(|(quote, _)| b"\"'".contains(quote))?;
            let end = after.iter().position(|&b| b == quote)?;
            if key == name.as_bytes() {
                return Some(unescaped(&String::from_utf8_lossy(&after[..end])));
            }
            rest = &after[end + 1..];
        }
    }
}

/// An attribute that is a whole number.
pub(super) fn number(tag: &Tag, name: &str) -> Result<u64> {
    let value = tag.attribute(name);
    let number = value.as_deref().unwrap_or_default().trim().parse();
    number.map_err(|_| Error::expected(name, "a whole number", shown_value(value)))
}

/// The value of an attribute, for an error.
pub(super) fn shown_value(value: Option<String>) -> String {
    value.map_or("none".into(), |value| quoted(&value))
}

/// The start of a text, in quotes.
pub(super) fn quoted(value: &str) -> String {
    format!("\"{}\"", value.chars().take(40).collect::<String>())
}

fn unescaped(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('&') {
        plain.push_str(before);
        let end = after.bytes().take(LONGEST_ENTITY).position(|b| b == b';');
        match end.and_then(|end| Some((character(&after[..end])?, end))) {
            Some((character, end)) => {
                plain.push(character);
                rest = &after[end + 1..];
            }
            None => {
                plain.push('&');
                rest = after;
            }
        }
    }
    plain.push_str(rest);
    plain
}

fn character(entity: &str) -> Option<char> {
    match entity {
        "lt" => Some('<'),
        "gt" => Some('>'),
        "amp" => Some('&'),
        "quot" => Some('"'),
        "apos" => Some('\''),
        _ => {
            let number = entity.strip_prefix('#')?;
            let code = match number.strip_prefix('x') {
                Some(number) => u32::from_str_radix(number, 16),
                None => number.parse(),
            };
            char::from_u32(code.ok()?)
        }
    }
}
