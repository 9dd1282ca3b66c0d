//! Springs for a stiffness matrix from elsewhere.

use crate::arrays::{list, matrix, places, rows};
use crate::error::{invalid, raised};
use crate::progress::alone;
use nalgebra::DMatrix;
use numpy::{PyArray1, PyArray2, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use springfit_fit::fit::{Choices, Fit, GivenFit, GivenStiffness, Objective, condense};
use springfit_report::report;
use std::path::PathBuf;

/// Springs, constants, errors in the Frobenius and the 2-norm, whether they are unique and reached, the gap, and how many rows were condensed.
type Found<'py> = (Bound<'py, PyArray2<i64>>, Bound<'py, PyArray1<f64>>, f64, f64, bool, bool, Option<f64>, usize);

/// The matrix of a file of Matrix Market.
#[pyfunction]
pub fn read_matrix(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let found = report::read_matrix(&path).map_err(|error| raised(py, error))?;
    let columns = found.ncols();
    Ok(matrix(py, found.transpose().as_slice().to_vec(), columns))
}

/// Fits springs to a stiffness.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "what the function of Python has")]
pub fn fit_stiffness<'py>(
    py: Python<'py>,
    stiffness: PyReadonlyArray2<f64>,
    points: PyReadonlyArray2<f64>,
    springs: Option<PyReadonlyArray2<i64>>,
    displacements: Option<PyReadonlyArray2<i64>>,
    objective: &str,
    weight: Option<&str>,
    nonnegative: bool,
) -> PyResult<Found<'py>> {
    let fault = |error| raised(py, error);
    let d = points.shape()[1];
    let [height, width] = [stiffness.shape()[0], stiffness.shape()[1]];
    let whole = DMatrix::from_row_slice(height, width, &rows(&stiffness));
    let choices = Choices { weight, ..Choices::default() };
    let objective = Objective::named(objective, choices).map_err(fault)?;
    let pairs = springs.map(|springs| {
        if springs.shape()[1] != 2 {
            return Err(invalid(py, "springs", "an array of shape (springs, 2)", format!("{:?}", springs.shape())));
        }
        let nodes = places(py, "springs", springs.as_array())?;
        Ok(nodes.as_chunks::<2>().0.to_vec())
    });
    let pairs = pairs.transpose()?;
    let kept = displacements.map(|kept| {
        if kept.shape() != points.shape() {
            let expected = format!("an array of shape ({}, {d})", points.shape()[0]);
            return Err(invalid(py, "displacements", &expected, format!("{:?}", kept.shape())));
        }
        places(py, "displacements", kept.as_array())
    });
    let kept = kept.transpose()?;
    let points = rows(&points);
    let fit = Fit { nonnegative, ..Fit::new(objective) };
    let (pairs, condensed, found): (Vec<[usize; 2]>, usize, GivenFit) = alone(py, move || {
        let (own, condensed) = match &kept {
            Some(kept) => (condense(&whole, kept)?, whole.nrows() - kept.len()),
            None => (whole, 0),
        };
        let given = GivenStiffness::new(own, points, d)?;
        let pairs = pairs.unwrap_or_else(|| given.pairs());
        let found = given.fit(&pairs, &fit)?;
        Ok((pairs, condensed, found))
    })?;
    let ends = pairs.iter().flat_map(|pair| pair.map(|p| p as i64)).collect();
    let GivenFit { constants, frobenius, spectral, is_unique, reached, gap, .. } = found;
    Ok((matrix(py, ends, 2), list(py, constants), frobenius, spectral, is_unique, reached, gap, condensed))
}
