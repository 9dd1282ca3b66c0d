//! What a model costs that is there: a solution, and a step of a motion.

use super::costs::ModelTimes;
use super::repeats::{TimedWork, interleaved};
use crate::clock::Clock;
use crate::dynamics::{Integrator, LinearSolver, Motion, Options, Simulation};
use crate::engine::{Frames, Setting, TruncatedModel};
use crate::error::{Error, Result};
use crate::model::{Elastic, Network, Support};

/// The time step of the implicit method, s: that of pictures that move.
const IMPLICIT_STEP: f64 = 1.0 / 60.0;
/// The step of the explicit method as a share of the longest one that is stable.
// The limit is that of the body at rest: with half of it springs may become four times as stiff as they deform.
const SHARE: f64 = 0.5;
/// A pass of steps takes about this time, s: much more than a look at the clock.
const PASS: f64 = 2e-4;
/// Steps of a pass at most.
const MOST_STEPS: usize = 1000;
/// Points are displaced by this share of the body's size at the start, so that no force is zero.
const DISPLACED: f64 = 1e-6;

/// A solution under a load: what is timed, with its own clock.
pub type Statics<'a> = Box<dyn Fn() -> Result<Option<f64>> + 'a>;

/// A model whose costs are measured.
pub struct Costed<'a> {
    /// The finite elements or the network.
    pub model: &'a dyn Elastic,
    /// Whether the model is linear.
    pub linear: bool,
    /// The points at rest, `[points × dimension]`, m.
    pub points: &'a [f64],
    /// What holds the points.
    pub support: &'a Support,
    /// `[points]`, kg.
    pub masses: &'a [f64],
    /// A solution under a load, where there is one.
    pub statics: Option<Statics<'a>>,
    /// The engine that the constants of a network are for.
    pub engine: Option<(&'a Network, Setting)>,
}

impl<'a> Costed<'a> {
    /// A solution, and a step of each kind, as works that are timed; `None` of those that the model does not have. The explicit step depends
    /// on the longest one.
    fn works(&'a self, longest: Option<f64>) -> Result<[Option<TimedWork<'a>>; 4]> {
        let solve = match &self.statics {
            Some(statics) => statics()?.map(|_| {
                let lost = || Error::new("a solution was found once, and then not");
                Box::new(move || statics()?.ok_or_else(lost)) as TimedWork
            }),
            None => None,
        };
        let explicit = longest.map(|longest| self.options(Integrator::SymplecticEuler, SHARE * longest));
        let explicit = explicit.map(|options| self.steps(options)).transpose()?.flatten();
        let implicit = self.steps(self.options(Integrator::ImplicitEuler, IMPLICIT_STEP))?;
        Ok([solve, explicit, implicit, self.frames()?])
    }

    /// Steps of the engine, a second of them.
    fn frames(&self) -> Result<Option<TimedWork<'a>>> {
        let Some((network, setting)) = self.engine else { return Ok(None) };
        let model = TruncatedModel { network, points: self.points, masses: self.masses };
        let mut frames = Frames::new(model, self.support, &setting)?;
        let displacement = self.moved();
        let still = vec![0.0; displacement.len()];
        let mut count = 1;
        Ok(Some(Box::new(move || {
            frames.start(&displacement);
            let clock = Clock::start();
            for _ in 0..count {
                frames.step(&still);
            }
            let each = clock.seconds() / count as f64;
            // A clock that has not moved gives zero, by which nothing may be divided.
            count = ((PASS / each.max(1e-12)) as usize).clamp(1, MOST_STEPS);
            Ok(each / setting.step)
        })))
    }

    /// A small displacement of the free points that is in no symmetry of the body, so that no force is zero.
    fn moved(&self) -> Vec<f64> {
        let extent = self.points.iter().fold(0.0f64, |extent, x| extent.max(x.abs()));
        let held = |dof: usize| self.support.prescribed[dof].is_some();
        // A sine of the number has no symmetry of a body, so that no spring keeps its length.
        let moved = |dof: usize| if held(dof) { 0.0 } else { DISPLACED * extent * (1.0 + dof as f64).sin() };
        (0..self.points.len()).map(moved).collect()
    }

    fn motion(&self) -> Motion<'a> {
        Motion { support: self.support.clone(), ..Motion::free(self.model, self.points, self.masses) }
    }

    fn options(&self, integrator: Integrator, step: f64) -> Options {
        let solver = LinearSolver::default();
        Options { step, integrator, iterations: 1, linear: self.linear, solver, account: false, ..Options::default() }
    }

    /// The longest explicit step that is stable, s.
    fn longest_step(&self) -> Option<f64> {
        // With a step that is stable for certain, so that there is a motion that can be asked.
        let tried = self.options(Integrator::SymplecticEuler, f64::MIN_POSITIVE);
        Simulation::new(self.motion(), tried).ok().map(|found| found.longest_step()).filter(|step| step.is_finite())
    }

    /// Steps from a shape near rest; `None` if the model has no such motion.
    fn steps(&self, options: Options) -> Result<Option<TimedWork<'a>>> {
        let Ok(mut simulation) = Simulation::new(self.motion(), options) else { return Ok(None) };
        let displacement = self.moved();
        let still = vec![0.0; displacement.len()];
        if simulation.start(&displacement, &still).is_err() {
            return Ok(None);
        }
        let mut count = 1;
        Ok(Some(Box::new(move || {
            simulation.start(&displacement, &still)?;
            let clock = Clock::start();
            for _ in 0..count {
                simulation.step();
            }
            let each = clock.seconds() / count as f64;
            // A clock may not have moved during a short pass. The next pass has as many steps as fill its time.
            count = ((PASS / each.max(1e-12)) as usize).clamp(1, MOST_STEPS);
            Ok(each)
        })))
    }
}

/// The costs of each model, all in turns; `has_density` says whether the masses are those of the scene.
///
/// # Errors
/// The equations do not fit into memory.
pub fn model_times(models: &[Costed], has_density: bool) -> Result<Vec<ModelTimes>> {
    let mut works = Vec::new();
    let (mut longest, mut has) = (Vec::new(), Vec::new());
    for model in models {
        let step = model.longest_step();
        let own = model.works(step)?;
        longest.push(step.filter(|_| has_density));
        let stands = model.statics.is_none() || own[0].is_some();
        has.push((own.each_ref().map(Option::is_some), stands));
        works.extend(own.into_iter().flatten());
    }
    let mut found = interleaved(&mut works)?.into_iter();
    let times = longest.into_iter().zip(has).map(|(longest_step, (has, stands))| {
        let [solve, explicit_step, implicit_step, frames] = has.map(|has| if has { found.next() } else { None });
        // A network for an engine is moved by it alone: its explicit steps are of a body that is stiffer than the engine's.
        // A second has `1/(SHARE Δt)` steps.
        let explicit_second = || Some(explicit_step.as_ref()?.scaled(1.0 / (SHARE * longest_step?))).filter(|_| stands);
        let simulated_second = frames.or_else(explicit_second);
        ModelTimes { solve, explicit_step, implicit_step, simulated_second, longest_step }
    });
    Ok(times.collect())
}
