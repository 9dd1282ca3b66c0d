//! The spectral problem of one element in `f64`, for the refinement of an optimum that is nearly known.

use super::Spectral;
use crate::fit::dense::{factorize, solve};
use crate::fit::jacobi::eigenvectors;
use crate::fit::reduction::Reduced;
use crate::scalar::Real;
use nalgebra::{DMatrix, DVector, DVectorView};

/// The rounding error of sums of this many terms.
const ROUNDINGS: f64 = 4.0;

/// The matrix function `E(κ) = R̂ − Σ_I κ_I Σ_{s∈I} h_s h_sᵀ`.
pub struct Problem<'a> {
    pub r: DMatrix<f64>,
    /// The h_s, one column per spring, `[order × springs]`.
    pub h: DMatrix<f64>,
    /// The unknown of each spring.
    pub unknowns: &'a [usize],
    pub nonnegative: bool,
    /// The factors of the Gram matrix of the matrices of the unknowns.
    gram: Vec<f64>,
    pivots: Vec<f64>,
    /// The spectrum of E where the barrier method ended, in `f64`.
    pub spectrum: Spectrum,
    /// The relative rounding error of R̂.
    rounding: f64,
}

/// Eigenvalues in decreasing order, and the eigenvectors, column by column.
#[derive(Clone)]
pub struct Spectrum {
    pub values: DVector<f64>,
    pub vectors: DMatrix<f64>,
}

impl Spectrum {
    fn new(p: usize, value: impl Fn(usize) -> f64, entry: impl Fn(usize, usize) -> f64) -> Spectrum {
        let mut order: Vec<usize> = (0..p).collect();
        // Active eigenvalues are at both ends of the order, where they are ranges.
        order.sort_by(|&i, &j| value(j).total_cmp(&value(i)));
        let values = DVector::from_fn(p, |i, _| value(order[i]));
        Spectrum { values, vectors: DMatrix::from_fn(p, p, |k, i| entry(order[i], k)) }
    }
}

/// The best known point, its value and a lower bound.
#[derive(Debug, Clone)]
pub struct Optimum {
    /// `[unknowns]`.
    pub kappa: Vec<f64>,
    /// `‖E(κ)‖₂` is at most this.
    pub value: f64,
    /// No κ reaches less than this.
    pub bound: f64,
}

impl<'a> Problem<'a> {
    /// The problem in the lane that `lane` reads, for which `solver` has been run. The rounding error of R̂ grows by
    /// the inverse `quality`, the ratio of its Jacobian determinant to the product of the lengths of its columns, and
    /// by the inverse softness of the softest motion if the weight divides by R.
    pub fn of<T: Real>(
        reduced: &'a Reduced<T>,
        solver: &Spectral<T>,
        lane: impl Fn(&T) -> f64,
        quality: f64,
    ) -> Problem<'a> {
        let (p, c) = (reduced.order, reduced.scales.len());
        let all = |values: &[T]| -> Vec<f64> { values.iter().map(&lane).collect() };
        Problem {
            spectrum: Spectrum::new(
                p,
                |i| lane(&solver.eigenvalues[i * p + i]),
                |i, j| lane(&solver.eigenvectors[i * p + j]),
            ),
            r: DMatrix::from_vec(p, p, all(&reduced.stiffness[..p * p])),
            h: DMatrix::from_vec(p, reduced.unknowns.len(), all(reduced.rows())),
            unknowns: &reduced.unknowns,
            nonnegative: solver.nonnegative,
            gram: all(&solver.gram[..c * c]),
            pivots: all(&solver.gram_pivots),
            // The worse of the two causes decides.
            rounding: ROUNDINGS * f64::EPSILON / quality.min(lane(&reduced.softest)),
        }
    }

    pub fn order(&self) -> usize {
        self.r.nrows()
    }

    pub fn unknown_count(&self) -> usize {
        self.pivots.len()
    }

    /// The matrix `Σ_{s∈I} h_s h_sᵀ` of each unknown.
    pub fn matrices(&self) -> Vec<DMatrix<f64>> {
        let mut matrices = vec![DMatrix::zeros(self.order(), self.order()); self.unknown_count()];
        for (h, &unknown) in self.h.column_iter().zip(self.unknowns) {
            matrices[unknown].ger(1.0, &h, &h, 1.0);
        }
        matrices
    }

    pub fn error(&self, kappa: &[f64]) -> DMatrix<f64> {
        let mut e = self.r.clone();
        for (h, &unknown) in self.h.column_iter().zip(self.unknowns) {
            e.ger(-kappa[unknown], &h, &h, 1.0);
        }
        e
    }

    pub fn spectrum(&self, kappa: &[f64]) -> Spectrum {
        let p = self.order();
        let (mut e, mut vectors) = (self.error(kappa), vec![0.0; p * p]);
        eigenvectors(e.as_mut_slice(), p, &mut vectors);
        Spectrum::new(p, |i| e[(i, i)], |i, k| vectors[i * p + k])
    }

    /// Whether `‖E(κ)‖₂ < t`, by the pivots of `tI ± E`.
    pub fn reaches(&self, kappa: &[f64], t: f64) -> bool {
        let p = self.order();
        let (e, mut pivots) = (self.error(kappa), vec![0.0; p]);
        [-1.0, 1.0].into_iter().all(|sign| {
            let mut side = &e * sign;
            (0..p).for_each(|i| side[(i, i)] += t);
            factorize(side.as_mut_slice(), p, 0.0, &mut pivots) > 0.0
        })
    }

    /// The rounding error of the eigenvalues of `E(κ)`.
    pub fn rounding(&self, kappa: &[f64]) -> f64 {
        let springs = self.h.column_iter().zip(self.unknowns).map(|(h, &i)| kappa[i].abs() * h.norm_squared());
        self.rounding * (self.r.trace() + springs.sum::<f64>())
    }

    /// The lower bound `⟨R̂, Z⟩/(tr X + tr Y)` of the pair of positive semidefinite X and Y, with `Z = X − Y`, after
    /// they are corrected for the remainder of `⟨h_s h_sᵀ, Z⟩`.
    pub fn bound(&self, x: &DMatrix<f64>, y: &DMatrix<f64>) -> f64 {
        let z = x - y;
        let form = |a: &DMatrix<f64>, h: &DVectorView<f64>| h.dot(&(a * h));
        let mut moved = vec![0.0; self.unknown_count()];
        for (h, &unknown) in self.h.column_iter().zip(self.unknowns) {
            moved[unknown] += form(&z, &h);
        }
        // Where no constant is negative these products may be: the bound holds all the same.
        if self.nonnegative {
            moved.iter_mut().for_each(|entry| *entry = entry.max(0.0));
        }
        solve(&self.gram, moved.len(), &self.pivots, &mut moved);
        let (mut value, mut size) = (self.r.dot(&z), x.trace() + y.trace());
        for (h, &unknown) in self.h.column_iter().zip(self.unknowns) {
            value -= moved[unknown] * form(&self.r, &h);
            size += moved[unknown].abs() * h.norm_squared();
        }
        // What rounding of R̂ may have added is taken off: the bound must not be above what is proved.
        (value / size - self.rounding * self.r.trace()).max(0.0)
    }
}
