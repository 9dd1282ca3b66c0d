//! The response to harmonic forces of a body without inertia whose parts are stiff and lose energy unlike.
//!
//! Theory: page *Springs that forget* of the book.

use super::linear::{Factor, System};
use crate::error::{Error, ErrorKind, Result};
use crate::model::{Entries, Support};
use nalgebra::Complex;

/// The relative residual at which iterations end.
// It is some hundred roundings. A loss modulus of a millionth of its storage modulus has seven digits then, or more: the work of the
// forces mostly errs with the square of the residual.
const ENOUGH: f64 = 1e-13;
/// The relative residual beyond which displacements are no solution.
// Rounding may end the iterations before [`ENOUGH`] on slender bodies. Up to this residual a loss modulus of a millionth of its
// storage modulus still has three digits or more.
const SOLVED: f64 = 1e-9;
/// Iterations of a start at most.
// Preconditioned eigenvalues are on a line between the coefficients of two parts: where these differ a hundredfold, some fifty
// iterations are needed.
const ITERATIONS: usize = 400;
/// The number of times that iterations begin, the later ones from the residual.
// The second start takes away the drift of the first. Two more are for starts that end where `dᵀ A d` vanishes.
const STARTS: usize = 4;

/// The equations `Σ_p c_p K_p u = f`, with a complex coefficient for each part of a stiffness that is positive definite.
#[derive(Debug)]
pub struct Harmonic {
    /// `Σ_p K_p` of the parts that resist at rest, and its factor.
    whole: System,
    factor: Factor,
    parts: Vec<System>,
}

impl Harmonic {
    /// The equations of these parts, of which `stiff` are those whose sum resists at rest; `None` if some motion of it has no stiffness. `points` are
    /// `[points × dimension]`, m.
    ///
    /// # Errors
    /// The equations do not fit into memory.
    pub fn new(
        parts: &[Entries],
        stiff: usize,
        support: &Support,
        points: &[f64],
        dimension: usize,
    ) -> Result<Option<Harmonic>> {
        let whole = System::new(&parts[..stiff].concat(), support)?.placed(points, dimension);
        let Some(factor) = whole.cholesky()? else { return Ok(None) };
        let parts = parts.iter().map(|part| System::new(part, support)).collect::<Result<_>>()?;
        Ok(Some(Harmonic { whole, factor, parts }))
    }

    /// The displacements under the forces f, `[points · dimension]`, N, with the coefficient of each part: conjugate gradients with the product
    /// `xᵀ y` instead of `xᴴ y` (van der Vorst, Melissen, IEEE Trans. Magn. 26, 1990), preconditioned by the stiffness at rest.
    ///
    /// # Errors
    /// Iterations stall: kind `Limit`.
    pub fn solve(&self, coefficients: &[Complex<f64>], f: &[f64]) -> Result<Vec<Complex<f64>>> {
        let rhs: Vec<Complex<f64>> = self.whole.free().iter().map(|&dof| f[dof].into()).collect();
        let size = norm(&rhs);
        let mut u = vec![Complex::default(); rhs.len()];
        let mut residual = rhs.clone();
        // The residual of the recurrence drifts from the true one by rounding: each start computes it anew.
        for _ in 0..STARTS {
            if !(norm(&residual) > ENOUGH * size) {
                break;
            }
            let correction = self.iterate(coefficients, &residual, ENOUGH * size);
            u.iter_mut().zip(&correction).for_each(|(u, c)| *u += c);
            residual = rhs.iter().zip(self.apply(coefficients, &u)).map(|(f, inner)| f - inner).collect();
        }
        // The comparison is negated, so that NaN is refused.
        if !(norm(&residual) <= SOLVED * size) {
            let expected = "parts that hold the body together at each frequency";
            return Err(Error::expected("springs", expected, "a motion that meets next to no resistance")
                .of_kind(ErrorKind::Limit));
        }
        let mut all = vec![Complex::default(); f.len()];
        self.whole.free().iter().zip(&u).for_each(|(&dof, u)| all[dof] = *u);
        Ok(all)
    }

    fn iterate(&self, coefficients: &[Complex<f64>], rhs: &[Complex<f64>], enough: f64) -> Vec<Complex<f64>> {
        let mut u = vec![Complex::default(); rhs.len()];
        let mut residual = rhs.to_vec();
        let mut raised = self.precondition(&residual);
        let mut direction = raised.clone();
        let mut along = dot(&residual, &raised);
        for _ in 0..ITERATIONS {
            let image = self.apply(coefficients, &direction);
            let step = along / dot(&direction, &image);
            // `xᵀ y` is no norm: `dᵀ A d` may vanish with d and A regular. The next start goes on from what was found.
            if !(step.re.is_finite() && step.im.is_finite()) {
                break;
            }
            u.iter_mut().zip(&direction).for_each(|(u, d)| *u += step * d);
            residual.iter_mut().zip(&image).for_each(|(r, i)| *r -= step * i);
            if norm(&residual) <= enough {
                break;
            }
            raised = self.precondition(&residual);
            let next = dot(&residual, &raised);
            let ratio = next / along;
            along = next;
            direction.iter_mut().zip(&raised).for_each(|(d, z)| *d = z + ratio * *d);
        }
        u
    }

    fn precondition(&self, x: &[Complex<f64>]) -> Vec<Complex<f64>> {
        let mut both: Vec<f64> = x.iter().map(|x| x.re).chain(x.iter().map(|x| x.im)).collect();
        // The factor is real, and solves for the real and the imaginary part side by side.
        self.factor.solve(&mut both);
        let (real, imaginary) = both.split_at(x.len());
        real.iter().zip(imaginary).map(|(re, im)| Complex::new(*re, *im)).collect()
    }

    fn apply(&self, coefficients: &[Complex<f64>], x: &[Complex<f64>]) -> Vec<Complex<f64>> {
        let (real, imaginary): (Vec<f64>, Vec<f64>) = x.iter().map(|x| (x.re, x.im)).unzip();
        let mut y = vec![Complex::default(); x.len()];
        for (part, coefficient) in self.parts.iter().zip(coefficients) {
            let images = part.apply(&real).into_iter().zip(part.apply(&imaginary));
            y.iter_mut().zip(images).for_each(|(y, (re, im))| *y += coefficient * Complex::new(re, im));
        }
        y
    }
}

fn dot(x: &[Complex<f64>], y: &[Complex<f64>]) -> Complex<f64> {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

fn norm(x: &[Complex<f64>]) -> f64 {
    x.iter().map(Complex::norm_sqr).sum::<f64>().sqrt()
}
