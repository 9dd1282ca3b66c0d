//! The positions of the nodes of a cell relative to its first node: in space, or in the cell's own plane or line if its
//! dimension is less than that of its space.
//!
//! Far from the origin, coordinates have few digits left for the shape of a cell, and sums of them lose these digits.
//! Differences of nearby coordinates are exact (Sterbenz 1974).

use super::fault::Fault;
use crate::element::Tabulation;
use crate::scalar::of_dimension;

/// Memory to place the nodes of one cell after the other.
///
/// A cell of a surface or a curve is projected orthogonally onto the mean of its tangent planes. This is exact for
/// lines and flat cells; a slightly curved cell is replaced by a flat facet.
#[derive(Debug, Clone)]
pub struct Placement {
    /// Orthonormal vectors along the cell, `[dimension × space]`; empty if the cell fills its space.
    pub frame: Vec<f64>,
    spatial: Vec<f64>,
}

impl Placement {
    /// Memory for the cells of an element with this table.
    pub fn new(table: &Tabulation) -> Placement {
        let embedded = table.dimension < table.space;
        let room = |size: usize| vec![0.0; if embedded { size } else { 0 }];
        Placement { frame: room(table.dimension * table.space), spatial: room(table.nodes * table.space) }
    }

    /// Writes the positions of `nodes` among `points`, `[points × space]`, relative to the first of them into `x`,
    /// `[nodes × dimension]`.
    ///
    /// # Errors
    /// A cell of a surface or curve has no tangents.
    pub fn place(&mut self, table: &Tabulation, points: &[f64], nodes: &[usize], x: &mut [f64]) -> Result<(), Fault> {
        let (d, space) = (table.dimension, table.space);
        if self.frame.is_empty() {
            gather(points, d, nodes, x);
            from_first(d, x);
            return Ok(());
        }
        gather(points, space, nodes, &mut self.spatial);
        from_first(space, &mut self.spatial);
        self.set_frame(table)?;
        for (local, at) in x.chunks_exact_mut(d).zip(self.spatial.chunks_exact(space)) {
            for (local, e) in local.iter_mut().zip(self.frame.chunks_exact(space)) {
                *local = e.iter().zip(at).map(|(e, x)| e * x).sum();
            }
        }
        Ok(())
    }

    /// The mean tangents `Σ_q w_q ∂x/∂ξ_l`, made orthonormal.
    fn set_frame(&mut self, table: &Tabulation) -> Result<(), Fault> {
        let (d, space) = (table.dimension, table.space);
        for l in 0..d {
            let (done, rest) = self.frame.split_at_mut(l * space);
            let tangent = &mut rest[..space];
            tangent.fill(0.0);
            // Points without a weight, those of the volumetric rule alone, do not turn the plane.
            for (dn, w) in table.gradients.chunks_exact(table.nodes * d).zip(&table.weights) {
                for (dn, x) in dn.chunks_exact(d).zip(self.spatial.chunks_exact(space)) {
                    tangent.iter_mut().zip(x).for_each(|(t, x)| *t += w * dn[l] * x);
                }
            }
            let size = norm(tangent);
            for e in done.chunks_exact(space) {
                let along: f64 = e.iter().zip(&*tangent).map(|(e, t)| e * t).sum();
                tangent.iter_mut().zip(e).for_each(|(t, e)| *t -= along * e);
            }
            let left = norm(tangent);
            // What is left of a tangent then is the rounding of its projection.
            if left.is_nan() || left <= 1e-12 * size {
                return Err(Fault::Flat);
            }
            tangent.iter_mut().for_each(|t| *t /= left);
        }
        Ok(())
    }
}

/// Subtracts the first position from all.
fn from_first(dimension: usize, x: &mut [f64]) {
    let (first, rest) = x.split_at_mut(dimension);
    rest.chunks_exact_mut(dimension).for_each(|x| x.iter_mut().zip(&*first).for_each(|(x, o)| *x -= o));
    first.fill(0.0);
}

fn norm(vector: &[f64]) -> f64 {
    vector.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Copies the coordinates of `nodes` into `x`, `[nodes × dimension]`.
pub fn gather(points: &[f64], dimension: usize, nodes: &[usize], x: &mut [f64]) {
    of_dimension!(dimension, |D| gather_in::<D>(points, nodes, x))
}

/// The coordinates of `nodes`, `[nodes × dimension]`.
pub fn gathered(points: &[f64], dimension: usize, nodes: &[usize]) -> Vec<f64> {
    let mut x = vec![0.0; nodes.len() * dimension];
    gather(points, dimension, nodes, &mut x);
    x
}

fn gather_in<const D: usize>(points: &[f64], nodes: &[usize], x: &mut [f64]) {
    let points = points.as_chunks::<D>().0;
    x.as_chunks_mut::<D>().0.iter_mut().zip(nodes).for_each(|(x, &node)| *x = points[node]);
}
