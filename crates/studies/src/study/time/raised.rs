//! The shifted stiffness `K + σ M` of a model with masses lumped at its points.

use crate::dynamics::largest_square;
use crate::error::Result;
use crate::mesh::Mesh;
use crate::model::{Entries, Support};
use crate::solve::System;
use faer::sparse::Triplet;

/// A model releases energy if some ω² is negative by this share of the largest; less is rounding.
pub const RELEASE: f64 = 1e-9;

/// The equations for any σ, with one analysis of their pattern.
pub struct Raised<'a> {
    /// The entries of K, then the diagonal of σ M.
    entries: Entries,
    springs: usize,
    /// The masses of the degrees of freedom, kg.
    masses: Vec<f64>,
    support: &'a Support,
    mesh: &'a Mesh,
    system: Option<System>,
    /// An upper bound of the largest ω², rad²/s².
    pub largest: f64,
}

impl<'a> Raised<'a> {
    /// The equations of this K; `masses` are `[points]`, kg.
    pub fn new(mut entries: Entries, masses: &[f64], support: &'a Support, mesh: &'a Mesh) -> Raised<'a> {
        let masses: Vec<f64> = masses.iter().flat_map(|m| std::iter::repeat_n(*m, mesh.dimension)).collect();
        let held: Vec<bool> = (0..masses.len()).map(|dof| support.is_fixed(dof)).collect();
        let largest = largest_square(entries.iter().map(|e| (e.row, e.col, e.val)), &masses, &held);
        let springs = entries.len();
        entries.extend((0..masses.len()).map(|dof| Triplet::new(dof, dof, 0.0)));
        Raised { entries, springs, masses, support, mesh, system: None, largest }
    }

    /// The equations with this σ, rad²/s².
    ///
    /// # Errors
    /// They do not fit into memory.
    pub fn by(&mut self, shift: f64) -> Result<System> {
        self.entries[self.springs..].iter_mut().zip(&self.masses).for_each(|(entry, m)| entry.val = shift * m);
        match &self.system {
            Some(system) => system.renewed(&self.entries, self.support),
            None => {
                let system = System::new(&self.entries, self.support)?;
                let system = self.system.insert(system.placed(&self.mesh.points, self.mesh.dimension));
                system.renewed(&self.entries, self.support)
            }
        }
    }
}
