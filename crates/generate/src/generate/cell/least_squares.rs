//! The constants that minimise a Frobenius norm of `R − Σ_s k_s g_s g_sᵀ`, as code.
//!
//! With `y_s = h² g_s + (1 − h²) P g_s`, P the projection on the linear motions (h = 1 if the weight is not modal), and
//! `H = Σ_a y_sa ∇N_aᵀ` the gradient of that motion,
//!
//! ```text
//! M_st = (g_s·y_t)²,   b_s = ∫ λ (tr H)² + μ (H : H + H : Hᵀ) dV
//! ```
//!
//! The blocks of different nodes lack `Σ_a (g_sa·g_ta)²` and the same integral of `g_sa ∇N_aᵀ` for each node a. A length
//! spring has `g = (−n, n)`: all of its products follow from `d = x_j − x_i` and `1/d·d` without a root.
//!
//! Theory: pages *Least squares* and *Modal weights* of the book.

use super::solve::solve;
use super::{Body, Cell, Index, Room, Status, Value, difference, dot};
use crate::error::{Error, ErrorKind, Result};
use crate::fit::Weight;
use crate::scalar::{Scalar, adjugate, of_dimension};
use crate::stiffness::Geometry;

/// A weight that has normal equations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LeastSquares {
    /// All entries.
    All,
    /// The blocks of different nodes.
    Blocks,
    /// Motions beyond constant strain scaled by h.
    Modal(f64),
}

impl LeastSquares {
    /// The normal equations of a weight.
    ///
    /// # Errors
    /// The weight has no normal equations without roots of the stiffness.
    pub fn of(weight: Weight) -> Result<LeastSquares> {
        match weight {
            Weight::None => Ok(LeastSquares::All),
            Weight::OffDiagonal => Ok(LeastSquares::Blocks),
            Weight::Modal(higher) => Ok(LeastSquares::Modal(higher.value())),
            Weight::Relative => {
                let found = format!("\"{}\"", weight.name());
                let error = Error::expected("weight", "one with direct equations: none, offdiag or modal", found);
                Err(error.of_kind(ErrorKind::Unsupported))
            }
        }
    }
}

/// The projection on the linear motions: node positions relative to their mean, and `S⁻¹` of their spread.
struct Linear {
    r: Vec<Value>,
    inverse: Vec<Vec<Value>>,
    /// `h²` and `1 − h²`.
    shares: [f64; 2],
}

/// Writes the constants of one cell and returns where they are, `[springs]`.
pub fn least_squares(cell: &Cell, weight: LeastSquares, lambda: &Value, mu: &Value) -> Room {
    let (body, plan, d) = (&cell.body, cell.plan, cell.dimension());
    let (lengths, m) = (cell.springs.pairs().len(), cell.springs.len());
    // Springs between the same two nodes share a block, and have equations together.
    let is_decoupled = weight == LeastSquares::Blocks && lengths == m && !has_parallel(cell.springs.pairs());
    let is_array = !plan.springs || !plan.equations && !is_decoupled;
    let linear = Linear::of(cell, weight);

    // d_s and 1/d_s·d_s
    let mut edges = Room::unset(body, "edges", lengths * d, is_array);
    let mut squares = Room::unset(body, "squares", lengths, is_array);
    let (one, zero) = (body.number(1.0), body.number(0.0));
    body.fail_with(Status::Shape);
    cell.each_length(|s, i, j| {
        let edge = cell.edge(i, j);
        let square = dot(&edge, &edge);
        // Code for simulations must end with a status where the library would have numbers that are not finite.
        body.guard(&square, &zero);
        squares.set(body, s, &(&one / &square));
        edge.iter().enumerate().for_each(|(k, e)| edges.set(body, &(s * d) + k, e));
    });
    let edge = |s: &Index| -> Vec<Value> { (0..d).map(|k| edges.get(body, &(s * d) + k)).collect() };
    let others = Others::of(cell, linear.as_ref(), is_array);

    // b
    let mut b = Room::new(body, "b", m, is_array || !plan.points);
    let mut gradients = Room::unset(body, "gradients", cell.x.len(), !plan.springs);
    cell.each_point(|_, geometry| {
        let [volume, volumetric] = cell.volumes(geometry);
        let (lambda, mu) = (lambda * &volumetric, mu * &volume);
        let along = &lambda + &mu;
        geometry.gradients.iter().enumerate().for_each(|(i, g)| gradients.set(body, i, g));
        let gradient = |a: &Index| -> Vec<Value> { (0..d).map(|k| gradients.get(body, &(a * d) + k)).collect() };
        cell.each_length(|s, i, j| {
            let (d, gi, gj) = (edge(s), gradient(i), gradient(j));
            let energy = if weight == LeastSquares::Blocks {
                let both = &dot(&d, &gi) * &dot(&d, &gj);
                let sum = &(&mu * &dot(&gi, &gj)) + &(&(&along * &squares.get(body, s)) * &both);
                (&sum + &sum).negated()
            } else {
                let mut w = difference(&gi, &gj);
                if let Some(linear) = &linear {
                    w = linear.weighted(&w, &d);
                }
                &(&mu * &dot(&w, &w)) + &(&(&along * &squares.get(body, s)) * &dot(&d, &w).squared())
            };
            b.add(body, s, &energy);
        });
        for (o, row) in others.images.iter().enumerate() {
            b.add(body, lengths + o, &energy(weight, row, geometry, &lambda, &mu));
        }
    });
    if is_decoupled {
        // M = 2I
        let half = body.number(0.5);
        body.each(plan.springs, 0, m, |s| {
            let constant = &b.get(body, s) * &half;
            b.set(body, s, &constant);
        });
        return b;
    }

    // M, the upper triangle
    let mut matrix = Room::unset(body, "matrix", m * m, !plan.equations);
    let ends = |s: &Index| -> [Index; 2] {
        match s.number() {
            Some(s) => cell.springs.pairs()[s].map(Index::from),
            None => [body.integer(cell.ends(), s * 2), body.integer(cell.ends(), &(s * 2) + 1)],
        }
    };
    body.each(plan.equations, 0, lengths, |s| {
        let ([i, j], ds, qs) = (ends(s), edge(s), squares.get(body, s));
        let spread = linear.as_ref().map(|linear| linear.spread(&ds));
        body.each(plan.equations, s, lengths, |t| {
            let ([k, l], dt) = (ends(t), edge(t));
            let cosine = &dot(&ds, &dt).squared() * &(&qs * &squares.get(body, t));
            let same = &body.equal(&i, &k) + &body.equal(&j, &l);
            let shared = &same - &(&body.equal(&i, &l) + &body.equal(&j, &k));
            let entry = match (weight, &linear, &spread) {
                // Springs between the same two nodes alone: shared = ±2.
                (LeastSquares::Blocks, ..) => {
                    let more = shared.squared().select(&one, &one, &zero);
                    &(&more + &more) * &cosine
                }
                (_, Some(linear), Some(spread)) => {
                    let factor = &(&shared * &body.number(linear.shares[0])) + &dot(spread, &dt);
                    &factor.squared() * &cosine
                }
                _ => &shared.squared() * &cosine,
            };
            matrix.set(body, &(s * m) + t, &entry);
        });
        for o in 0..others.rows.len() {
            let row = |a: &Index| -> Vec<Value> { (0..d).map(|k| others.entry(body, o, &(a * d) + k)).collect() };
            let (yi, yj) = (row(&i), row(&j));
            let entry = if weight == LeastSquares::Blocks {
                let both = &dot(&ds, &yi) * &dot(&ds, &yj);
                (&both + &both).negated()
            } else {
                dot(&ds, &difference(&yi, &yj)).squared()
            };
            matrix.set(body, &(s * m) + (lengths + o), &(&entry * &qs));
        }
    });
    for (o, row) in others.rows.iter().enumerate() {
        for (p, image) in others.images.iter().enumerate().skip(o) {
            let mut entry = dot(row, image).squared();
            if weight == LeastSquares::Blocks {
                let alone = row.chunks_exact(d).zip(image.chunks_exact(d)).map(|(a, b)| dot(a, b).squared());
                entry = alone.fold(entry, |entry, alone| &entry - &alone);
            }
            matrix.set(body, (lengths + o) * m + lengths + p, &entry);
        }
    }
    solve(body, plan.equations, m, &mut matrix, &mut b);
    b
}

/// Whether two springs join the same two nodes.
fn has_parallel(pairs: &[[usize; 2]]) -> bool {
    pairs.iter().enumerate().any(|(s, [i, j])| pairs[..s].iter().any(|p| p == &[*i, *j] || p == &[*j, *i]))
}

/// `λ (tr H)² + μ (H : H + H : Hᵀ)`, `H = Σ_a y_a ∇N_aᵀ`; less the same of each node alone for the blocks.
fn energy(weight: LeastSquares, y: &[Value], geometry: &Geometry<Value>, lambda: &Value, mu: &Value) -> Value {
    let d = geometry.dimension;
    let zero = lambda.zero();
    let mut total = vec![zero.clone(); d * d];
    let mut alone = zero.clone();
    for (y, g) in y.chunks_exact(d).zip(geometry.gradients.chunks_exact(d)) {
        let own: Vec<Value> = (0..d * d).map(|kl| &y[kl / d] * &g[kl % d]).collect();
        total.iter_mut().zip(&own).for_each(|(total, own)| *total = &*total + own);
        if weight == LeastSquares::Blocks {
            alone = &alone + &density(&own, d, lambda, mu);
        }
    }
    &density(&total, d, lambda, mu) - &alone
}

fn density(h: &[Value], d: usize, lambda: &Value, mu: &Value) -> Value {
    let trace = (1..d).fold(h[0].clone(), |sum, k| &sum + &h[k * d + k]);
    let both = |kl: usize| &h[kl] * &(&h[kl] + &h[kl % d * d + kl / d]);
    let squares = (1..d * d).fold(both(0), |sum, kl| &sum + &both(kl));
    &(lambda * &trace.squared()) + &(mu * &squares)
}

impl Linear {
    fn of(cell: &Cell, weight: LeastSquares) -> Option<Linear> {
        let LeastSquares::Modal(h) = weight else { return None };
        let d = cell.dimension();
        let share = cell.body.number(1.0 / cell.nodes() as f64);
        let mean = |k: usize| cell.x.iter().skip(k).step_by(d).fold(cell.body.number(0.0), |sum, x| &sum + x) * &share;
        let mean: Vec<Value> = (0..d).map(mean).collect();
        let r: Vec<Value> = cell.x.iter().enumerate().map(|(i, x)| x - &mean[i % d]).collect();
        let inverse = of_dimension!(d, |D| inverse_spread::<D>(cell, &r));
        Some(Linear { r, inverse, shares: [h * h, 1.0 - h * h] })
    }

    /// `(1 − h²) S⁻¹ v`.
    fn spread(&self, v: &[Value]) -> Vec<Value> {
        let share = v[0].like(self.shares[1]);
        self.inverse.iter().map(|row| &dot(row, v) * &share).collect()
    }

    /// `h² w + (1 − h²) S⁻¹ v`.
    fn weighted(&self, w: &[Value], v: &[Value]) -> Vec<Value> {
        let share = w[0].like(self.shares[0]);
        w.iter().zip(self.spread(v)).map(|(w, v)| &(w * &share) + &v).collect()
    }

    /// `y = h² g + (1 − h²) P g`, `(P g)_a = (Σ_b g_b r_bᵀ) S⁻¹ r_a`.
    fn image(&self, g: &[Value]) -> Vec<Value> {
        let d = self.inverse.len();
        let nodes = || self.r.chunks_exact(d);
        let zero = g[0].like(0.0);
        let moment = |k: usize, l: usize| {
            g.chunks_exact(d).zip(nodes()).fold(zero.clone(), |sum, (g, r)| sum.plus_product(&g[k], &r[l]))
        };
        let rows: Vec<Vec<Value>> = (0..d).map(|k| (0..d).map(|l| moment(k, l)).collect()).collect();
        let linear = nodes().flat_map(|r| {
            let spread = self.spread(r);
            rows.iter().map(|row| dot(row, &spread)).collect::<Vec<_>>()
        });
        let share = zero.like(self.shares[0]);
        g.iter().zip(linear).map(|(g, linear)| &(g * &share) + &linear).collect()
    }
}

/// `S⁻¹ = (Σ_a r_a r_aᵀ)⁻¹`. The function ends with [`Status::Shape`] if all nodes lie in one plane.
fn inverse_spread<const D: usize>(cell: &Cell, r: &[Value]) -> Vec<Vec<Value>> {
    let zero = r[0].zero();
    let mut spread: [[Value; D]; D] = zero.repeated_rows();
    for r in r.chunks_exact(D) {
        for k in 0..D {
            for l in 0..D {
                spread[k][l] = spread[k][l].clone().plus_product(&r[k], &r[l]);
            }
        }
    }
    let (adjugate, determinant) = adjugate(&spread);
    // Some languages end with an error of their own at a division by zero.
    cell.body.fail_with(Status::Shape);
    cell.body.guard(&determinant, &zero);
    adjugate.iter().map(|row| row.iter().map(|entry| entry / &determinant).collect()).collect()
}

/// The springs that do not measure lengths.
struct Others {
    /// g, `[nodes × dimension]` each.
    rows: Vec<Vec<Value>>,
    /// y.
    images: Vec<Vec<Value>>,
    /// y of all in one array, for loops over length springs.
    stored: Option<usize>,
}

impl Others {
    fn of(cell: &Cell, linear: Option<&Linear>, is_array: bool) -> Others {
        let body = &cell.body;
        let mut rows: Vec<Vec<Value>> = cell.springs.functions().iter().map(|f| cell.function(f).1).collect();
        if cell.springs.content().is_some() {
            rows.push(cell.content(true).1);
        }
        let images: Vec<Vec<Value>> =
            rows.iter().map(|row| linear.map_or_else(|| row.clone(), |linear| linear.image(row))).collect();
        let size = cell.x.len();
        let stored = (is_array && !rows.is_empty()).then(|| {
            let array = body.array("rows", size * rows.len(), super::Role::Work);
            images.iter().flatten().enumerate().for_each(|(i, y)| body.store(array, i, y));
            array
        });
        Others { rows, images, stored }
    }

    /// Entry `at` of y of spring o.
    fn entry(&self, body: &Body, o: usize, at: impl Into<Index>) -> Value {
        let at = at.into();
        match (at.number(), self.stored) {
            (None, Some(array)) => body.entry(array, &at + o * self.images[o].len()),
            (at, _) => self.images[o][at.unwrap_or(0)].clone(),
        }
    }
}
