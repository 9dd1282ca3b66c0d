//! Conjugate gradients, preconditioned by the levels.

use crate::fault::{Fault, Motion};
use crate::hierarchy::{Multigrid, shown};
use crate::parallel::{combine, dot, norm};
use crate::settings::{Event, Watch};
use crate::tridiagonal::Tridiagonal;

/// Iterations without a new least residual after which there is no hope.
const PATIENCE: usize = 60;
/// Times that the residual is worked out anew from the solution.
const RESTARTS: usize = 4;
/// A residual this many roundings of `|A| |x|` large is none.
const ROUNDINGS: f64 = 4.0;

/// A solution, and how it was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// On all unknowns, zero in what is held.
    pub displacement: Vec<f64>,
    /// Iterations of the method.
    pub iterations: usize,
    /// `‖b − A x‖/‖b‖` on the unknowns that are not held, worked out anew from x.
    pub residual: f64,
    /// `√(rᵀ M⁻¹ r / bᵀ M⁻¹ b)` at the end, which is about the relative error in the norm of the energy.
    pub error: f64,
    /// The least and the largest eigenvalue of `M⁻¹ A` that the iteration has met.
    pub spectrum: [f64; 2],
}

impl<const D: usize, const M: usize> Multigrid<D, M> {
    /// `A x = b` on the unknowns that are not held, where x is zero, until `rᵀ M⁻¹ r ≤ tolerance² bᵀ M⁻¹ b` or the residual is rounding.
    ///
    /// # Errors
    /// A motion of the search has no energy above zero, the residual does not become less, the sizes do not agree, or the watch broke off.
    pub fn solve(&self, b: &[f64], tolerance: f64, iterations: usize, watch: &mut Watch) -> Result<Solution, Fault> {
        let rows = self.rows();
        if b.len() != rows * D {
            return Err(Fault::Size { what: "the right hand side", expected: rows * D, found: b.len() });
        }
        if b.iter().any(|x| !x.is_finite()) {
            return Err(Fault::NotFinite);
        }
        let mut room = self.workspace();
        let mut force = b.as_chunks::<D>().0.to_vec();
        self.mask(&mut force);
        let size = norm(&force);
        let mut x = vec![[0.0; D]; rows];
        let mut solution =
            Solution { displacement: Vec::new(), iterations: 0, residual: 0.0, error: 0.0, spectrum: [1.0, 1.0] };
        let (mut r, mut z) = (force.clone(), vec![[0.0; D]; rows]);
        let (mut p, mut ap) = (z.clone(), z.clone());
        let mut first = None;
        let mut best = (f64::INFINITY, 0);
        for _ in 0..RESTARTS {
            self.apply(&r, &mut z, &mut room);
            let mut along = dot(&r, &z);
            let scale = *first.get_or_insert(along);
            if !(along > tolerance * tolerance * scale) {
                solution.error = (along / scale).max(0.0).sqrt();
                break;
            }
            p.copy_from_slice(&z);
            let mut t = Lanczos::default();
            loop {
                self.matrix().apply(&p, &mut ap);
                let energy = dot(&p, &ap);
                if !(energy > 0.0) {
                    return Err(self.not_positive(&p, energy));
                }
                let step = along / energy;
                combine(&mut x, 1.0, &p, step);
                combine(&mut r, 1.0, &ap, -step);
                self.mask(&mut r);
                self.apply(&r, &mut z, &mut room);
                let next = dot(&r, &z);
                t.step(step, next / along);
                solution.iterations += 1;
                solution.error = (next / scale).max(0.0).sqrt();
                let event = Event::Iteration { number: solution.iterations, residual: solution.error };
                if watch(event).is_break() {
                    return Err(Fault::Interrupted);
                }
                if solution.error < best.0 {
                    best = (solution.error, solution.iterations);
                }
                let is_stalled = solution.iterations >= iterations || solution.iterations > best.1 + PATIENCE;
                if !(solution.error > tolerance) || is_stalled || !next.is_finite() {
                    break;
                }
                combine(&mut p, next / along, &z, 1.0);
                along = next;
            }
            if let Some([low, high]) = t.matrix.extremes() {
                solution.spectrum = [solution.spectrum[0].min(low), solution.spectrum[1].max(high)];
            }
            // What rounding has taken from the residual.
            self.matrix().apply(&x, &mut ap);
            r.copy_from_slice(&force);
            combine(&mut r, 1.0, &ap, -1.0);
            self.mask(&mut r);
            let is_rounding = norm(&r) <= ROUNDINGS * f64::EPSILON * self.rounding(&x);
            if is_rounding || solution.iterations >= iterations {
                break;
            }
        }
        solution.residual = if size > 0.0 { norm(&r) / size } else { 0.0 };
        let is_rounding = || norm(&r) <= ROUNDINGS * f64::EPSILON * self.rounding(&x);
        if !(solution.error <= tolerance) && !is_rounding() {
            let (residual, iterations, levels) = (solution.residual, solution.iterations, self.levels().to_vec());
            return Err(Fault::Stalled { residual, iterations, levels });
        }
        solution.displacement = x.as_flattened().to_vec();
        Ok(solution)
    }

    /// `‖ |A| |x| ‖`.
    fn rounding(&self, x: &[[f64; D]]) -> f64 {
        let a = self.matrix();
        let mut sizes = vec![[0.0; D]; x.len()];
        for (row, sizes) in sizes.iter_mut().enumerate() {
            for at in a.pattern.starts[row]..a.pattern.starts[row + 1] {
                let x = &x[a.pattern.columns[at] as usize];
                for i in 0..D {
                    sizes[i] += (0..D).map(|j| (a.values[at][i][j] * x[j]).abs()).sum::<f64>();
                }
            }
        }
        norm(&sizes)
    }

    /// A motion without energy above zero, or numbers that are not finite.
    pub(crate) fn not_positive(&self, p: &[[f64; D]], energy: f64) -> Fault {
        if energy.is_nan() {
            return Fault::NotFinite;
        }
        let motion: Motion = shown(self.matrix(), p.to_vec());
        Fault::NotPositive(motion)
    }
}

/// The tridiagonal matrix of Lanczos' method from the numbers of conjugate gradients (Golub, Van Loan, Matrix Computations, § 10.2).
#[derive(Default)]
pub(crate) struct Lanczos {
    pub matrix: Tridiagonal,
    last: Option<[f64; 2]>,
}

impl Lanczos {
    /// The step α along a direction, and the ratio β of the residuals after and before it.
    pub fn step(&mut self, alpha: f64, beta: f64) {
        let carried = self.last.map_or(0.0, |[alpha, beta]| beta / alpha);
        self.matrix.diagonal.push(1.0 / alpha + carried);
        if let Some([alpha, beta]) = self.last {
            self.matrix.beside.push(beta.max(0.0).sqrt() / alpha);
        }
        self.last = Some([alpha, beta]);
    }
}
