//! Values of Python as values of TOML, of which scenes and fits are made.

use crate::error::invalid;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use toml::{Table, Value};

/// The keys of a dictionary; those whose value is None are left out.
pub fn table(given: &Bound<PyDict>) -> PyResult<Table> {
    keyed(given, "")
}

/// The text of a table, one line for each of its keys.
pub fn text(table: &Table) -> String {
    table.iter().map(|(key, value)| format!("{} = {}\n", quoted(key), inline(value))).collect()
}

fn inline(value: &Value) -> String {
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

/// A basic string of TOML.
fn quoted(text: &str) -> String {
    let escaped = text.chars().map(|c| match c {
        '"' => "\\\"".into(),
        '\\' => "\\\\".into(),
        c if c.is_control() => format!("\\U{:08x}", u32::from(c)),
        c => c.to_string(),
    });
    format!("\"{}\"", escaped.collect::<String>())
}

fn keyed(given: &Bound<PyDict>, parent: &str) -> PyResult<Table> {
    let mut table = Table::new();
    for (key, item) in given {
        let Ok(key) = key.extract::<String>() else {
            return Err(invalid(given.py(), parent, "keys that are texts", key));
        };
        let path = if parent.is_empty() { key.clone() } else { format!("{parent}.{key}") };
        if !item.is_none() {
            table.insert(key, value(&item, &path)?);
        }
    }
    Ok(table)
}

fn value(given: &Bound<PyAny>, path: &str) -> PyResult<Value> {
    let py = given.py();
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
        return Ok(Value::String(given.extract()?));
    }
    if let Ok(dict) = given.cast::<PyDict>() {
        return Ok(Value::Table(keyed(dict, path)?));
    }
    if given.cast::<PyList>().is_ok() || given.cast::<PyTuple>().is_ok() {
        let entries = given.try_iter()?.enumerate().map(|(i, entry)| value(&entry?, &format!("{path}[{i}]")));
        return Ok(Value::Array(entries.collect::<PyResult<_>>()?));
    }
    // Numbers and arrays of NumPy.
    if let Ok(plain) = given.call_method0("tolist") {
        return value(&plain, path);
    }
    if let Ok(place) = given.call_method0("__fspath__") {
        return value(&place, path);
    }
    Err(invalid(py, path, "a number, a text, a list or a dictionary", given.get_type().name()?))
}
