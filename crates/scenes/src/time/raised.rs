//! The shifted stiffness `K + σ M` of a model.

use crate::dynamics::largest_square;
use crate::error::Result;
use crate::model::{Entries, Support};
use crate::solve::{Masses, System};
use faer::sparse::Triplet;

/// A model releases energy if some ω² is negative by this share of the largest; less is rounding.
// The sums of a stiffness are rounded by some 1e-15 of the largest entry, and the factor of a large body by some hundred times that.
pub const RELEASE: f64 = 1e-9;

/// The equations for any σ, with one analysis of their pattern.
pub struct Raised<'a> {
    /// The entries of K, then those of σ M.
    entries: Entries,
    springs: usize,
    /// The entries of M, kg, in this order.
    masses: Vec<f64>,
    support: &'a Support,
    /// The positions of the points, and their dimension.
    at: (&'a [f64], usize),
    system: Option<System>,
    /// An upper bound of the largest ω² with the diagonal of M, rad²/s².
    pub largest: f64,
}

impl<'a> Raised<'a> {
    /// The equations of this K with these masses.
    pub fn new<'m>(
        mut entries: Entries,
        masses: impl Into<Masses<'m>>,
        support: &'a Support,
        at: (&'a [f64], usize),
    ) -> Raised<'a> {
        let (d, masses) = (at.1, masses.into());
        let diagonal: Vec<f64> = masses.diagonal().iter().flat_map(|m| std::iter::repeat_n(*m, d)).collect();
        let held: Vec<bool> = (0..diagonal.len()).map(|dof| support.is_fixed(dof)).collect();
        let largest = largest_square(entries.iter().map(|e| (e.row, e.col, e.val)), &diagonal, &held);
        let springs = entries.len();
        let mut values = Vec::new();
        // The entries of K have each pair of different degrees of freedom once.
        for (a, b, mass) in masses.entries().into_iter().filter(|(a, b, _)| a >= b) {
            // Zeros keep the places of the masses, so that one pattern serves every shift.
            entries.extend((0..d).map(|k| Triplet::new(a * d + k, b * d + k, 0.0)));
            values.extend(std::iter::repeat_n(mass, d));
        }
        Raised { entries, springs, masses: values, support, at, system: None, largest }
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
                let system = self.system.insert(system.placed(self.at.0, self.at.1));
                system.renewed(&self.entries, self.support)
            }
        }
    }
}
