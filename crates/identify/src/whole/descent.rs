//! What a descent of the objective of a whole-object fit finds, and L-BFGS.

use super::linearized::LeastSquares;
use crate::error::{Error, Result};
use argmin::core::{CostFunction, Executor, Gradient, IterState, State, TerminationReason};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use std::cell::RefCell;

/// The end of a descent, and the way to it.
pub(super) struct Descent {
    /// The lowest point.
    pub theta: Vec<f64>,
    /// The objective at the start and at each lower point; empty if the network is unstable at the start.
    pub objective: Vec<f64>,
    /// Whether it ended by itself, and not at its largest number of steps.
    pub is_finished: bool,
}

/// The objective for argmin, which requests value and gradient separately; the last point is stored for both.
struct Objective<'a> {
    problem: &'a dyn LeastSquares,
    rho: f64,
    known: RefCell<Known<'a>>,
}

struct Known<'a> {
    last: Option<(Vec<f64>, f64, Vec<f64>)>,
    best: (f64, Vec<f64>),
    lowered: Vec<f64>,
    visit: &'a mut dyn FnMut(&[f64], f64) -> bool,
    /// The error that ended the search, if there was one.
    error: Option<Error>,
}

impl Objective<'_> {
    fn at(&self, theta: &[f64]) -> std::result::Result<(f64, Vec<f64>), argmin::core::Error> {
        let mut known = self.known.borrow_mut();
        if let Some((_, value, gradient)) = known.last.as_ref().filter(|(at, ..)| at == theta) {
            return Ok((*value, gradient.clone()));
        }
        let linearized = match self.problem.at(theta) {
            Ok(Some(linearized)) => linearized,
            // The line search returns from points where the network is unstable.
            Ok(None) => return Ok((f64::INFINITY, vec![0.0; theta.len()])),
            Err(error) => {
                known.error = Some(error.clone());
                return Err(error.into());
            }
        };
        let (value, gradient) = match linearized.objective(self.rho) {
            Ok(found) => found,
            Err(error) => {
                known.error = Some(error.clone());
                return Err(error.into());
            }
        };
        known.last = Some((theta.to_vec(), value, gradient.clone()));
        if value < known.best.0 {
            known.best = (value, theta.to_vec());
            known.lowered.push(value);
            if !(known.visit)(theta, value) {
                // An error is what ends a search of argmin from within; `known.error` stays empty, so that it counts as
                // an end.
                return Err(Error::new("cancelled").into());
            }
        }
        Ok((value, gradient))
    }
}

impl CostFunction for &Objective<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, theta: &Vec<f64>) -> std::result::Result<f64, argmin::core::Error> {
        Ok(self.at(theta)?.0)
    }
}

impl Gradient for &Objective<'_> {
    type Param = Vec<f64>;
    type Gradient = Vec<f64>;

    fn gradient(&self, theta: &Vec<f64>) -> std::result::Result<Vec<f64>, argmin::core::Error> {
        Ok(self.at(theta)?.1)
    }
}

/// Minimises from θ in at most `iterations` steps with `memory` pairs of steps and gradients (Liu and Nocedal 1989),
/// to the lowest point. `visit` is called with each new lowest point and may end the search by returning false.
pub(super) fn lbfgs(
    problem: &dyn LeastSquares,
    rho: f64,
    theta: &[f64],
    memory: usize,
    iterations: usize,
    visit: &mut dyn FnMut(&[f64], f64) -> bool,
) -> Result<Descent> {
    let known = Known { last: None, best: (f64::INFINITY, theta.to_vec()), lowered: Vec::new(), visit, error: None };
    let objective = Objective { problem, rho, known: RefCell::new(known) };
    let configure = |state: IterState<_, _, _, _, _, f64>| state.param(theta.to_vec()).max_iters(iterations as u64);
    let solver = LBFGS::new(MoreThuenteLineSearch::new(), memory);
    // If a line search fails, the search ends at the present point.
    // The program itself hears interrupts.
    let ended = Executor::new(&objective, solver).configure(configure).ctrlc(false).run();
    let reason = ended.ok().and_then(|end| end.state().get_termination_reason().cloned());
    let is_finished = reason != Some(TerminationReason::MaxItersReached);
    let known = objective.known.into_inner();
    match known.error {
        Some(error) => Err(error),
        None => Ok(Descent { theta: known.best.1, objective: known.lowered, is_finished }),
    }
}
