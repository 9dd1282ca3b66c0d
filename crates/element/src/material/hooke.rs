//! Hooke's law `σ = D ε` of a cell: isotropic, or with a stiffness of its own.

use super::Moduli;
use crate::error::{Error, ErrorKind, Result};
use crate::scalar::Scalar;
use nalgebra::DMatrix;
use std::sync::Arc;

/// The linear law of a cell in the dimensions of the body. Copies share their numbers.
#[derive(Debug, Clone, PartialEq)]
pub enum Hooke<C = f64> {
    /// `σ = λ tr(ε) I + 2μ ε`.
    Isotropic(Moduli<C>),
    /// `σ = D ε` of any symmetric D.
    Anisotropic(Stiffness<C>),
}

/// D in Voigt's notation: strains xx, yy, zz, 2 yz, 2 xz, 2 xy in space; xx, yy, 2 xy in the plane; xx of a rod.
#[derive(Debug, Clone, PartialEq)]
pub struct Stiffness<C = f64> {
    dimension: usize,
    /// `[strains × strains]`, Pa; in two dimensions multiplied by the thickness, in N/m, for a rod by its cross-section, in N.
    entries: Arc<[C]>,
    /// λ of the isotropic D that is nearest: the part that elements with a rule of their own for changes of volume integrate by it.
    lambda: C,
}

/// Voigt's number of the strain in the directions k and l.
pub const fn voigt(dimension: usize, k: usize, l: usize) -> usize {
    match (dimension, k == l) {
        (_, true) => k,
        // yz, xz, xy: the direction that is missing.
        // Shears are numbered 3, 4 and 5, and two directions add up to 3 less the one that is missing.
        (3, false) => 6 - k - l,
        (_, false) => 2,
    }
}

/// The number of strains in so many dimensions.
pub const fn strains(dimension: usize) -> usize {
    dimension * (dimension + 1) / 2
}

/// The difference of entries above and below the diagonal that is rounding, relative to the largest entry. Matrices
/// that other programs have inverted or turned differ by that much.
const SYMMETRIC: f64 = 1e-9;
/// The least eigenvalue relative to the largest that is not rounding.
// Eigenvalues of six rows are known to some 1e-15 of the largest. The rest is for entries that other programs have rounded as they
// inverted a compliance.
const LEAST: f64 = 1e-12;

impl Stiffness {
    /// D of a body of this dimension, `[strains × strains]`, proved symmetric and positive definite.
    ///
    /// # Errors
    /// The number of entries is wrong, or D is not finite, not symmetric or not positive definite; the error has the eigenvalue, in
    /// Kelvin's notation, in which shear strains have √2 instead of 2.
    pub fn new(dimension: usize, entries: &[f64]) -> Result<Stiffness> {
        let s = strains(dimension);
        if !(1..=3).contains(&dimension) || entries.len() != s * s {
            return Err(Error::expected(
                "stiffness",
                format!("{s} rows of {s} numbers"),
                format!("{} numbers", entries.len()),
            ));
        }
        if let Some(found) = entries.iter().find(|entry| !entry.is_finite()) {
            return Err(Error::expected("stiffness", "finite numbers", found));
        }
        let size = entries.iter().fold(0.0, |a: f64, d| a.max(d.abs()));
        let pairs = (0..s).flat_map(|i| (0..i).map(move |j| (i, j)));
        for (i, j) in pairs {
            let [below, above] = [entries[i * s + j], entries[j * s + i]];
            if (below - above).abs() > SYMMETRIC * size {
                let found = format!("{below:e} and {above:e} in row {} and column {}", i + 1, j + 1);
                return Err(Error::expected("stiffness", "a symmetric matrix", found));
            }
        }
        // Both halves differ by the rounding of the file; their mean is symmetric to the last bit, as the assembly of
        // one half supposes.
        let mean: Vec<f64> = (0..s * s).map(|e| (entries[e] + entries[e % s * s + e / s]) / 2.0).collect();
        let stiffness = Stiffness { dimension, lambda: nearest_lambda(dimension, &mean), entries: mean.into() };
        // Voigt's shears are twice those of the tensor: its eigenvalues would depend on the axes.
        let eigenvalues = stiffness.kelvin().symmetric_eigenvalues();
        let (least, largest) = (eigenvalues.min(), eigenvalues.max());
        if !(least > LEAST * largest) {
            let expected = "a positive definite matrix: every strain must have an energy above zero";
            let found = format!("the eigenvalue {least:.6e} Pa beside {largest:.6e} Pa");
            return Err(Error::expected("stiffness", expected, found).of_kind(ErrorKind::Infeasible));
        }
        Ok(stiffness)
    }

    /// D in Kelvin's notation, with the strains xx, yy, (zz,) and √2 times yz, (xz, xy): its norms are those of the tensor.
    pub fn kelvin(&self) -> DMatrix<f64> {
        let s = strains(self.dimension);
        let scale = |i: usize| if i < self.dimension { 1.0 } else { f64::sqrt(2.0) };
        DMatrix::from_fn(s, s, |i, j| scale(i) * scale(j) * self.entries[i * s + j])
    }

    /// The numbers that tell this law from others.
    pub fn bits(&self) -> Vec<u64> {
        self.entries.iter().map(|entry| entry.to_bits()).collect()
    }

    /// Converts the stiffness to numbers of the kind of `any`.
    pub fn of_kind<T: Scalar<Constant = f64>>(&self, any: &T) -> Stiffness<T> {
        let entries = self.entries.iter().map(|entry| any.constant(entry)).collect();
        Stiffness { dimension: self.dimension, entries, lambda: any.constant(&self.lambda) }
    }
}

impl<C> Stiffness<C> {
    /// D from its entries, of other numbers for each of several cells.
    pub fn of_parts(dimension: usize, entries: Vec<C>, lambda: C) -> Stiffness<C> {
        Stiffness { dimension, entries: entries.into(), lambda }
    }

    /// The dimension of the body.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// D by rows, `[strains × strains]`.
    pub fn entries(&self) -> &[C] {
        &self.entries
    }

    /// λ of the isotropic D that is nearest.
    pub fn lambda(&self) -> &C {
        &self.lambda
    }
}

impl<T: Scalar> Stiffness<T> {
    /// Returns the stiffness itself, in kernels that are compiled for anisotropic materials. A kernel calls it first, so that the compiler
    /// drops the code behind it for numbers that only isotropic materials use.
    ///
    /// # Panics
    /// The kind of number is one that only isotropic materials use, see [`Scalar::ANISOTROPIC`].
    #[inline(always)]
    pub fn compiled(&self) -> &Stiffness<T> {
        assert!(T::ANISOTROPIC, "only isotropic materials use this kind of number");
        self
    }
}

/// λ of the projection on the isotropic tensors: `C_iijj = d² λ + 2 d μ` and `C_ijij = d λ + d (d + 1) μ`.
fn nearest_lambda(dimension: usize, entries: &[f64]) -> f64 {
    let (s, d) = (strains(dimension), dimension as f64);
    if dimension == 1 {
        // One strain has no part that is a change of volume alone, and the quotient below would be 0/0.
        return 0.0;
    }
    let normal: f64 =
        (0..dimension).flat_map(|i| (0..dimension).map(move |j| (i, j))).map(|(i, j)| entries[i * s + j]).sum();
    // Voigt's shear entries are those of the tensor, which has each of them twice in the trace.
    let weight = |i: usize| if i < dimension { 1.0 } else { 2.0 };
    let trace: f64 = (0..s).map(|i| weight(i) * entries[i * s + i]).sum();
    // This is the λ of the nearest isotropic tensor in the norm of tensors, which does not depend on the axes.
    (normal * (d + 1.0) / 2.0 - trace) / (d * d * (d + 1.0) / 2.0 - d)
}

impl Hooke {
    /// The moduli, if the law is isotropic.
    pub fn moduli(&self) -> Option<Moduli> {
        match self {
            Hooke::Isotropic(moduli) => Some(*moduli),
            Hooke::Anisotropic(_) => None,
        }
    }

    /// The least stiffness against one strain alone, Pa: μ, or the least entry on the diagonal of D.
    pub fn least_diagonal(&self) -> f64 {
        match self {
            Hooke::Isotropic(moduli) => moduli.mu,
            Hooke::Anisotropic(stiffness) => {
                let s = strains(stiffness.dimension);
                stiffness.entries.iter().step_by(s + 1).fold(f64::INFINITY, |least, entry| least.min(*entry))
            }
        }
    }

    /// D by rows in this dimension, and the λ of [`Stiffness::lambda`].
    pub fn entries(&self, dimension: usize) -> (Vec<f64>, f64) {
        match self {
            Hooke::Anisotropic(stiffness) => (stiffness.entries.to_vec(), stiffness.lambda),
            Hooke::Isotropic(Moduli { lambda, mu }) => {
                let s = strains(dimension);
                let entry = |(i, j): (usize, usize)| match (i < dimension, j < dimension, i == j) {
                    (true, true, true) => lambda + 2.0 * mu,
                    (true, true, false) => *lambda,
                    (false, false, true) => *mu,
                    _ => 0.0,
                };
                ((0..s * s).map(|e| entry((e / s, e % s))).collect(), *lambda)
            }
        }
    }

    /// Converts the law to numbers of the kind of `any`.
    pub fn of_kind<T: Scalar<Constant = f64>>(&self, any: &T) -> Hooke<T> {
        match self {
            Hooke::Isotropic(moduli) => Hooke::Isotropic(moduli.of_kind(any)),
            Hooke::Anisotropic(stiffness) => Hooke::Anisotropic(stiffness.of_kind(any)),
        }
    }
}

impl<C> Hooke<C> {
    /// Whether the law has a stiffness of its own.
    pub fn is_anisotropic(&self) -> bool {
        match self {
            Hooke::Isotropic(_) => false,
            Hooke::Anisotropic(_) => true,
        }
    }
}

impl<C> From<Moduli<C>> for Hooke<C> {
    fn from(moduli: Moduli<C>) -> Hooke<C> {
        Hooke::Isotropic(moduli)
    }
}

impl From<&Hooke> for Hooke {
    fn from(hooke: &Hooke) -> Hooke {
        hooke.clone()
    }
}
