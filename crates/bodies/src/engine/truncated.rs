//! The effective stiffness of a network in an engine: products, solutions, and how they change with the constants.
//!
//! Theory: page *Networks in engines* of the book.

use super::constraints::Constraints;
use super::descents::Descents;
use super::growth::{check_growth, ends, motion_growth};
use super::history::History;
use super::krylov::gmres;
use super::lanes::{Block, LANES, block, vectors};
use super::model::TruncatedModel;
use super::setting::{Setting, Sweep};
use super::vibration::Vibration;
use crate::error::{Error, ErrorKind, Result};
use crate::model::{Network, SpringGradients, Support};
use crate::solve::Equations;
use faer::Mat;
use faer::linalg::solvers::{PartialPivLu, Solve};
use rayon::prelude::*;

/// The effective stiffness `K_N` of a network under a support, with what solves its equations.
#[derive(Debug)]
pub struct Truncated {
    sweeps: Sweeps,
    /// W, `[dofs]`, 1/kg; zero where points are held.
    inverse: Vec<f64>,
    /// The degrees of freedom that are free.
    free: Vec<usize>,
    /// h, s.
    substep: f64,
    solver: Solver,
}

#[derive(Debug)]
enum Sweeps {
    Springs(Constraints),
    Points(Descents),
}

#[derive(Debug)]
enum Solver {
    /// The factors of the whole matrix.
    Dense(PartialPivLu<f64>),
    /// GMRES with the factor of the stiffness of the network.
    Krylov(Equations),
}

/// Up to this number of free degrees of freedom the whole matrix costs less than iterations for the loads of a fit; it has 128 MB.
const DENSE: usize = 4000;
/// The relative residual at which iterations end.
// It is that of the statics of a scene by default: the body in the engine has as many digits as the one beside it.
const RESIDUAL: f64 = 1e-10;
/// What they may leave where rounding ends them, in units of what was asked. Eight digits are left then, more than a
/// fit of displacements asks for.
const LEFT: f64 = 100.0;

impl Truncated {
    /// The effective stiffness at a setting; `None` if some motion has no stiffness.
    ///
    /// # Errors
    /// The engine does not hold the springs, or a point has no mass: kind `Unsupported`; or the equations do not fit into memory.
    pub fn new(model: TruncatedModel, support: &Support, setting: &Setting) -> Result<Option<Truncated>> {
        Truncated::prepare(model, support, setting, (false, DENSE))
    }

    /// The effective stiffness as [`Truncated::new`] has it, with the equations solved by iterations, whatever their number.
    ///
    /// # Errors
    /// Those of [`Truncated::new`].
    pub fn iterated(model: TruncatedModel, support: &Support, setting: &Setting) -> Result<Option<Truncated>> {
        Truncated::prepare(model, support, setting, (false, 0))
    }

    /// The largest effective stiffness of a setting, that of springs without compliance; `None` if some motion has no stiffness, or sweeps that take
    /// all such springs at once grow without bound. Vertex block descent has none.
    ///
    /// # Errors
    /// Those of [`Truncated::new`].
    pub fn rigid(model: TruncatedModel, support: &Support, setting: &Setting) -> Result<Option<Truncated>> {
        Truncated::prepare(model, support, setting, (true, DENSE))
    }

    fn prepare(
        model: TruncatedModel,
        support: &Support,
        setting: &Setting,
        (is_rigid, dense): (bool, usize),
    ) -> Result<Option<Truncated>> {
        model.check(support)?;
        let TruncatedModel { network, points, masses } = model;
        let d = network.dimension;
        let inverse: Vec<f64> =
            (0..points.len()).map(|dof| if support.is_fixed(dof) { 0.0 } else { 1.0 / masses[dof / d] }).collect();
        let free: Vec<usize> = (0..points.len()).filter(|&dof| !support.is_fixed(dof)).collect();
        // Without compliance the constants decide nothing but how well the stiffness prepares the iterations: those that a sweep sees do best.
        let seen = is_rigid.then(|| seen_by_sweeps(network, points, (&inverse, setting.substep())));
        let stiffness = seen.as_ref().unwrap_or(network).stiffness(points);
        let held = Equations::factored(&stiffness, support, points, d)?;
        let Some(equations) = held else { return Ok(None) };
        let sweeps = match setting.is_by_points() {
            true => Sweeps::Points(Descents::new(network, (points, &inverse), setting)?),
            false => {
                let constraints = Constraints::new(network, (points, &inverse), setting, is_rigid);
                if setting.sweep == Sweep::Jacobi {
                    if !is_rigid {
                        check_growth(&constraints, (network, points, &inverse), setting)?;
                    } else if !ends(&constraints, points.len()) {
                        return Ok(None);
                    }
                }
                Sweeps::Springs(constraints)
            }
        };
        let substep = setting.substep();
        let solver = Solver::Krylov(equations);
        let found = Truncated { sweeps, inverse, free, substep, solver };
        if found.free.len() > dense {
            return Ok(Some(found));
        }
        let matrix = found.matrix();
        // Sweeps that correct too much may grow beyond the range of numbers, which is no stiffness.
        let is_finite = matrix.col_iter().all(|column| column.iter().all(|k| k.is_finite()));
        Ok(is_finite.then(|| Truncated { solver: Solver::Dense(matrix.partial_piv_lu()), ..found }))
    }

    /// `K_N` on the degrees of freedom that are free.
    fn matrix(&self) -> Mat<f64> {
        let n = self.free.len();
        let columns = |chunk: &[usize]| {
            let mut unit = vec![[0.0; LANES]; self.inverse.len()];
            chunk.iter().enumerate().for_each(|(lane, &dof)| unit[dof][lane] = 1.0);
            vectors(&self.apply(&unit, false), chunk.len())
        };
        // Collected in the order of the columns, whichever is swept first.
        let columns: Vec<Vec<f64>> = self.free.par_chunks(LANES).flat_map_iter(columns).collect();
        Mat::from_fn(n, n, |i, j| columns[j][self.free[i]])
    }

    /// `K_N y`, or `K_Nᵀ y`.
    fn apply(&self, y: &Block, is_transposed: bool) -> Block {
        self.freed(match &self.sweeps {
            Sweeps::Springs(constraints) => constraints.apply(y, is_transposed),
            Sweeps::Points(descents) if is_transposed => descents.apply_transposed(y),
            Sweeps::Points(descents) => descents.apply(y),
        })
    }

    /// The vectors with zero where points are held.
    fn freed(&self, mut block: Block) -> Block {
        block.iter_mut().zip(&self.inverse).filter(|(_, w)| **w == 0.0).for_each(|(all, _)| *all = [0.0; LANES]);
        block
    }

    /// `K_N⁻¹ f` of each f, or `K_N⁻ᵀ f`, zero where points are held.
    fn solve(&self, forces: &[Vec<f64>], is_transposed: bool, tolerance: f64) -> Result<Vec<Vec<f64>>> {
        let size = self.inverse.len();
        match &self.solver {
            Solver::Dense(factors) => {
                let right = Mat::from_fn(self.free.len(), forces.len(), |i, load| forces[load][self.free[i]]);
                let found = if is_transposed { factors.solve_transpose(&right) } else { factors.solve(&right) };
                let one = |load: usize| {
                    let mut all = vec![0.0; size];
                    self.free.iter().enumerate().for_each(|(i, &dof)| all[dof] = found[(i, load)]);
                    all
                };
                Ok((0..forces.len()).map(one).collect())
            }
            Solver::Krylov(equations) => {
                let one = |chunk: &[Vec<f64>]| {
                    let right = self.freed(block(chunk, size));
                    let precondition = |v: &Block| {
                        let found = equations.respond_all(&vectors(v, LANES), 0.0).ok()?;
                        Some(block(&found, size))
                    };
                    let apply = |v: &Block| self.apply(v, is_transposed);
                    let found = gmres(apply, precondition, &right, tolerance);
                    let found = found.filter(|(_, left)| *left <= LEFT * tolerance);
                    let (found, _) = found.ok_or_else(|| {
                        let problem =
                            "iterations for the body in the engine stall: its sweeps are far from the equilibrium";
                        Error::at("engine", problem).of_kind(ErrorKind::Limit)
                    })?;
                    Ok(vectors(&found, chunk.len()))
                };
                // Chunks are solved each on its own, and the list keeps their order: threads do not change the
                // displacements.
                let found: Result<Vec<Vec<Vec<f64>>>> = forces.par_chunks(LANES).map(one).collect();
                Ok(found?.concat())
            }
        }
    }

    /// The predictions `y = K_N⁻¹ f` at rest under each of several nodal forces, `[points · dimension]`, N.
    ///
    /// # Errors
    /// Iterations stall: kind `Limit`.
    pub fn predictions(&self, forces: &[Vec<f64>]) -> Result<Vec<Vec<f64>>> {
        let found = self.solve(forces, false, RESIDUAL)?;
        match found.iter().flatten().all(|y| y.is_finite()) {
            true => Ok(found),
            false => {
                let problem = "where the body rests in the engine is no finite number";
                Err(Error::at("engine", problem).of_kind(ErrorKind::Limit))
            }
        }
    }

    /// The displacements `u = y − h² W f`.
    pub fn displacement(&self, prediction: &[f64], force: &[f64]) -> Vec<f64> {
        let square = self.substep.powi(2);
        prediction.iter().zip(force).zip(&self.inverse).map(|((y, f), w)| y - square * w * f).collect()
    }

    /// The displacements at rest under each of several nodal forces, `[points · dimension]`, N.
    ///
    /// # Errors
    /// Iterations stall: kind `Limit`.
    pub fn answers(&self, forces: &[Vec<f64>]) -> Result<Vec<Vec<f64>>> {
        let predictions = self.predictions(forces)?;
        Ok(predictions.iter().zip(forces).map(|(y, f)| self.displacement(y, f)).collect())
    }

    fn trace(&self, y: &Block) -> History {
        match &self.sweeps {
            Sweeps::Springs(constraints) => constraints.trace(y),
            Sweeps::Points(descents) => descents.trace(y),
        }
    }

    /// The changes of the displacements, `−K_N⁻¹ δK_N y`, where the logarithms of the constants change by `changes`, `[springs]`, within a relative
    /// error where equations are solved by iterations.
    ///
    /// # Errors
    /// Iterations stall: kind `Limit`.
    pub fn changes(&self, predictions: &[Vec<f64>], changes: &[f64], tolerance: f64) -> Result<Vec<Vec<f64>>> {
        let one = |chunk: &[Vec<f64>]| {
            let history = self.trace(&block(chunk, self.inverse.len()));
            let mut change = self.freed(match &self.sweeps {
                Sweeps::Springs(constraints) => constraints.change(&history, changes),
                Sweeps::Points(descents) => descents.change(&history, changes),
            });
            // From `K y = f` with a constant f follows `K dy = −dK y`.
            change.iter_mut().flatten().for_each(|f| *f = -*f);
            vectors(&change, chunk.len())
        };
        let forces: Vec<Vec<Vec<f64>>> = predictions.par_chunks(LANES).map(one).collect();
        // The predictions are known within this residual: to ask for less is of no use.
        self.solve(&forces.concat(), false, tolerance.max(RESIDUAL))
    }

    /// `Σ_l w_l·∂u_l/∂ ln k_s` of each spring, `[springs]`, for the weights w_l of the displacements of each load: with `K_Nᵀ z = w` it is
    /// `−zᵀ (∂K_N/∂ ln k_s) y`, within a relative error where equations are solved by iterations.
    ///
    /// # Errors
    /// Iterations stall: kind `Limit`.
    pub fn gradient(&self, predictions: &[Vec<f64>], weights: &[Vec<f64>], tolerance: f64) -> Result<Vec<f64>> {
        let size = self.inverse.len();
        let adjoints = self.solve(weights, true, tolerance.max(RESIDUAL))?;
        let one = |(predictions, adjoints): (&[Vec<f64>], &[Vec<f64>])| {
            let (history, z) = (self.trace(&block(predictions, size)), block(adjoints, size));
            match &self.sweeps {
                Sweeps::Springs(constraints) => constraints.sensitivities(&history, &z),
                Sweeps::Points(descents) => descents.sensitivities(&history, &z),
            }
        };
        let chunks = predictions.par_chunks(LANES).zip(adjoints.par_chunks(LANES));
        let parts: Vec<Vec<f64>> = chunks.map(one).collect();
        let mut total = vec![0.0; parts.first().map_or(0, Vec::len)];
        // Added in the order of the loads, so that the sum has the same bits on any number of threads.
        for part in &parts {
            // The derivative of `K⁻¹` is `−K⁻¹ dK K⁻¹`, whence the sign.
            total.iter_mut().zip(part).for_each(|(t, own)| *t -= own);
        }
        Ok(total)
    }

    /// The factor by which the motion of the body grows in each substep where nothing pushes it; `None` if it does not grow. Sweeps that take springs one
    /// after the other, and do not correct more than they find, never let it grow.
    pub fn growth(&self) -> Option<f64> {
        motion_growth(|y| self.apply(y, false), &self.inverse, self.substep)
    }

    /// The lowest natural vibration in the engine, found by inverse iteration; `None` if it is not found.
    ///
    /// Without forces `x_{n+1} = (I − h² W K_N) (2 x_n − x_{n−1})`. A motion with the eigenvalue κ of `W K_N` has the complex factor
    /// `ρ e^{iφ}` in a substep, with `ρ² = 1 − h² κ` and `cos φ = ρ`: the angular frequency φ/h and the damping ratio `ln(1/ρ)/φ` of the
    /// truncation and of the implicit steps.
    ///
    /// # Errors
    /// Iterations stall: kind `Limit`.
    pub fn lowest_vibration(&self) -> Result<Option<Vibration>> {
        // No symmetric body has this direction as that of another mode.
        let mut shape: Vec<f64> = (0..self.inverse.len()).map(|dof| 1.0 + 0.3 * (1.7 * dof as f64).sin()).collect();
        let (mut before, mut change) = (f64::NAN, f64::NAN);
        for _ in 0..VIBRATIONS {
            let inertia: Vec<f64> =
                shape.iter().zip(&self.inverse).map(|(x, w)| if *w > 0.0 { x / w } else { 0.0 }).collect();
            let Some(next) = self.solve(std::slice::from_ref(&inertia), false, RESIDUAL)?.pop() else {
                return Ok(None);
            };
            let (own, both): (f64, f64) = inertia
                .iter()
                .zip(&next)
                .zip(&self.inverse)
                .filter(|(_, w)| **w > 0.0)
                .fold((0.0, 0.0), |(own, both), ((m, x), w)| (own + m * m * w, both + m * x));
            // κ = (M x)·x/(M x)·(K_N⁻¹ M x).
            let kappa = own / both;
            if !(kappa > 0.0 && kappa.is_finite()) {
                return Ok(None);
            }
            let size = next.iter().map(|x| x * x).sum::<f64>().sqrt();
            shape = next.iter().map(|x| x / size).collect();
            change = (kappa - before).abs() / kappa;
            before = kappa;
            // The eigenvalue errs with the square of the shape: more iterations would change no digit that is printed.
            if change <= 1e-9 {
                break;
            }
        }
        // Inverse iteration separates two motions of nearly the same frequency slowly, and the eigenvalue of either gives that frequency.
        Ok(if change <= NEARLY { Vibration::of(before, self.substep) } else { None })
    }
}

/// The relative change of an eigenvalue in the last iteration with which it is known to the digits that are printed.
const NEARLY: f64 = 1e-5;
/// Inverse iterations at most.
// The eigenvalue converges with the square of the quotient of the two lowest eigenvalues in each iteration: 500
// iterations leave 2e-9 where the two frequencies differ by 1 %.
const VIBRATIONS: usize = 500;

/// The network with the constants `1/(h² g·W g)` at which the compliance of each spring is what its points have. Springs between held points stay.
fn seen_by_sweeps(network: &Network, points: &[f64], (inverse, substep): (&[f64], f64)) -> Network {
    let (gradients, _) = SpringGradients::at(network, points);
    let moves = gradients.each().map(|(dofs, g)| dofs.iter().zip(g).map(|(&dof, g)| inverse[dof] * g * g).sum::<f64>());
    // Factors multiply the constants that the springs have.
    let factor = |(moved, (_, constant)): (f64, (_, f64))| {
        if moved > 0.0 { 1.0 / (substep * substep * moved * constant) } else { 1.0 }
    };
    let factors: Vec<f64> = moves.zip(network.springs()).map(factor).collect();
    network.scaled(&factors)
}
