//! What is measured or drawn from rounding errors, and is therefore not compared: one table, with the reasons.

use super::case::fits;
use serde_json::Value;
use std::ops::Range;

/// Stands for what is masked.
const MASKED: &str = "T";

/// Where a mask applies.
#[derive(Debug, Clone, Copy, PartialEq)]
enum At {
    /// The numbers of a key in JSON.
    Key,
    /// An object of a key in JSON.
    Object,
    /// A column of a table: its heading or its unit, in print, in CSV and in the page's record.
    Column,
    /// A number in a text before this word.
    Before,
    /// A number with dots in a text after these words.
    After,
    /// A whole line of a text.
    Line,
}

/// Patterns, in which `*` stands for any letters and `#` for a whole number.
const MASKS: [(At, &str, &str); 27] = [
    (At::Object, "times", "times of passes"),
    (At::Object, "model_times", "times of passes"),
    (At::Column, "median / least us/element", "a time"),
    (At::Key, "seconds*", "a time"),
    (At::Key, "steps_per_second", "from a time"),
    (At::Key, "residual", "what rounding leaves of the forces after a solve; its digits are those of rounding errors"),
    (At::Key, "certificate_gap", "a bound of rounding errors where the optimum is reached"),
    (At::Column, "us/element*", "a time"),
    (At::Column, "µs/element", "a time"),
    (At::Column, "ms", "a time"),
    (At::Column, "time ms", "a time"),
    (At::Column, "time", "an estimate for this machine"),
    (At::Column, "memory", "an estimate for this machine"),
    (At::Column, "steps/s", "from a time"),
    (At::Column, "residual", "as the key"),
    (At::Column, "solver_*.residual", "as the key"),
    (At::Column, "gap max", "as the key certificate_gap"),
    (At::Before, "ms", "a time"),
    (At::Before, "us", "a time"),
    (At::Before, "s with *", "a time of equations that take long"),
    (At::Before, "s, # lost", "the time of a study of stability"),
    (At::After, "springfit ", "the version"),
    (At::Line, "note: *: # of #", "progress, which is printed where work takes long"),
    (At::Line, "note: *: # of #, about *", "as above"),
    (At::Line, "note: *level # of #: *", "progress with a time; the table has the other numbers"),
    (At::Line, "note: about * are expected*", "an estimate for this machine, which is printed where it is long"),
    (At::Line, "stage: *", "times of stages"),
];

fn is_masked(at: At, name: &str) -> bool {
    MASKS.iter().any(|(place, pattern, _)| *place == at && fits(name, pattern))
}

/// A column by its heading, which may have the unit after a comma.
pub fn is_column(heading: &str) -> bool {
    let unit = heading.rsplit(", ").next().unwrap_or_default();
    is_masked(At::Column, heading.trim()) || is_masked(At::Column, unit.trim())
}

/// Masks values by their keys, and cells of the page's tables by their columns.
pub fn mask_value(value: &mut Value) {
    match value {
        Value::Array(items) => items.iter_mut().for_each(mask_value),
        Value::Object(entries) => {
            mask_rows(entries);
            for (key, value) in entries.iter_mut() {
                let is_number = value.is_number() || value.is_array();
                if is_masked(At::Key, key) && is_number || is_masked(At::Object, key) && value.is_object() {
                    *value = MASKED.into();
                } else {
                    mask_value(value);
                }
            }
        }
        Value::Null | Value::Bool(_) | Value::Number(_) => {}
        Value::String(text) => *text = mask_words(text),
    }
}

/// A table of the page: `columns` with `title` and `unit`, and `rows` of cells.
fn mask_rows(table: &mut serde_json::Map<String, Value>) {
    let name = |column: &Value, key: &str| column[key].as_str().is_some_and(is_column);
    let Some(columns) = table.get("columns").and_then(Value::as_array) else { return };
    let masked: Vec<bool> = columns.iter().map(|column| name(column, "title") || name(column, "unit")).collect();
    for row in table.get_mut("rows").and_then(Value::as_array_mut).into_iter().flatten() {
        let cells = row.as_array_mut().into_iter().flatten().zip(&masked);
        cells.filter(|(_, masked)| **masked).for_each(|(cell, _)| *cell = MASKED.into());
    }
}

/// Masks the lines of a text.
pub fn mask_lines(text: &str) -> Vec<String> {
    let (mut lines, mut columns) = (Vec::new(), Columns::None);
    for line in text.lines() {
        if !is_masked(At::Line, line) {
            columns = columns.next(line);
            lines.push(mask_words(&columns.mask(line)));
        }
    }
    lines
}

/// Numbers before a unit, and after words.
fn mask_words(line: &str) -> String {
    let (mut masked, mut at) = (String::new(), 0);
    for word in line.split_inclusive(' ') {
        let (before, after, bare) = (&line[..at], &line[at + word.len()..], word.trim_end());
        let is_measured = bare.parse::<f64>().is_ok() && is_beside(At::Before, after);
        let is_version =
            bare.contains('.') && bare.starts_with(|c: char| c.is_ascii_digit()) && is_beside(At::After, before);
        masked += if is_measured || is_version { MASKED } else { bare };
        masked += &word[bare.len()..];
        at += word.len();
    }
    masked
}

/// Whether a text begins with words of [`At::Before`], after which no letter follows, or ends with words of [`At::After`].
fn is_beside(at: At, text: &str) -> bool {
    MASKS.iter().filter(|(place, ..)| *place == at).any(|(_, words, _)| match at {
        At::After => text.ends_with(words),
        At::Before | At::Key | At::Object | At::Column | At::Line => {
            let rest = text.strip_prefix(words);
            rest.is_some_and(|rest| !rest.starts_with(char::is_alphanumeric)) || fits(text, words)
        }
    })
}

/// The masked columns of the table around a line.
enum Columns {
    None,
    /// Where their cells end, in letters.
    Ends(Vec<usize>),
    /// The places of the cells between bars.
    Bars(Vec<usize>),
}

impl Columns {
    /// Those of the next line: headings begin them, and an empty line ends them.
    fn next(self, line: &str) -> Columns {
        if line.trim().is_empty() {
            return Columns::None;
        }
        if line.starts_with('|') {
            let bars: Vec<usize> =
                (0..).zip(between_bars(line).iter()).filter(|(_, cell)| is_column(cell)).map(|c| c.0).collect();
            return if bars.is_empty() { self } else { Columns::Bars(bars) };
        }
        let ends = heading_ends(line);
        if ends.is_empty() { self } else { Columns::Ends(ends) }
    }

    /// The line with its masked cells. Blanks of a table with such cells depend on the widths of the times, and are joined.
    fn mask(&self, line: &str) -> String {
        let joined = |line: &str| {
            let is_rule = |word: &str| word.len() > 3 && word.chars().all(|c| matches!(c, '-' | '|' | ':'));
            let words = line.split_whitespace().map(|word| if is_rule(word) { "---" } else { word });
            words.collect::<Vec<&str>>().join(" ")
        };
        match self {
            Columns::None => line.to_string(),
            Columns::Bars(bars) => {
                let cell = |(i, cell): (usize, &str)| {
                    let is_number = cell.trim().trim_end_matches('*').parse::<f64>().is_ok();
                    if bars.contains(&i) && is_number { format!(" {MASKED} ") } else { cell.to_string() }
                };
                let cells = between_bars(line);
                joined(&cells.iter().map(String::as_str).enumerate().map(cell).collect::<Vec<String>>().join("|"))
            }
            Columns::Ends(ends) => {
                let letters: Vec<char> = line.chars().collect();
                let mut masked = letters.clone();
                for end in ends.iter().copied().filter(|end| *end <= letters.len()).rev() {
                    if let Some(place) = number_before(&letters[..end]) {
                        masked.splice(place, MASKED.chars());
                    }
                }
                joined(&masked.iter().collect::<String>())
            }
        }
    }
}

/// The place of the number that ends a cell, or of that before the unit that ends it.
fn number_before(letters: &[char]) -> Option<Range<usize>> {
    let mut end = letters.len();
    for _ in 0..2 {
        let begin = letters[..end].iter().rposition(|c| c.is_whitespace()).map_or(0, |at| at + 1);
        let word: String = letters[begin..end].iter().collect();
        // A mark says that some elements have the constants of others.
        let number = word.trim_end_matches('*');
        if number.parse::<f64>().is_ok() {
            return Some(begin..begin + number.len());
        }
        // Two blanks are between cells.
        end = begin.checked_sub(1).filter(|end| !letters[..*end].last().is_none_or(|c| c.is_whitespace()))?;
    }
    None
}

/// The cells of a line of Markdown; a bar within a cell is written with a stroke before it.
fn between_bars(line: &str) -> Vec<String> {
    line.replace("\\|", "¦").split('|').map(String::from).collect()
}

/// Where masked headings of a line end; two blanks are between headings.
fn heading_ends(line: &str) -> Vec<usize> {
    let (mut ends, mut at) = (Vec::new(), 0);
    for heading in line.split("  ") {
        let end = at + heading.chars().count();
        if is_column(heading) {
            ends.push(end);
        }
        at = end + 2;
    }
    ends
}

#[test]
fn times_and_versions_are_masked_and_nothing_else() {
    let table = " fit   us/element   error\n-----------------\n a         12.30*    1.37\n b              -    1.38\n\n 12.30  1\n";
    let masked = ["fit us/element error", "---", "a T* 1.37", "b - 1.38", "", " 12.30  1"];
    assert_eq!(mask_lines(table), masked);
    let line = "springfit 0.1.0 took 5.2 ms, and 3 s of 4 m in 12.5 us each";
    assert_eq!(mask_words(line), "springfit T took T ms, and 3 s of 4 m in T us each");
    let mut value = serde_json::json!({ "seconds_fem": 0.5, "steps": 3, "seconds": null });
    mask_value(&mut value);
    assert_eq!(value, serde_json::json!({ "seconds_fem": "T", "steps": 3, "seconds": null }));
}
