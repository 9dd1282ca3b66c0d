//! A function of Python that a work calls.

use crate::arguments::check_mask;
use crate::ends::Ends;
use crate::error::invalid;
use crate::progress::calling;
use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::sync::Arc;

/// A function with what is said of it in errors.
#[derive(Debug)]
pub struct Function {
    pub key: String,
    pub call: Py<PyAny>,
    /// Of the fit; networks are evaluated by other calls.
    pub ends: Arc<Ends>,
}

impl Function {
    /// The values at `arguments`, an array of this shape; `None` once a function has not returned.
    pub fn values<'py>(
        &self,
        arguments: impl FnOnce(Python<'py>) -> PyResult<Bound<'py, PyTuple>>,
        py: Python<'py>,
        shape: &[usize],
    ) -> Option<Vec<f64>> {
        self.called(py, || {
            let arguments = arguments(py)?;
            let found = calling(|| self.call.bind(py).call1(arguments))?;
            let array = self.real(py, &found)?;
            self.shaped(py, &array, "an array", shape)
        })
    }

    /// What `call` gives; `None` once a function has not returned.
    pub fn called<T>(&self, _: Python, call: impl FnOnce() -> PyResult<T>) -> Option<T> {
        let ends = Ends::current(&self.ends);
        if ends.is_set() {
            return None;
        }
        call().map_err(|exception| ends.set(&self.key, exception)).ok()
    }

    /// What the function has returned as real numbers.
    pub fn real<'py>(&self, py: Python<'py>, found: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        if let Ok(array) = found.cast::<PyArrayDyn<f64>>() {
            // What most functions return; a subclass may have a mask.
            if array.get_type().is(py.get_type::<PyUntypedArray>()) {
                return Ok(array.clone());
            }
        }
        check_mask(&self.key, found)?;
        let found = py.import("numpy")?.call_method1("asarray", (found,))?;
        let kind: String = found.getattr("dtype")?.getattr("kind")?.extract()?;
        if !["f", "i", "u"].contains(&&*kind) {
            let found = found.getattr("dtype")?;
            return Err(invalid(py, &self.key, "an array of real numbers from the function", found));
        }
        Ok(found.call_method1("astype", ("float64",))?.cast_into()?)
    }

    /// The numbers of an array of this shape; errors call it by `what`.
    pub fn shaped(
        &self,
        py: Python,
        array: &Bound<PyArrayDyn<f64>>,
        what: &str,
        shape: &[usize],
    ) -> PyResult<Vec<f64>> {
        if array.shape() != shape {
            let shown = |shape: &[usize]| PyTuple::new(py, shape).map(|shape| shape.to_string());
            let expected = format!("{what} of shape {} from the function", shown(shape)?);
            return Err(invalid(py, &self.key, &expected, format!("one of shape {}", shown(array.shape())?)));
        }
        let array = array.readonly();
        Ok(array.as_slice().map_or_else(|_| array.as_array().iter().copied().collect(), <[f64]>::to_vec))
    }
}
