//! The data of sampled fits as columns.

use crate::arrays::{list, matrix};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springfit_fit::fit::{CellStart, ShapeError};
use springfit_studies::study::SampledOutcome;

/// The errors at each shape of one cell of each shape; empty columns without `data`.
pub fn shapes<'py>(py: Python<'py>, outcome: &SampledOutcome) -> PyResult<Bound<'py, PyDict>> {
    let rows: Vec<(usize, &ShapeError)> = blocks(&outcome.errors).collect();
    let places = |of: fn(&ShapeError) -> usize| list(py, rows.iter().map(|(_, row)| of(row) as i64).collect());
    let numbers = |of: fn(&ShapeError) -> f64| list(py, rows.iter().map(|(_, row)| of(row)).collect());
    let columns = PyDict::new(py);
    columns.set_item("block", list(py, rows.iter().map(|(block, _)| *block as i64).collect()))?;
    columns.set_item("cell", places(|row| row.cell))?;
    columns.set_item("part", rows.iter().map(|(_, row)| row.part.name()).collect::<Vec<_>>())?;
    columns.set_item("set", places(|row| row.set))?;
    columns.set_item("shape", places(|row| row.shape))?;
    columns.set_item("family", rows.iter().map(|(_, row)| row.family).collect::<Vec<_>>())?;
    columns.set_item("least_det", numbers(|row| row.content))?;
    columns.set_item("stretches", matrix(py, rows.iter().flat_map(|(_, row)| row.stretches).collect(), 2))?;
    columns.set_item("force", numbers(|row| row.force))?;
    columns.set_item("error", numbers(|row| row.error))?;
    Ok(columns)
}

/// The ends of the starts of one cell of each shape; empty columns without `data`.
pub fn starts<'py>(py: Python<'py>, outcome: &SampledOutcome) -> PyResult<Bound<'py, PyDict>> {
    let rows: Vec<(usize, &CellStart)> = blocks(&outcome.ends).collect();
    let places = |of: fn(&CellStart) -> usize| list(py, rows.iter().map(|(_, row)| of(row) as i64).collect());
    let numbers = |of: fn(&CellStart) -> f64| list(py, rows.iter().map(|(_, row)| of(row)).collect());
    let columns = PyDict::new(py);
    columns.set_item("block", list(py, rows.iter().map(|(block, _)| *block as i64).collect()))?;
    columns.set_item("cell", places(|row| row.cell))?;
    columns.set_item("start", places(|row| row.start))?;
    columns.set_item("error", numbers(|row| row.end.error))?;
    columns.set_item("steps", places(|row| row.end.steps))?;
    columns.set_item("converged", list(py, rows.iter().map(|(_, row)| row.end.converged).collect()))?;
    columns.set_item("distance", numbers(|row| row.end.distance))?;
    Ok(columns)
}

/// The rows of all blocks, each with its block.
fn blocks<T>(all: &[Vec<T>]) -> impl Iterator<Item = (usize, &T)> {
    all.iter().enumerate().flat_map(|(block, rows)| rows.iter().map(move |row| (block, row)))
}
