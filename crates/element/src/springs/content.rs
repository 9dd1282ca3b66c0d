//! The content (length, area or volume) of a cell at given positions, by its quadrature `Σ_q w_q |J_q|`: whole, or of
//! single points.

use super::vector::{cross, dot, norm};
use crate::element::Tabulation;
use crate::scalar::of_dimension;
use crate::symbolic::Jet;
use std::ops::Range;

/// The content at some quadrature points of a cell with its nodes at `x`, `[nodes × space]`.
pub struct Content<'a> {
    table: &'a Tabulation,
    points: Range<usize>,
    x: &'a [f64],
    /// The number of coordinates of a node; more than the dimension for a cell of a surface or curve.
    space: usize,
}

impl<'a> Content<'a> {
    /// The content at all points.
    pub fn of_cell(table: &'a Tabulation, x: &'a [f64]) -> Content<'a> {
        Content { table, points: 0..table.points(), x, space: x.len() / table.nodes }
    }

    /// The content at point q alone.
    pub fn of_point(table: &'a Tabulation, q: usize, x: &'a [f64]) -> Content<'a> {
        Content { points: q..q + 1, ..Content::of_cell(table, x) }
    }

    /// Calls `visit(∂N_a/∂ξ, w)` for each point. A point that serves the volumetric rule alone has its weight in that
    /// rule, unless all points are asked for.
    fn each_point(&self, mut visit: impl FnMut(&[f64], f64)) {
        let size = self.table.nodes * self.table.dimension;
        let is_single = self.points.len() == 1;
        for q in self.points.clone() {
            let weight = if is_single { self.table.point_weight(q) } else { self.table.weights[q] };
            visit(&self.table.gradients[q * size..(q + 1) * size], weight);
        }
    }

    fn is_embedded(&self) -> bool {
        self.space > self.table.dimension
    }

    /// The content, in m, m² or m³.
    pub fn value(&self) -> f64 {
        let mut total = 0.0;
        self.each_point(|dn, w| {
            total += w * if self.is_embedded() {
                norm(&self.normal(dn).0)
            } else {
                let [a, b, c] = self.rows(dn);
                triple(a, b, c)
            }
        });
        total
    }

    /// The gradient of the content in the positions, `[nodes × space]`.
    pub fn gradient(&self) -> Vec<f64> {
        let mut gradient = vec![0.0; self.x.len()];
        self.both(&mut gradient);
        gradient
    }

    /// The content, and its gradient, which is written into memory for it.
    pub fn both(&self, gradient: &mut [f64]) -> f64 {
        let (d, mut total) = (self.table.dimension, 0.0);
        gradient.fill(0.0);
        self.each_point(|dn, w| {
            if self.is_embedded() {
                let (normal, turns) = self.normal(dn);
                let size = norm(&normal);
                let unit = scaled(normal, 1.0 / size);
                gradient.iter_mut().zip(&turns).for_each(|(entry, turn)| *entry += w * dot(&unit, turn));
                total += w * size;
                return;
            }
            let j = self.rows(dn);
            let [a, b, c] = j;
            total += w * triple(a, b, c);
            // det = J_k · (J_k+1 × J_k+2) for every k.
            // Rows of the identity stand for missing dimensions, so that one formula serves lengths, areas and volumes.
            let beside: [[f64; 3]; 3] = std::array::from_fn(|k| cross(j[(k + 1) % 3], j[(k + 2) % 3]));
            for (entries, dn) in gradient.chunks_exact_mut(d).zip(dn.chunks_exact(d)) {
                let dn = node(dn, 0, d);
                entries.iter_mut().zip(&beside).for_each(|(entry, beside)| *entry += w * dot(&dn, beside));
            }
        });
        total
    }

    /// The content with its first and second derivatives in the positions.
    ///
    /// In a cell that fills its space the content is a polynomial of degree d: det is linear in each row J_k of the
    /// Jacobian, so that in its derivatives by `x_ak` and `x_bm` the gradients ∇N_a and ∇N_b take the places of J_k and
    /// J_m.
    pub fn jet(&self) -> Jet {
        let (d, size) = (self.table.dimension, self.x.len());
        let mut hessian = vec![0.0; size * size];
        self.each_point(|dn, w| {
            if self.is_embedded() {
                self.bend(dn, w, &mut hessian);
                return;
            }
            // ∇N_a · (∇N_b × J_l) = J_l · (∇N_a × ∇N_b), with l the axis other than k and m: one cross product for each
            // pair of nodes.
            let j = self.rows(dn);
            for a in 0..size / d {
                // ∇N_a × ∇N_a is zero, and the other half is the same.
                for b in 0..a {
                    let normal = cross(node(dn, a, d), node(dn, b, d));
                    for k in 0..d {
                        for m in (0..d).filter(|m| *m != k) {
                            let l = 3 - k - m;
                            let sign = if (k + 1) % 3 == m { w } else { -w };
                            let bend = sign * dot(&j[l], &normal);
                            hessian[(a * d + k) * size + b * d + m] += bend;
                            hessian[(b * d + m) * size + a * d + k] += bend;
                        }
                    }
                }
            }
        });
        Jet { value: self.value(), gradient: self.gradient(), hessian }
    }

    /// The rows `J_k = Σ_a x_ak ∇N_a` of the Jacobian, extended by those of the identity to three dimensions.
    fn rows(&self, dn: &[f64]) -> [[f64; 3]; 3] {
        of_dimension!(self.table.dimension, |D| rows::<D>(self.x, dn))
    }

    /// The tangent `∂x/∂ξ_l` in three dimensions.
    fn tangent(&self, dn: &[f64], l: usize) -> [f64; 3] {
        let d = self.table.dimension;
        let mut tangent = [0.0; 3];
        for (x, dn) in self.x.chunks_exact(self.space).zip(dn.chunks_exact(d)) {
            tangent.iter_mut().zip(x).for_each(|(t, x)| *t += dn[l] * x);
        }
        tangent
    }

    /// The vector n whose length is the content: of a curve its tangent t, of a surface `t₁ × t₂`. With its derivatives
    /// in the positions, `[nodes × space]`.
    fn normal(&self, dn: &[f64]) -> ([f64; 3], Vec<[f64; 3]>) {
        let (d, space) = (self.table.dimension, self.space);
        let tangents = [self.tangent(dn, 0), if d == 2 { self.tangent(dn, 1) } else { [0.0; 3] }];
        let turn = |i: usize| {
            let (dn, e) = (&dn[i / space * d..][..d], axis(i % space));
            match d {
                1 => scaled(e, dn[0]),
                _ => sum(scaled(cross(e, tangents[1]), dn[0]), scaled(cross(tangents[0], e), dn[1])),
            }
        };
        let normal = if d == 1 { tangents[0] } else { cross(tangents[0], tangents[1]) };
        (normal, (0..self.x.len()).map(turn).collect())
    }

    /// Adds `w ∇∇‖n‖ = w (N · ∇∇n + ∇n (I − N Nᵀ) ∇nᵀ/‖n‖)`, `N = n/‖n‖`.
    fn bend(&self, dn: &[f64], w: f64, hessian: &mut [f64]) {
        let (d, space, size) = (self.table.dimension, self.space, self.x.len());
        let (normal, turns) = self.normal(dn);
        let length = norm(&normal);
        let unit = scaled(normal, 1.0 / length);
        for (i, row) in hessian.chunks_exact_mut(size).enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                let (a, b) = (&dn[i / space * d..][..d], &dn[j / space * d..][..d]);
                // The tangent of a curve is linear in the positions, and has no second derivative.
                let turned = if d == 1 { 0.0 } else { a[0] * b[1] - a[1] * b[0] };
                // With the unit normal u: `∂∂‖n‖ = u·∂∂n + (∂n·∂n − (u·∂n)²)/‖n‖`.
                let across = dot(&turns[i], &turns[j]) - dot(&unit, &turns[i]) * dot(&unit, &turns[j]);
                let second = turned * triple(unit, axis(i % space), axis(j % space));
                *entry += w * (second + across / length);
            }
        }
    }
}

/// [`Content::rows`] in `D` dimensions. With a known number of them the sums of a cell stay in registers, which takes a fifth of the time.
fn rows<const D: usize>(x: &[f64], dn: &[f64]) -> [[f64; 3]; 3] {
    let mut rows = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    rows.iter_mut().take(D).for_each(|row| row[..D].fill(0.0));
    for (x, dn) in x.as_chunks::<D>().0.iter().zip(dn.as_chunks::<D>().0) {
        for k in 0..D {
            for l in 0..D {
                rows[k][l] += x[k] * dn[l];
            }
        }
    }
    rows
}

/// `∇N_a` in three dimensions.
fn node(dn: &[f64], a: usize, d: usize) -> [f64; 3] {
    std::array::from_fn(|l| if l < d { dn[a * d + l] } else { 0.0 })
}

fn axis(k: usize) -> [f64; 3] {
    std::array::from_fn(|l| f64::from(u8::from(k == l)))
}

fn scaled(a: [f64; 3], factor: f64) -> [f64; 3] {
    a.map(|a| a * factor)
}

fn sum(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] + b[k])
}

/// `a · (b × c)`.
fn triple(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * (b[(k + 1) % 3] * c[(k + 2) % 3] - b[(k + 2) % 3] * c[(k + 1) % 3])).sum()
}
