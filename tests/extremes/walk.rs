//! The numbers of a document, and the keys that a document may have.

use std::collections::BTreeSet;
use toml::{Table, Value};

/// A step from a value to one inside it.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    Key(String),
    Index(usize),
}

pub type Place = Vec<Step>;

/// `motion.pull[].displacement[]`: the place without the numbers of its entries.
pub fn key(place: &[Step]) -> String {
    let step = |text: String, step: &Step| match step {
        Step::Index(_) => text + "[]",
        Step::Key(name) if text.is_empty() => name.clone(),
        Step::Key(name) => format!("{text}.{name}"),
    };
    place.iter().fold(String::new(), step)
}

/// The places of all values below, tables and lists among them.
pub fn places(value: &Value) -> Vec<Place> {
    let inner: Vec<(Step, &Value)> = match value {
        Value::Table(table) => table.iter().map(|(name, value)| (Step::Key(name.clone()), value)).collect(),
        Value::Array(list) => list.iter().enumerate().map(|(i, value)| (Step::Index(i), value)).collect(),
        _ => Vec::new(),
    };
    let mut found = vec![Place::new()];
    for (step, value) in inner {
        found.extend(places(value).into_iter().map(|rest| [vec![step.clone()], rest].concat()));
    }
    found
}

pub fn at<'a>(value: &'a Value, place: &[Step]) -> &'a Value {
    place.iter().fold(value, |value, step| match step {
        Step::Key(name) => &value[name.as_str()],
        Step::Index(i) => &value[*i],
    })
}

/// The document with another value at the place.
pub fn with(document: &Value, place: &[Step], value: Value) -> Value {
    let mut document = document.clone();
    let target = place.iter().fold(&mut document, |value, step| match step {
        Step::Key(name) => {
            value.as_table_mut().expect("this is a table").entry(name.clone()).or_insert(Value::Boolean(true))
        }
        Step::Index(i) => &mut value[*i],
    });
    *target = value;
    document
}

pub fn parse(text: &str) -> Value {
    Value::Table(text.parse::<Table>().expect("samples are TOML"))
}

/// The document as TOML, a line for each key at the top.
pub fn text(document: &Value) -> String {
    let lines = document
        .as_table()
        .into_iter()
        .flatten()
        .map(|(name, value)| format!("{} = {}\n", quoted(name), inline(value)));
    lines.collect()
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

pub fn inline(value: &Value) -> String {
    match value {
        Value::String(text) => quoted(text),
        Value::Integer(i) => i.to_string(),
        Value::Float(x) if x.is_nan() => "nan".into(),
        Value::Float(x) if x.is_infinite() => {
            if *x > 0.0 {
                "inf".into()
            } else {
                "-inf".into()
            }
        }
        Value::Float(x) => format!("{x:e}").replace('e', if format!("{x:e}").contains('.') { "e" } else { ".0e" }),
        Value::Boolean(b) => b.to_string(),
        Value::Datetime(time) => time.to_string(),
        Value::Array(list) => format!("[{}]", list.iter().map(inline).collect::<Vec<_>>().join(", ")),
        Value::Table(table) => {
            let pairs = table.iter().map(|(name, value)| format!("{} = {}", quoted(name), inline(value)));
            format!("{{ {} }}", pairs.collect::<Vec<_>>().join(", "))
        }
    }
}

/// What reading a document says: nothing, or the problem.
pub type Read<'a> = &'a dyn Fn(&str) -> Option<String>;

/// Whether a value of the wrong kind is the problem.
fn is_of_wrong_kind(problem: &str) -> bool {
    ["invalid type", "wanted", "invalid value", "did not match", "in quotes"]
        .iter()
        .any(|words| problem.contains(words))
}

/// Whether the document may have a value of this kind there.
pub fn takes(read: Read, document: &Value, place: &[Step], value: Value) -> bool {
    !read(&text(&with(document, place, value))).is_some_and(|problem| is_of_wrong_kind(&problem))
}

/// Whether the value there is a number, or a text where there may be a number.
pub fn is_numeric(read: Read, document: &Value, place: &[Step]) -> bool {
    match at(document, place) {
        Value::Integer(_) | Value::Float(_) => true,
        Value::String(_) => [Value::Integer(1), Value::Float(0.5)].into_iter().any(|v| takes(read, document, place, v)),
        Value::Boolean(_) | Value::Datetime(_) | Value::Array(_) | Value::Table(_) => false,
    }
}

/// The keys that may have a number or a list of numbers, as the errors of the entry structs list them: of every table of the document,
/// and of those that it does not have.
pub fn numeric_keys(read: Read, document: &Value) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for place in places(document).into_iter().filter(|place| at(document, place).is_table()) {
        for name in fields(read, document, &place) {
            let inner = [place.clone(), vec![Step::Key(name)]].concat();
            let list = |v: Value| Value::Array(vec![v]);
            let numbers = [Value::Integer(1), Value::Float(0.5)];
            let lists = numbers.clone().map(list);
            let nested = numbers.clone().map(list).map(list);
            if numbers.into_iter().chain(lists).chain(nested).any(|v| takes(read, document, &inner, v)) {
                found.insert(key(&inner));
            }
            let tables = [Value::Table(Table::new()), Value::Array(vec![Value::Table(Table::new())])];
            let [one, several] = tables.map(|v| with(document, &inner, v));
            // A table of its own must be in a sample, where its keys are met. A struct may be read from a list as well.
            let entry = [inner.clone(), vec![Step::Index(0)]].concat();
            if !fields(read, &one, &inner).is_empty() {
                found.insert(key(&inner));
            } else if !fields(read, &several, &entry).is_empty() {
                found.insert(key(&entry));
            }
        }
    }
    found
}

/// The keys of a table, as the error about an unknown one lists them; none where the table may have any.
fn fields(read: Read, document: &Value, place: &[Step]) -> Vec<String> {
    let unknown = [place.to_vec(), vec![Step::Key("zzz".into())]].concat();
    let Some(problem) = read(&text(&with(document, &unknown, Value::Boolean(true)))) else { return Vec::new() };
    let Some((_, listed)) =
        problem.split_once("expected").filter(|(before, _)| before.contains("unknown field") && before.contains("zzz"))
    else {
        return Vec::new();
    };
    let listed: String = listed.replace('"', "`");
    listed.split('`').skip(1).step_by(2).map(String::from).collect()
}

#[test]
fn the_keys_of_a_document_are_found() {
    let read = |text: &str| {
        springfit_studies::study::Scene::parse(text, std::path::Path::new("s.toml"))
            .err()
            .map(|e| e.problem().to_string())
    };
    let keys = numeric_keys(&read, &parse(super::samples::LINEAR));
    for key in ["mesh.scale", "mesh.box.size", "material.young", "material.density", "load[].traction", "fit[].higher"]
    {
        assert!(keys.contains(key), "{key} is not in {keys:?}");
    }
    for key in ["title", "mesh.file", "material.plane", "fix[].group", "output.vtu"] {
        assert!(!keys.contains(key), "{key} has no numbers");
    }
}
