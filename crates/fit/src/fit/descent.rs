//! General optimisers on the raw objective, as the older literature used them; they show what such a search reaches
//! compared with the native solver.
//!
//! Annealing found spring constants in O. Deussen, L. Kobbelt, P. Tücke, "Using simulated annealing to obtain good
//! approximations of deformable bodies", EG Workshop on Computer Animation and Simulation 1995. Genetic searches found
//! them in A. Joukhadar, F. Garat, C. Laugier, "Parameter identification for dynamic simulation", ICRA 1997, and
//! together with the set of springs in G. Bianchi et al., "Simultaneous topology and stiffness identification for
//! mass-spring models based on FEM reference deformations", MICCAI 2004.

use super::objective::Objective;
use super::reduction::{Reduced, Source};
use super::settings::Fit;
use super::solver::{Search, Topology};
use super::weight::MotionWeight;
use crate::material::Hooke;
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

/// The objective of one element as a function of its unknowns κ, followed by their switches if there are any.
struct Raw<'a> {
    reduced: &'a Reduced<f64>,
    objective: Objective,
    nonnegative: bool,
    /// The cost of each spring that is on.
    price: f64,
    /// The length of a random step.
    stride: f64,
    random: Mutex<StdRng>,
}

impl Raw<'_> {
    /// The objective, with the cost of the springs that are on.
    fn cost_of(&self, at: &[f64]) -> f64 {
        let kappa = self.kappa(at);
        let on = self.reduced.unknowns.iter().filter(|&&unknown| kappa[unknown] != 0.0).count();
        self.value(&kappa) + self.price * on as f64
    }

    fn value(&self, kappa: &[f64]) -> f64 {
        let p = self.reduced.order;
        let mut e = vec![0.0; p * p];
        self.reduced.residual(kappa, &mut e);
        // The residual has its lower triangle alone, whereas nalgebra's eigenvalues and norm read the whole matrix.
        let e = DMatrix::from_fn(p, p, |i, j| e[i.max(j) * p + i.min(j)]);
        match self.objective {
            Objective::Frobenius(_) => e.norm(),
            Objective::Spectral(_) => springfit_numerics::dense::eigenvalues(e).amax(),
            Objective::Divergence(balance) => {
                let balance = balance.value();
                let eigenvalues = springfit_numerics::dense::eigenvalues(DMatrix::identity(p, p) - e);
                if eigenvalues.min() <= 0.0 {
                    // The objective is infinite here. A number keeps the difference of two such points defined, which
                    // annealing asks for.
                    return 1e300;
                }
                eigenvalues.iter().map(|a| a + balance / a - (1.0 - balance) * a.ln()).sum()
            }
        }
    }

    /// The κ within their bounds, and zero if they are switched off.
    fn kappa(&self, at: &[f64]) -> Vec<f64> {
        let (kappa, switches) = at.split_at(self.reduced.scales.len());
        let is_off = |i: usize| switches.get(i).is_some_and(|switch| *switch < 0.0);
        let bounded = |(i, k): (usize, &f64)| match *k {
            _ if is_off(i) => 0.0,
            k if self.nonnegative => k.max(0.0),
            k => k,
        };
        kappa.iter().enumerate().map(bounded).collect()
    }
}

impl CostFunction for &Raw<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, at: &Vec<f64>) -> std::result::Result<f64, argmin::core::Error> {
        Ok(self.cost_of(at))
    }
}

impl Anneal for &Raw<'_> {
    type Param = Vec<f64>;
    type Output = Vec<f64>;
    type Float = f64;

    fn anneal(&self, at: &Vec<f64>, extent: f64) -> std::result::Result<Vec<f64>, argmin::core::Error> {
        // The optimiser calls from one thread, so that the lock is never waited for, and the sequence of numbers is the
        // same in each run.
        let mut random = self.random.lock().expect("nothing panics while it holds the generator");
        let (kappa, switches) = at.split_at(self.reduced.scales.len());
        let extent = extent.min(1.0);
        // When a spring is removed the others have to adapt: steps that shrink with the temperature would be too short
        // for that.
        let size = self.stride * if switches.is_empty() { extent } else { extent.sqrt() };
        // The random walk is symmetric about the present point, as the rule of Metropolis asks for.
        let mut next: Vec<f64> = kappa.iter().map(|k| k + size * random.random_range(-1.0..=1.0)).collect();
        next.extend(switches);
        // A switch is on or off: small steps would not change it.
        if !switches.is_empty() && random.random_bool(FLIPPING) {
            let flipped = random.random_range(kappa.len()..at.len());
            next[flipped] = -next[flipped];
        }
        Ok(next)
    }
}

/// The probability with which a step of annealing flips one of the switches.
// Of quad4, tet4 and hex8 probabilities of 0.03 to 0.5 leave objectives that are the same to 1 %; if each step flips a
// switch they are 18 % larger.
const FLIPPING: f64 = 0.25;
/// The number of iterations after which a swarm has agreed on the set of springs. The remaining iterations go to
/// another swarm.
// Swarms of 25 to 400 iterations leave objectives that are the same to 2 % after 2 000 iterations; those of 800 leave 5
// % more, and a single swarm 18 % more.
const AGREED: u64 = 200;

/// The constants of the element with nodes at `x`, `[springs]`, N/m. The objective, with the cost of the springs, is
/// never larger than at the start.
///
/// # Errors
/// The message of an optimiser that fails.
pub fn search(
    springs: &Springs,
    x: &[f64],
    geometry: &Geometry,
    hooke: &Hooke,
    fit: &Fit,
    weight: MotionWeight,
    (method, iterations, topology): (Search, u64, Option<Topology>),
) -> std::result::Result<Vec<f64>, String> {
    let mut reduced = Reduced::like(&0.0, springs, fit.tied);
    let mut measured = vec![0.0; springs.functions().len() * x.len()];
    springs.function_gradients(x, &mut measured);
    reduced.set(weight, springs, x, Source::Element(geometry, hooke), &measured);
    let count = reduced.scales.len();
    let mut start = vec![reduced.uniform(); count];
    // Best equal constants tell the size of κ, of which a search knows nothing else.
    // Half of this share leaves switched annealing 2 % more and a swarm without switches 6 % more, and twice of it
    // leaves a swarm with switches 16 % more. Without switches twice of it leaves 1 to 6 % less.
    let stride = 0.3 * start.iter().sum::<f64>() / count as f64;
    // The seed is fixed: the same element has the same springs in each run. The
    // optimiser has the objective behind a shared reference, hence the lock.
    let random = Mutex::new(StdRng::seed_from_u64(1));
    let (objective, nonnegative) = (fit.objective, fit.nonnegative);
    let mut raw = Raw { reduced: &reduced, objective, nonnegative, price: 0.0, stride, random };
    raw.price = topology.map_or(0.0, |topology| topology.sparsity * raw.value(&start));
    start.extend(topology.iter().flat_map(|_| vec![1.0; count]));
    let failed = |error: argmin::core::Error| error.to_string();
    let best: Option<Vec<f64>> = match method {
        Search::NelderMead => {
            let mut simplex = vec![start.clone(); start.len() + 1];
            simplex.iter_mut().skip(1).enumerate().for_each(|(i, vertex)| vertex[i] += stride);
            // Objectives are of the size of one: the simplex has ended where its values agree to twelve digits.
            let solver = NelderMead::new(simplex).with_sd_tolerance(1e-12).expect("the tolerance is positive");
            let run = Executor::new(&raw, solver).configure(|state| state.max_iters(iterations)).run();
            run.map_err(failed)?.state.take_best_param()
        }
        Search::ParticleSwarm => {
            // The remaining springs take the load of those that are removed.
            let most = if topology.is_some() { 10.0 } else { 3.0 };
            let bound = |sign: f64| {
                // Three strides are 0.9 of the start, so that every κ of a swarm is above zero unless it is switched
                // off.
                let reach = stride * if sign > 0.0 { most } else { -3.0 };
                let kappa = start[..count].iter().map(|k| k + reach);
                kappa.chain(start[count..].iter().map(|_| sign)).collect::<Vec<f64>>()
            };
            let swarm = |seed: u64, iterations: u64| -> std::result::Result<Option<Vec<f64>>, String> {
                let random = StdRng::seed_from_u64(seed);
                // Forty particles are those of the standard swarm (Clerc 2012).
                let solver = ParticleSwarm::new((bound(-1.0), bound(1.0)), 40).with_rng_generator(random);
                let run = Executor::new(&raw, solver).configure(|state| state.max_iters(iterations)).run();
                Ok(run.map_err(failed)?.state.best_individual.map(|particle| particle.position))
            };
            let each = topology.map_or(iterations, |_| iterations.min(AGREED)).max(1);
            let swarms = iterations.div_ceil(each).max(1);
            // Each swarm has a seed of its own; the last one has the iterations that are left.
            // The first swarms have `each` iterations, of which none is left over: `i each < iterations` for every `i <
            // swarms`, so that the difference cannot be negative.
            let found = (0..swarms).map(|i| swarm(1 + i, each.min(iterations - i * each)));
            let found = found.collect::<std::result::Result<Vec<_>, String>>()?;
            found.into_iter().flatten().min_by(|a, b| raw.cost_of(a).total_cmp(&raw.cost_of(b)))
        }
        Search::SimulatedAnnealing => {
            let rng = StdRng::seed_from_u64(1);
            // At a temperature of one the first steps have the whole stride.
            let solver = SimulatedAnnealing::new_with_rng(1.0, rng).expect("the temperature is positive");
            let configure = |state: argmin::core::IterState<_, (), (), (), (), f64>| {
                state.param(start.clone()).max_iters(iterations)
            };
            let run = Executor::new(&raw, solver).configure(configure).run();
            run.map_err(failed)?.state.take_best_param()
        }
    };
    let best = best.ok_or("it has no best point")?;
    // A search that finds nothing better ends at its start.
    let kappa = raw.kappa(if raw.cost_of(&best) <= raw.cost_of(&start) { &best } else { &start });
    Ok(reduced.unknowns.iter().map(|&unknown| kappa[unknown] * reduced.scales[unknown]).collect())
}
