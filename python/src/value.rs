//! Values of Python as values of TOML, of which scenes and fits are made.

use crate::arguments::{self, found};
use crate::error::invalid;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use springfit_foundation::text::toml as quoted;
use toml::{Table, Value};

/// The most values inside each other; TOML is read to a similar depth.
const DEEPEST: usize = 64;

/// The keys of a dictionary, which errors call by this name; those whose value is None are left out.
pub fn table(given: &Bound<PyDict>, name: &str) -> PyResult<Table> {
    keyed(given, name, "", 0)
}

/// The value at this path.
pub fn value_of(given: &Bound<PyAny>, path: &str) -> PyResult<Value> {
    value(given, path, 0)
}

/// The text of a table, one line for each of its keys.
pub fn text(table: &Table) -> String {
    table.iter().map(|(key, value)| format!("{} = {}\n", quoted(key), inline(value))).collect()
}

/// A value on one line.
pub fn inline(value: &Value) -> String {
    match value {
        Value::String(text) => quoted(text),
        Value::Integer(number) => number.to_string(),
        Value::Float(number) if number.is_nan() => "nan".into(),
        Value::Float(number) => format!("{number:?}"),
        Value::Boolean(flag) => flag.to_string(),
        Value::Datetime(date) => date.to_string(),
        Value::Array(entries) => format!("[{}]", entries.iter().map(inline).collect::<Vec<_>>().join(", ")),
        Value::Table(table) => {
            let entries: Vec<String> =
                table.iter().map(|(key, value)| format!("{} = {}", quoted(key), inline(value))).collect();
            format!("{{{}}}", entries.join(", "))
        }
    }
}

fn keyed(given: &Bound<PyDict>, name: &str, parent: &str, depth: usize) -> PyResult<Table> {
    let mut table = Table::new();
    for (key, item) in given {
        let Ok(key) = key.extract::<String>() else {
            let place = if parent.is_empty() { name } else { parent };
            return Err(invalid(given.py(), place, "keys that are texts", found(&key)));
        };
        let path = if parent.is_empty() { key.clone() } else { format!("{parent}.{key}") };
        if !item.is_none() {
            table.insert(key, value(&item, &path, depth)?);
        }
    }
    Ok(table)
}

/// The value at a path; `depth` is the number of values that it is in.
fn value(given: &Bound<PyAny>, path: &str, depth: usize) -> PyResult<Value> {
    let py = given.py();
    if depth > DEEPEST {
        // What is in itself has an endless path.
        let place = path.find('[').map_or(path, |end| &path[..end]);
        let expected = format!("at most {DEEPEST} lists and dictionaries inside each other");
        return Err(invalid(py, place, &expected, "more"));
    }
    if let Ok(flag) = given.cast::<PyBool>() {
        return Ok(Value::Boolean(flag.is_true()));
    }
    if let Ok(number) = given.cast::<PyInt>() {
        return number.extract().map(Value::Integer).map_err(|_| invalid(py, path, "an integer of 64 bits", given));
    }
    if let Ok(number) = given.cast::<PyFloat>() {
        return Ok(Value::Float(number.extract()?));
    }
    if given.cast::<PyString>().is_ok() {
        return Ok(Value::String(arguments::text(path, given)?));
    }
    if let Ok(dict) = given.cast::<PyDict>() {
        return Ok(Value::Table(keyed(dict, "", path, depth + 1)?));
    }
    if given.cast::<PyList>().is_ok() || given.cast::<PyTuple>().is_ok() {
        let entries = given.try_iter()?.enumerate();
        let entries = entries.map(|(i, entry)| value(&entry?, &format!("{path}[{i}]"), depth + 1));
        return Ok(Value::Array(entries.collect::<PyResult<_>>()?));
    }
    arguments::check_mask(path, given)?;
    let kind = arguments::kind(given);
    // Times of NumPy would become integers whose unit is lost.
    let plain = if matches!(kind, Some('m' | 'M')) { None } else { given.call_method0("tolist").ok() };
    let is_same = plain.as_ref().is_some_and(|plain| plain.get_type().is(given.get_type()));
    match plain {
        // Numbers of NumPy that Python has not, such as long doubles.
        Some(_) if is_same && kind == Some('f') => return Ok(Value::Float(given.extract()?)),
        // Other numbers and arrays of NumPy.
        Some(plain) if !is_same => return value(&plain, path, depth + 1),
        Some(_) | None => {}
    }
    if let Ok(place) = given.call_method0("__fspath__") {
        return value(&place, path, depth + 1);
    }
    Err(invalid(py, path, "a number, a text, a list or a dictionary", found(given)))
}
