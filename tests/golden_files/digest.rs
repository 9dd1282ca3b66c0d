//! Long lists as sums: a network of thousands of springs is kept in a few kilobytes, in which a change of any spring shows.
//!
//! A list is cut into blocks. For each block and each key of its entries the sum `Σ w_i x_i` is kept, with weights `w_i` from 1 to 128
//! that differ within a block, so that entries that change places show as well. A change of one number by more than some 128 × 1e-10 of
//! the block's numbers shows, and one of all springs by 1e-10. Texts and whole numbers, which have no rounding errors, are kept as a
//! checksum, and some entries as they are.

use super::form::SEVEN_DIGITS;
use super::number::{Piece, pieces};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// The entries of a block.
const BLOCK: usize = 128;
/// Of numbers with seven digits, which a page draws; networks and tables have them with all digits.
const BLOCK_OF_SEVEN: usize = 512;
/// An entry that holds more numbers, such as a state of a motion, is a block of its own.
const LARGE: usize = 32;
/// Lists with fewer entries are kept as they are, unless they hold many numbers.
const FULL: usize = 60;
/// As [`FULL`], the numbers and texts of all entries.
const MANY: usize = 1000;
/// So many entries are kept as they are.
const SAMPLES: usize = 3;

/// The numbers and the texts of one key.
#[derive(Default)]
struct Column {
    sums: BTreeMap<usize, f64>,
    sizes: BTreeMap<usize, f64>,
    /// Checksums of the texts, and of the numbers as they are written.
    texts: u64,
    whole: u64,
    has_digits: bool,
    count: usize,
}

/// The value with its long lists as sums.
pub fn shortened(value: Value) -> Value {
    match value {
        Value::Array(items) if items.len() > FULL || is_large(&items) => digest(&items, BLOCK),
        Value::Array(items) => items.into_iter().map(shortened).collect(),
        Value::Object(entries) => {
            let entry = |(key, value): (String, Value)| match value {
                Value::Array(items) if key == SEVEN_DIGITS && items.len() > FULL => {
                    (key, digest(&items, BLOCK_OF_SEVEN))
                }
                value => (key, shortened(value)),
            };
            entries.into_iter().map(entry).collect()
        }
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => value,
    }
}

/// Whether a list of lists is kept as sums: that of a table's rows or of a motion's states.
fn is_large(items: &[Value]) -> bool {
    items.len() > SAMPLES && items.iter().all(is_list) && items.iter().map(leaves).sum::<usize>() > MANY
}

/// A list, or an object that holds nothing else.
fn is_list(value: &Value) -> bool {
    value.is_array()
        || value.as_object().is_some_and(|entries| entries.len() == 1 && entries.values().all(Value::is_array))
}

fn leaves(value: &Value) -> usize {
    match value {
        Value::Array(items) => items.iter().map(leaves).sum(),
        Value::Object(entries) => entries.values().map(leaves).sum(),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => 1,
    }
}

fn digest(items: &[Value], block: usize) -> Value {
    let mut columns: BTreeMap<String, Column> = BTreeMap::new();
    let block = if items.iter().map(leaves).max().unwrap_or(0) > LARGE { 1 } else { block };
    for (i, item) in items.iter().enumerate() {
        // Constants of other kinds have other units.
        let kind = item.get("kind").and_then(Value::as_str).unwrap_or_default();
        let weight = (1 + (37 * i) % BLOCK) as f64;
        add(item, kind, i / block, weight, &mut columns);
    }
    let column = |(name, column): (String, Column)| {
        let mut entries = Map::from_iter([("count".to_string(), Value::from(column.count))]);
        if column.has_digits {
            let scale = column.sizes.values().copied().fold(0.0, f64::max);
            entries.insert("scale".into(), json!(scale));
            if scale > 0.0 {
                entries.insert("sums".into(), column.sums.into_values().collect());
            }
        } else if column.whole != 0 {
            entries.insert("whole numbers".into(), format!("{:016x}", column.whole).into());
        }
        if column.texts != 0 {
            entries.insert("texts".into(), format!("{:016x}", column.texts).into());
        }
        (name, Value::Object(entries))
    };
    let step = items.len() / SAMPLES;
    let sample = |i: usize| (format!("{i:06}"), shortened(items[i].clone()));
    json!({
        "length": items.len(),
        "columns": columns.into_iter().map(column).collect::<Map<String, Value>>(),
        "samples": (0..SAMPLES).map(|k| sample(k * step + step / 2)).collect::<Map<String, Value>>(),
    })
}

/// Adds what a value holds to the columns; `name` is the kind of the entry and the keys that lead to the value.
fn add(value: &Value, name: &str, block: usize, weight: f64, columns: &mut BTreeMap<String, Column>) {
    let mut number = |x: f64, text: &str, has_digits: bool| {
        let column = columns.entry(name.to_string()).or_default();
        column.count += 1;
        column.has_digits |= has_digits;
        column.whole = checksum(column.whole, text);
        // Entries within an entry, such as coordinates, have weights of their own.
        let weight = weight + (column.count % 7) as f64;
        *column.sums.entry(block).or_default() += weight * x;
        *column.sizes.entry(block).or_default() += weight * x.abs();
    };
    match value {
        Value::Number(x) => number(x.as_f64().unwrap_or(f64::NAN), &x.to_string(), x.is_f64()),
        Value::Array(items) => items.iter().for_each(|item| add(item, name, block, weight, columns)),
        Value::Object(entries) => {
            entries.iter().for_each(|(key, value)| add(value, &format!("{name}.{key}"), block, weight, columns));
        }
        // Numbers in a text are numbers, those of SVG and of printed tables.
        Value::String(text) => {
            let mut words = String::new();
            for piece in pieces(text) {
                match piece {
                    Piece::Words(text) => words += text,
                    Piece::Number(text) => {
                        words.push('0');
                        number(text.parse().unwrap_or(f64::NAN), "", true);
                    }
                }
            }
            remember(&words, name, columns);
        }
        Value::Null | Value::Bool(_) => remember(&value.to_string(), name, columns),
    }
}

fn remember(text: &str, name: &str, columns: &mut BTreeMap<String, Column>) {
    let column = columns.entry(name.to_string()).or_default();
    column.count += 1;
    column.texts = checksum(column.texts, text);
}

/// FNV-1a, with the end of the text.
fn checksum(begin: u64, text: &str) -> u64 {
    let begin = if begin == 0 { 0xcbf2_9ce4_8422_2325 } else { begin };
    text.bytes().chain([0xff]).fold(begin, |sum, byte| (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn a_change_of_any_spring_shows() {
    let springs = |constant: f64, at: usize| {
        let spring = |i| json!({ "kind": "length", "constant": if i == at { constant } else { 2.0 }, "law": null });
        shortened((0..500).map(spring).collect())
    };
    let same = springs(2.0, 0);
    assert_eq!(same["columns"]["length.constant"]["count"], 500);
    assert_eq!(same["length"], 500);
    let sums = |value: &Value| value["columns"]["length.constant"]["sums"].clone();
    for at in 0..500 {
        assert_ne!(sums(&springs(2.0 + 1e-7, at)), sums(&same), "{at}");
    }
    assert_eq!(shortened(json!([1, 2])), json!([1, 2]));
}
