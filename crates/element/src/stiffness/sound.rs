//! Whether an element has a stiffness, without the stiffness.

use super::{Geometry, jacobian, squared_bound};
use crate::element::Tabulation;
use crate::scalar::{Scalar, adjugate, of_dimension};

impl Geometry {
    /// Whether [`Geometry::set`] finds no fault in the element with nodes at `x`, `[nodes × dimension]`, m, at first sight; without what follows from
    /// its Jacobian.
    pub fn is_sound(table: &Tabulation, x: &[f64]) -> bool {
        of_dimension!(table.dimension, |D| is_sound::<D>(table, x))
    }
}

fn is_sound<const D: usize>(table: &Tabulation, x: &[f64]) -> bool {
    let flat = f64::delicate().powi(2);
    table.gradients.chunks_exact(table.nodes * D).all(|dn| {
        let j = jacobian(x.as_chunks::<D>().0, dn.as_chunks::<D>().0);
        let (_, determinant) = adjugate(&j);
        determinant > 0.0 && determinant * determinant > squared_bound(&j) * flat
    })
}
