//! Errors of the library as one Python exception.

use pyo3::create_exception;
use pyo3::exceptions::{PyFileNotFoundError, PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple, PyType};
use springfit_foundation::error::{Error, ErrorKind};
use std::error::Error as _;
use std::io;
use std::path::Path;

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

/// The classes of faults of files: of those that are missing, and of others. They are `OSError`s as well.
static OF_FILES: PyOnceLock<[Py<PyType>; 2]> = PyOnceLock::new();

pub fn classes_of_files(py: Python) -> PyResult<[Bound<PyType>; 2]> {
    let make = || {
        let of = |name: &str, base: Bound<'_, PyType>, words: &str| -> PyResult<Py<PyType>> {
            let bases = PyTuple::new(py, [py.get_type::<SpringfitError>(), base])?;
            let body = PyDict::new(py);
            body.set_item("__module__", "springfit._core")?;
            body.set_item("__doc__", words)?;
            // An `OSError` would print its number in place of the sentence.
            let plain = py.get_type::<SpringfitError>().getattr("__str__")?;
            body.set_item("__str__", plain)?;
            Ok(py.get_type::<PyType>().call1((name, bases, body))?.cast_into::<PyType>()?.unbind())
        };
        let missing = of("MissingFileError", py.get_type::<PyFileNotFoundError>(), "A file is not there.")?;
        Ok::<_, PyErr>([missing, of("FileError", py.get_type::<PyOSError>(), "A file cannot be read or written.")?])
    };
    Ok(OF_FILES.get_or_try_init(py, make)?.each_ref().map(|class| class.bind(py).clone()))
}

/// The exception of this class, without its attributes.
fn new(py: Python, error: &Error) -> PyErr {
    let cause = error.source().and_then(|source| source.downcast_ref::<io::Error>());
    let Some(cause) = cause.filter(|cause| cause.raw_os_error().is_some()) else {
        return SpringfitError::new_err(error.to_string());
    };
    let place = usize::from(cause.kind() != io::ErrorKind::NotFound);
    let made = classes_of_files(py).and_then(|classes| {
        let exception = classes[place].call1((error.to_string(),))?;
        exception.setattr("errno", cause.raw_os_error())?;
        exception.setattr("filename", error.file().map(|file| file.display().to_string()))?;
        Ok(PyErr::from_value(exception))
    });
    made.unwrap_or_else(|fault| fault)
}

/// An error in the text that a dictionary was written as has neither file nor line, because the user has no such file. Other errors are left as they are.
pub fn unwritten(error: Error, file: Option<&Path>) -> Error {
    if file.is_none() || error.file() != file {
        return error;
    }
    let plain = match error.key() {
        Some(key) => Error::at(key, error.problem()),
        None => Error::new(error.problem()),
    };
    plain.of_kind(error.kind())
}

/// The exception of an error.
pub fn raised(py: Python, error: Error) -> PyErr {
    let exception = new(py, &error);
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
