//! Sparse matrices as the arrays of SciPy.

use crate::arrays::list;
use numpy::PyArray1;
use pyo3::prelude::*;
use springfit_bodies::model::CompressedRows;

/// `data`, `indices` and `indptr` of a `csr_matrix`: without two entries at one place, and ascending in each row. Places have 32 bits where
/// that is enough.
pub type Rows<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyAny>, Bound<'py, PyAny>);

pub fn rows(py: Python<'_>, matrix: CompressedRows) -> Rows<'_> {
    let CompressedRows { starts, columns, values } = matrix;
    // Places in the values are at most their number, and columns of a square matrix are fewer than the starts of rows:
    // the casts below hold.
    let is_short = i32::try_from(values.len()).is_ok() && i32::try_from(starts.len()).is_ok();
    let (indices, indptr) = if is_short {
        let columns = columns.into_iter().map(|column| column as i32).collect();
        (list(py, columns).into_any(), list(py, starts.into_iter().map(|at| at as i32).collect()).into_any())
    } else {
        let columns = columns.into_iter().map(i64::from).collect();
        (list(py, columns).into_any(), list(py, starts.into_iter().map(|at| at as i64).collect()).into_any())
    };
    (list(py, values), indices, indptr)
}

/// A matrix of points as one of `d` degrees of freedom each, which do not act on each other along different axes.
pub fn along_axes(matrix: &CompressedRows, d: usize) -> CompressedRows {
    let size = matrix.values.len() * d;
    let mut found =
        CompressedRows { starts: vec![0], columns: Vec::with_capacity(size), values: Vec::with_capacity(size) };
    for at in matrix.starts.windows(2) {
        for k in 0..d {
            found.columns.extend(matrix.columns[at[0]..at[1]].iter().map(|column| column * d as u32 + k as u32));
            found.values.extend(&matrix.values[at[0]..at[1]]);
            found.starts.push(found.columns.len());
        }
    }
    found
}
