//! A model linearised at rest.

use super::limit::{largest_square, largest_square_of_blocks};
use super::memory::Memory;
use crate::error::{Error, ErrorKind, Result};
use crate::model::{BlockStiffness, Elastic, Entries};
use faer::sparse::{SparseColMat, Triplet};

/// `F ≈ F₀ + K₀ u`.
#[derive(Debug)]
pub(super) struct Rest {
    /// The energy at rest, J: springs of rest length zero have some.
    pub energy: f64,
    /// F₀, N: the forces of springs that pull at rest.
    pub force: Vec<f64>,
    tangent: Tangent,
}

/// K₀ on all degrees of freedom.
#[derive(Debug)]
enum Tangent {
    /// Its entries, as equations are made of, and both triangles of the matrix.
    Entries {
        entries: Entries,
        values: Vec<f64>,
        matrix: SparseColMat<usize, f64>,
    },
    Blocks(BlockStiffness),
}

impl Rest {
    /// Linearises the model at `points`, with what its memory adds against a sudden strain; with its entries if equations are to be solved.
    ///
    /// # Errors
    /// The model has no response at rest, or K₀ does not fit into memory.
    pub fn new(model: &dyn Elastic, points: &[f64], memory: Option<&Memory>, has_equations: bool) -> Result<Rest> {
        let none = || Error::expected("model", "a response at rest", "none").of_kind(ErrorKind::Infeasible);
        let sound = |energy: f64, force: &[f64]| energy.is_finite() && force.iter().all(|f| f.is_finite());
        let energy = model.energy(points).ok_or_else(none)?;
        // An explicit method asks for products and the highest frequency alone: blocks of points take less memory than
        // entries.
        if let Some(blocks) = (!has_equations && memory.is_none()).then(|| model.blocks(points)).flatten() {
            let mut force = vec![0.0; points.len()];
            if !model.forces(points, &mut force) {
                return Err(none());
            }
            let rest = Rest { energy, force, tangent: Tangent::Blocks(blocks) };
            return if sound(energy, &rest.force) { Ok(rest) } else { Err(none()) };
        }
        let mut response = model.respond(points).ok_or_else(none)?;
        let mut energy = energy;
        if let Some(memory) = memory {
            let (places, still) = (memory.places(), vec![0.0; points.len()]);
            let mut values = vec![0.0; places.len()];
            memory.add(&still, &mut response.force, Some(&mut values)).ok_or_else(none)?;
            energy += memory.stored(&still).ok_or_else(none)?;
            let added = places.into_iter().zip(values).map(|((row, column), value)| Triplet::new(row, column, value));
            response.tangent.extend(added);
        }
        if !sound(energy, &response.force) {
            return Err(none());
        }
        let entries = response.tangent;
        let values = entries.iter().map(|e| e.val).collect();
        let mirrored = entries.iter().filter(|e| e.row != e.col).map(|e| Triplet::new(e.col, e.row, e.val));
        let both: Entries = entries.iter().copied().chain(mirrored).collect();
        let matrix = SparseColMat::try_new_from_triplets(points.len(), points.len(), &both).map_err(|e| {
            Error::new(format!("the stiffness matrix cannot be built: {e:?}")).of_kind(ErrorKind::Limit)
        })?;
        let tangent = Tangent::Entries { entries, values, matrix };
        Ok(Rest { energy, force: response.force, tangent })
    }

    /// The entries of K₀ that equations are made of; none for methods without equations.
    pub fn entries(&self) -> &[Triplet<usize, usize, f64>] {
        match &self.tangent {
            Tangent::Entries { entries, .. } => entries,
            Tangent::Blocks(_) => &[],
        }
    }

    /// The values of these entries.
    pub fn values(&self) -> &[f64] {
        match &self.tangent {
            Tangent::Entries { values, .. } => values,
            Tangent::Blocks(_) => &[],
        }
    }

    /// An upper bound of the largest ω² of `K₀ φ = ω² M φ` on the free degrees of freedom, rad²/s².
    pub fn largest_square(&self, masses: &[f64], held: &[bool]) -> f64 {
        match &self.tangent {
            Tangent::Entries { entries, .. } => {
                largest_square(entries.iter().map(|e| (e.row, e.col, e.val)), masses, held)
            }
            Tangent::Blocks(blocks) => largest_square_of_blocks(blocks, masses, held),
        }
    }

    /// Adds `factor · K₀ x` to y.
    pub fn add_product(&self, factor: f64, x: &[f64], y: &mut [f64]) {
        let matrix = match &self.tangent {
            Tangent::Entries { matrix, .. } => matrix,
            Tangent::Blocks(blocks) => {
                return y.iter_mut().zip(blocks.apply(x)).for_each(|(y, product)| *y += factor * product);
            }
        };
        // K₀ is symmetric: its columns are its rows.
        let (starts, rows, values) = (matrix.col_ptr(), matrix.row_idx(), matrix.val());
        for (y, at) in y.iter_mut().zip(starts.windows(2)) {
            let (rows, values) = (&rows[at[0]..at[1]], &values[at[0]..at[1]]);
            *y += factor * rows.iter().zip(values).map(|(&row, k)| k * x[row]).sum::<f64>();
        }
    }

    /// Writes `F₀ + K₀ u` into `force` and returns the energy beyond that at rest, `F₀·u + ½ uᵀ K₀ u`.
    pub fn refill(&self, u: &[f64], force: &mut [f64]) -> f64 {
        force.copy_from_slice(&self.force);
        self.add_product(1.0, u, force);
        // `F₀ + F` is `2 F₀ + K₀ u`: no second product is needed.
        0.5 * self.force.iter().zip(&*force).zip(u).map(|((a, b), u)| (a + b) * u).sum::<f64>()
    }
}
