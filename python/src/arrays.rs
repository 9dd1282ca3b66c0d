//! Arrays of NumPy as slices of the library, and back.

use crate::error::invalid;
use numpy::ndarray::{Array2, ArrayView, Dimension};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use springfit_foundation::number;

/// The rows of a matrix one after the other.
pub fn rows<T: numpy::Element + Copy>(matrix: &PyReadonlyArray2<T>) -> Vec<T> {
    copied(matrix.as_array())
}

/// The numbers of an array in the order of its rows. One after the other they are copied where rows do not follow each other.
fn copied<T: Copy, D: Dimension>(array: ArrayView<T, D>) -> Vec<T> {
    array.as_slice().map_or_else(|| array.iter().copied().collect(), <[T]>::to_vec)
}

/// Places from 0; a negative one is an error.
pub fn places<D: Dimension>(py: Python, key: &str, list: ArrayView<i64, D>) -> PyResult<Vec<usize>> {
    number::places(copied(list)).map_err(|p| invalid(py, key, "places from 0", p))
}

/// One place in each row's list, from 0.
pub fn place_list(py: Python, key: &str, list: &PyReadonlyArray1<i64>) -> PyResult<Vec<usize>> {
    places(py, key, list.as_array())
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
    match number::first_not_finite(&values) {
        Some(place) => Err(invalid(py, &format!("{key}[{}]", place / d), "finite numbers", values[place])),
        None => Ok(values),
    }
}
