//! Texts in files with a grammar: each function writes a text so that a reader of the grammar finds this one text and nothing else.
//!
//! Characters that end a line, act on a terminal or change the direction of writing become U+FFFD first, as in
//! [`printable`](super::printable): no grammar has a place for them in a name.

use super::printable;
use std::borrow::Cow;
use std::fmt::Write;

/// A line of comment that begins with `mark`, in a language in which a comment ends with its line.
///
/// In C a backslash at the end of a line, or its trigraph, takes the next line into the comment; blanks after it do not
/// help with every compiler. A point after it does.
pub fn comment(mark: &str, text: &str) -> String {
    let line = format!("{mark}{}", printable(text));
    let line = line.trim_end();
    let goes_on = line.ends_with('\\') || line.ends_with("??/");
    format!("{line}{}", if goes_on { " ." } else { "" })
}

/// A text for an element or an attribute of XML, SVG and HTML.
pub fn xml(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in printable(text).chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            // No characters of XML.
            '\u{fffe}' | '\u{ffff}' => safe.push('\u{fffd}'),
            _ => safe.push(c),
        }
    }
    safe
}

/// A basic string of TOML, which is a string of JSON and of JavaScript as well.
pub fn toml(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            // All are in the first plane, which four digits number.
            c if super::acts_on_terminal(c) => write!(quoted, "\\u{:04x}", u32::from(c)).expect("a String grows"),
            c => quoted.push(c),
        }
    }
    quoted + "\""
}

/// A text of LaTeX outside of formulas, or in `\text`: characters that LaTeX reads as commands or joins to others are commands that
/// print them.
pub fn latex(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    let mut before = None;
    for c in printable(text).chars() {
        match c {
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => safe.extend(['\\', c]),
            '\\' => safe.push_str("\\textbackslash{}"),
            '~' => safe.push_str("\\textasciitilde{}"),
            '^' => safe.push_str("\\textasciicircum{}"),
            // Packages for languages give it a meaning, and not every encoding of fonts has a command for it.
            '"' => safe.push_str("\\char34{}"),
            '<' | '>' | '|' => safe.extend(['$', c, '$']),
            // After the end of a row these are its options.
            '[' | '*' if before.is_none() => safe.extend(['{', c, '}']),
            // Two are a dash, or a quotation mark.
            '-' | '\'' | '`' if before == Some(c) => safe.extend(['{', '}', c]),
            // With ! or ? before it, a Spanish mark.
            '`' if matches!(before, Some('!' | '?')) => safe.push_str("{}`"),
            '−' => safe.push_str("$-$"),
            '–' => safe.push_str("--"),
            'ν' => safe.push_str("$\\nu$"),
            'ρ' => safe.push_str("$\\rho$"),
            '×' => safe.push_str("$\\times$"),
            '†' => safe.push_str("$\\dagger$"),
            '²' => safe.push_str("$^2$"),
            '³' => safe.push_str("$^3$"),
            '…' => safe.push_str("\\dots{}"),
            'µ' => safe.push_str("\\textmu{}"),
            '≤' => safe.push_str("$\\le$"),
            '≥' => safe.push_str("$\\ge$"),
            _ => safe.push(c),
        }
        before = Some(c);
    }
    safe
}

/// A text of Markdown, within a line or a cell of a table.
pub fn markdown(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    let text = printable(text);
    let mut characters = text.chars().peekable();
    let mut before = None;
    while let Some(c) = characters.next() {
        let is_inside =
            before.is_some_and(char::is_alphanumeric) && characters.peek().is_some_and(|c| c.is_alphanumeric());
        before = Some(c);
        match c {
            '<' => safe.push_str("&lt;"),
            '&' => safe.push_str("&amp;"),
            // Within a word it has no meaning.
            '_' if is_inside => safe.push(c),
            '\\' | '|' | '`' | '*' | '_' | '[' | ']' | '~' | '$' => safe.extend(['\\', c]),
            _ => safe.push(c),
        }
    }
    safe
}

/// A cell of a table in CSV, before it is quoted as its grammar asks: a text that a spreadsheet would evaluate, and one that begins with
/// an apostrophe, has an apostrophe before it, which [`of_csv`] takes away. Numbers, and lists of them, are as they are.
pub fn csv(cell: &str) -> Cow<'_, str> {
    let is_number = |word: &str| word == "-" || word.parse::<f64>().is_ok();
    let is_evaluated = cell.trim_start_matches(' ').starts_with(['=', '+', '-', '@', '\t', '\r', '\n', '\'']);
    match is_evaluated && !cell.split_whitespace().all(is_number) {
        true => Cow::Owned(format!("'{cell}")),
        false => Cow::Borrowed(cell),
    }
}

/// The text of a cell that [`csv`] has written.
pub fn of_csv(cell: &str) -> &str {
    match cell.strip_prefix('\'') {
        Some(text) if csv(text) == cell => text,
        _ => cell,
    }
}
