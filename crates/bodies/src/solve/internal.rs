//! The internal forces of a model at given displacements, and their rounding errors.
//!
//! Theory: page *Precision* of the book.

use crate::element::Quadrature;
use crate::model::{Elastic, Entries, Response, Support, displaced};
use crate::springs::norm;
use faer::sparse::Triplet;

/// The number of roundings of a force: positions are rounded once, sums over the nodes and points of a cell a few
/// times, and plane stress finds its thickness to 45 ε.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;
/// The relative change of the tangent up to which the integral is exact to rounding: its error is 10⁻⁶ of the sixth
/// power of this change.
const NEAR: f64 = 0.05;
/// The points of the integral along the displacements, whose error is of sixth order.
const POINTS: usize = 3;

/// A model at displacements u.
#[derive(Debug, Clone)]
pub(super) struct Internal {
    pub response: Response,
    /// The internal forces, `[points · dimension]`, N.
    pub force: Vec<f64>,
    /// A bound of the rounding error of `force` on the free degrees of freedom, in the Euclidean norm, N.
    pub rounding: f64,
}

/// How the forces are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// From the positions, as the model gives them. The displacements lose digits in `x = X + u`. The rounding error is
    /// that of the forces that the cells would have if x were a stretch from nothing: `64 ε Σ_e Σ_j |T^e_ij| |x_j|` at
    /// degree of freedom i, with T^e the tangents of cells and springs before they are added. Relative to a load p on a
    /// material of modulus E it is about `ε E/p`.
    Position,
    /// From the displacements: `g(X + u) = g(X) + ∫₀¹ T(X + s u) u ds`, by the Gauss–Legendre rule of three points. The
    /// rounding error is `64 ε Σ_e Σ_j |T^e_ij| |u_j|`, some ε of the forces themselves, however small they are. If the
    /// tangent changes by more than a twentieth in any row, the displacements are too large for the rule, and the form
    /// above is used. Forces at rest that do not exceed their rounding error count as zero.
    Displacement,
}

/// A model at rest.
pub(super) struct Rest<'a> {
    pub model: &'a dyn Elastic,
    /// The positions at rest, `[points × dimension]`, m.
    pub points: &'a [f64],
    pub support: &'a Support,
}

impl Rest<'_> {
    /// The model at displacements u; `None` if it has no response there.
    pub fn at(&self, u: &[f64], form: Form) -> Option<Internal> {
        let x = displaced(self.points, u);
        let response = self.model.respond(&x)?;
        let rounding = self.free(&rounding(&response.tangent, &x));
        let plain = |response: Response| Internal { force: response.force.clone(), response, rounding };
        match form {
            Form::Position => Some(plain(response)),
            Form::Displacement => Some(match self.secant(u, &response.tangent) {
                // The forces are within either bound where displacements are small, and the lesser one tells more.
                Some((force, own)) => Internal { rounding: rounding.min(own), force, response },
                None => plain(response),
            }),
        }
    }

    /// The forces of [`Form::Displacement`] and their rounding error; `None` if the tangent differs too much from that
    /// at rest.
    fn secant(&self, u: &[f64], there: &Entries) -> Option<(Vec<f64>, f64)> {
        let rest = self.model.respond(self.points)?;
        if !is_near(&rest.tangent, there, u.len()) {
            return None;
        }
        let (mut force, mut bound) = (vec![0.0; u.len()], vec![0.0; u.len()]);
        let hidden = rounding(&rest.tangent, self.points);
        // Forces at rest that are within their rounding count as none, and add no bound of theirs.
        if !rest.force.iter().zip(&hidden).all(|(f, r)| f.abs() <= *r) {
            (force, bound) = (rest.force, hidden);
        }
        let line = Quadrature::gauss_legendre(1, POINTS);
        for (s, w) in line.points.iter().zip(&line.weights) {
            // From [−1, 1] to [0, 1]. There the error of the rule is f⁽⁶⁾/2016000, the 10⁻⁶ of the limit above.
            let (s, w) = ((1.0 + s) / 2.0, w / 2.0);
            let part: Vec<f64> = u.iter().map(|u| s * u).collect();
            let tangent = self.model.respond(&displaced(self.points, &part))?.tangent;
            let add = |sum: &mut Vec<f64>, row: usize, value: f64| sum[row] += w * value;
            each_product(&tangent, u, |row, value| add(&mut force, row, value));
            let all = rounding(&tangent, u);
            bound.iter_mut().zip(all).for_each(|(bound, r)| *bound += w * r);
        }
        Some((force, self.free(&bound)))
    }

    /// The norm over the free degrees of freedom.
    pub fn free(&self, v: &[f64]) -> f64 {
        norm(&masked(v, self.support))
    }
}

/// The entries of the free degrees of freedom; the others are set to zero.
pub(super) fn masked(v: &[f64], support: &Support) -> Vec<f64> {
    v.iter().enumerate().map(|(i, v)| if support.is_fixed(i) { 0.0 } else { *v }).collect()
}

/// `64 ε Σ_e Σ_j |T^e_ij| |x_j|`.
pub(crate) fn rounding(tangent: &[Triplet<usize, usize, f64>], x: &[f64]) -> Vec<f64> {
    let mut bound = vec![0.0; x.len()];
    for entry in tangent {
        let size = ROUNDINGS * entry.val.abs();
        bound[entry.row] += size * x[entry.col].abs();
        if entry.row != entry.col {
            bound[entry.col] += size * x[entry.row].abs();
        }
    }
    bound
}

/// Calls `visit(row, T_ij u_j)` for both triangles.
fn each_product(tangent: &Entries, u: &[f64], mut visit: impl FnMut(usize, f64)) {
    for entry in tangent {
        visit(entry.row, entry.val * u[entry.col]);
        if entry.row != entry.col {
            visit(entry.col, entry.val * u[entry.row]);
        }
    }
}

/// Whether two tangents with the same pattern differ little in every row.
fn is_near(rest: &Entries, there: &Entries, rows: usize) -> bool {
    let (mut sizes, mut changes) = (vec![0.0; rows], vec![0.0; rows]);
    for (rest, there) in rest.iter().zip(there) {
        // An entry of the diagonal counts twice in both sums, which weighs it more in the quotient and needs no branch.
        for row in [rest.row, rest.col] {
            sizes[row] += rest.val.abs();
            changes[row] += (there.val - rest.val).abs();
        }
    }
    changes.iter().zip(&sizes).all(|(change, size)| *change <= NEAR * size)
}
