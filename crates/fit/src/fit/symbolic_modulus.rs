//! The numbers of a material in which a closed form is linear, and the stiffness of each as rational functions.
//!
//! Theory: page *Least squares* of the book.

use crate::material::voigt;
use crate::scalar::Scalar;
use crate::stiffness::Geometry;
use crate::symbolic::Fraction;

/// One number of a material, such as λ or the entry `C₁₂` of its stiffness.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Modulus {
    /// The number has this name in text, such as `lambda` or `C12`.
    pub name: String,
    /// In LaTeX, such as `\\lambda` or `C_{12}`.
    pub latex: String,
    /// The entries `C_kilj` of the stiffness that are one if this number is one and the others are zero; those that occur twice are two.
    entries: Vec<[usize; 4]>,
}

impl Modulus {
    /// λ and μ of `σ = λ tr(ε) I + 2μ ε`.
    pub fn isotropic(dimension: usize) -> Vec<Modulus> {
        let pairs = || (0..dimension * dimension).map(|e| (e / dimension, e % dimension));
        let lambda = pairs().map(|(k, l)| [k, k, l, l]);
        let mu = pairs().flat_map(|(k, l)| [[k, l, k, l], [k, l, l, k]]);
        let of = |name: &str, entries: Vec<_>| Modulus { name: name.into(), latex: format!("\\{name}"), entries };
        vec![of("lambda", lambda.collect()), of("mu", mu.collect())]
    }

    /// The entries of the stiffness of a material whose axes are those of the coordinates, in Voigt's order.
    pub fn orthotropic(dimension: usize) -> Vec<Modulus> {
        let d = dimension;
        let normal = (0..d).flat_map(|i| (i..d).map(move |j| [i, j]));
        // Voigt's order has the shear strains from yz to xy, which pairs of axes count the other way.
        let shear = (0..d * d).filter(|e| e / d < e % d).map(|e| voigt(d, e / d, e % d)).rev();
        let all = normal.chain(shear.map(|s| [s, s]));
        // C66 of the plane is the third entry of its three.
        let number = |s: usize| if d == 2 && s == 2 { 6 } else { s + 1 };
        all.map(|[i, j]| {
            let named = |left: &str, right: &str| format!("C{left}{}{}{right}", number(i), number(j));
            let is_entry = |e: &[usize; 4]| {
                let found = [voigt(d, e[0], e[1]), voigt(d, e[2], e[3])];
                found == [i, j] || found == [j, i]
            };
            let entries = (0..d.pow(4)).map(|e| [e / d.pow(3), e / d.pow(2) % d, e / d % d, e % d]);
            Modulus { name: named("", ""), latex: named("_{", "}"), entries: entries.filter(is_entry).collect() }
        })
        .collect()
    }

    /// The stiffness if this number is one and the others are zero, `[size × size]`: `R_akbl = ∫ ∇_i N_a C_kilj ∇_j N_b dV`.
    pub(super) fn stiffness(&self, geometry: &Geometry<Fraction>) -> Vec<Fraction> {
        let (n, d) = (geometry.nodes, geometry.dimension);
        let size = n * d;
        let mut r = vec![geometry.volumes[0].zero(); size * size];
        // R is symmetric: half of the products of polynomials are spared.
        for (a, b) in (0..n).flat_map(|a| (0..=a).map(move |b| (a, b))) {
            // ∫ ∇_i N_a ∇_j N_b dV
            let product = |i: usize, j: usize| {
                let points = geometry.gradients.chunks_exact(n * d).zip(&geometry.volumes);
                sum(points.map(|(grad, v)| grad[a * d + i].clone() * &grad[b * d + j] * v), &r[0])
            };
            let products: Vec<Fraction> = (0..d * d).map(|e| product(e / d, e % d)).collect();
            for &[k, i, l, j] in &self.entries {
                let place = (a * d + k) * size + b * d + l;
                r[place] = r[place].clone() + &products[i * d + j];
            }
        }
        for i in 0..size {
            for j in i + 1..size {
                r[i * size + j] = r[j * size + i].clone();
            }
        }
        r
    }
}

pub(super) fn sum(terms: impl Iterator<Item = Fraction>, any: &Fraction) -> Fraction {
    terms.fold(any.zero(), |sum, term| sum + &term)
}
