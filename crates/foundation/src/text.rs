//! Texts from outside the program, made safe to print.

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
