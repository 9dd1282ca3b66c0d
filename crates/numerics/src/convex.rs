//! Convex quadratic programmes, which Clarabel's interior-point method solves. All packages call the method through this
//! file, so that one rule says what counts as solved.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultInfo, DefaultSettings, DefaultSolution, DefaultSolver, IPSolver, NonnegativeConeT, SolverError,
    SolverStatus, ZeroConeT,
};
use std::sync::mpsc;

/// The accuracy that is asked of the gap and of the residuals, absolutely and relatively. Callers scale their programmes
/// to a size of about one. The solver's own default for the gap, 1e-8, would end the search with residuals of 1e-5.
const TOLERANCE: f64 = 1e-12;

/// The accuracy that is accepted if rounding stops the solver earlier. The solver's own default, 5e-5, would be far too
/// coarse.
const REDUCED_TOLERANCE: f64 = 1e-8;

/// Added to the diagonal of the solver's equations. With its default, 1e-8, residuals that much smaller than the
/// largest are lost and the 1-norm with a gross outlier does not converge; from 1e-10 down, rounding stops the maximum
/// norm.
const REGULARIZATION: f64 = 1e-9;

/// The powers of ten between one and [`TOLERANCE`].
const NEAR: usize = 12;

/// A sparse matrix in compressed columns.
pub type Sparse = CscMatrix<f64>;

/// `min ½ vᵀ P v + qᵀ v` under `G v + s = h`, where the first components of the slacks s are zero and the others are not
/// negative.
pub struct Programme {
    /// The upper triangle of P, `[variables × variables]`.
    pub quadratic: Sparse,
    /// q, `[variables]`.
    pub linear: Vec<f64>,
    /// G, `[constraints × variables]`.
    pub constraints: Sparse,
    /// h, `[constraints]`.
    pub limits: Vec<f64>,
    /// The number of leading constraints that are equations.
    pub equations: usize,
}

/// What the solver finds.
pub enum Found {
    /// The optimum, to 1e-12 or, where rounding stopped the solver, to 1e-8.
    Optimum(Optimum),
    /// A proof that no variables satisfy the constraints.
    Infeasible,
    /// Neither, and why.
    Unsolved(String),
}

/// The optimum of a programme.
pub struct Optimum {
    /// v, `[variables]`.
    pub variables: Vec<f64>,
    /// The multipliers of the constraints, `[constraints]`.
    pub multipliers: Vec<f64>,
    /// s, `[constraints]`.
    pub slacks: Vec<f64>,
    /// The number of iterations.
    pub iterations: u32,
}

/// A callback `(done, total)`: how many of the powers of ten that are asked for the largest residual has decreased.
pub type Watch<'a> = dyn FnMut(usize, usize) + 'a;

impl Programme {
    /// The optimum, if the solver finds one.
    pub fn optimum(self) -> Option<Optimum> {
        match found(self.search(|_| ())) {
            Found::Optimum(optimum) => Some(optimum),
            Found::Infeasible | Found::Unsolved(_) => None,
        }
    }

    /// Solves the programme while `watch` hears how far the search is.
    pub fn solve(self, watch: &mut Watch) -> Found {
        let (sender, iterates) = mpsc::channel();
        // Clarabel keeps its callback, so that it runs in a thread of its own, whose end closes the channel.
        found(std::thread::scope(|scope| {
            let send = move |near| {
                // The receiver may be gone once the search is over.
                let _ = sender.send(near);
            };
            let solver = scope.spawn(move || self.search(send));
            let mut nearest = 0;
            for near in iterates {
                nearest = near.max(nearest);
                watch(nearest, NEAR);
            }
            solver.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        }))
    }

    fn search(self, mut hear: impl FnMut(usize) + Send + Sync + 'static) -> Result<DefaultSolution<f64>, SolverError> {
        let settings = DefaultSettings {
            verbose: false,
            tol_gap_abs: TOLERANCE,
            tol_gap_rel: TOLERANCE,
            tol_feas: TOLERANCE,
            reduced_tol_gap_abs: REDUCED_TOLERANCE,
            reduced_tol_gap_rel: REDUCED_TOLERANCE,
            reduced_tol_feas: REDUCED_TOLERANCE,
            static_regularization_constant: REGULARIZATION,
            ..Default::default()
        };
        let Programme { quadratic, linear, constraints, limits, equations } = self;
        let cones = [ZeroConeT(equations), NonnegativeConeT(limits.len() - equations)];
        let mut solver = DefaultSolver::new(&quadratic, &linear, &constraints, &limits, &cones, settings)?;
        solver.set_termination_callback(move |info: &DefaultInfo<f64>| {
            // False lets the solver go on: a search is ended by its tolerances alone, whoever hears of it.
            hear(nearness(info));
            false
        });
        solver.solve();
        Ok(solver.solution)
    }
}

/// The one rule for what counts as solved: `AlmostSolved` is that to the reduced tolerance.
fn found(solution: Result<DefaultSolution<f64>, SolverError>) -> Found {
    let solution = match solution {
        Ok(solution) => solution,
        Err(problem) => return Found::Unsolved(problem.to_string()),
    };
    match solution.status {
        SolverStatus::Solved | SolverStatus::AlmostSolved => Found::Optimum(Optimum {
            variables: solution.x,
            multipliers: solution.z,
            slacks: solution.s,
            iterations: solution.iterations,
        }),
        // A proof to the reduced tolerance is none: `AlmostPrimalInfeasible` is among what is left.
        SolverStatus::PrimalInfeasible => Found::Infeasible,
        status => Found::Unsolved(format!("{status:?} after {} iterations", solution.iterations)),
    }
}

/// How many of the powers of ten to the tolerance the largest residual has decreased.
fn nearness(info: &DefaultInfo<f64>) -> usize {
    let residual = info.gap_rel.max(info.res_primal).max(info.res_dual);
    if residual > 0.0 { (-residual.log10()).clamp(0.0, NEAR as f64) as usize } else { 0 }
}

/// The matrix with these columns, each a list of rows in ascending order and values. Zeros are left out.
pub fn sparse<C: IntoIterator<Item = (usize, f64)>>(height: usize, columns: impl Iterator<Item = C>) -> Sparse {
    let (mut starts, mut rows, mut values) = (vec![0], vec![], vec![]);
    for column in columns {
        for (row, value) in column.into_iter().filter(|entry| entry.1 != 0.0) {
            // Zeros would be entries of the solver's factor like others.
            rows.push(row);
            values.push(value);
        }
        starts.push(rows.len());
    }
    CscMatrix::new(height, starts.len() - 1, starts, rows, values)
}
