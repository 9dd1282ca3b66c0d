//! What is compared of an output: a text by its lines, all else as JSON, without what is masked.

use super::case::PRINTED;
use super::digest::shortened;
use super::mask::{is_column, mask_lines, mask_value};
use base64::prelude::{BASE64_STANDARD, Engine};
use serde_json::{Map, Value, json};
use std::io::{Cursor, Read};

/// Longer texts are kept as sums, but what is printed.
const LONGEST: usize = 20_000;
/// Marks numbers that the program itself writes with seven digits.
pub const SEVEN_DIGITS: &str = "seven digits";
/// The base64 arrays of the page's record: numbers, and places.
const FLOATS: [&str; 6] = ["points", "displacement", "displacements", "constants", "rests", "states"];
const PLACES: [&str; 4] = ["numbers", "edges", "triangles", "ends"];

#[derive(Debug, Clone, PartialEq)]
pub enum Form {
    Text(Vec<String>),
    Tree(Value),
}

impl Form {
    /// Of an output by the ending of its name. `is_whole` keeps long lists.
    ///
    /// # Errors
    /// The output is not what its ending says.
    pub fn of(name: &str, bytes: &[u8], is_whole: bool) -> Result<Form, String> {
        let text = || std::str::from_utf8(bytes).map_err(|e| format!("{name}: {e}"));
        let json = |text: &str| serde_json::from_str::<Value>(text).map_err(|e| format!("{name}: {e}"));
        let mut tree = match name.rsplit_once('.').map_or("", |(_, ending)| ending) {
            "json" => json(text()?)?,
            "jsonl" => text()?.lines().map(json).collect::<Result<Value, String>>()?,
            "csv" => table(text()?),
            "html" if text()?.contains("id=\"record\">") => {
                record(&json(between(text()?, "id=\"record\">", "</script>"))?)
            }
            "vtu" => vtk_arrays(text()?),
            "npz" => arrays(bytes).ok_or(format!("{name}: expected arrays of NumPy"))?,
            _ => {
                let lines = mask_lines(text()?);
                let is_short = is_whole || name == PRINTED || lines.iter().map(String::len).sum::<usize>() <= LONGEST;
                return Ok(if is_short { Form::Text(lines) } else { Form::Tree(shortened(json!({ "lines": lines }))) });
            }
        };
        mask_value(&mut tree);
        Ok(Form::Tree(if is_whole { tree } else { shortened(tree) }))
    }
}

fn between<'a>(text: &'a str, begin: &str, end: &str) -> &'a str {
    let rest = text.split_once(begin).map_or("", |(_, rest)| rest);
    rest.split_once(end).map_or(rest, |(inside, _)| inside)
}

/// The columns of a table by their headings; cells with numbers are numbers.
fn table(text: &str) -> Value {
    let mut lines = text.lines().map(cells);
    let headings = lines.next().unwrap_or_default();
    let rows: Vec<Vec<String>> = lines.collect();
    let cell = |cell: &String| match (cell.parse::<i64>(), cell.parse::<f64>()) {
        (Ok(whole), _) => Value::from(whole),
        (_, Ok(x)) if x.is_finite() => json!(x),
        _ => json!(cell),
    };
    let column = |(i, heading): (usize, &String)| {
        let values = rows.iter().map(|row| match row.get(i) {
            Some(_) if is_column(heading) => json!("T"),
            Some(text) => cell(text),
            None => Value::Null,
        });
        (format!("{i:02} {heading}"), values.collect())
    };
    let columns: Map<String, Value> = headings.iter().enumerate().map(column).collect();
    json!({ "rows": rows.len(), "columns of the table": columns })
}

/// The cells of a line, of which some are quoted.
fn cells(line: &str) -> Vec<String> {
    if !line.contains('"') {
        return line.split(',').map(String::from).collect();
    }
    let (mut found, mut is_quoted) = (vec![String::new()], false);
    for letter in line.chars() {
        match letter {
            '"' => is_quoted = !is_quoted,
            ',' if !is_quoted => found.push(String::new()),
            letter => found.last_mut().expect("there is a cell").push(letter),
        }
    }
    found
}

/// The record of a page with its arrays decoded, and without the report, which is a file of its own.
fn record(record: &Value) -> Value {
    let mut record = record.clone();
    if let Some(entries) = record.as_object_mut() {
        entries.remove("report");
    }
    record["view"] = decoded("", &record["view"]);
    record
}

fn decoded(key: &str, value: &Value) -> Value {
    let decode = |text: &str| -> Option<Vec<[u8; 4]>> { Some(words(&BASE64_STANDARD.decode(text).ok()?).collect()) };
    match value {
        Value::String(text) if FLOATS.contains(&key) => match decode(text) {
            Some(words) => json!({ SEVEN_DIGITS: words.into_iter().map(f32::from_le_bytes).collect::<Vec<f32>>() }),
            None => value.clone(),
        },
        Value::String(text) if PLACES.contains(&key) => match decode(text) {
            Some(words) => words.into_iter().map(u32::from_le_bytes).collect(),
            None => value.clone(),
        },
        Value::Array(items) => items.iter().map(|item| decoded(key, item)).collect(),
        Value::Object(entries) => entries.iter().map(|(key, value)| (key.clone(), decoded(key, value))).collect(),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => value.clone(),
    }
}

/// The lines of a file of VTK, with the numbers of its arrays: base64 of their length in bytes and of their bytes.
fn vtk_arrays(text: &str) -> Value {
    let (mut parts, mut kind) = (Vec::new(), "");
    for line in text.lines() {
        let bytes = BASE64_STANDARD.decode(line).ok().filter(|bytes| bytes.len() > 8 && !kind.is_empty());
        parts.push(match bytes.and_then(|bytes| numbers(kind, &bytes[8..])) {
            Some(numbers) => json!({ "numbers": numbers }),
            None => json!(line),
        });
        kind = if line.contains("format=\"binary\"") { between(line, "type=\"", "\"") } else { "" };
    }
    json!({ "lines": parts.chunks(20).collect::<Vec<&[Value]>>() })
}

/// Little-endian numbers of a type of VTK or NumPy.
fn numbers(kind: &str, bytes: &[u8]) -> Option<Vec<Value>> {
    Some(match kind {
        "Float64" | "<f8" => words(bytes).map(|x| json!(f64::from_le_bytes(x))).collect(),
        "Int64" => words(bytes).map(|x| json!(i64::from_le_bytes(x))).collect(),
        "Int32" | "<i4" => words(bytes).map(|x| json!(i32::from_le_bytes(x))).collect(),
        "UInt8" => words::<1>(bytes).map(|x| json!(x[0])).collect(),
        _ => {
            let letters: usize = kind.strip_prefix("<U")?.parse().ok()?;
            bytes.chunks_exact(4 * letters).map(|text| json!(letters_of(text))).collect()
        }
    })
}

/// A text in UTF-32, filled up with zeros.
fn letters_of(bytes: &[u8]) -> String {
    words(bytes).map(u32::from_le_bytes).take_while(|&c| c != 0).filter_map(char::from_u32).collect()
}

/// The bytes in groups of the same number.
fn words<const N: usize>(bytes: &[u8]) -> impl Iterator<Item = [u8; N]> {
    bytes.as_chunks().0.iter().copied()
}

/// The arrays of an archive of NumPy: shape and numbers of each.
fn arrays(bytes: &[u8]) -> Option<Value> {
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).ok()?;
    let mut found = Map::new();
    for i in 0..archive.len() {
        let mut member = archive.by_index(i).ok()?;
        let name = member.name().ok()?.to_string();
        let mut content = Vec::new();
        member.read_to_end(&mut content).ok()?;
        let header = usize::from(u16::from_le_bytes([*content.get(8)?, *content.get(9)?]));
        let (described, data) = content.get(10..)?.split_at_checked(header)?;
        let described = String::from_utf8_lossy(described).trim().to_string();
        let numbers = numbers(between(&described, "'descr': '", "'"), data)?;
        found.insert(name, json!({ "described": described, "numbers": numbers }));
    }
    Some(Value::Object(found))
}

#[test]
fn a_table_is_read_by_columns() {
    let Ok(Form::Tree(found)) = Form::of("a.csv", b"fit,us/element,k\n\"a, b\",12.5,1.5\nc,3,2\n", false) else {
        panic!("a table is a tree");
    };
    let columns = json!({ "00 fit": ["a, b", "c"], "01 us/element": ["T", "T"], "02 k": [1.5, 2] });
    assert_eq!(found, json!({ "rows": 2, "columns of the table": columns }));
}
