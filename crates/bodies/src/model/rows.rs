//! Networks whose points and forces are in rows of their own numbers, for explicit steps.

use std::fmt::Debug;

/// Forces with one row of four numbers for each point.
pub trait RowForces<N>: Debug {
    /// Writes the forces, as (z, x, y) and an unused number, N, with the points at x, m, `[points]` both; the unused numbers of x are zero.
    /// False if a spring has no force.
    fn pull_rows(&self, x: &[[N; 4]], force: &mut [[N; 4]]) -> bool;
}

/// A network in one of the numbers.
#[derive(Debug, Clone, Copy)]
pub enum Rows<'a> {
    /// In `f64`.
    Double(&'a dyn RowForces<f64>),
    /// In `f32`.
    Single(&'a dyn RowForces<f32>),
}
