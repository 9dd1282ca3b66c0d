//! Reads arguments that have to be numbers, counts or texts. A value of another type is an error that names the argument.

use crate::error::{invalid, raised};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyComplex, PyFloat, PyInt, PyNone, PyString};
use springfit_foundation::quantity::Quantity;

/// Reads a real number.
///
/// # Errors
/// The value is a text, a flag, a complex number, an array or another object.
pub fn number(key: &str, given: &Bound<PyAny>) -> PyResult<f64> {
    let is_real = match kind(given) {
        Some(kind) => "fiu".contains(kind) && is_single(given),
        None => !given.is_instance_of::<PyBool>(),
    };
    // A complex number would lose its imaginary part.
    let number = if is_real { given.extract().ok() } else { None };
    number.ok_or_else(|| invalid(given.py(), key, "a number", found(given)))
}

/// Reads a quantity with or without a unit, such as `0.1 mm`, in the SI unit: of the kind `length`, or `mesh unit` for that of a mesh.
///
/// # Errors
/// The text is no such quantity.
#[pyfunction]
pub fn quantity(py: Python, key: &str, kind: &str, text: &str) -> PyResult<f64> {
    let kind = match kind {
        "length" => Quantity::Length,
        "mesh unit" => Quantity::MeshUnit,
        other => return Err(invalid(py, "kind", "length or mesh unit", other)),
    };
    kind.parse(text).map_err(|error| raised(py, error.at_key(key)))
}

/// Reads a list of real numbers, such as an array of one dimension.
///
/// # Errors
/// The value is not a list, or an entry is not a real number.
pub fn numbers(key: &str, given: &Bound<PyAny>) -> PyResult<Vec<f64>> {
    each(key, "a list of numbers", given, number)
}

/// Reads an integer from 0.
///
/// # Errors
/// The value is not an integer, or it is negative.
pub fn count(key: &str, given: &Bound<PyAny>) -> PyResult<usize> {
    match given.extract() {
        Ok(count) if !given.is_instance_of::<PyBool>() => Ok(count),
        _ => Err(invalid(given.py(), key, "an integer from 0", found(given))),
    }
}

/// Reads a list of integers from 0.
///
/// # Errors
/// The value is not a list, or an entry is not an integer from 0.
pub fn counts(key: &str, given: &Bound<PyAny>) -> PyResult<Vec<usize>> {
    each(key, "a list of integers", given, count)
}

/// Reads a text.
///
/// # Errors
/// The value is not a text, or the text has an unpaired surrogate, which UTF-8 cannot encode.
pub fn text(key: &str, given: &Bound<PyAny>) -> PyResult<String> {
    given.extract().map_err(|_| invalid(given.py(), key, "a text of Unicode characters", found(given)))
}

/// What `read` makes of an argument that may be None.
///
/// # Errors
/// Those of `read`.
pub fn optional<T>(
    key: &str,
    given: Option<&Bound<PyAny>>,
    read: impl Fn(&str, &Bound<PyAny>) -> PyResult<T>,
) -> PyResult<Option<T>> {
    given.map(|given| read(key, given)).transpose()
}

/// Checks that an array of NumPy has no masked entries, whose values are no data.
///
/// # Errors
/// It has some.
pub fn check_mask(key: &str, given: &Bound<PyAny>) -> PyResult<()> {
    let py = given.py();
    if given.hasattr("mask")? && py.import("numpy.ma")?.call_method1("is_masked", (given,))?.is_truthy()? {
        return Err(invalid(py, key, "an array without masked entries", "a masked array"));
    }
    Ok(())
}

/// The kind of the type of NumPy, if the value has one: 'f' of floating-point numbers.
pub fn kind(given: &Bound<PyAny>) -> Option<char> {
    given.getattr("dtype").ok()?.getattr("kind").ok()?.extract().ok()
}

/// What is given, in words: the value itself if it is short.
pub fn found(given: &Bound<PyAny>) -> String {
    if let Ok(text) = given.cast::<PyString>() {
        return format!("\"{}\"", text.to_string_lossy());
    }
    let is_short = given.is_instance_of::<PyInt>()
        || given.is_instance_of::<PyFloat>()
        || given.is_instance_of::<PyComplex>()
        || given.is_instance_of::<PyNone>();
    match given.repr() {
        Ok(shown) if is_short => shown.to_string(),
        _ => given.get_type().to_string(),
    }
}

fn is_single(given: &Bound<PyAny>) -> bool {
    given.getattr("ndim").and_then(|axes| axes.extract::<usize>()).is_ok_and(|axes| axes == 0)
}

fn each<T>(
    key: &str,
    expected: &str,
    given: &Bound<PyAny>,
    read: impl Fn(&str, &Bound<PyAny>) -> PyResult<T>,
) -> PyResult<Vec<T>> {
    let entries = if given.is_instance_of::<PyString>() { None } else { given.try_iter().ok() };
    let entries = entries.ok_or_else(|| invalid(given.py(), key, expected, found(given)))?;
    check_mask(key, given)?;
    entries.enumerate().map(|(i, entry)| read(&format!("{key}[{i}]"), &entry?)).collect()
}
