//! Errors of the library as one Python exception.

use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyType;
use springfit::error::{Error, ErrorKind};

create_exception!(
    springfit,
    SpringfitError,
    PyValueError,
    "A fault of an input: `kind` (\"io\", \"syntax\", \"invalid\", \"unsupported\", \"limit\" or \"infeasible\"), and `file`, `line` and \
     `key`, each None where it is not known."
);

/// The class, whose exceptions have all attributes even where Python makes them.
pub fn class(py: Python) -> PyResult<Bound<PyType>> {
    let class = py.get_type::<SpringfitError>();
    class.setattr("kind", "invalid")?;
    for attribute in ["file", "line", "key"] {
        class.setattr(attribute, py.None())?;
    }
    Ok(class)
}

/// The exception of an error.
pub fn raised(py: Python, error: Error) -> PyErr {
    let exception = SpringfitError::new_err(error.to_string());
    let kind = match error.kind() {
        ErrorKind::Io => "io",
        ErrorKind::Syntax => "syntax",
        ErrorKind::Unsupported => "unsupported",
        ErrorKind::Limit => "limit",
        ErrorKind::Infeasible => "infeasible",
        _ => "invalid",
    };
    let value = exception.value(py);
    let file = error.file().map(|file| file.display().to_string());
    let set = || {
        value.setattr("kind", kind)?;
        value.setattr("file", file)?;
        value.setattr("line", error.line())?;
        value.setattr("key", error.key())
    };
    set().err().unwrap_or(exception)
}

/// That of an argument, as the library would raise it.
pub fn invalid(py: Python, key: &str, expected: &str, found: impl std::fmt::Display) -> PyErr {
    raised(py, Error::expected(key, expected, found))
}
