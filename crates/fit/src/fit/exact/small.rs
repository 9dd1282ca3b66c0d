//! The springs of exact networks for small deformations in any kind of number, for their derivatives.
//!
//! Theory: page *Gradients of spring constants* of the book.

use super::ExactFit;
use super::energy::Coefficients;
use super::kernel::ExactKernel;
use crate::element::Tabulation;
use crate::material::Moduli;
use crate::scalar::Real;
use crate::springs::Springs;
use crate::stiffness::Geometry;

impl<'a> ExactKernel<'a> {
    /// The kernel of a fit with these springs, which have none on areas.
    pub fn of(fit: &ExactFit, springs: &'a Springs) -> ExactKernel<'a> {
        ExactKernel { springs, has_law: false, shares: fit.volume.shares(springs.points().is_empty()) }
    }

    /// Writes the constants and the rest contents of a cell with nodes at `x`, `[nodes × dimension]`, and fills in its geometry; the last array is
    /// memory for one number per node. False if a Jacobian is not safely positive.
    pub fn solve_plain<T: Real>(
        &self,
        table: &Tabulation,
        x: &[T],
        moduli: &Moduli<T>,
        geometry: &mut Geometry<T>,
        [constants, rests, own]: [&mut [T]; 3],
    ) -> bool {
        let coefficients = Coefficients::plain(moduli.clone(), &x[0].zero());
        let is_found = self.solve(table, &coefficients, x, geometry, [constants, rests, own]);
        // The kernel writes k c₀.
        let pairs = self.springs.pairs().len();
        for (rest, constant) in rests.iter_mut().zip(&constants[pairs..]) {
            *rest = rest.clone() / constant;
        }
        is_found
    }
}
