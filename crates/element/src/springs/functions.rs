//! The gradients of springs on functions.
//!
//! Theory: page *Stiffness and the reduced space* of the book.

use super::Springs;
use super::angle::{angle_gradient, angle_sine};
use crate::element::SpringKind;
use crate::symbolic::Differentiable;

impl Springs {
    /// Writes the rows of the springs on functions alone, `[functions × nodes·dimension]`, into `rows`, which must be
    /// zero. False if a row is zero or not finite.
    ///
    /// # Panics
    /// If `rows` has another length.
    pub fn function_gradients<T: Differentiable>(&self, x: &[T], rows: &mut [T]) -> bool {
        let d = self.dimension;
        let size = self.nodes * d;
        for (row, spring) in rows.chunks_exact_mut(size).zip(&self.functions) {
            let at: Vec<T> = spring.nodes.iter().flat_map(|&a| &x[a * d..(a + 1) * d]).cloned().collect();
            let gradient = match spring.kind == SpringKind::Angle {
                true => angle_gradient(&at, d),
                false => spring.function.program().gradient(&at).1,
            };
            for (&a, g) in spring.nodes.iter().zip(gradient.chunks_exact(d)) {
                // Added, because a coupling may name a node twice.
                row[a * d..(a + 1) * d].iter_mut().zip(g).for_each(|(row, g)| *row = row.clone() + g);
            }
        }
        let springs = rows[..self.functions.len() * size].chunks_exact(size);
        springs
            .map(|row| row.iter().map(|g| g.rounded().powi(2)).sum::<f64>())
            .all(|square| square > 0.0 && square.is_finite())
    }

    /// The least `|sin θ|` of the angles that springs measure of nodes at `x`, `[nodes × dimension]`; one if none measures an angle.
    pub fn least_sine(&self, x: &[f64]) -> f64 {
        let d = self.dimension;
        let angles = self.functions.iter().filter(|spring| spring.kind == SpringKind::Angle);
        angles.fold(1.0, |least, spring| {
            let at: Vec<f64> = spring.nodes.iter().flat_map(|&a| &x[a * d..(a + 1) * d]).copied().collect();
            least.min(angle_sine(&at, d))
        })
    }
}
