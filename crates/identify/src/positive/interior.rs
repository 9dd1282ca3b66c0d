//! The quadratic programme by the interior-point method, which also proves that there is no solution.

use super::quadratic::{Minimum, Quadratic, SearchProgress};
use crate::error::{Error, ErrorKind, Result};
use crate::memory;
use crate::model::ADVICE;
use springfit_numerics::convex::{Found, Programme, sparse};

/// The bytes for 10 000 unknowns, measured on bricks of 8³ and 14³ hexahedra. They grow with the power 4/3, as the
/// factors of solids do.
const MEMORY: f64 = 1.7e8;

/// The solution; `None` if there is none.
///
/// # Errors
/// The programme does not fit into memory; or the solver stops without a solution and without a proof that there is none.
pub(super) fn minimum(programme: &Quadratic, watch: &mut SearchProgress) -> Result<Option<Minimum>> {
    let count = programme.len();
    let mut weights = programme.weights.clone();
    let mut columns: Vec<Vec<(usize, f64)>> = (0..count).map(|variable| programme.column(variable).collect()).collect();
    // The sparse matrix takes the rows of a column in ascending order; rows that are added below are larger than these.
    columns.iter_mut().for_each(|column| column.sort_unstable_by_key(|entry| entry.0));
    let mut rows = programme.rows;
    for (dense, weight) in &programme.dense {
        columns.iter_mut().zip(dense).for_each(|(column, d)| column.push((rows, *d)));
        // A row with a weight has a variable of its own: its product with the others.
        if weight.is_finite() {
            columns.push(vec![(rows, -1.0)]);
            weights.push(*weight);
        }
        rows += 1;
    }
    let equations = rows;
    let mut limits = vec![0.0; equations];
    for (variable, lower) in programme.lower.iter().enumerate().filter(|(_, lower)| lower.is_finite()) {
        columns[variable].push((rows, -1.0));
        limits.push(-lower);
        rows += 1;
    }
    let variables = weights.len();
    let bytes = (MEMORY * (variables as f64 / 1e4).powf(4.0 / 3.0)) as u64;
    memory::require("the search of the nearest network", bytes, ADVICE).map_err(|e| e.at_key("nonnegative"))?;
    let programme = Programme {
        quadratic: sparse(variables, weights.into_iter().enumerate().map(|entry| [entry])),
        linear: vec![0.0; variables],
        constraints: sparse(rows, columns.into_iter()),
        limits,
        equations,
    };
    match programme.solve(watch) {
        Found::Optimum(mut optimum) => {
            // The products of the rows with weights come last and are no changes of springs.
            optimum.variables.truncate(count);
            Ok(Some(Minimum { variables: optimum.variables, steps: optimum.iterations }))
        }
        Found::Infeasible => Ok(None),
        Found::Unsolved(found) => {
            let expected = "a quadratic programme that the interior-point method solves";
            Err(Error::expected("nonnegative", expected, found).of_kind(ErrorKind::Infeasible))
        }
    }
}
