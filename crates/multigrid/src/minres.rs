//! Minimal residuals for symmetric matrices that are not positive definite, preconditioned by the levels of one that is.

use crate::fault::Fault;
use crate::gradients::Solution;
use crate::hierarchy::Multigrid;
use crate::matrix::BlockMatrix;
use crate::parallel::{combine, dot, norm};
use crate::settings::{Event, Watch};

/// Vectors of the recurrence, the last and the one before.
type Pair<const D: usize> = [Vec<[f64; D]>; 2];

impl<const D: usize, const M: usize> Multigrid<D, M> {
    /// `A x = b` on the unknowns that are not held, where x is zero, A any symmetric matrix of the same size: until the residual in the
    /// norm of the inverse preconditioner has become less than `tolerance` times that of b.
    ///
    /// Paige and Saunders' method (SIAM J. Numer. Anal. 12, 1975) with a preconditioner (Elman, Silvester, Wathen, Finite Elements and Fast
    /// Iterative Solvers, § 4.1). The spectrum of the solution is not known.
    ///
    /// # Errors
    /// The residual does not become less, the sizes do not agree, or the watch broke off.
    pub fn solve_indefinite(
        &self,
        a: &BlockMatrix<D, D>,
        b: &[f64],
        tolerance: f64,
        iterations: usize,
        watch: &mut Watch,
    ) -> Result<Solution, Fault> {
        let rows = self.rows();
        for (what, expected, found) in [("the rows", rows, a.rows()), ("the right hand side", rows * D, b.len())] {
            if expected != found {
                return Err(Fault::Size { what, expected, found });
            }
        }
        if b.iter().any(|x| !x.is_finite()) {
            return Err(Fault::NotFinite);
        }
        let mut room = self.workspace();
        let zero = vec![[0.0; D]; rows];
        let mut force = b.as_chunks::<D>().0.to_vec();
        self.mask(&mut force);
        let size = norm(&force);
        let mut x = zero.clone();
        let mut solution = Solution {
            displacement: x.as_flattened().to_vec(),
            iterations: 0,
            residual: 0.0,
            error: 0.0,
            spectrum: [f64::NAN; 2],
        };
        let (mut v, mut before) = (force.clone(), zero.clone());
        let mut z = zero.clone();
        self.apply(&v, &mut z, &mut room);
        let mut gamma = dot(&v, &z).max(0.0).sqrt();
        if gamma == 0.0 {
            return Ok(solution);
        }
        let (first, mut last) = (gamma, 1.0);
        let mut eta = gamma;
        // Cosines and sines of the last two rotations.
        let (mut c, mut s) = ([1.0, 1.0], [0.0, 0.0]);
        let mut w: Pair<D> = [zero.clone(), zero.clone()];
        let mut az = zero;
        while solution.iterations < iterations {
            combine(&mut z, 1.0 / gamma, &v, 0.0);
            a.apply(&z, &mut az);
            self.mask(&mut az);
            let delta = dot(&az, &z);
            combine(&mut az, 1.0, &v, -delta / gamma);
            combine(&mut az, 1.0, &before, -gamma / last);
            before = std::mem::replace(&mut v, az.clone());
            let mut next = z.clone();
            self.apply(&v, &mut next, &mut room);
            let after = dot(&v, &next).max(0.0).sqrt();
            let a0 = c[0] * delta - c[1] * s[0] * gamma;
            let a1 = a0.hypot(after);
            let a2 = s[0] * delta + c[1] * c[0] * gamma;
            let a3 = s[1] * gamma;
            if !(a1 > 0.0 && a1.is_finite()) {
                break;
            }
            (c, s) = ([a0 / a1, c[0]], [after / a1, s[0]]);
            let [newer, older] = &mut w;
            combine(older, -a3 / a1, newer, -a2 / a1);
            combine(older, 1.0, &z, 1.0 / a1);
            w.swap(0, 1);
            combine(&mut x, 1.0, &w[0], c[0] * eta);
            eta *= -s[0];
            (last, gamma, z) = (gamma, after, next);
            solution.iterations += 1;
            solution.error = (eta / first).abs();
            let event = Event::Iteration { number: solution.iterations, residual: solution.error };
            if watch(event).is_break() {
                return Err(Fault::Interrupted);
            }
            if !(solution.error > tolerance) || gamma == 0.0 {
                break;
            }
        }
        a.apply(&x, &mut az);
        combine(&mut force, 1.0, &az, -1.0);
        self.mask(&mut force);
        solution.residual = norm(&force) / size;
        // A false minimum shows in the residual that is worked out anew.
        if !(solution.error <= tolerance && solution.residual <= 1e4 * tolerance.max(1e-12)) {
            let (residual, iterations, levels) = (solution.residual, solution.iterations, self.levels().to_vec());
            return Err(Fault::Stalled { residual, iterations, levels });
        }
        solution.displacement = x.as_flattened().to_vec();
        Ok(solution)
    }
}
