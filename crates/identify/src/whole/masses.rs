//! Masses at the points that give a network the frequencies of a body.
//!
//! `min_θ Σ_i w (½ ln ω_i²/ω̄_i²)² + (ρ/m) ‖θ‖²` for the masses `m_a = m⁰_a exp θ_a`, with the mass and the centre of the body
//! and either its second moments or those of the masses at the start: linear equations in the masses. With modes of unit mass, `∂ ln ω_i²/∂θ_a = −m_a |φ_i(a)|²`.
//!
//! Theory: page *Whole-object fits* of the book.

use crate::error::{Error, ErrorKind, Result};
use crate::model::{Moments, Support};
use crate::solve::Equations;
use nalgebra::{DMatrix, DVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use springfit_numerics::dense::singular;

/// The frequencies that a network should have under a support.
#[derive(Debug, Clone)]
pub struct Vibrations {
    /// The support.
    pub support: Support,
    /// The equations of the network under it.
    pub equations: Equations,
    /// The wanted squares ω², rad²/s², ascending.
    pub squares: Vec<f64>,
}

/// Fitted masses.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct MassFit {
    /// The masses, `[points]`, kg.
    pub masses: Vec<f64>,
    /// The regularization ρ that was chosen.
    pub regularization: f64,
    /// The largest factor by which a mass changed.
    pub change: f64,
    /// The stages of its path.
    pub curve: Vec<MassStage>,
}

/// The root mean square errors `½ ln ω²/ω̄²` with a ρ.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct MassStage {
    /// The stage has this regularization ρ.
    pub regularization: f64,
    /// The frequencies that were fitted have this root mean square error.
    pub trained: f64,
    /// The frequencies that chose ρ have this root mean square error; it is null where none choose.
    pub validated: Option<f64>,
}

/// The values of ρ. Smaller ones fit the frequencies and spoil those above.
const REGULARIZATIONS: [f64; 3] = [1.0, 1e-1, 1e-2];
/// The one of them that is taken where nothing chooses: masses change by 30 % to lower a frequency's error from 10 %.
const PLAIN: usize = 1;
/// Steps for each ρ at most. Each takes the modes under every support.
const STEPS: usize = 12;
/// Steps that bring the masses back to the moments at most. Newton's method doubles the digits in each; where no
/// positive masses have the moments it does not end.
const RETURNS: usize = 30;
/// The relative error of the moments.
// Newton's method doubles the digits in each step: from here the next one is at rounding.
const KEPT: f64 = 1e-10;
/// A step that lowers the objective by a smaller share is the last one.
// The root of the sum of squares that is lowered then falls by less than 5e-4 of itself.
const DECREASE: f64 = 1e-3;
/// The largest change of a logarithm in a step. The derivatives hold for masses that change by some ten per cent, and
/// not by orders of magnitude.
const LONGEST: f64 = 0.5;
/// The singular values of the moments, relative to the largest, that count as zero: points in one plane have none across it, and points that
/// are nearer to a plane than this part of their extent count as in it.
const NOTHING: f64 = 3e-5;

/// Fits the masses at `points`, `[points × dimension]`, from `start`, `[points]`, kg, with the second moments of the body where positive masses have
/// them. The frequencies of `others`, if there are any, choose ρ and whether second moments are those of the body or of the start.
///
/// # Errors
/// No frequency is wanted, a mass at the start is not above zero, no positive masses have the mass and the centre of the body, or
/// frequencies are not found.
pub fn fit_masses(
    points: &[f64],
    dimension: usize,
    start: &[f64],
    moments: &Moments,
    (wanted, others): (&[Vibrations], &[Vibrations]),
) -> Result<MassFit> {
    let fitted: Vec<(usize, usize)> =
        wanted.iter().enumerate().flat_map(|(v, wanted)| (0..wanted.squares.len()).map(move |i| (v, i))).collect();
    if fitted.is_empty() {
        return Err(Error::expected("masses", "frequencies to fit", "none"));
    }
    if let Some(p) = start.iter().position(|m| !(*m > 0.0 && m.is_finite())) {
        let found = format!("{:e} kg at point {}", start[p], p);
        return Err(Error::expected("masses", "masses above zero at the start", found));
    }
    // The mass is right before anything is fitted, so that the way back to the moments is short.
    let scale = moments.mass / start.iter().sum::<f64>();
    let start: Vec<f64> = start.iter().map(|m| scale * m).collect();
    let own = Moments::of_masses(points, dimension, &start);
    let mut best: Option<(f64, MassFit)> = None;
    for second in [&moments.second, &own.second] {
        let problem = Problem::new(points, dimension, &start, (moments, second), wanted);
        // A body that reaches beyond its points may have moments that no positive masses at them have.
        let Some(begin) = problem.back(&vec![0.0; start.len()]) else { continue };
        let mut theta = begin;
        let (mut curve, mut path) = (Vec::new(), Vec::new());
        // With nothing to choose by, the change stays small.
        let stages = if others.is_empty() { &REGULARIZATIONS[..=PLAIN] } else { &REGULARIZATIONS[..] };
        for rho in stages {
            theta = problem.descend(*rho, theta, &fitted)?;
            let judged = residuals(others, &problem.masses(&theta), dimension)?;
            curve.push(MassStage {
                regularization: *rho,
                trained: root_mean_square(&problem.residuals(&theta, &fitted)?.0),
                validated: (!judged.is_empty()).then(|| root_mean_square(&judged)),
            });
            path.push(theta.clone());
        }
        let error = |stage: &MassStage| stage.validated.unwrap_or(stage.trained);
        let least = match others.is_empty() {
            true => curve.len() - 1,
            false => (0..curve.len()).fold(0, |best, k| if error(&curve[k]) < error(&curve[best]) { k } else { best }),
        };
        if best.as_ref().is_none_or(|(least_error, _)| error(&curve[least]) < *least_error) {
            // A mass that is halved counts as one that is doubled.
            let change = path[least].iter().map(|theta| theta.abs().exp()).fold(1.0, f64::max);
            let (masses, regularization) = (problem.masses(&path[least]), REGULARIZATIONS[least]);
            best = Some((error(&curve[least]), MassFit { masses, regularization, change, curve }));
        }
        // With nothing to choose by, second moments are those of the body.
        if others.is_empty() {
            break;
        }
    }
    let impossible = || {
        let expected = "points among which positive masses have the mass and the centre of the body";
        Error::expected("masses", expected, "none").of_kind(ErrorKind::Infeasible)
    };
    best.map(|(_, found)| found).ok_or_else(impossible)
}

/// `½ ln ω²/ω̄²` of all frequencies with these masses.
fn residuals(of: &[Vibrations], masses: &[f64], dimension: usize) -> Result<Vec<f64>> {
    let mut all = Vec::new();
    for vibrations in of {
        let modes = vibrations.equations.lowest_modes(masses, dimension, vibrations.squares.len())?;
        // Half of the logarithm of ω² is that of ω: a residual is the relative error of a frequency.
        all.extend(modes.squares.iter().zip(&vibrations.squares).map(|(a, b)| 0.5 * (a / b).ln()));
    }
    Ok(all)
}

struct Problem<'a> {
    dimension: usize,
    start: &'a [f64],
    wanted: &'a [Vibrations],
    /// A linear function of the masses in each row, `[moments × points]`, and its value.
    rows: DMatrix<f64>,
    kept: DVector<f64>,
}

impl<'a> Problem<'a> {
    /// Keeps the mass and the centre of these moments, and these second moments, in units in which each is about one.
    fn new(
        points: &'a [f64],
        dimension: usize,
        start: &'a [f64],
        (moments, second): (&Moments, &[f64]),
        wanted: &'a [Vibrations],
    ) -> Problem<'a> {
        let d = dimension;
        // In units of the radius of gyration all rows have about the same size, whatever the unit of length is.
        let trace: f64 = (0..d).map(|k| second[k * d + k]).sum();
        let size = (trace / moments.mass).sqrt();
        let away = |p: usize, k: usize| (points[p * d + k] - moments.centre[k]) / size;
        let pairs: Vec<(usize, usize)> = (0..d).flat_map(|k| (0..=k).map(move |l| (k, l))).collect();
        let rows = DMatrix::from_fn(1 + d + pairs.len(), start.len(), |row, p| {
            let value = match row {
                0 => 1.0,
                row if row <= d => away(p, row - 1),
                row => away(p, pairs[row - 1 - d].0) * away(p, pairs[row - 1 - d].1),
            };
            value / moments.mass
        });
        let mut kept = vec![0.0; 1 + d];
        kept[0] = 1.0;
        kept.extend(pairs.iter().map(|(k, l)| second[k * d + l] / (moments.mass * size * size)));
        Problem { dimension, start, wanted, rows, kept: DVector::from_vec(kept) }
    }

    fn masses(&self, theta: &[f64]) -> Vec<f64> {
        self.start.iter().zip(theta).map(|(m, theta)| m * theta.exp()).collect()
    }

    /// The moments that are off, and their derivatives A in θ.
    fn moments(&self, theta: &[f64]) -> (DVector<f64>, DMatrix<f64>) {
        let masses = DVector::from_vec(self.masses(theta));
        let off = &self.rows * &masses - &self.kept;
        let mut slopes = self.rows.clone();
        slopes.column_iter_mut().zip(masses.iter()).for_each(|(mut column, m)| column *= *m);
        (off, slopes)
    }

    /// The shortest way back to the moments, by Newton's method; `None` if it does not get there.
    fn back(&self, theta: &[f64]) -> Option<Vec<f64>> {
        let mut theta = DVector::from_column_slice(theta);
        for _ in 0..RETURNS {
            let (off, slopes) = self.moments(theta.as_slice());
            if off.amax() <= KEPT {
                return Some(theta.as_slice().to_vec());
            }
            // The pseudo-inverse gives the least change of logarithms of all that lead back.
            let step = -pseudo_inverse(&slopes)? * off;
            let longest = step.amax();
            theta += step * (2.0 * LONGEST / longest).min(1.0);
        }
        None
    }

    /// The residuals `½ ln ω²/ω̄²` of these frequencies, and their derivatives in θ.
    fn residuals(&self, theta: &[f64], of: &[(usize, usize)]) -> Result<(Vec<f64>, DMatrix<f64>)> {
        let masses = self.masses(theta);
        let d = self.dimension;
        let (mut residuals, mut rows) = (Vec::new(), Vec::new());
        for (v, wanted) in self.wanted.iter().enumerate() {
            if !of.iter().any(|(own, _)| *own == v) {
                continue;
            }
            let modes = wanted.equations.lowest_modes(&masses, d, wanted.squares.len())?;
            for (_, i) in of.iter().filter(|(own, _)| *own == v) {
                residuals.push(0.5 * (modes.squares[*i] / wanted.squares[*i]).ln());
                let own = modes.shapes[*i].chunks_exact(d).map(|phi| phi.iter().map(|x| x * x).sum::<f64>());
                // With `φᵀ M φ = 1` the derivative of ω² is `−ω² φ_p·φ_p` in a mass, so that of `½ ln ω²` in the
                // logarithm of the mass is `−½ m_p φ_p·φ_p`.
                rows.extend(own.zip(&masses).map(|(square, m)| -0.5 * m * square));
            }
        }
        let count = residuals.len();
        Ok((residuals, DMatrix::from_row_slice(count, masses.len(), &rows)))
    }

    /// Gauss–Newton steps from θ along the moments.
    fn descend(&self, rho: f64, theta: Vec<f64>, of: &[(usize, usize)]) -> Result<Vec<f64>> {
        let share = rho / theta.len() as f64;
        // Means of both squares are weighed against each other, whatever the numbers of frequencies and of points are.
        let weight = (1.0 / of.len().max(1) as f64).sqrt();
        let value = |r: &[f64], theta: &[f64]| {
            weight * weight * r.iter().map(|r| r * r).sum::<f64>() + share * theta.iter().map(|t| t * t).sum::<f64>()
        };
        let mut theta = theta;
        let (mut r, mut j) = self.residuals(&theta, of)?;
        let mut now = value(&r, &theta);
        for _ in 0..STEPS {
            let Some(step) = self.step(&theta, (&r, &j), weight, share) else { break };
            let longest = step.amax();
            let mut length = (LONGEST / longest).min(1.0);
            let mut found = None;
            // Where a thirty-second of a step lowers nothing, the stage has ended.
            for _ in 0..6 {
                let tried: Vec<f64> = theta.iter().zip(step.iter()).map(|(t, s)| t + length * s).collect();
                if let Some(tried) = self.back(&tried) {
                    let (r, j) = self.residuals(&tried, of)?;
                    let after = value(&r, &tried);
                    if after < now {
                        found = Some((tried, r, j, after));
                        break;
                    }
                }
                length /= 2.0;
            }
            let Some((tried, next, slopes, after)) = found else { break };
            let enough = now - after <= DECREASE * now;
            (theta, r, j, now) = (tried, next, slopes, after);
            if enough {
                break;
            }
        }
        Ok(theta)
    }

    /// The step d to the least `w² ‖r + J d‖² + s ‖θ + d‖²` with `A d = −c`. With `z = θ + d = z_A + z_N`, `z_A` the shortest with
    /// `A z = A θ − c` and `A z_N = 0`: `z_N = −J_Nᵀ (s I + J_N J_Nᵀ)⁻¹ w (r + J (z_A − θ))`, where `J_N = w J (I − A⁺ A)`.
    fn step(&self, theta: &[f64], (r, j): (&[f64], &DMatrix<f64>), weight: f64, share: f64) -> Option<DVector<f64>> {
        let theta = DVector::from_column_slice(theta);
        let (off, a) = self.moments(theta.as_slice());
        let inverse = pseudo_inverse(&a)?;
        let along = &inverse * (&a * &theta - off);
        let j = j * weight;
        let free = &j - (&j * &inverse) * &a;
        let lack = DVector::from_column_slice(r) * weight + &j * (&along - &theta);
        let mut square = &free * free.transpose();
        (0..square.nrows()).for_each(|i| square[(i, i)] += share);
        let z = &along - free.transpose() * square.cholesky()?.solve(&lack);
        Some(z - theta)
    }
}

/// `A⁺` of a matrix with few rows.
fn pseudo_inverse(a: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    Some(singular(a.transpose())?.pseudo_inverse(NOTHING).transpose())
}

fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
}
