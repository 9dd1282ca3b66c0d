//! The motion of the finite elements and the networks of a scene.

use super::raised::{RELEASE, Raised};
use super::relaxing::Relaxing;
use crate::dynamics::{Dampers, Damping, Drive, Integrator, Memory, Motion, Options, Simulation, StepOutcome};
use crate::error::{Error, Result};
use crate::material::EnergyMap;
use crate::mesh::Mesh;
use crate::model::{
    BlockStiffness, Body, Deformation, Elastic, LinearElastic, Network, Support, check_body, finite_elements, inverted,
    unheld_bodies,
};
use crate::outcome::{
    ModelMotion, MotionEnding, MotionOutcome, Outcome, Record, TimedForce, TimedPull, mean_and_largest,
};
use crate::own_name::BODY;
use crate::progress::{Event, Progress};
use crate::scalar::{norm, scaled_norm};
use crate::scene::{DampingRecipe, ForcePrecision, MotionRecipe};
use crate::solve::{Levels, StaticSolver, lowest_modes};
use std::time::Instant;

/// A displacement of this multiple of the body's size means that the motion has diverged.
// A step beyond the limit multiplies a motion by a factor, so that it is so large long before it overflows. A free body of 10 cm
// falls for more than an hour before it is as far.
const AWAY: f64 = 1e9;
/// States in which inverted cells are counted, about: each takes as long as some steps.
const LOOKS: usize = 12;
/// If linear finite elements are strained or rotated by more than this, in rad, springs that rotate deviate from them
/// by half of it: the error that the fit causes is then computed with springs that do not rotate.
const TURNING: f64 = 0.01;

/// A motion that has been checked on its mesh.
pub struct Planned {
    pub recipe: MotionRecipe,
    /// The support of `[[fix]]` and of prescribed motions.
    pub support: Support,
    pub drive: Drive,
    /// The masses, `[points]`, kg.
    pub masses: Vec<f64>,
    /// What `drive` is made of.
    pub forces: Vec<TimedForce>,
    pub pulls: Vec<TimedPull>,
    /// The points whose mean displacement is written.
    pub watched: Vec<usize>,
    /// The steps at whose end a state is written.
    pub written: Vec<usize>,
    /// How the networks are shown to be stable before they move.
    pub solver: StaticSolver,
    /// What becomes of stress, if it relaxes.
    pub relaxing: Option<Relaxing>,
    /// Whether the states are needed after the motion.
    pub draws: bool,
}

/// Moves the finite elements, if requested, and every network of `outcome`; `energy` is that of the material's law.
///
/// # Errors
/// A step exceeds the limit of an explicit method, or the equations do not fit into memory.
pub fn move_models(
    planned: &Planned,
    energy: Option<&EnergyMap>,
    outcome: &Outcome,
    progress: &mut Progress,
) -> Result<MotionOutcome> {
    let (mesh, material) = (&outcome.mesh, &outcome.material);
    let run = Run { planned, mesh };
    let relaxing = planned.relaxing.as_ref();
    if let Some(note) = relaxing.and_then(|relaxing| planned.long_step(relaxing)) {
        progress(Event::Note(&note));
    }
    let mut models = Vec::new();
    let mut reference = Vec::new();
    if planned.recipe.finite_elements {
        let mut options = planned.recipe.options;
        let resists = (planned.damping(None, mesh)?, relaxing.map(|relaxing| relaxing.of_body(mesh)).transpose()?);
        let (mut made, states) = match energy {
            Some(laws) => {
                let body = Body::new(mesh, relaxing.and_then(Relaxing::laws).unwrap_or(laws));
                run.follow((BODY, None, &planned.masses), &body, resists, options, true, progress)?
            }
            None => {
                options.linear = true;
                check_body(mesh)?;
                let stiffness = finite_elements(mesh, material.moduli());
                let body = LinearElastic { points: &mesh.points, stiffness };
                run.follow((BODY, None, &planned.masses), &body, resists, options, true, progress)?
            }
        };
        if planned.draws {
            made.states.clone_from(&states);
        }
        if energy.is_none() {
            made.deformation = states.iter().map(|u| Deformation::largest(mesh, u)).reduce(Deformation::max);
        }
        models.push(made);
        reference = states;
    }
    let turns = |deformation: Deformation| deformation.exceeds(TURNING) && !planned.recipe.options.linear;
    let turning = models.first().and_then(|body| body.deformation).is_some_and(turns);
    let largest = reference.iter().flat_map(|u| u.chunks_exact(mesh.dimension)).map(norm).fold(0.0, f64::max);
    for (i, fit) in outcome.fits.iter().enumerate() {
        let masses = fit.masses().unwrap_or(&planned.masses);
        let growth = match planned.recipe.options.quasi_static {
            // A network that releases energy has no equilibrium to follow, and is refused.
            true => None,
            false => growth(&fit.network, masses, mesh, planned)?,
        };
        if growth.is_some() {
            progress(Event::Note(&indefinite(mesh, &fit.fit.name, &fit.network)));
        }
        let (rest, memory) = match relaxing {
            Some(relaxing) => {
                let (rest, memory) = relaxing.of_network(mesh, &fit.fit, &fit.network)?;
                (rest, Some(memory))
            }
            None => (None, None),
        };
        let network = rest.as_ref().unwrap_or(&fit.network);
        let resists = (planned.damping(Some((&fit.network, masses)), mesh)?, memory);
        let keeps = planned.draws || !reference.is_empty();
        let options = planned.recipe.options;
        let model: Box<dyn Elastic> = match planned.recipe.precision {
            ForcePrecision::Double => Box::new(network.prepared()),
            ForcePrecision::Single => network.prepared_in::<f32>(),
        };
        let (mut made, states) =
            run.follow((&fit.fit.name, growth, masses), &*model, resists, options, keeps, progress)?;
        made.fit = Some(i);
        // None if the finite elements do not move, or an error is not finite.
        let errors = |states: &[Vec<f64>]| -> Vec<Option<f64>> {
            let rms = |(u, fem): (&Vec<f64>, &Vec<f64>)| {
                let apart: Vec<f64> = u.iter().zip(fem).map(|(a, b)| a - b).collect();
                let rms = scaled_norm(&apart, |apart| square(apart) / mesh.point_count() as f64);
                (largest > 0.0).then(|| 100.0 * rms / largest).filter(|error| error.is_finite())
            };
            states.iter().zip(&reference).map(rms).collect()
        };
        made.records.iter_mut().zip(errors(&states)).for_each(|(record, error)| record.error = error);
        // The motion of a network that releases energy grows whatever the fit: its error says nothing.
        if turning && growth.is_none() && made.ending == MotionEnding::Complete {
            let linear = Options { linear: true, ..options };
            let damping = (planned.damping(Some((&fit.network, masses)), mesh)?, None);
            let name = format!("{} without turning", fit.fit.name);
            let (linear, states) = run.follow((&name, growth, masses), &*model, damping, linear, true, progress)?;
            let complete = linear.ending == MotionEnding::Complete;
            let errors: Option<Vec<f64>> = errors(&states).into_iter().collect();
            made.linear_error = errors.and_then(|errors| mean_and_largest(&errors)).filter(|_| complete);
        }
        if planned.draws {
            made.states = states;
        }
        models.push(made);
    }
    Ok(MotionOutcome {
        recipe: planned.recipe.clone(),
        watched: planned.watched.clone(),
        masses: planned.masses.clone(),
        support: planned.support.clone(),
        forces: planned.forces.clone(),
        pulls: planned.pulls.clone(),
        relaxation: planned.relaxing.as_ref().map_or(Vec::new(), |relaxing| relaxing.terms()),
        models,
    })
}

fn square(u: &[f64]) -> f64 {
    u.iter().map(|u| u * u).sum()
}

impl Planned {
    /// That a step is longer than the shortest relaxation time, if it is.
    fn long_step(&self, relaxing: &Relaxing) -> Option<String> {
        let (step, shortest) = (self.recipe.options.step, relaxing.shortest());
        // A step with an error is divided until it has no more than that.
        (step > shortest && self.recipe.options.error.is_none()).then(|| {
            format!(
                "a step of {step:?} s is {:.3} times the shortest relaxation time, {shortest:?} s: what relaxes within a step is known at its end \
                 alone, and only if the strain changes evenly over it",
                step / shortest
            )
        })
    }

    /// The damping of a network, or of the finite elements.
    pub(super) fn damping(&self, network: Option<(&Network, &[f64])>, mesh: &Mesh) -> Result<Damping> {
        Ok(match (self.recipe.damping, network) {
            (DampingRecipe::Ratio(ratio), Some((network, masses))) => {
                let dampers = Dampers::of_ratio(network, &mesh.points, masses, &self.support, ratio)?;
                Damping { dampers: Some(dampers), ..Damping::default() }
            }
            (DampingRecipe::Rayleigh([mass, stiffness]), _) => Damping { mass, stiffness, dampers: None },
            (DampingRecipe::Ratio(_), None) => Damping::default(),
        })
    }
}

struct Run<'a> {
    planned: &'a Planned,
    mesh: &'a Mesh,
}

impl Run<'_> {
    /// Moves one model from rest to the end; returns its displacements at the records if they are kept.
    fn follow(
        &self,
        (name, growth, masses): (&str, Option<f64>, &[f64]),
        model: &dyn Elastic,
        (damping, memory): (Damping, Option<Memory>),
        options: Options,
        keeps: bool,
        progress: &mut Progress,
    ) -> Result<(ModelMotion, Vec<Vec<f64>>)> {
        let planned = self.planned;
        let mut made = ModelMotion { name: name.into(), growth, ..ModelMotion::default() };
        let (support, drive) = (planned.support.clone(), planned.drive.clone());
        let motion = Motion { support, drive, damping, memory, ..Motion::free(model, &self.mesh.points, masses) };
        let mut simulation = match Simulation::new(motion, options) {
            Ok(simulation) => simulation,
            Err(e) if e.key() == Some("step") && options.integrator == Integrator::SymplecticEuler => {
                return Err(Error::at("step", format!("{} ({name})", e.problem())));
            }
            Err(e) if ["step", "model"].contains(&e.key().unwrap_or_default()) => {
                made.ending = MotionEnding::Refused(e.problem().into());
                return Ok((made, Vec::new()));
            }
            Err(e) => return Err(e),
        };
        let extent = self.mesh.points.iter().fold(0.0f64, |extent, x| extent.max(x.abs()));
        let stage = format!("motion of {name}{}", if growth.is_some() { ", indefinite" } else { "" });
        let mut states = Vec::new();
        // A motion without states to write has no distance between looks, by which nothing may be divided.
        let apart = planned.written.len().div_ceil(LOOKS).max(1);
        for (place, &until) in planned.written.iter().enumerate() {
            progress(Event::stage(&stage, made.steps, planned.recipe.steps));
            let start = Instant::now();
            while made.steps < until && made.ending == MotionEnding::Complete {
                match simulation.step().outcome {
                    StepOutcome::NoResponse => made.ending = MotionEnding::NoResponse,
                    StepOutcome::Stalled => (made.steps, made.unsolved) = (made.steps + 1, made.unsolved + 1),
                    StepOutcome::Converged | StepOutcome::Linearized => made.steps += 1,
                }
                if !simulation.is_within(AWAY * extent) {
                    made.ending = MotionEnding::RanAway;
                }
            }
            made.seconds += start.elapsed().as_secs_f64();
            if made.ending != MotionEnding::Complete {
                break;
            }
            let record = self.record(&mut simulation);
            if !record.is_finite() {
                made.ending = MotionEnding::RanAway;
                break;
            }
            made.records.push(record);
            let moved = &simulation.state().displacement;
            made.largest = moved.chunks_exact(self.mesh.dimension).map(norm).fold(made.largest, f64::max);
            if place % apart == 0 || place + 1 == planned.written.len() {
                let x: Vec<f64> = self.mesh.points.iter().zip(moved).map(|(x, u)| x + u).collect();
                made.inverted = made.inverted.max(inverted(self.mesh, &x));
            }
            if keeps {
                states.push(simulation.state().displacement.clone());
            }
        }
        if let (Some(estimate), Some(allowed)) = (simulation.estimated_error(), options.error)
            && estimate > allowed
        {
            let note = format!(
                "{name}: a step is estimated to be off by {estimate:.1e} of the displacement, though it was divided as often as possible"
            );
            progress(Event::Note(&note));
        }
        if made.ending == MotionEnding::Complete && made.unsolved > 0 {
            made.ending = MotionEnding::Unsolved;
        }
        Ok((made, states))
    }

    fn record(&self, simulation: &mut Simulation) -> Record {
        let (d, watched) = (self.mesh.dimension, &self.planned.watched);
        let u = &simulation.state().displacement;
        let mean = |k: usize| watched.iter().map(|p| u[p * d + k]).sum::<f64>() / watched.len() as f64;
        let watched = if watched.is_empty() { Vec::new() } else { (0..d).map(mean).collect() };
        Record { watched, error: None, account: simulation.account() }
    }
}

/// The note about an indefinite network before it moves.
fn indefinite(mesh: &Mesh, name: &str, network: &Network) -> String {
    let worst = network.most_negative(3).into_iter().map(|(points, constant)| {
        let points: Vec<String> = points.iter().map(|p| mesh.point_number(*p).to_string()).collect();
        format!("{constant:.2e} at {}s {}", mesh.point_word(), points.join(" "))
    });
    let worst: Vec<String> = worst.collect();
    format!(
        "{name} is indefinite and may run away: {} of its {} springs are negative, the worst {} (N/m for lengths); \
         nonnegative = true forbids them, and constants of objective = \"whole\" stay positive",
        network.negative(),
        network.len(),
        worst.join(", ")
    )
}

/// The growth rate of the fastest motion that releases energy, 1/s; `None` if there is none. The rate is an upper bound where the motion
/// cannot be computed, for example if a point has no mass.
///
/// `K + σ M` is positive definite for `σ > −ω²` of the lowest mode. Of a large network that cannot move as a rigid body, K itself is shown to
/// be positive definite without a factor.
fn growth(network: &Network, masses: &[f64], mesh: &Mesh, planned: &Planned) -> Result<Option<f64>> {
    if planned.solver.iterates(mesh, 1) && unheld_bodies(mesh, &planned.support).is_empty() {
        let blocks = BlockStiffness::of_network(network, &mesh.points, None);
        let proof =
            Levels::new(blocks, &mesh.points, &planned.support).map(|levels| levels.map(|levels| levels.prove()));
        if matches!(proof, Ok(Ok(Ok(None)))) {
            return Ok(None);
        }
    }
    network.check_size()?;
    let stiffness = network.stiffness(&mesh.points);
    let mut raised = Raised::new(stiffness, masses, &planned.support, (&mesh.points, mesh.dimension));
    let largest = raised.largest;
    if !(largest > 0.0 && largest.is_finite()) {
        return Ok(None);
    }
    let mut shift = RELEASE * largest;
    let mut stands = |shift: f64| -> Result<bool> { Ok(raised.by(shift)?.cholesky()?.is_some()) };
    if stands(shift)? {
        return Ok(None);
    }
    // A factor of four brackets the rate within a factor of two, in a few factorisations of one pattern.
    while shift < 1e6 * largest && !stands(4.0 * shift)? {
        shift *= 4.0;
    }
    // The lowest ω² of `K + σ M` is that of K raised by σ.
    let above = 4.0 * shift;
    let system = raised.by(above)?;
    let lowest = system.cholesky()?.and_then(|factor| lowest_modes(&system, &factor, masses, mesh.dimension, 1).ok());
    let square = lowest.map_or(above, |modes| above - modes.squares[0]);
    // Factors have shown that the lowest ω² lies between these two; the iterations of the modes may be less exact.
    Ok(Some(square.clamp(shift, above).sqrt()))
}
