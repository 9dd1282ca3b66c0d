//! The quadratic programme by Clarabel's interior-point method, which also proves that there is no solution.

use super::quadratic::{Minimum, Quadratic, SearchProgress};
use crate::error::{Error, ErrorKind, Result};
use crate::memory;
use crate::model::ADVICE;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultInfo, DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverError, SolverStatus, ZeroConeT,
};
use std::sync::mpsc;

/// The bytes for 10 000 unknowns, measured on bricks of 8³ and 14³ hexahedra. They grow with the power 4/3, as the
/// factors of solids do.
const MEMORY: f64 = 1.7e8;
/// The powers of ten between one and the residual at which Clarabel ends.
const NEAR: usize = 8;

/// The entries of a sparse matrix.
#[derive(Default)]
struct Sparse {
    rows: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
}

impl Sparse {
    fn push(&mut self, row: usize, column: usize, value: f64) {
        self.rows.push(row);
        self.columns.push(column);
        self.values.push(value);
    }

    fn matrix(self, rows: usize, columns: usize) -> CscMatrix {
        CscMatrix::new_from_triplets(rows, columns, self.rows, self.columns, self.values)
    }
}

/// The solution; `None` if there is none.
///
/// # Errors
/// The programme does not fit into memory; or the solver stops without a solution and without a proof that there is none.
pub(super) fn minimum(programme: &Quadratic, watch: &mut SearchProgress) -> Result<Option<Minimum>> {
    let count = programme.len();
    let mut weights = programme.weights.clone();
    let mut matrix = Sparse::default();
    for variable in 0..count {
        programme.column(variable).for_each(|(row, value)| matrix.push(row, variable, value));
    }
    let mut rows = programme.rows;
    for (dense, weight) in &programme.dense {
        dense.iter().enumerate().filter(|(_, d)| **d != 0.0).for_each(|(variable, d)| matrix.push(rows, variable, *d));
        // A row with a weight has a variable of its own: its product with the others.
        if weight.is_finite() {
            matrix.push(rows, weights.len(), -1.0);
            weights.push(*weight);
        }
        rows += 1;
    }
    let equations = rows;
    let mut bounds = vec![0.0; equations];
    for (variable, lower) in programme.lower.iter().enumerate().filter(|(_, lower)| lower.is_finite()) {
        matrix.push(rows, variable, -1.0);
        bounds.push(-lower);
        rows += 1;
    }
    let variables = weights.len();
    let bytes = (MEMORY * (variables as f64 / 1e4).powf(4.0 / 3.0)) as u64;
    memory::require("the search of the nearest network", bytes, ADVICE).map_err(|e| e.at_key("nonnegative"))?;
    let mut quadratic = Sparse::default();
    weights.iter().enumerate().for_each(|(i, weight)| quadratic.push(i, i, *weight));
    let settings = DefaultSettings { verbose: false, ..Default::default() };
    let cones = [ZeroConeT(equations), NonnegativeConeT(rows - equations)];
    let (quadratic, matrix) = (quadratic.matrix(variables, variables), matrix.matrix(rows, variables));
    let linear = vec![0.0; variables];
    let (sender, iterates) = mpsc::channel();
    let solve = move || {
        let mut solver = DefaultSolver::new(&quadratic, &linear, &matrix, &bounds, &cones, settings)?;
        solver.set_termination_callback(move |info: &DefaultInfo<f64>| {
            // The receiver may be gone once the search is over.
            let _ = sender.send(nearness(info));
            false
        });
        solver.solve();
        Ok(solver.solution)
    };
    // Clarabel keeps its callback, so that it runs in a thread of its own, whose end closes the channel.
    let solution = std::thread::scope(|scope| {
        let solver = scope.spawn(solve);
        let mut nearest = 0;
        for found in iterates {
            nearest = found.max(nearest);
            watch(nearest, NEAR);
        }
        solver.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    });
    let solution = solution.map_err(|problem: SolverError| unsolved(&format!("{problem}")))?;
    match solution.status {
        SolverStatus::Solved | SolverStatus::AlmostSolved => {
            Ok(Some(Minimum { variables: solution.x[..count].to_vec(), steps: solution.iterations }))
        }
        SolverStatus::PrimalInfeasible => Ok(None),
        status => Err(unsolved(&format!("{status:?} after {} iterations", solution.iterations))),
    }
}

/// How many of the [`NEAR`] powers of ten the largest residual has decreased.
fn nearness(info: &DefaultInfo<f64>) -> usize {
    let residual = info.gap_rel.max(info.res_primal).max(info.res_dual);
    if residual > 0.0 { (-residual.log10()).clamp(0.0, NEAR as f64) as usize } else { 0 }
}

fn unsolved(found: &str) -> Error {
    Error::expected("nonnegative", "a quadratic programme that Clarabel solves", found).of_kind(ErrorKind::Infeasible)
}
