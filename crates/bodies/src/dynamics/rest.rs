//! A model linearised at rest.

use crate::error::{Error, ErrorKind, Result};
use crate::model::{Elastic, Entries};
use faer::sparse::{SparseColMat, Triplet};

/// `F ≈ F₀ + K₀ u`.
#[derive(Debug)]
pub(super) struct Rest {
    /// The energy at rest, J.
    pub energy: f64,
    /// F₀, N: the forces of springs that pull at rest.
    pub force: Vec<f64>,
    pub entries: Entries,
    /// The values of the entries.
    pub values: Vec<f64>,
    /// K₀ on all degrees of freedom, both triangles.
    matrix: SparseColMat<usize, f64>,
}

impl Rest {
    /// Linearises the model at `points`.
    ///
    /// # Errors
    /// The model has no response at rest, or K₀ does not fit into memory.
    pub fn new(model: &dyn Elastic, points: &[f64]) -> Result<Rest> {
        let none = || Error::expected("model", "a response at rest", "none").of_kind(ErrorKind::Infeasible);
        let response = model.respond(points).ok_or_else(none)?;
        if !(response.energy.is_finite() && response.force.iter().all(|f| f.is_finite())) {
            return Err(none());
        }
        let entries = response.tangent;
        let values = entries.iter().map(|e| e.val).collect();
        let mirrored = entries.iter().filter(|e| e.row != e.col).map(|e| Triplet::new(e.col, e.row, e.val));
        let both: Entries = entries.iter().copied().chain(mirrored).collect();
        let matrix = SparseColMat::try_new_from_triplets(points.len(), points.len(), &both).map_err(|e| {
            Error::new(format!("the stiffness matrix cannot be built: {e:?}")).of_kind(ErrorKind::Limit)
        })?;
        Ok(Rest { energy: response.energy, force: response.force, entries, values, matrix })
    }

    /// Adds `factor · K₀ x` to y.
    pub fn add_product(&self, factor: f64, x: &[f64], y: &mut [f64]) {
        // K₀ is symmetric: its columns are its rows.
        let (starts, rows, values) = (self.matrix.col_ptr(), self.matrix.row_idx(), self.matrix.val());
        for (y, at) in y.iter_mut().zip(starts.windows(2)) {
            let (rows, values) = (&rows[at[0]..at[1]], &values[at[0]..at[1]]);
            *y += factor * rows.iter().zip(values).map(|(&row, k)| k * x[row]).sum::<f64>();
        }
    }

    /// Writes `F₀ + K₀ u` into `force` and returns the energy `U₀ + F₀·u + ½ uᵀ K₀ u`.
    pub fn refill(&self, u: &[f64], force: &mut [f64]) -> f64 {
        force.copy_from_slice(&self.force);
        self.add_product(1.0, u, force);
        self.energy + 0.5 * self.force.iter().zip(&*force).zip(u).map(|((a, b), u)| (a + b) * u).sum::<f64>()
    }
}
