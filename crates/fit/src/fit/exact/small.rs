//! The springs of exact networks for small deformations in any kind of number, for their derivatives.
//!
//! Theory: page *Gradients of spring constants* of the book.

use super::ExactFit;
use super::energy::Coefficients;
use super::kernel::ExactBatch;
use super::volume::Shares;
use crate::element::Element;
use crate::material::{BlockValues, Moduli};
use crate::scalar::Real;
use crate::springs::Springs;
use crate::stiffness::Geometry;

/// Which springs on content a cell has, and what they receive.
pub struct ExactKernel<'a> {
    /// The quadrature points whose contents are measured.
    pub points: &'a [usize],
    pub shares: Shares,
}

impl<'a> ExactKernel<'a> {
    /// The kernel of a fit with these springs, which have none on areas.
    pub fn of(fit: &ExactFit, springs: &'a Springs) -> ExactKernel<'a> {
        ExactKernel { points: springs.points(), shares: fit.volume.shares(springs.points().is_empty()) }
    }

    /// Writes the constants and the rest contents of a cell with nodes at `x`, `[nodes × dimension]`, and fills in its geometry; the last array is
    /// memory for one number per node. False if a Jacobian is not safely positive.
    pub fn solve<T: Real>(
        &self,
        element: &Element,
        springs: &Springs,
        x: &[T],
        moduli: &Moduli<T>,
        geometry: &mut Geometry<T>,
        [constants, rests, own]: [&mut [T]; 3],
    ) -> bool {
        let batch = ExactBatch {
            element,
            springs,
            points: &[],
            connectivity: &[],
            // The kernel is asked for one geometry, whose coefficients are an argument: the block has no cells.
            coefficients: BlockValues::Each(&[]),
            has_law: false,
            shares: self.shares,
            constants: &mut [],
            parameters: &mut [],
        };
        let coefficients = Coefficients::plain(moduli.clone(), &x[0].zero());
        let is_found = batch.solve(&coefficients, x, geometry, constants, rests, own);
        // The kernel writes k c₀.
        let pairs = springs.pairs().len();
        for (rest, constant) in rests.iter_mut().zip(&constants[pairs..]) {
            *rest = rest.clone() / constant;
        }
        is_found
    }
}
