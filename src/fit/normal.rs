//! Normal equations `M k = b` of a least-squares fit: assembly by groups and solution.

use nalgebra::{DMatrix, DVector};

/// A pivot below this fraction of its (equilibrated, unit) diagonal entry counts as zero. Rounding leaves about
/// m·10⁻¹⁶; what lies between is solved and the digits are lost that the condition costs.
const RANK: f64 = 1e-13;

/// `M`, row by row, and `b`.
#[derive(Debug, Clone, Default)]
pub struct Normal {
    pub gram: Vec<f64>,
    pub rhs: Vec<f64>,
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
        let mut tied = Normal { gram: vec![0.0; count * count], rhs: vec![0.0; count] };
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
        Normal {
            gram: set.iter().flat_map(|&s| set.iter().map(move |&t| s * m + t)).map(|st| self.gram[st]).collect(),
            rhs: set.iter().map(|&s| self.rhs[s]).collect(),
        }
    }

    /// `½ kᵀ M k − bᵀ k`'s gradient `M k − b`.
    pub fn gradient(&self, k: &[f64]) -> Vec<f64> {
        let rows = self.gram.chunks_exact(self.size());
        rows.zip(&self.rhs).map(|(row, b)| row.iter().zip(k).map(|(m, k)| m * k).sum::<f64>() - b).collect()
    }

    /// Solves `M k = b`, overwriting both; `k` is left in `rhs`.
    pub fn solve(&mut self) -> Rank {
        let m = self.size();
        let scale: Vec<f64> = (0..m).map(|s| 1.0 / self.gram[s * m + s].sqrt()).collect();
        for s in 0..m {
            self.rhs[s] *= scale[s];
            for t in 0..m {
                self.gram[s * m + t] *= scale[s] * scale[t];
            }
        }
        let rank = if ldlt(&mut self.gram, &mut self.rhs) {
            Rank::Full
        } else {
            least_norm(&self.gram, &mut self.rhs);
            Rank::Deficient
        };
        self.rhs.iter_mut().zip(&scale).for_each(|(k, s)| *k *= s);
        rank
    }
}

/// `M = L D Lᵀ` in the strict lower triangle, then `b ← M⁻¹ b`. Returns false, with the upper triangle and the
/// unit diagonal of `M` and `b` as they were, if a pivot vanishes.
fn ldlt(gram: &mut [f64], rhs: &mut [f64]) -> bool {
    let m = rhs.len();
    let mut pivots = [0.0; 64];
    let mut long;
    let pivots = if m <= 64 {
        &mut pivots[..m]
    } else {
        long = vec![0.0; m];
        &mut long[..]
    };
    for s in 0..m {
        let (above, row) = gram.split_at_mut(s * m);
        // L_st = (M_st − Σ_{r<t} L_sr D_r L_tr)/D_t; the row holds L_sr D_r until its pivot is known.
        for t in 0..s {
            let other = &above[t * m..t * m + t];
            let dot: f64 = row[..t].iter().zip(other).map(|(a, b)| a * b).sum();
            row[t] -= dot;
        }
        let mut pivot = row[s];
        for t in 0..s {
            let scaled = row[t];
            row[t] = scaled / pivots[t];
            pivot -= scaled * row[t];
        }
        if !(pivot > RANK) {
            return false;
        }
        pivots[s] = pivot;
    }
    for s in 0..m {
        let dot: f64 = gram[s * m..s * m + s].iter().zip(&*rhs).map(|(l, b)| l * b).sum();
        rhs[s] -= dot;
    }
    rhs.iter_mut().zip(&*pivots).for_each(|(b, d)| *b /= d);
    for s in (0..m).rev() {
        let k = rhs[s];
        for (b, l) in rhs[..s].iter_mut().zip(&gram[s * m..s * m + s]) {
            *b -= l * k;
        }
    }
    true
}

/// The minimum-norm solution, from the eigenvectors of `M`, whose upper triangle and diagonal are given.
fn least_norm(gram: &[f64], rhs: &mut [f64]) {
    let m = rhs.len();
    let eigen = DMatrix::from_fn(m, m, |s, t| gram[s.min(t) * m + s.max(t)]).symmetric_eigen();
    let b = DVector::from_column_slice(rhs);
    let largest = eigen.eigenvalues.amax();
    let mut coefficients = eigen.eigenvectors.tr_mul(&b);
    for (c, &value) in coefficients.iter_mut().zip(&eigen.eigenvalues) {
        *c = if value > RANK * largest { *c / value } else { 0.0 };
    }
    rhs.copy_from_slice((&eigen.eigenvectors * coefficients).as_slice());
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `k = (1, 2)` for a regular matrix, `(1, 1)` where only the sum of the two is determined.
    #[test]
    fn solves_and_tells_the_rank() {
        let mut regular = Normal { gram: vec![4.0, 1.0, 1.0, 3.0], rhs: vec![6.0, 7.0] };
        assert_eq!(regular.solve(), Rank::Full);
        assert!((regular.rhs[0] - 1.0).abs() < 1e-15 && (regular.rhs[1] - 2.0).abs() < 1e-15);
        let mut singular = Normal { gram: vec![4.0; 4], rhs: vec![8.0; 2] };
        assert_eq!(singular.solve(), Rank::Deficient);
        assert!(singular.rhs.iter().all(|k| (k - 1.0).abs() < 1e-14));
    }
}
