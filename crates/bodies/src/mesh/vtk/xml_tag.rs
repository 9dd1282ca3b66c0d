//! The tags of an XML file.

use std::ops::Range;

/// A tag, its place in the file and what stands in it.
pub(super) struct Tag<'a> {
    pub start: usize,
    pub end: usize,
    /// With a slash before it for an end tag.
    pub name: &'a [u8],
    attributes: &'a str,
    /// Whether the element ends with its start tag.
    pub empty: bool,
}

/// The first tag from `at` on; comments and declarations are passed over.
pub(super) fn next_tag(bytes: &[u8], mut at: usize) -> Option<Tag<'_>> {
    loop {
        let start = text_after(bytes, at).end;
        let rest = bytes.get(start + 1..)?;
        if rest.starts_with(b"!--") {
            at = start + 4 + rest.windows(3).position(|w| w == b"-->")?;
            continue;
        }
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
        return Some(Tag { start, end, name, attributes: std::str::from_utf8(attributes).unwrap_or_default(), empty });
    }
}

/// The text from `start` to the next tag or the end.
pub(super) fn text_after(bytes: &[u8], start: usize) -> Range<usize> {
    let rest = bytes.get(start..).unwrap_or_default();
    start..start + rest.iter().position(|&b| b == b'<').unwrap_or(rest.len())
}

impl<'a> Tag<'a> {
    pub fn attribute(&self, name: &str) -> Option<&'a str> {
        let mut rest = self.attributes;
        loop {
            let (key, after) = rest.split_once('=')?;
            let after = after.trim_start();
            let quote = after.chars().next().filter(|c| "\"'".contains(*c))?;
            let (value, after) = after[1..].split_once(quote)?;
            if key.trim() == name {
                return Some(value);
            }
            rest = after;
        }
    }
}
