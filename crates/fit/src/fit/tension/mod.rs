//! Constants and rest tensions of each cell: `min ‖W (R − K) W‖_F`, `K = Σ_s k_s g_s g_sᵀ + T_s ∇∇c_s`, under
//! `Σ_s T_s g_s = 0`.
//!
//! In equilibrium K vanishes on the rigid motions, so that the norm can be taken on the deformations alone. The
//! equations are solved by orthogonal transformations, which do not square their condition number.
//!
//! Theory: page *Exact networks and patches* of the book.

mod bounded;
mod cell;
mod linear;
mod problem;
mod unknowns;
mod view;

use super::congruence::Congruence;
use super::settings::Fit;
use super::visit::{cell_name, each_cell};
use crate::element::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::material::{BlockValues, Hooke};
use crate::springs::Springs;
use cell::{CellTension, Cells};
use rayon::prelude::*;
use std::sync::Arc;

/// The number of cells that one thread fits at a time.
// A cell takes the solution of a programme, beside which a thread begins for nothing; longer chunks would leave threads without work
// at the end of a round.
const CHUNK: usize = 16;

/// The springs of all cells.
#[derive(Debug, Default)]
pub struct Tensions {
    /// The constants k, `[cells × springs]`.
    pub constants: Vec<f64>,
    /// `k c₀`, `[cells × springs]`.
    pub parameters: Vec<f64>,
    /// The number of cells whose unknowns are linearly dependent. They have the optimum of least norm, in the scaling
    /// in which each unknown alone has a matrix of norm one.
    pub deficient: usize,
    /// The number of cells whose quadratic programme did not reach its optimum.
    pub unreached: usize,
    /// The number of cells that received the springs of a congruent cell.
    pub reused: usize,
}

/// Fits every cell. `progress` is called from time to time with the number of finished cells. The caller has checked
/// the arguments.
///
/// # Errors
/// The cells are those of a surface or curve in space; a cell is reversed, tangled or flat; the measure of a spring has
/// no gradient; or the only springs in equilibrium are those without a force.
pub fn fit_tensions(
    element: &Element,
    springs: &Springs,
    points: &[f64],
    connectivity: &[usize],
    moduli: BlockValues<Hooke>,
    fit: &Fit,
    progress: &mut dyn FnMut(usize),
) -> Result<Tensions> {
    if element.space() > element.dimension() {
        let expected =
            "\"mesh\" on surfaces and curves in space, where tensions resist motions out of the cell's plane";
        let error = Error::expected("rest", expected, format!("\"{}\"", fit.rest.name()));
        return Err(error.of_kind(ErrorKind::Unsupported));
    }
    let n = element.nodes();
    let cells = connectivity.len() / n;
    let Congruence { representatives, shapes } = Congruence::of(element, points, connectivity, &moduli)?;
    let all = Cells::new(&Arc::new(element.clone()), springs, fit);
    let chunk = |chunk: &[usize]| {
        let mut found = Vec::new();
        for &cell in chunk {
            let mut outcome = None;
            each_cell(element, points, &connectivity[cell * n..(cell + 1) * n], cell, |_, x, geometry| {
                outcome = Some(all.fit(x, geometry, moduli.at(cell)));
            })?;
            let placed = |problem: String| Error::at(cell_name(element, cell), problem).of_kind(ErrorKind::Infeasible);
            found.extend(outcome.transpose().map_err(placed)?);
        }
        Ok(found)
    };
    let mut fitted: Vec<CellTension> = Vec::new();
    // Several chunks for each thread, so that a slow chunk does not keep the others waiting.
    for round in representatives.chunks(CHUNK * 4 * rayon::current_num_threads()) {
        let parts: Vec<Result<Vec<CellTension>>> = round.par_chunks(CHUNK).map(chunk).collect();
        for part in parts {
            fitted.extend(part?);
        }
        progress(fitted.len() * cells / representatives.len());
    }
    let mut tensions = Tensions { reused: cells - fitted.len(), ..Tensions::default() };
    tensions.deficient = fitted.iter().filter(|cell| cell.deficient).count();
    tensions.unreached = fitted.iter().filter(|cell| !cell.reached).count();
    for one in shapes.iter().map(|&shape| &fitted[shape]) {
        tensions.constants.extend(&one.constants);
        tensions.parameters.extend(&one.parameters);
    }
    Ok(tensions)
}
