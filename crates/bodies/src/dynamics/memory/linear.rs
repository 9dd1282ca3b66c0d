//! The memory of a linear model: Prony series of the forces of its shear part and of its bulk part.
//!
//! Theory: page *Springs that forget* of the book.

use super::decay::Decay;
use crate::error::{Error, ErrorKind, Result};
use crate::model::Entries;
use crate::springs::dot;
use faer::sparse::{SparseColMat, Triplet};

/// A part of the stiffness at rest, and the share of it that relaxes in each term.
#[derive(Debug, Clone)]
pub struct RelaxingPart {
    /// The lower triangle, entries at one position added.
    matrix: SparseColMat<usize, f64>,
    shares: Vec<f64>,
}

impl RelaxingPart {
    /// The part with these entries of the lower triangle, N/m, of `dofs` rows, and these shares, one for each term.
    ///
    /// # Errors
    /// The matrix does not fit into memory.
    pub fn new(entries: &Entries, dofs: usize, shares: Vec<f64>) -> Result<RelaxingPart> {
        // Cells of other regions have zeros.
        let own = entries.iter().filter(|e| e.val != 0.0);
        let lower: Vec<_> = own.map(|e| Triplet::new(e.row.max(e.col), e.row.min(e.col), e.val)).collect();
        let matrix = SparseColMat::try_new_from_triplets(dofs, dofs, &lower).map_err(|e| {
            Error::new(format!("the stiffness matrix cannot be built: {e:?}")).of_kind(ErrorKind::Limit)
        })?;
        Ok(RelaxingPart { matrix, shares })
    }

    /// `K z`.
    fn product(&self, z: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; z.len()];
        let (starts, rows, values) = (self.matrix.col_ptr(), self.matrix.row_idx(), self.matrix.val());
        for (column, at) in starts.windows(2).enumerate() {
            let mut own = 0.0;
            for (&row, k) in rows[at[0]..at[1]].iter().zip(&values[at[0]..at[1]]) {
                own += k * z[row];
                if row != column {
                    // An entry beside the diagonal of the lower triangle stands for two.
                    product[row] += k * z[column];
                }
            }
            product[column] += own;
        }
        product
    }
}

/// Each term is a Maxwell element of the stiffness `A_i = Σ_parts g_i K`. Its dashpot has the displacement w_i, so that the model
/// `F₀ + K u` becomes
///
/// ```text
/// F = F₀ + K u − Σ_i A_i w_i        w_i ← e w_i + (1 − e) u_n + (1 − γ) (u − u_n)
/// ```
///
/// with `e = e^(−h/τ_i)`, `γ = (1 − e) τ_i/h`: the rule is exact for displacements that change linearly over the step. What pulls at rest, F₀,
/// does not relax.
#[derive(Debug, Clone)]
pub struct LinearMemory {
    times: Vec<f64>,
    parts: Vec<RelaxingPart>,
    /// u_n, m.
    displacement: Vec<f64>,
    /// w_i, m.
    creep: Vec<Vec<f64>>,
    decays: Vec<Decay>,
    dissipated: f64,
}

impl LinearMemory {
    /// The memory with these relaxation times, s, of parts of the stiffness with `dofs` rows.
    ///
    /// # Errors
    /// A part does not have one share for each time.
    pub fn new(times: Vec<f64>, parts: Vec<RelaxingPart>, dofs: usize) -> Result<LinearMemory> {
        if let Some(part) = parts.iter().find(|part| part.shares.len() != times.len() || part.matrix.nrows() != dofs) {
            let expected = format!("{} shares, one for each time, of a matrix of {dofs} rows", times.len());
            let found = format!("{} of {} rows", part.shares.len(), part.matrix.nrows());
            return Err(Error::expected("parts", expected, found));
        }
        let creep = vec![vec![0.0; dofs]; times.len()];
        let mut memory =
            LinearMemory { displacement: vec![0.0; dofs], creep, decays: Vec::new(), dissipated: 0.0, times, parts };
        memory.prepare(0.0);
        Ok(memory)
    }

    pub(super) fn dofs(&self) -> usize {
        self.displacement.len()
    }

    /// The number of numbers that are remembered.
    pub fn numbers(&self) -> usize {
        self.displacement.len() * (1 + self.creep.len())
    }

    pub(super) fn places(&self) -> Vec<(usize, usize)> {
        let of = |part: &RelaxingPart| -> Vec<(usize, usize)> {
            let (starts, rows) = (part.matrix.col_ptr(), part.matrix.row_idx());
            let column = |(column, at): (usize, &[usize])| -> Vec<(usize, usize)> {
                rows[at[0]..at[1]].iter().map(|&row| (row, column)).collect()
            };
            starts.windows(2).enumerate().flat_map(column).collect()
        };
        self.parts.iter().flat_map(of).collect()
    }

    pub(super) fn reset(&mut self, u: &[f64]) {
        self.displacement.copy_from_slice(u);
        self.creep.iter_mut().for_each(|w| w.fill(0.0));
        self.dissipated = 0.0;
        self.prepare(0.0);
    }

    pub(super) fn prepare(&mut self, step: f64) {
        self.decays = self.times.iter().map(|time| Decay::new(step, *time)).collect();
    }

    /// w_i at the end of a step to u, one degree of freedom after the other.
    fn crept<'a>(&'a self, term: usize, u: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let decay = self.decays[term];
        // `1 − e` by its own function, which keeps the digits of steps that are short beside τ.
        let (left, gone, late) = (decay.left, decay.gone(), 1.0 - decay.mean);
        let states = self.creep[term].iter().zip(&self.displacement).zip(u);
        states.map(move |((w, start), u)| left * w + gone * start + late * (u - start))
    }

    /// `Σ_i g_i w_i` of a part at the end of a step to u.
    fn relaxed(&self, part: &RelaxingPart, u: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; u.len()];
        // Each region has few of the terms of the body.
        for (term, share) in part.shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
            sum.iter_mut().zip(self.crept(term, u)).for_each(|(sum, w)| *sum += share * w);
        }
        sum
    }

    pub(super) fn add(&self, u: &[f64], force: &mut [f64], tangent: Option<&mut [f64]>) {
        for part in &self.parts {
            let lost = part.product(&self.relaxed(part, u));
            force.iter_mut().zip(lost).for_each(|(f, lost)| *f -= lost);
        }
        let Some(mut tangent) = tangent else { return };
        for part in &self.parts {
            let of_term = |(share, decay): (&f64, &Decay)| share * (1.0 - decay.mean);
            let lost: f64 = part.shares.iter().zip(&self.decays).map(of_term).sum();
            let values = part.matrix.val();
            let (own, others) = tangent.split_at_mut(values.len());
            own.iter_mut().zip(values).for_each(|(entry, k)| *entry = -lost * k);
            tangent = others;
        }
    }

    pub(super) fn advance(&mut self, u: &[f64]) {
        self.dissipated += self.dissipation(u);
        for term in 0..self.times.len() {
            self.creep[term] = self.crept(term, u).collect();
        }
        self.displacement.copy_from_slice(u);
    }

    /// What a step to u dissipates, J.
    fn dissipation(&self, u: &[f64]) -> f64 {
        // A jump takes no time, and a product with each part is saved.
        if self.decays.iter().all(|decay| decay.steps == 0.0) {
            return 0.0;
        }
        let change: Vec<f64> = u.iter().zip(&self.displacement).map(|(u, start)| u - start).collect();
        let mut sum = 0.0;
        for part in &self.parts {
            let of_change = part.product(&change);
            for ((share, decay), w) in part.shares.iter().zip(&self.decays).zip(&self.creep) {
                if *share > 0.0 {
                    let stretch: Vec<f64> = self.displacement.iter().zip(w).map(|(u, w)| u - w).collect();
                    let [own, both, other] = decay.dissipation();
                    let form = own * dot(&stretch, &part.product(&stretch))
                        + both * dot(&stretch, &of_change)
                        + other * dot(&change, &of_change);
                    // What is below zero is rounding: the form is positive semidefinite, as the matrix is.
                    sum += share * form.max(0.0);
                }
            }
        }
        sum
    }

    /// `Σ_i (½ w_i·A_i w_i − u·A_i w_i)`: with `½ u·K u` it is the energy of the springs of all branches.
    pub(super) fn stored(&self, u: &[f64]) -> f64 {
        let mut sum = 0.0;
        for part in &self.parts {
            for (term, share) in part.shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
                let w: Vec<f64> = self.crept(term, u).collect();
                let pull = part.product(&w);
                sum += share * (dot(&w, &pull) / 2.0 - dot(u, &pull));
            }
        }
        sum
    }

    pub(super) fn dissipated(&self) -> f64 {
        self.dissipated
    }
}
