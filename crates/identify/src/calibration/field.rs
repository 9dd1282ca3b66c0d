//! Young's modulus of each cell, with a prior of smoothness whose weight is the largest that the noise and the error of the mesh allow
//! (Morozov 1966).
//!
//! `min_θ Σ r² + ρ Σ_ab s_ab φ(θ_a − θ_b)` over neighbours a and b with a side of size s. The smooth prior has `φ = (θ_a − θ_b)²/d`, with the
//! distance d of the cells; that of edges `φ = √((θ_a − θ_b)² + ε²)`, the total variation of the field, which lets a modulus jump (Vogel and Oman
//! 1996).
//!
//! Theory: page *Calibration* of the book.

use super::limit::{Limit, Limiting};
use super::neighbours::{Pair, pairs};
use crate::error::{Error, ErrorKind, Result};
use crate::springs::dot;
use nalgebra::{Cholesky, DMatrix, DVector};

/// What a field is like where measurements do not say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Prior {
    /// It is constant but for jumps.
    #[default]
    Edges,
    /// It changes little from cell to cell.
    Smooth,
}

crate::named!(Prior { "edges" => Edges, "smooth" => Smooth });

/// A field that was found.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct FieldEstimate {
    /// The logarithms of the factors, `[cells]`.
    pub theta: Vec<f64>,
    /// Their deviations with the prior, a share of the modulus, `[cells]`.
    pub deviations: Vec<f64>,
    /// The weight of the prior.
    pub weight: f64,
    /// The root of `Σ r²/n` at the end.
    pub misfit: f64,
    /// Whether that is as small as the noise.
    pub is_within_noise: bool,
    /// The residuals `(y − u)/σ`.
    pub residuals: Vec<f64>,
    /// Steps that were taken.
    pub steps: usize,
}

/// The weight falls by this factor from stage to stage.
// On a square of 200 cells with an inclusion of five times the modulus, falls of 2 to 9 end at the same weight to 10 %,
// in 56 to 26 steps.
const FALL: f64 = 3.0;
/// Stages at most: eleven powers of ten.
// Twenty-three falls by the factor three are 9e10.
const STAGES: usize = 24;
/// Steps of each stage.
// With 2 to 16 the errors of the field of that square are the same to 3 %.
const STEPS: usize = 4;
/// The differences of logarithms below which the prior of edges is quadratic.
// Between 0.005 and 0.08 the errors of that field change by 2 %.
const ROUND: f64 = 0.02;
/// Bisections of the weight after the first stage within the noise.
// Each bisection halves the logarithm of a fall by the factor 3: after three of them the weight is known to 3^(1/8) =
// 1.15.
const BISECTIONS: usize = 3;
/// Cells at most: the normal equations are dense.
// With this number they have 288 MB, and a factor takes `6000³/3 = 7e10` operations.
const MOST: usize = 6000;
/// The largest change of a logarithm in one step.
// The bound holds back the first steps of bodies that are far from the guess: where the guess is 1.5 times the modulus,
// a fourth of it would do.
const LARGEST: f64 = 1.0;

struct Search<'a, 'b> {
    limit: &'a Limit<'b>,
    pairs: Vec<Pair>,
    prior: Prior,
    /// The length by which distances are measured, m, so that the weight has no unit.
    unit: f64,
    steps: usize,
}

/// The field with the largest weight of the prior with which residuals are no larger than the noise.
///
/// # Errors
/// There are too many cells, or no equilibrium.
pub fn estimate_field(limit: &Limit, prior: Prior, goes_on: &mut dyn FnMut(usize) -> bool) -> Result<FieldEstimate> {
    let m = limit.unknowns.count();
    if m > MOST {
        return Err(Error::expected("unknowns", format!("at most {MOST} cells with a modulus each"), m));
    }
    let pairs = pairs(&limit.levels[0].mesh);
    // A mesh of one cell has no pairs.
    let unit = pairs.iter().map(|pair| pair.distance).sum::<f64>() / pairs.len().max(1) as f64;
    // Sides over the largest one, so that the weight has no unit.
    let largest = pairs.iter().map(|pair| pair.side).fold(0.0, f64::max);
    let pairs = pairs.into_iter().map(|pair| Pair { side: pair.side / largest, ..pair }).collect();
    let mut search = Search { limit, pairs, prior, unit, steps: 0 };
    let n = limit.observations.len() as f64;
    let misfit = |at: &Limiting| {
        let r = limit.residuals(&at.values());
        (dot(&r, &r) / n).sqrt()
    };
    // What is left of the error of the meshes is as little to be fitted as the noise.
    let is_within = |at: &Limiting| misfit(at) <= (1.0 + limit.left(at) / n).sqrt();
    // One factor for the whole body first: the prior does not see it.
    let mut theta = vec![0.0; m];
    let mut now = search.at(&theta)?.ok_or_else(no_equilibrium)?;
    let columns = limit.weighed(&now.columns);
    // A hundred times the weight of what is seen: the field starts as good as uniform.
    let mut rho = columns.iter().map(|column| dot(column, column)).fold(0.0, f64::max) * 100.0;
    let (mut outside, mut inside): (Option<f64>, Option<f64>) = (None, None);
    let mut best = (theta.clone(), rho);
    for stage in 0..STAGES {
        if !goes_on(stage) {
            break;
        }
        (theta, now) = search.stage(theta, now, rho)?;
        if is_within(&now) {
            inside = Some(rho);
            best = (theta.clone(), rho);
            break;
        }
        best = (theta.clone(), rho);
        outside = Some(rho);
        rho /= FALL;
    }
    if let (Some(mut high), Some(mut low)) = (outside, inside) {
        for _ in 0..BISECTIONS {
            // The weight matters by its logarithm.
            let middle = (high * low).sqrt();
            let (tried, at) = search.stage(best.0.clone(), search.again(&best.0)?, middle)?;
            if is_within(&at) {
                (low, best) = (middle, (tried, middle));
            } else {
                high = middle;
            }
        }
    }
    let (theta, weight) = best;
    let at = search.again(&theta)?;
    let columns = limit.weighed(&at.columns);
    let normal = search.normal(&columns, &theta, weight);
    let deviations = match Cholesky::new(normal) {
        Some(factor) => factor.inverse().diagonal().iter().map(|v| v.max(0.0).sqrt()).collect(),
        // Rounding can make the matrix indefinite. The deviations are not known then, and reports show NaN as unknown.
        None => vec![f64::NAN; m],
    };
    let misfit = misfit(&at);
    Ok(FieldEstimate {
        residuals: limit.residuals(&at.values()),
        theta,
        deviations,
        weight,
        misfit,
        is_within_noise: inside.is_some(),
        steps: search.steps,
    })
}

fn no_equilibrium() -> Error {
    Error::expected("load", "loads under which the body has an equilibrium", "none").of_kind(ErrorKind::Infeasible)
}

impl Search<'_, '_> {
    fn at(&self, theta: &[f64]) -> Result<Option<Limiting>> {
        self.limit.at(theta, self.limit.levels.len(), 0)
    }

    fn again(&self, theta: &[f64]) -> Result<Limiting> {
        self.at(theta)?.ok_or_else(no_equilibrium)
    }

    /// The weight of the difference of two neighbours, with the prior of edges as that of a quadratic one at θ.
    fn pair_weight(&self, pair: &Pair, theta: &[f64]) -> f64 {
        match self.prior {
            Prior::Smooth => pair.side * self.unit / pair.distance,
            Prior::Edges => {
                let [a, b] = pair.cells;
                // Half of the derivative of the root, in units in which a jump of one counts as with the smooth prior.
                0.5 * pair.side / (theta[a] - theta[b]).hypot(ROUND)
            }
        }
    }

    /// The value of the prior.
    fn value(&self, theta: &[f64]) -> f64 {
        let one = |pair: &Pair| {
            let difference = theta[pair.cells[0]] - theta[pair.cells[1]];
            match self.prior {
                Prior::Smooth => self.pair_weight(pair, theta) * difference * difference,
                // Less its value for equal moduli, so that a uniform field costs nothing and small changes of the sum
                // keep their digits.
                Prior::Edges => pair.side * (difference.hypot(ROUND) - ROUND),
            }
        };
        self.pairs.iter().map(one).sum()
    }

    fn normal(&self, columns: &[Vec<f64>], theta: &[f64], rho: f64) -> DMatrix<f64> {
        let m = columns.len();
        let n = columns.first().map_or(0, Vec::len);
        let jacobian = DMatrix::from_fn(n, m, |i, p| columns[p][i]);
        let mut normal = jacobian.tr_mul(&jacobian);
        let mut largest: f64 = 0.0;
        for pair in &self.pairs {
            let weight = rho * self.pair_weight(pair, theta);
            let [a, b] = pair.cells;
            normal[(a, a)] += weight;
            normal[(b, b)] += weight;
            normal[(a, b)] -= weight;
            normal[(b, a)] -= weight;
            largest = largest.max(weight);
        }
        // What neither measurements nor neighbours see stays where it is.
        let least = 1e-10 * normal.diagonal().max();
        (0..m).for_each(|p| normal[(p, p)] += least);
        normal
    }

    /// Steps towards the optimum with one weight.
    fn stage(&mut self, mut theta: Vec<f64>, mut now: Limiting, rho: f64) -> Result<(Vec<f64>, Limiting)> {
        let limit = self.limit;
        let objective = |search: &Self, theta: &[f64], at: &Limiting| {
            let r = limit.residuals(&at.values());
            dot(&r, &r) + rho * search.value(theta)
        };
        for _ in 0..STEPS {
            let columns = limit.weighed(&now.columns);
            let residuals = limit.residuals(&now.values());
            let normal = self.normal(&columns, &theta, rho);
            let mut slope = DVector::from_iterator(theta.len(), columns.iter().map(|column| dot(column, &residuals)));
            for pair in &self.pairs {
                let [a, b] = pair.cells;
                let pull = rho * self.pair_weight(pair, &theta) * (theta[a] - theta[b]);
                slope[a] -= pull;
                slope[b] += pull;
            }
            let Some(factor) = Cholesky::new(normal) else { break };
            let step = factor.solve(&slope);
            let largest = step.amax();
            let before = objective(self, &theta, &now);
            let mut length = (LARGEST / largest).min(1.0);
            let mut found = None;
            // One halving or twelve give the same field of that square: most steps are taken whole.
            for _ in 0..6 {
                let tried: Vec<f64> = theta.iter().zip(&step).map(|(t, s)| t + length * s).collect();
                if let Some(next) = self.at(&tried)?
                    && objective(self, &tried, &next) < before
                {
                    found = Some((tried, next));
                    break;
                }
                length /= 2.0;
            }
            self.steps += 1;
            let Some((tried, next)) = found else { break };
            let after = objective(self, &tried, &next);
            (theta, now) = (tried, next);
            // A stage need not be exact: the next one begins where it has ended.
            if before - after < 1e-3 * before {
                break;
            }
        }
        Ok((theta, now))
    }
}
