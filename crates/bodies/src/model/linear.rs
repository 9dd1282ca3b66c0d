//! A linear elastic model.

use super::{Elastic, Entries, Response};

/// The model `U = ½ uᵀ K u` with `u = x − X`: finite elements at small deformation, for simulations.
#[derive(Debug, Clone)]
pub struct LinearElastic<'a> {
    /// The positions at rest, `[points × dimension]`, m.
    pub points: &'a [f64],
    /// The entries of K, N/m.
    pub stiffness: Entries,
}

impl Elastic for LinearElastic<'_> {
    fn respond(&self, x: &[f64]) -> Option<Response> {
        let u: Vec<f64> = x.iter().zip(self.points).map(|(x, p)| x - p).collect();
        let mut force = vec![0.0; u.len()];
        for entry in &self.stiffness {
            force[entry.row] += entry.val * u[entry.col];
            if entry.row != entry.col {
                force[entry.col] += entry.val * u[entry.row];
            }
        }
        let energy = 0.5 * u.iter().zip(&force).map(|(u, f)| u * f).sum::<f64>();
        Some(Response { energy, force, tangent: self.stiffness.clone() })
    }
}
