//! The descent: L-BFGS on the logarithms of the constants, with less and less regularization while loads that it does not see gain.

use super::problem::{Evaluation, Problem, Target};
use crate::error::{Error, Result};
use crate::model::Network;
use argmin::core::{CostFunction, Executor, Gradient};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use std::sync::Mutex;

/// How a whole-object fit goes on.
#[derive(Debug, Clone, PartialEq)]
pub struct WholeSettings {
    /// Values of ρ from the first to the last, each started where the one before ended. The one of least error on the loads of the
    /// validation is taken.
    pub regularizations: Vec<f64>,
    /// Iterations with each.
    pub iterations: u64,
    /// Pairs of steps and gradients that L-BFGS remembers.
    pub memory: usize,
}

impl Default for WholeSettings {
    fn default() -> WholeSettings {
        WholeSettings { regularizations: vec![1e-2, 1e-3, 1e-4, 1e-5, 1e-6], iterations: 20, memory: 10 }
    }
}

/// What a whole-object fit found.
#[derive(Debug, Clone)]
pub struct WholeFit {
    pub network: Network,
    /// The ρ that was taken.
    pub regularization: f64,
    /// `‖u_l − u_l^FEM‖/‖u_l^FEM‖` of the loads of the fit, before and after.
    pub trained: [Vec<f64>; 2],
    /// The same of the loads of the validation.
    pub validated: [Vec<f64>; 2],
    /// Factorisations with all their solves.
    pub evaluations: usize,
    /// The largest factor by which a constant changed.
    pub change: f64,
}

/// The objective for argmin, which asks for value and gradient apart: the last evaluation serves both.
struct Cached<'p, 'a> {
    problem: &'p Problem<'a>,
    targets: &'p [Target],
    last: Mutex<Option<(Vec<f64>, Evaluation)>>,
    evaluations: Mutex<usize>,
}

impl Cached<'_, '_> {
    fn at(&self, theta: &[f64]) -> std::result::Result<Evaluation, argmin::core::Error> {
        let mut last = self.last.lock().expect("nothing panics while it holds the evaluation");
        if let Some((_, evaluation)) = last.as_ref().filter(|(at, _)| at == theta) {
            return Ok(evaluation.clone());
        }
        *self.evaluations.lock().expect("nothing panics while it counts") += 1;
        let found = self.problem.evaluate(theta, self.targets)?;
        let evaluation = found.ok_or_else(|| Error::new("a network that is not positive definite"))?;
        *last = Some((theta.to_vec(), evaluation.clone()));
        Ok(evaluation)
    }
}

impl CostFunction for &Cached<'_, '_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, theta: &Vec<f64>) -> std::result::Result<f64, argmin::core::Error> {
        Ok(self.at(theta)?.value)
    }
}

impl Gradient for &Cached<'_, '_> {
    type Param = Vec<f64>;
    type Gradient = Vec<f64>;

    fn gradient(&self, theta: &Vec<f64>) -> std::result::Result<Vec<f64>, argmin::core::Error> {
        Ok(self.at(theta)?.gradient)
    }
}

/// Fits the constants to `trained`; of the regularizations that which is best on `validated` is taken.
///
/// # Errors
/// There is no load, the network does not stand, or the equations do not fit into memory.
pub fn fit_whole(
    problem: &mut Problem,
    trained: &[Target],
    validated: &[Target],
    settings: &WholeSettings,
) -> Result<WholeFit> {
    if trained.is_empty() || settings.regularizations.is_empty() {
        return Err(Error::expected("loads", "at least one load and one regularization", "none"));
    }
    let stands = |found: Option<Evaluation>| {
        found.ok_or_else(|| Error::expected("springs", "a network that stands", "a mechanism"))
    };
    let start = problem.start().to_vec();
    let before = stands(problem.evaluate(&start, trained)?)?.errors;
    let validated_before = stands(problem.evaluate(&start, validated)?)?.errors;
    let mean = |errors: &[f64]| errors.iter().map(|e| e.ln()).sum::<f64>() / errors.len().max(1) as f64;
    let mut best = (mean(&validated_before), start.clone(), f64::INFINITY);
    let (mut theta, mut evaluations) = (start.clone(), 2);
    for &regularization in &settings.regularizations {
        problem.regularization = regularization;
        let cached = Cached { problem, targets: trained, last: Mutex::new(None), evaluations: Mutex::new(0) };
        let solver = LBFGS::new(MoreThuenteLineSearch::new(), settings.memory);
        let configure = |state: argmin::core::IterState<_, _, _, _, _, f64>| {
            state.param(theta.clone()).max_iters(settings.iterations)
        };
        let run = Executor::new(&cached, solver).configure(configure).run();
        evaluations += *cached.evaluations.lock().expect("nothing panics while it counts");
        // A line search that fails ends this ρ where it stands.
        if let Some(found) = run.ok().and_then(|mut run| run.state.take_best_param()) {
            theta = found;
        }
        let Some(others) = problem.evaluate(&theta, validated)? else { break };
        evaluations += 1;
        let error = mean(&others.errors);
        if validated.is_empty() || error < best.0 {
            best = (error, theta.clone(), regularization);
        } else {
            break;
        }
    }
    let (_, theta, regularization) = best;
    let after = stands(problem.evaluate(&theta, trained)?)?.errors;
    let validated_after = stands(problem.evaluate(&theta, validated)?)?.errors;
    let change = theta.iter().zip(&start).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max).exp();
    Ok(WholeFit {
        network: problem.network(&theta),
        regularization,
        trained: [before, after],
        validated: [validated_before, validated_after],
        evaluations: evaluations + 2,
        change,
    })
}
