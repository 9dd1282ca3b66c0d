//! The dual of the quadratic programme, minimised by a semismooth Newton method.
//!
//! With multipliers y of A z = 0 and η of the dense rows, the variables that minimise the Lagrangian are
//!
//! ```text
//! z(y, η) = max(l, −W⁻¹ g),   g = Aᵀ y + Dᵀ η
//! ```
//!
//! and minus the dual function, `Σ_i −(w_i z_i²/2 + g_i z_i) + Σ_m η_m²/(2 c_m)`, is convex with the gradient
//! `(−A z, η/c − D z)`. The gradient is linear wherever the set of variables at their bounds does not change; there the
//! Hessian in y is `A W⁻¹ Aᵀ` over the other variables, the stiffness of a network of springs. The method is finite, and it
//! finds the set of zero springs exactly.
//!
//! Source: X. Zhao, D. Sun, K.-C. Toh, SIAM J. Optim. 20 (2010) 1737–1765, with the proximal term of R. T. Rockafellar,
//! Math. Oper. Res. 1 (1976) 97–116.

use super::quadratic::{Minimum, Quadratic, SearchProgress};
use crate::error::Result;
use crate::model::{Entries, Support};
use crate::solve::{Factor, System};
use crate::springs::dot;
use faer::sparse::Triplet;
use nalgebra::{DMatrix, DVector};

/// The search ends when no sum of A z exceeds this share of the largest bound.
// It is above the rounding of the sums, some 1e-15, and below the 1e-10 of a spring's force at which forces at rest are accepted.
const FOUND: f64 = 1e-13;
/// The powers of ten between one and [`FOUND`]. Progress is reported in these steps.
const NEAR: usize = 13;
/// The weight of the proximal term, relative to the mean of the diagonal of the Hessian. The Hessian is singular where
/// variables at their bounds leave a motion free. The term makes it regular, and the centre moves until it does not
/// act.
// Networks of three bodies of 357 to 1 436 tetrahedra take 4 to 7 steps with weights of 1e-12 to 1e-8, up to 11 with 1e-6,
// and 32 to 60 with 1e-4, where one of them is not found.
const PROXIMAL: f64 = 1e-8;
/// The proximal term is centred again when the gradient is below this share of the residual. Then the minimum with this
/// centre is near, and another centre takes its bias away.
// Shares from 0.01 to 0.5 take as many steps.
const CENTRED: f64 = 0.1;
/// The largest number of steps, and of steps shorter than `SHORT`. Programmes with a solution took 6 to 15 steps, none of
/// them short; those without one take short steps for ever.
const STEPS: u32 = 60;
const SHORT_STEPS: usize = 4;
const SHORT: f64 = 1e-2;
/// A search along a direction ends when the slope is below this share of the first. The next direction corrects what is
/// left more cheaply than another round.
// Shares from 0.025 to 1 take as many steps, but for one.
const FLAT: f64 = 0.1;
/// The largest number of rounds of that search: every second one halves the interval, so that its end is rounding.
const HALVINGS: usize = 60;

/// The solution; `None` if it has not been found, which is no proof that there is none.
///
/// # Errors
/// The equations do not fit into memory.
pub(super) fn minimum(programme: &Quadratic, watch: &mut SearchProgress) -> Result<Option<Minimum>> {
    let largest = programme.lower.iter().filter(|l| l.is_finite()).fold(0.0f64, |a, l| a.max(l.abs()));
    let mut point = Point::new(programme);
    let mut pattern = None;
    let (mut short, mut nearest) = (0, 0);
    for steps in 1..=STEPS {
        let Some(direction) = point.direction(&mut pattern)? else { return Ok(None) };
        let length = point.length(&direction);
        short += usize::from(length < SHORT);
        if short > SHORT_STEPS {
            return Ok(None);
        }
        point.step(&direction, length);
        let left = point.residual();
        // Residuals may rise between two steps; what a user sees of the progress does not fall back.
        // A residual of zero gives infinity, which the cast takes to the largest number and the clamp to the end.
        nearest = ((largest / left).log10().max(0.0) as usize).clamp(nearest, NEAR);
        watch(nearest, NEAR);
        if left <= FOUND * largest {
            return Ok(Some(Minimum { variables: point.variables, steps }));
        }
        point.centre_if_near(left);
    }
    Ok(None)
}

/// Multipliers, with the variables that belong to them.
struct Point<'a> {
    programme: &'a Quadratic,
    y: Vec<f64>,
    eta: Vec<f64>,
    /// g, `[variables]`.
    slopes: Vec<f64>,
    /// z, `[variables]`.
    variables: Vec<f64>,
    /// A z.
    sums: Vec<f64>,
    /// The centre of the proximal term `τ ‖y − y_c‖²/2`, and its weight τ.
    centre: Vec<f64>,
    weight: f64,
}

struct Direction {
    y: Vec<f64>,
    eta: Vec<f64>,
    slopes: Vec<f64>,
}

impl<'a> Point<'a> {
    fn new(programme: &'a Quadratic) -> Point<'a> {
        let diagonal: f64 = (0..programme.len())
            .flat_map(|i| programme.column(i).map(move |(_, v)| v * v / programme.weights[i]))
            .sum();
        let slopes = vec![0.0; programme.len()];
        let mut point = Point {
            programme,
            y: vec![0.0; programme.rows],
            eta: vec![0.0; programme.dense.len()],
            variables: Vec::new(),
            sums: Vec::new(),
            slopes,
            centre: vec![0.0; programme.rows],
            weight: PROXIMAL * diagonal / programme.rows as f64,
        };
        point.evaluate();
        point
    }

    /// The unbounded minimiser `−g/w` of a variable.
    fn unbounded(&self, variable: usize, slope: f64) -> f64 {
        -slope / self.programme.weights[variable]
    }

    fn evaluate(&mut self) {
        let each = self.slopes.iter().zip(&self.programme.lower).enumerate();
        self.variables = each.map(|(i, (slope, lower))| self.unbounded(i, *slope).max(*lower)).collect();
        self.sums = self.programme.apply(&self.variables);
    }

    /// The largest violation of an equation.
    fn residual(&self) -> f64 {
        let equations = self.programme.dense.iter().filter(|(_, weight)| weight.is_infinite());
        let sums = equations.map(|(row, _)| dot(row, &self.variables));
        sums.chain(self.sums.iter().copied()).fold(0.0, |a, x| a.max(x.abs()))
    }

    /// The gradients in y and η.
    fn gradients(&self) -> (Vec<f64>, Vec<f64>) {
        let y = self.sums.iter().zip(&self.y).zip(&self.centre).map(|((s, y), c)| self.weight * (y - c) - s);
        let dense = self.programme.dense.iter().zip(&self.eta);
        (y.collect(), dense.map(|((row, weight), eta)| eta / weight - dot(row, &self.variables)).collect())
    }

    /// The Newton direction; `None` if the equations are singular. `pattern` is made the first time.
    fn direction(&self, pattern: &mut Option<System>) -> Result<Option<Direction>> {
        let (programme, rows) = (self.programme, self.programme.rows);
        // At the kink itself either slope belongs to the generalised Hessian; that of a variable at its bound is taken.
        let is_free = |i: usize| self.unbounded(i, self.slopes[i]) > programme.lower[i];
        let compliances: Vec<f64> =
            (0..programme.len()).map(|i| if is_free(i) { 1.0 / programme.weights[i] } else { 0.0 }).collect();
        let support = Support { prescribed: vec![None; rows] };
        let hessian = self.hessian(&compliances);
        let system = match pattern.take() {
            Some(pattern) => pattern.renewed(&hessian, &support)?,
            None => System::new(&hessian, &support)?.placed(&programme.points, programme.dimension),
        };
        let factor = system.cholesky()?;
        *pattern = Some(system);
        let Some(factor) = factor else { return Ok(None) };
        let (mut y, mut eta) = self.gradients();
        y.iter_mut().chain(&mut eta).for_each(|x| *x = -*x);
        factor.solve(&mut y);
        if !eta.is_empty() {
            let Some(found) = self.dense(&factor, &compliances, &mut y, &eta) else { return Ok(None) };
            eta = found;
        }
        let slopes = programme.transposed(&y, &eta);
        Ok(Some(Direction { y, eta, slopes }))
    }

    /// `A C Aᵀ + τ I`, with C the diagonal of compliances. Variables at their bounds have zeros, so that the pattern is
    /// always the same.
    fn hessian(&self, compliances: &[f64]) -> Entries {
        let mut entries = Entries::new();
        for (variable, compliance) in compliances.iter().enumerate() {
            for (row, value) in self.programme.column(variable) {
                let others = self.programme.column(variable).filter(|(other, _)| row >= *other);
                entries.extend(others.map(|(other, v)| Triplet::new(row, other, compliance * value * v)));
            }
        }
        entries.extend((0..self.programme.rows).map(|row| Triplet::new(row, row, self.weight)));
        entries
    }

    /// Eliminates y from the equations with the dense rows: returns the direction of η for these negative gradients, and
    /// turns y from `H⁻¹ (−∇_y)` into its direction. `None` if the rows are dependent.
    fn dense(&self, factor: &Factor, compliances: &[f64], y: &mut [f64], eta: &[f64]) -> Option<Vec<f64>> {
        let (dense, rows) = (&self.programme.dense, self.programme.rows);
        let moved = |row: &Vec<f64>| row.iter().zip(compliances).map(|(d, c)| d * c).collect::<Vec<f64>>();
        let moved: Vec<Vec<f64>> = dense.iter().map(|(row, _)| moved(row)).collect();
        let coupling: Vec<Vec<f64>> = moved.iter().map(|row| self.programme.apply(row)).collect();
        let mut solved = coupling.concat();
        factor.solve(&mut solved);
        let solved: Vec<&[f64]> = solved.chunks_exact(rows).collect();
        let n = dense.len();
        // An equation has an infinite weight, and no compliance of its own.
        let own = |a: usize, b: usize| if a == b { 1.0 / dense[a].1 } else { 0.0 };
        let entry = |a, b| own(a, b) + dot(&dense[a].0, &moved[b]) - dot(&coupling[a], solved[b]);
        let right = DVector::from_fn(n, |a, _| eta[a] - dot(&coupling[a], y));
        let found = DMatrix::from_fn(n, n, entry).cholesky()?.solve(&right);
        for (found, solved) in found.iter().zip(solved) {
            y.iter_mut().zip(solved).for_each(|(y, s)| *y -= found * s);
        }
        Some(found.as_slice().to_vec())
    }

    /// The slope of minus the dual function at this length along the direction.
    fn slope(&self, direction: &Direction, length: f64) -> f64 {
        let programme = self.programme;
        let each = self.slopes.iter().zip(&direction.slopes).zip(&programme.lower).enumerate();
        let variables: f64 =
            each.map(|(i, ((g, by), lower))| self.unbounded(i, g + length * by).max(*lower) * by).sum();
        let dense = programme.dense.iter().zip(&self.eta).zip(&direction.eta);
        let dense: f64 = dense.map(|(((_, weight), eta), by)| (eta + length * by) * by / weight).sum();
        let y = self.y.iter().zip(&direction.y).zip(&self.centre);
        let proximal: f64 = y.map(|((y, by), c)| (y + length * by - c) * by).sum();
        dense + self.weight * proximal - variables
    }

    /// A length near the minimum along the direction; the slope grows along it. The full length if the slope is small there.
    fn length(&self, direction: &Direction) -> f64 {
        let first = -self.slope(direction, 0.0);
        let (mut low, mut high) = ((0.0, -first), (1.0, self.slope(direction, 1.0)));
        for round in 0..HALVINGS {
            // In the first round this is the full step of Newton's method, which ends the search where no variable
            // meets its bound.
            if high.1 <= FLAT * first {
                break;
            }
            let secant = low.0 - low.1 * (high.0 - low.0) / (high.1 - low.1);
            // A secant may creep along a kink of the slope, and a half knows nothing of it: they take turns.
            let at = if round % 2 == 0 { secant } else { (low.0 + high.0) / 2.0 };
            let slope = self.slope(direction, at);
            if slope > 0.0 {
                high = (at, slope);
            } else if slope < -FLAT * first {
                low = (at, slope);
            } else {
                return at;
            }
        }
        high.0
    }

    fn step(&mut self, direction: &Direction, length: f64) {
        let add = |to: &mut [f64], by: &[f64]| to.iter_mut().zip(by).for_each(|(to, by)| *to += length * by);
        add(&mut self.y, &direction.y);
        add(&mut self.eta, &direction.eta);
        add(&mut self.slopes, &direction.slopes);
        self.evaluate();
    }

    fn centre_if_near(&mut self, residual: f64) {
        let (y, eta) = self.gradients();
        let left = y.iter().chain(&eta).fold(0.0f64, |a, x| a.max(x.abs()));
        // Both are violations of the equations, with and without the proximal term.
        if left < CENTRED * residual {
            self.centre.copy_from_slice(&self.y);
        }
    }
}
