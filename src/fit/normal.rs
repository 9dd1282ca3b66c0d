//! Normal equations `M k = b` of a least-squares fit: assembly by groups and solution.

use nalgebra::{DMatrix, DVector};

/// A pivot below this fraction of its diagonal entry counts as zero. Rounding leaves about
/// m·10⁻¹⁶; what lies between is solved and the digits are lost that the condition costs.
const RANK: f64 = 1e-13;

/// `M`, row by row, and `b`.
#[derive(Debug, Clone, Default)]
pub struct Normal {
    pub gram: Vec<f64>,
    pub rhs: Vec<f64>,
    /// Room for the edge vectors `x_j − x_i` of the length springs, `[springs × dimension]`.
    pub(super) edges: Vec<f64>,
    /// Room for their inverse squares, `[springs]`.
    pub(super) inverse_squares: Vec<f64>,
    pivots: Vec<f64>,
}

/// How the constants were determined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rank {
    Full,
    /// The springs are linearly dependent under this objective; of all optima the one of least norm was taken, in
    /// the scaling in which `M` has a unit diagonal.
    Deficient,
}

impl Normal {
    pub fn new(gram: Vec<f64>, rhs: Vec<f64>) -> Normal {
        Normal { gram, rhs, ..Normal::default() }
    }

    pub fn resize(&mut self, m: usize) {
        self.gram.resize(m * m, 0.0);
        self.rhs.resize(m, 0.0);
    }

    pub fn size(&self) -> usize {
        self.rhs.len()
    }

    /// The equations of one constant per group: `M_IJ = Σ_{s∈I, t∈J} M_st`, `b_I = Σ_{s∈I} b_s`.
    pub fn tied(&self, groups: &[usize], count: usize) -> Normal {
        let m = self.size();
        let mut tied = Normal::new(vec![0.0; count * count], vec![0.0; count]);
        for (s, &i) in groups.iter().enumerate() {
            tied.rhs[i] += self.rhs[s];
            for (t, &j) in groups.iter().enumerate() {
                tied.gram[i * count + j] += self.gram[s * m + t];
            }
        }
        tied
    }

    /// The equations of the springs `set` alone.
    pub fn restricted(&self, set: &[usize]) -> Normal {
        let m = self.size();
        let entries = set.iter().flat_map(|&s| set.iter().map(move |&t| s * m + t));
        Normal::new(entries.map(|st| self.gram[st]).collect(), set.iter().map(|&s| self.rhs[s]).collect())
    }

    /// `½ kᵀ M k − bᵀ k`'s gradient `M k − b`.
    pub fn gradient(&self, k: &[f64]) -> Vec<f64> {
        let rows = self.gram.chunks_exact(self.size());
        rows.zip(&self.rhs).map(|(row, b)| row.iter().zip(k).map(|(m, k)| m * k).sum::<f64>() - b).collect()
    }

    /// Solves `M k = b`, overwriting both; `k` is left in `rhs`.
    pub fn solve(&mut self) -> Rank {
        let m = self.size();
        self.pivots.resize(m, 0.0);
        // A size known at compile time unrolls the loops of the small systems, where they are most of the work.
        let regular = match m {
            3 => self.factorize(3),
            6 => self.factorize(6),
            _ => self.factorize(m),
        };
        if regular {
            return Rank::Full;
        }
        let scale: Vec<f64> = (0..m).map(|s| 1.0 / self.gram[s * m + s].sqrt()).collect();
        least_norm(&self.gram, &scale, &mut self.rhs);
        Rank::Deficient
    }

    /// `M = L D Lᵀ`, with L in the strict lower triangle, then `b ← M⁻¹ b`. Returns false, with the upper triangle and
    /// diagonal of `M` and `b` as they were, if a pivot vanishes.
    ///
    /// No scaling is needed: each pivot and its diagonal entry scale alike.
    #[inline(always)]
    fn factorize(&mut self, m: usize) -> bool {
        let (gram, rhs, inverse) = (&mut self.gram[..m * m], &mut self.rhs[..m], &mut self.pivots[..m]);
        for s in 0..m {
            // L_st = (M_st − Σ_{r<t} L_sr D_r L_tr)/D_t; the row holds L_sr D_r until its pivot is known.
            for t in 1..s {
                for r in 0..t {
                    gram[s * m + t] -= gram[s * m + r] * gram[t * m + r];
                }
            }
            let mut pivot = gram[s * m + s];
            for t in 0..s {
                let scaled = gram[s * m + t];
                gram[s * m + t] *= inverse[t];
                pivot -= scaled * gram[s * m + t];
            }
            if !(pivot > RANK * gram[s * m + s]) {
                return false;
            }
            inverse[s] = 1.0 / pivot;
        }
        for s in 1..m {
            for t in 0..s {
                rhs[s] -= gram[s * m + t] * rhs[t];
            }
        }
        rhs.iter_mut().zip(&*inverse).for_each(|(b, d)| *b *= d);
        for s in (1..m).rev() {
            for t in 0..s {
                rhs[t] -= gram[s * m + t] * rhs[s];
            }
        }
        true
    }
}

/// The solution of least `Σ (k_s/scale_s)²`, from the eigenvectors of the matrix scaled to a unit diagonal; the upper
/// triangle and diagonal of `M` are given.
fn least_norm(gram: &[f64], scale: &[f64], rhs: &mut [f64]) {
    let m = rhs.len();
    let entry = |s: usize, t: usize| gram[s.min(t) * m + s.max(t)] * scale[s] * scale[t];
    let eigen = DMatrix::from_fn(m, m, entry).symmetric_eigen();
    let b = DVector::from_fn(m, |s, _| rhs[s] * scale[s]);
    let largest = eigen.eigenvalues.amax();
    let mut coefficients = eigen.eigenvectors.tr_mul(&b);
    for (c, &value) in coefficients.iter_mut().zip(&eigen.eigenvalues) {
        *c = if value > RANK * largest { *c / value } else { 0.0 };
    }
    let k = &eigen.eigenvectors * coefficients;
    for s in 0..m {
        rhs[s] = k[s] * scale[s];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `k = (1, 2)` for a regular matrix, `(1, 1)` where only the sum of the two is determined.
    #[test]
    fn solves_and_tells_the_rank() {
        let mut regular = Normal::new(vec![4.0, 1.0, 1.0, 3.0], vec![6.0, 7.0]);
        assert_eq!(regular.solve(), Rank::Full);
        assert!((regular.rhs[0] - 1.0).abs() < 1e-15 && (regular.rhs[1] - 2.0).abs() < 1e-15);
        let mut singular = Normal::new(vec![4.0; 4], vec![8.0; 2]);
        assert_eq!(singular.solve(), Rank::Deficient);
        assert!(singular.rhs.iter().all(|k| (k - 1.0).abs() < 1e-14));
    }
}
