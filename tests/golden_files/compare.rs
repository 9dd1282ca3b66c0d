//! Whether two forms of an output agree: words to the letter, numbers at ten digits.
//!
//! Two numbers agree if they differ by at most 1e-10 of the larger one, or by rounding errors of the largest number of their group.
//! A group are all numbers with the same keys: the `e_rms` of all fits and loads of a report, or the sums of one column. So 1e-17 beside 1
//! is a zero, whatever its digits.

use super::case::fits;
use super::form::{Form, SEVEN_DIGITS};
use super::number::{Piece, pieces};
use super::tolerance::Tolerance;
use serde_json::Value;
use std::collections::BTreeMap;

/// Columns of a motion's table with the components of one vector, and its group.
const VECTORS: [(&str, &str); 6] = [
    ("# px", "momentum"),
    ("# py", "momentum"),
    ("# pz", "momentum"),
    ("# ux", "watched"),
    ("# uy", "watched"),
    ("# uz", "watched"),
];

/// Where the forms do not agree.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    pub place: String,
    pub expected: String,
    pub found: String,
    /// The difference of two numbers as a share of the larger one.
    pub relative: Option<f64>,
}

/// What was compared.
#[derive(Debug, Default)]
pub struct Comparison {
    pub numbers: usize,
    pub differences: Vec<Difference>,
}

/// Compares the forms of an output with this name; `is_exact` asks for equality to the bit.
pub fn compare(name: &str, expected: &Form, found: &Form, is_exact: bool) -> Comparison {
    let mut comparison = Comparison::default();
    match (expected, found) {
        (Form::Text(expected), Form::Text(found)) => {
            let count = expected.len().max(found.len());
            let end = "(the end)".to_string();
            for i in 0..count {
                let (expected, found) = (expected.get(i).unwrap_or(&end), found.get(i).unwrap_or(&end));
                comparison.line(&format!("line {}", i + 1), expected, found, &Tolerance::of(name, "", is_exact));
            }
        }
        (Form::Tree(expected), Form::Tree(found)) => {
            let mut scales = BTreeMap::new();
            gather(expected, "", &mut scales);
            Walk { name, scales, is_exact, comparison: &mut comparison }.values("", "", expected, found);
        }
        (Form::Text(_), Form::Tree(_)) => comparison.differ("length", "a short text", "a long text"),
        (Form::Tree(_), Form::Text(_)) => comparison.differ("length", "a long text", "a short text"),
    }
    comparison
}

impl Comparison {
    fn differ(&mut self, place: &str, expected: &str, found: &str) {
        let cut = |text: &str| text.chars().take(150).collect::<String>();
        let (place, expected, found) = (place.to_string(), cut(expected), cut(found));
        self.differences.push(Difference { place, expected, found, relative: None });
    }

    fn number(&mut self, place: &str, expected: f64, found: f64, tolerance: &Tolerance, scale: f64) {
        self.numbers += 1;
        if !tolerance.allows(expected, found, scale) {
            let larger = expected.abs().max(found.abs());
            let relative = Some((expected - found).abs() / larger);
            let text = |x: f64| format!("{x:e}");
            self.differences.push(Difference {
                place: place.to_string(),
                expected: text(expected),
                found: text(found),
                relative,
            });
        }
    }

    /// Numbers of a line are beside each other: the largest one is their scale. Where numbers differ in their digits alone, blanks may too.
    fn line(&mut self, place: &str, expected: &str, found: &str, tolerance: &Tolerance) {
        let (ours, theirs) = (pieces(expected), pieces(found));
        if expected == found {
            self.numbers += ours.iter().filter(|piece| matches!(piece, Piece::Number(_))).count();
            return;
        }
        let blank = |text: &str| text.split_whitespace().collect::<Vec<&str>>().join(" ");
        let agree = |(a, b): (&Piece, &Piece)| match (a, b) {
            (Piece::Words(a), Piece::Words(b)) => blank(a) == blank(b),
            (Piece::Number(_), Piece::Number(_)) => true,
            (Piece::Words(_), Piece::Number(_)) | (Piece::Number(_), Piece::Words(_)) => false,
        };
        let is_same = |(a, b): (&Piece, &Piece)| matches!(a, Piece::Words(_)) || a == b;
        let numbers_agree = || ours.iter().zip(&theirs).all(is_same);
        if ours.len() != theirs.len() || !ours.iter().zip(&theirs).all(agree) || numbers_agree() {
            return self.differ(place, expected, found);
        }
        let value = |piece: &Piece| match piece {
            Piece::Number(text) => text.parse::<f64>().ok(),
            Piece::Words(_) => None,
        };
        let scale = ours.iter().filter_map(value).fold(0.0, |scale: f64, x| scale.max(x.abs()));
        for (a, b) in ours.iter().zip(&theirs) {
            if let (Some(a), Some(b)) = (value(a), value(b)) {
                self.number(place, a, b, tolerance, scale);
            }
        }
    }
}

/// The largest number of each group.
fn gather(value: &Value, group: &str, scales: &mut BTreeMap<String, f64>) {
    match value {
        Value::Array(items) => items.iter().for_each(|item| gather(item, group, scales)),
        Value::Object(entries) => {
            entries.iter().for_each(|(key, value)| gather(value, &next(group, key, entries), scales));
            // A block of numbers that cancel each other has rounding errors of their sizes.
            if let Some(scale) = entries.get("scale").and_then(Value::as_f64) {
                scales.insert(next(group, "sums", entries), scale);
            }
        }
        Value::Number(number) => {
            let scale = scales.entry(group.to_string()).or_default();
            *scale = scale.max(number.as_f64().unwrap_or_default().abs());
        }
        Value::Null | Value::Bool(_) | Value::String(_) => {}
    }
}

/// The group of what a key holds. Springs of other kinds have other units.
fn next(group: &str, key: &str, entries: &serde_json::Map<String, Value>) -> String {
    let kind = entries.get("kind").and_then(Value::as_str).unwrap_or_default();
    // Samples of a list are numbered.
    let key = if key.bytes().all(|b| b.is_ascii_digit()) { "" } else { key };
    // Columns of one vector: the component across a plane of symmetry has rounding errors of the others.
    let key = VECTORS.iter().find(|(pattern, _)| fits(key, pattern)).map_or(key, |(_, vector)| vector);
    format!("{group}/{kind}{key}")
}

struct Walk<'a> {
    name: &'a str,
    scales: BTreeMap<String, f64>,
    is_exact: bool,
    comparison: &'a mut Comparison,
}

impl Walk<'_> {
    fn values(&mut self, place: &str, group: &str, expected: &Value, found: &Value) {
        match (expected, found) {
            (Value::Number(a), Value::Number(b)) => {
                // Whole numbers are counts and places.
                if (a.is_f64() || b.is_f64()) && !(self.is_exact && a.to_string() == b.to_string()) {
                    let (a, b) = (a.as_f64().unwrap_or(f64::NAN), b.as_f64().unwrap_or(f64::NAN));
                    let scale = self.scales.get(group).copied().unwrap_or_default();
                    let tolerance = Tolerance::of(self.name, group, self.is_exact);
                    self.comparison.number(place, a, b, &tolerance, scale);
                } else {
                    self.comparison.numbers += 1;
                    if a != b {
                        let (a, b) = (a.to_string(), b.to_string());
                        self.comparison.differ(place, &a, &b);
                    }
                }
            }
            (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
                for (i, (a, b)) in a.iter().zip(b).enumerate() {
                    self.values(&format!("{place}[{i}]"), group, a, b);
                }
            }
            (Value::Array(a), Value::Array(b)) => {
                self.comparison.differ(place, &format!("{} entries", a.len()), &format!("{} entries", b.len()));
            }
            (Value::Object(a), Value::Object(b)) => {
                for key in a.keys().chain(b.keys().filter(|key| !a.contains_key(*key))) {
                    let place = format!("{place}.{key}");
                    match (a.get(key), b.get(key)) {
                        (Some(x), Some(y)) => self.values(&place, &next(group, key, a), x, y),
                        (x, y) => {
                            let words = |value: Option<&Value>| value.map_or("no such key".into(), Value::to_string);
                            self.comparison.differ(&place, &words(x), &words(y));
                        }
                    }
                }
            }
            (Value::String(a), Value::String(b)) => {
                self.comparison.line(place, a, b, &Tolerance::of(self.name, group, self.is_exact));
            }
            (a, b) if a == b => {}
            (a, b) => self.comparison.differ(place, &a.to_string(), &b.to_string()),
        }
    }
}

/// Whether a group has numbers that the program writes with seven digits.
pub fn has_seven_digits(group: &str) -> bool {
    fits(group, &format!("*{SEVEN_DIGITS}*"))
}

#[test]
fn numbers_agree_at_ten_digits_and_zeros_whatever_their_digits() {
    let of = |x: f64, y: f64| Form::Tree(serde_json::json!({ "fits": [{ "k": x }, { "k": y }] }));
    let count = |a: &Form, b: &Form, exact| compare("report.json", a, b, exact).differences.len();
    assert_eq!(count(&of(1.0, 3e-17), &of(1.0 + 5e-11, -5e-17), false), 0);
    assert_eq!(count(&of(1.0, 3e-17), &of(1.0 + 5e-10, 3e-17), false), 1);
    assert_eq!(count(&of(1.0, 3e-17), &of(1.0, 1e-10), false), 1);
    assert_eq!(count(&of(1.0, 3e-17), &of(1.0, 3.000_000_000_000_001e-17), true), 1);
    let text = |line: &str| Form::Text(vec![line.to_string()]);
    assert_eq!(count(&text("k = 1.5, 0 m"), &text("k = 1.5,   1e-17 m"), false), 0);
    assert_eq!(count(&text("k = 1.5 m"), &text("k =  1.5 m"), false), 1);
    assert_eq!(count(&text("k = 1.5 m"), &text("k = 1.6 m"), false), 1);
    assert_eq!(count(&text("k = 1.5 m"), &text("k = 1.5 s"), false), 1);
}
