//! The quadratic programme of the nearest network, solved by Clarabel's interior-point method.
//!
//! Theory: page *Exact networks and patches* of the book.

use super::contents::Contents;
use super::edges::Edges;
use crate::error::{Error, ErrorKind, Result};
use crate::memory;
use crate::mesh::Mesh;
use crate::model::{ADVICE, Network};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultInfo, DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverError, SolverStatus, ZeroConeT,
};
use std::sync::mpsc;

/// The weight of the squared relative error of a mode's energy against squared relative changes of constants: a change
/// of every constant by a tenth costs as much as an energy error of 0.1 %.
const MODES: f64 = 1e4;
/// The weight of squared relative changes of tensions against those of constants. Each change of a tension causes a
/// force inside the body under homogeneous strain.
const TENSIONS: f64 = 100.0;

/// The bytes for 10 000 unknowns, measured on bricks of 8³ and 14³ hexahedra. They grow with the power 4/3, as the
/// factors of solids do.
const MEMORY: f64 = 1.7e8;
/// The powers of ten between one and the residual at which Clarabel ends.
const NEAR: usize = 8;

/// A callback `(done, total)` for the progress of a search.
pub type SearchProgress<'a> = dyn FnMut(usize, usize) + 'a;

/// What may change, and what should be kept.
pub(super) struct Programme<'a> {
    pub mesh: &'a Mesh,
    pub network: &'a Network,
    pub edges: &'a Edges,
    /// The springs on content whose tension may change; none if all are fixed.
    pub contents: &'a Contents,
    /// A typical modulus of the network, Pa.
    pub modulus: f64,
    /// For each mode the relative change of its energy per change of each constant and then of each tension.
    pub modes: Vec<Vec<f64>>,
}

/// The changes of the constants and of the tensions.
#[derive(Debug, Clone)]
pub(super) struct Changes {
    pub constants: Vec<f64>,
    pub tensions: Vec<f64>,
    pub iterations: u32,
}

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

impl Programme<'_> {
    /// A typical constant of an edge, `m V_e/ℓ²`, N/m.
    pub fn scale(&self, edge: usize) -> f64 {
        let Edges { lengths, volumes, .. } = self.edges;
        self.modulus * volumes[edge] / (lengths[edge] * lengths[edge])
    }

    /// Solves, with `z_e = δk_e/(m V_e/ℓ_e²)` and `z_c = δT_c/m`,
    ///
    /// ```text
    /// min Σ_e (V_e/V) (h²/ℓ_e²) z_e² + w_T Σ_c (c/V) z_c² + w_M Σ_m (δE_m/E_m)²
    /// Σ_e δk_e (X_j − X_i) + Σ_c δT_c ∇c = 0 at each point,   Σ_c c δT_c = 0,   k_e + δk_e ≥ 0
    /// ```
    ///
    /// The mean of the tensions, which is the shear modulus, is kept; otherwise a network with all springs zero would
    /// be a solution. `None` if there is no solution.
    ///
    /// # Errors
    /// The solver stops without a solution and without a proof that there is none.
    pub fn solve(&self, watch: &mut SearchProgress) -> Result<Option<Changes>> {
        let (mesh, edges, contents) = (self.mesh, self.edges, self.contents);
        let (d, dofs) = (mesh.dimension, mesh.points.len());
        let (count, tensions) = (edges.len(), contents.places.len());
        let scales: Vec<f64> = (0..count).map(|edge| self.scale(edge)).collect();
        let volume: f64 = edges.volumes.iter().sum();
        let square = edges.lengths.iter().map(|l| l * l).sum::<f64>() / count as f64;
        // The weights sum to about one: with larger ones the proof that there is no solution is not found.
        let share = |e: usize| edges.volumes[e] / volume * square / (edges.lengths[e] * edges.lengths[e]);
        let mut weights: Vec<f64> = (0..count).map(share).collect();
        let content: f64 = contents.rests.iter().sum();
        weights.extend(contents.rests.iter().map(|c| TENSIONS * c / content));

        let mut balance = Sparse::default();
        for (edge, scale) in scales.iter().enumerate() {
            let [i, j] = edges.pairs[edge];
            for (axis, r) in edges.vector(mesh, edge).iter().enumerate() {
                balance.push(i * d + axis, edge, -scale * r);
                balance.push(j * d + axis, edge, scale * r);
            }
        }
        for (c, gradient) in contents.gradients.iter().enumerate() {
            let points = &self.network.others[contents.places[c]].points;
            let rows = points.iter().flat_map(|p| p * d..(p + 1) * d);
            rows.zip(gradient).for_each(|(row, g)| balance.push(row, count + c, self.modulus * g));
        }
        let mut sizes = vec![0.0; dofs];
        balance.rows.iter().zip(&balance.values).for_each(|(row, value)| sizes[*row] += value * value);
        balance.values.iter_mut().zip(&balance.rows).for_each(|(value, row)| *value /= sizes[*row].sqrt());
        let mut rows = dofs;
        if tensions > 0 {
            let size = contents.rests.iter().map(|c| c * c).sum::<f64>().sqrt();
            contents.rests.iter().enumerate().for_each(|(c, rest)| balance.push(rows, count + c, rest / size));
            rows += 1;
        }
        for (m, mode) in self.modes.iter().enumerate() {
            let units = scales.iter().copied().chain(std::iter::repeat_n(self.modulus, tensions));
            let row: Vec<f64> = mode.iter().zip(units).map(|(share, unit)| share * unit).collect();
            let size = row.iter().map(|x| x * x).sum::<f64>().sqrt();
            row.iter().enumerate().for_each(|(column, value)| balance.push(rows, column, value / size));
            balance.push(rows, count + tensions + m, -1.0);
            weights.push(MODES * size * size);
            rows += 1;
        }
        let equations = rows;
        let mut bounds = vec![0.0; equations];
        for (edge, scale) in scales.iter().enumerate() {
            balance.push(rows, edge, -1.0);
            bounds.push(edges.constants[edge] / scale);
            rows += 1;
        }
        let variables = weights.len();
        let mut quadratic = Sparse::default();
        weights.iter().enumerate().for_each(|(i, weight)| quadratic.push(i, i, *weight));
        let settings = DefaultSettings { verbose: false, ..Default::default() };
        let cones = [ZeroConeT(equations), NonnegativeConeT(count)];
        let bytes = (MEMORY * (variables as f64 / 1e4).powf(4.0 / 3.0)) as u64;
        memory::require("the search of the nearest network", bytes, ADVICE).map_err(|e| e.at_key("nonnegative"))?;
        let (quadratic, matrix) = (quadratic.matrix(variables, variables), balance.matrix(rows, variables));
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
                let changes = |from: usize, to: usize| &solution.x[from..to];
                let constants = changes(0, count).iter().zip(&scales).map(|(z, scale)| z * scale).collect();
                let tensions = changes(count, count + tensions).iter().map(|z| z * self.modulus).collect();
                Ok(Some(Changes { constants, tensions, iterations: solution.iterations }))
            }
            SolverStatus::PrimalInfeasible => Ok(None),
            status => Err(unsolved(&format!("{status:?} after {} iterations", solution.iterations))),
        }
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
