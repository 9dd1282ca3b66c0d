//! General optimisers on the raw objective, as the older literature searched it: what they reach beside the native solver.

use super::reduction::Reduced;
use super::{Fit, Objective, Weight};
use crate::error::{Error, Result};
use crate::material::Moduli;
use crate::springs::Springs;
use crate::stiffness::Geometry;
use argmin::core::{CostFunction, Executor};
use argmin::solver::neldermead::NelderMead;
use argmin::solver::particleswarm::ParticleSwarm;
use argmin::solver::simulatedannealing::{Anneal, SimulatedAnnealing};
use nalgebra::DMatrix;
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use std::sync::Mutex;

/// What minimises the objective.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Solver {
    /// Normal equations, pivoting, the barrier or Newton's method, as the objective needs.
    #[default]
    Native,
    /// A general optimiser with at most so many iterations, from constants all alike.
    General { method: Search, iterations: u64 },
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Search {
    NelderMead,
    /// 40 particles.
    ParticleSwarm,
    SimulatedAnnealing,
}

impl Solver {
    pub const NAMES: [&'static str; 4] = ["native", "nelder-mead", "particle-swarm", "simulated-annealing"];
    pub const DEFAULT_ITERATIONS: u64 = 2000;

    /// The solver called `name`; `iterations` belongs to the general ones.
    ///
    /// # Errors
    /// The name is unknown, no iterations are allowed, or they are given to the native solver.
    pub fn named(name: &str, iterations: Option<u64>) -> Result<Solver> {
        let method = match name {
            "native" if iterations.is_some() => {
                return Err(Error::at("iterations", "belongs to a general solver, found with \"native\""));
            }
            "native" => return Ok(Solver::Native),
            "nelder-mead" => Search::NelderMead,
            "particle-swarm" => Search::ParticleSwarm,
            "simulated-annealing" => Search::SimulatedAnnealing,
            _ => {
                let expected = format!("one of {}", Solver::NAMES.join(", "));
                return Err(Error::expected("solver", expected, format!("\"{name}\"")));
            }
        };
        match iterations {
            Some(0) => Err(Error::expected("iterations", "a number above 0", 0)),
            _ => Ok(Solver::General { method, iterations: iterations.unwrap_or(Solver::DEFAULT_ITERATIONS) }),
        }
    }

    pub fn name(&self) -> &'static str {
        match self {
            Solver::Native => Solver::NAMES[0],
            Solver::General { method: Search::NelderMead, .. } => Solver::NAMES[1],
            Solver::General { method: Search::ParticleSwarm, .. } => Solver::NAMES[2],
            Solver::General { method: Search::SimulatedAnnealing, .. } => Solver::NAMES[3],
        }
    }
}

/// The objective of one element as a function of its unknowns.
struct Raw<'a> {
    reduced: &'a Reduced<f64>,
    objective: Objective,
    nonnegative: bool,
    /// The length of a random step.
    stride: f64,
    random: Mutex<StdRng>,
}

impl Raw<'_> {
    fn value(&self, kappa: &[f64]) -> f64 {
        let p = self.reduced.order;
        let kappa = self.bounded(kappa);
        let mut e = vec![0.0; p * p];
        self.reduced.residual(&kappa, &mut e);
        let e = DMatrix::from_fn(p, p, |i, j| e[i.max(j) * p + i.min(j)]);
        match self.objective {
            Objective::Frobenius(_) => e.norm(),
            Objective::Spectral(_) => e.symmetric_eigenvalues().amax(),
            Objective::Divergence { balance } => {
                let eigenvalues = (DMatrix::identity(p, p) - e).symmetric_eigenvalues();
                if eigenvalues.min() <= 0.0 {
                    return 1e300;
                }
                eigenvalues.iter().map(|a| a + balance / a - (1.0 - balance) * a.ln()).sum()
            }
        }
    }

    fn bounded(&self, kappa: &[f64]) -> Vec<f64> {
        kappa.iter().map(|k| if self.nonnegative { k.max(0.0) } else { *k }).collect()
    }
}

impl CostFunction for &Raw<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, kappa: &Vec<f64>) -> std::result::Result<f64, argmin::core::Error> {
        Ok(self.value(kappa))
    }
}

impl Anneal for &Raw<'_> {
    type Param = Vec<f64>;
    type Output = Vec<f64>;
    type Float = f64;

    fn anneal(&self, kappa: &Vec<f64>, extent: f64) -> std::result::Result<Vec<f64>, argmin::core::Error> {
        let mut random = self.random.lock().expect("nothing panics while it holds the generator");
        let size = self.stride * extent.min(1.0);
        Ok(kappa.iter().map(|k| k + size * random.random_range(-1.0..=1.0)).collect())
    }
}

/// The constants of the element with nodes at `x`, `[springs]`, N/m.
pub fn search(
    springs: &Springs,
    x: &[f64],
    geometry: &Geometry,
    moduli: &Moduli,
    fit: &Fit,
    method: Search,
    iterations: u64,
) -> Vec<f64> {
    let mut reduced = Reduced::of_kind(&0.0, springs, fit.tied);
    let mut measured = vec![0.0; springs.functions.len() * x.len()];
    springs.function_gradients(x, &mut measured);
    reduced.set(fit.objective.weight().unwrap_or(Weight::Relative), springs, x, geometry, moduli, &measured);
    let count = reduced.scales.len();
    let start = vec![reduced.uniform(); count];
    let stride = 0.3 * start.iter().sum::<f64>() / count as f64;
    let random = Mutex::new(StdRng::seed_from_u64(1));
    let raw = Raw { reduced: &reduced, objective: fit.objective, nonnegative: fit.nonnegative, stride, random };
    let best: Option<Vec<f64>> = match method {
        Search::NelderMead => {
            let mut simplex = vec![start.clone(); count + 1];
            simplex.iter_mut().skip(1).enumerate().for_each(|(i, vertex)| vertex[i] += stride);
            let solver = NelderMead::new(simplex).with_sd_tolerance(1e-12).expect("the tolerance is positive");
            let run = Executor::new(&raw, solver).configure(|state| state.max_iters(iterations)).run();
            run.ok().and_then(|mut run| run.state.take_best_param())
        }
        Search::ParticleSwarm => {
            let bound = |sign: f64| start.iter().map(|k| k + sign * 3.0 * stride).collect::<Vec<f64>>();
            let solver = ParticleSwarm::new((bound(-1.0), bound(1.0)), 40).with_rng_generator(StdRng::seed_from_u64(1));
            let run = Executor::new(&raw, solver).configure(|state| state.max_iters(iterations)).run();
            run.ok().and_then(|run| run.state.best_individual.map(|particle| particle.position))
        }
        Search::SimulatedAnnealing => {
            let rng = StdRng::seed_from_u64(1);
            let solver = SimulatedAnnealing::new_with_rng(1.0, rng).expect("the temperature is positive");
            let configure = |state: argmin::core::IterState<_, (), (), (), (), f64>| {
                state.param(start.clone()).max_iters(iterations)
            };
            let run = Executor::new(&raw, solver).configure(configure).run();
            run.ok().and_then(|mut run| run.state.take_best_param())
        }
    };
    // An optimiser that fails leaves what it was given.
    let kappa = raw.bounded(&best.filter(|best| raw.value(best) <= raw.value(&start)).unwrap_or(start.clone()));
    reduced.unknowns.iter().map(|&unknown| kappa[unknown] * reduced.scales[unknown]).collect()
}
