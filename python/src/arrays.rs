//! Arrays of NumPy as slices of the library, and back.

use crate::error::invalid;
use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

/// The rows of a matrix one after the other.
pub fn rows<T: numpy::Element + Copy>(matrix: &PyReadonlyArray2<T>) -> Vec<T> {
    matrix.as_array().iter().copied().collect()
}

/// Places from 0; a negative one is an error.
pub fn places<'a>(py: Python, key: &str, list: impl Iterator<Item = &'a i64>) -> PyResult<Vec<usize>> {
    let place = |&p: &i64| usize::try_from(p).map_err(|_| invalid(py, key, "places from 0", p));
    list.map(place).collect()
}

/// One place in each row's list, from 0.
pub fn place_list(py: Python, key: &str, list: &PyReadonlyArray1<i64>) -> PyResult<Vec<usize>> {
    places(py, key, list.as_array().iter())
}

/// `values` as a matrix of rows of this `width`.
pub fn matrix<'py, T: numpy::Element>(py: Python<'py>, values: Vec<T>, width: usize) -> Bound<'py, PyArray2<T>> {
    let rows = values.len() / width.max(1);
    Array2::from_shape_vec((rows, width), values).expect("each row is complete").into_pyarray(py)
}

pub fn list<T: numpy::Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyArray1<T>> {
    values.into_pyarray(py)
}

/// A vector for each point, `[points × dimension]`.
pub fn vectors(py: Python, key: &str, given: &PyReadonlyArray2<f64>, [points, d]: [usize; 2]) -> PyResult<Vec<f64>> {
    if given.shape() != [points, d] {
        let found = format!("{:?}", given.shape());
        return Err(invalid(py, key, &format!("an array of shape ({points}, {d})"), found));
    }
    let values = rows(given);
    match values.iter().position(|value| !value.is_finite()) {
        Some(place) => Err(invalid(py, &format!("{key}[{}]", place / d), "finite numbers", values[place])),
        None => Ok(values),
    }
}
