//! Few moduli by least squares, and their covariance.
//!
//! Theory: page *Calibration* of the book.

use super::limit::{Limit, Limiting};
use crate::error::{Error, ErrorKind, Result};
use crate::springs::dot;
use crate::whole::{Determination, ninety_five};
use nalgebra::{DMatrix, DVector};

/// What was found of few moduli.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Estimate {
    /// The unknowns.
    pub theta: Vec<f64>,
    /// Their covariance by noise; `None` of pairs that the measurements do not determine.
    pub covariance: Vec<Vec<Option<f64>>>,
    /// Deviations on either side that hold 95 % of the noise.
    pub reach: f64,
    /// The deviation of each unknown that the error of the extrapolated meshes causes; `None` without a finer mesh.
    pub mesh: Option<Vec<f64>>,
    /// Each unknown changes by this much from each mesh to the next, by linearisation, `[meshes − 1][unknowns]`.
    pub changes: Vec<Vec<f64>>,
    /// The ratio of the last two changes of the answers; `None` with fewer than three meshes.
    pub ratio: Option<f64>,
    /// What the error of the meshes gives to the sum of the squares of the residuals.
    pub left: f64,
    /// The residuals `(y − u)/σ`.
    pub residuals: Vec<f64>,
    /// The root of `Σ r²/(n − m)`: 1 where noise is known and the model explains the measurements.
    pub misfit: f64,
    /// Combinations of unknowns that the measurements hardly see.
    pub weak: Vec<Vec<usize>>,
    /// Steps that were taken.
    pub steps: usize,
    /// Where the search has ended before the optimum, why.
    pub fault: Option<Fault>,
}

/// Why a search has ended before its optimum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// The largest number of steps.
    Steps,
    /// No step is better, though the gradient promises one.
    Stalled,
}

/// Steps at most.
// With the bound below, ten steps lead to a modulus of a million times the guess. A search that takes so many is reported as one
// that has not ended.
const STEPS: usize = 60;
/// A step that counts as none: far below any interval.
const SETTLED: f64 = 1e-7;
/// The largest change of an unknown in a step, a logarithm.
// A modulus changes by the factor `e^1.5 = 4.5` in a step at most, beyond which a linearisation in the logarithm says
// nothing of displacements that go with its inverse.
const LARGEST: f64 = 1.5;
/// The step at which a search on some of the meshes ends: the next mesh moves the optimum by more.
const NEAR: f64 = 0.01;

/// The unknowns that make the sum of squares least. `noise` says whether the weights are those of known noise. A search on the first meshes, whose
/// steps cost little, gives the start on all of them.
///
/// # Errors
/// There are as many unknowns as measurements, or no equilibrium at the first guess.
pub fn estimate(limit: &Limit, noise: bool, goes_on: &mut dyn FnMut(usize) -> bool) -> Result<Estimate> {
    let m = limit.unknowns.count();
    // As many numbers as unknowns are met exactly, and leave no residual by which noise or model could be judged.
    if limit.observations.len() <= m {
        return Err(Error::expected(
            "measured",
            format!("more than {m} numbers, one for each unknown"),
            limit.observations.len(),
        ));
    }
    let nothing = || {
        Error::expected("load", "loads under which the body has an equilibrium", "none").of_kind(ErrorKind::Infeasible)
    };
    let (meshes, guess) = (limit.levels.len(), vec![0.0; m]);
    let (mut start, mut before) = (guess.clone(), 0);
    for some in 1..meshes {
        let mut goes_on = |steps| goes_on(before + steps);
        if let Some(found) = search(limit, some, start.clone(), NEAR, &mut goes_on)? {
            before += found.steps;
            // Where no optimum is near, the guess is the better start.
            start = if found.fault.is_none() { found.theta } else { guess.clone() };
        }
    }
    let mut found = search(limit, meshes, start.clone(), SETTLED, &mut |steps| goes_on(before + steps))?;
    // Coarse meshes that lock may lead astray.
    if start != guess && found.as_ref().is_none_or(|found| found.fault.is_some()) {
        before += found.as_ref().map_or(0, |found| found.steps);
        let other = search(limit, meshes, guess, SETTLED, &mut |steps| goes_on(before + steps))?;
        let square =
            |found: &Option<Reached>| found.as_ref().map_or(f64::INFINITY, |found| sum_of_squares(limit, &found.now));
        if square(&other) < square(&found) {
            found = other;
        }
    }
    let Reached { theta, now, fault, steps } = found.ok_or_else(nothing)?;
    let steps = before + steps;
    let (columns, residuals) = (limit.weighed(&now.columns), limit.residuals(&now.values()));
    let known = Determination::by(&columns, &residuals, residuals.len(), noise.then_some(1.0))?;
    // Residuals are in units of known noise; without it their spread stands for the noise.
    let size = if noise { 1.0 } else { known.residual };
    let inverse = inverse(&columns);
    let covariance = (0..m).map(|p| {
        let entry = |q: usize| known.deviations[p].and(known.deviations[q]).map(|_| size * size * inverse[(p, q)]);
        (0..m).map(entry).collect()
    });
    let covariance: Vec<Vec<Option<f64>>> = covariance.collect();
    let pulled = |change: &[f64]| -> Vec<f64> {
        let weighed: Vec<f64> = change.iter().zip(&limit.weights).map(|(c, w)| c * w).collect();
        let slopes = DVector::from_iterator(m, columns.iter().map(|column| dot(column, &weighed)));
        (&inverse * slopes).iter().map(|change| -change).collect()
    };
    let changes: Vec<Vec<f64>> = (0..limit.levels.len() - 1).map(|level| pulled(&now.change(level))).collect();
    // The errors of meshes move all unknowns together.
    let mesh = now.rest.zip(changes.last()).map(|(rest, last)| {
        // With one refinement there is no change before the last, and κ does not count.
        let before = |p: usize| changes.len().checked_sub(2).map_or(0.0, |before| changes[before][p]);
        let largest = last.iter().fold(0.0, |most: f64, last| most.max(last.abs()));
        last.iter().enumerate().map(|(p, last)| rest.spread(*last, before(p)) + rest.hidden * largest).collect()
    });
    Ok(Estimate {
        theta,
        covariance,
        reach: ninety_five((!noise).then_some(residuals.len() - m)),
        mesh,
        changes,
        ratio: now.rest.and_then(|rest| rest.ratio),
        left: limit.left(&now),
        misfit: known.residual,
        residuals,
        weak: known.weak,
        steps,
        fault,
    })
}

/// Where a search has come to.
struct Reached {
    theta: Vec<f64>,
    now: Limiting,
    /// Where it has ended before the optimum, why.
    fault: Option<Fault>,
    steps: usize,
}

fn sum_of_squares(limit: &Limit, at: &Limiting) -> f64 {
    let r = limit.residuals(&at.values());
    dot(&r, &r)
}

/// Steps of Levenberg and Marquardt on so many of the meshes until one is below `settled`; `None` without an equilibrium at the start.
fn search(
    limit: &Limit,
    meshes: usize,
    mut theta: Vec<f64>,
    settled: f64,
    goes_on: &mut dyn FnMut(usize) -> bool,
) -> Result<Option<Reached>> {
    let finest = meshes - 1;
    let Some(mut now) = limit.at(&theta, meshes, finest)? else { return Ok(None) };
    let (mut damping, mut fault, mut steps) = (0.0, Some(Fault::Steps), 0);
    for count in 0..STEPS {
        if !goes_on(count) {
            break;
        }
        steps = count + 1;
        let (columns, residuals) = (limit.weighed(&now.columns), limit.residuals(&now.values()));
        let before = sum_of_squares(limit, &now);
        let mut found = None;
        // Twelve factors of ten shorten a step below all that can be seen.
        for _ in 0..12 {
            let step = damped(&columns, &residuals, damping);
            let largest = step.iter().fold(0.0, |a: f64, s| a.max(s.abs()));
            if largest < settled {
                // A step that damping alone has made small says nothing of the optimum.
                if damping == 0.0 {
                    fault = None;
                }
                break;
            }
            // The whole step is shortened, and keeps its direction.
            let length = (LARGEST / largest).min(1.0);
            let tried: Vec<f64> = theta.iter().zip(&step).map(|(t, s)| t + length * s).collect();
            if let Some(next) = limit.at(&tried, meshes, finest)?
                && sum_of_squares(limit, &next) < before
            {
                found = Some((tried, next));
                break;
            }
            // Marquardt's factors of ten, from a damping that hardly changes a step.
            damping = if damping == 0.0 { 1e-4 } else { 10.0 * damping };
        }
        let Some((tried, next)) = found else {
            // Near the optimum rounding decides.
            let step = damped(&columns, &residuals, 0.0);
            // A relative change of 1e-4 is far below the intervals that are reported.
            let near = step.iter().all(|s| s.abs() < 1e-4);
            fault = fault.filter(|_| !near).map(|_| Fault::Stalled);
            break;
        };
        (theta, now) = (tried, next);
        // Steps that succeed become those of Gauss and Newton again, which converge fastest near the optimum.
        damping = if damping < 1e-4 { 0.0 } else { damping / 10.0 };
    }
    Ok(Some(Reached { theta, now, fault, steps }))
}

/// The step of Levenberg and Marquardt in units in which each unknown changes the residuals alike.
fn damped(columns: &[Vec<f64>], residuals: &[f64], damping: f64) -> Vec<f64> {
    let m = columns.len();
    // An unknown that nothing sees has a column of zeros, which must not divide by zero.
    let norms: Vec<f64> = columns.iter().map(|column| dot(column, column).sqrt().max(f64::MIN_POSITIVE)).collect();
    let scaled = |p: usize, q: usize| dot(&columns[p], &columns[q]) / (norms[p] * norms[q]);
    let normal = DMatrix::from_fn(m, m, |p, q| scaled(p, q) + if p == q { damping } else { 0.0 });
    let slopes = DVector::from_fn(m, |p, _| dot(&columns[p], residuals) / norms[p]);
    let eigen = springfit_numerics::dense::eigen(normal);
    let mut step = vec![0.0; m];
    for (value, vector) in
        // A combination that measurements see to less than a millionth stays where it is.
        eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()).filter(|(value, _)| **value > 1e-12)
    {
        let along = vector.dot(&slopes) / value;
        (0..m).for_each(|p| step[p] += along * vector[p] / norms[p]);
    }
    step
}

/// `(JᵀJ)⁻¹` of what the measurements see.
fn inverse(columns: &[Vec<f64>]) -> DMatrix<f64> {
    let m = columns.len();
    // A column of zeros, which no measurement sees, stays zero and is not 0/0.
    let norms: Vec<f64> = columns.iter().map(|column| dot(column, column).sqrt().max(f64::MIN_POSITIVE)).collect();
    let normal = DMatrix::from_fn(m, m, |p, q| dot(&columns[p], &columns[q]) / (norms[p] * norms[q]));
    let eigen = springfit_numerics::dense::eigen(normal);
    let mut sum = DMatrix::zeros(m, m);
    for (value, vector) in
        // The square of the share from which on a combination counts as seen where deviations are worked out.
        eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()).filter(|(value, _)| **value > 1e-14)
    {
        sum += vector * vector.transpose() / *value;
    }
    DMatrix::from_fn(m, m, |p, q| sum[(p, q)] / (norms[p] * norms[q]))
}
