//! The keys of `[motion]`: the motion of a scene in time.
//!
//! Theory: page *Dynamics* of the book.

use super::part::Part;
use super::value::{self, Varying};
use crate::bound::{self, check_count};
use crate::dynamics::{Integrator, LEAST_TOLERANCE, LinearSolver, Options};
use crate::error::{Error, ErrorKind, Result};
use crate::model::Lumping;
use crate::range;
use crate::study::choice::choice;
use crate::symbolic::{Expr, Scope, parse_rational};
use schemars::JsonSchema;
use serde::Deserialize;

/// A motion, before the mesh is known.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionRecipe {
    /// The time step, the method and the solver.
    pub options: Options,
    /// The numbers of the networks' forces.
    pub precision: ForcePrecision,
    /// The duration, s.
    pub duration: f64,
    /// The number of steps; the last one reaches the end.
    pub steps: usize,
    /// The time between states that are written, s; the first and the last state always are.
    pub every: f64,
    /// How masses are lumped.
    pub lumping: Lumping,
    /// The acceleration of gravity, m/s²; empty if there is none.
    pub gravity: Vec<f64>,
    /// The damping.
    pub damping: DampingRecipe,
    /// The points whose mean displacement is written.
    pub watch: Option<Part>,
    /// Whether the finite elements move as well.
    pub finite_elements: bool,
    /// The prescribed displacements.
    pub pulls: Vec<PrescribedMotion>,
    /// The forces.
    pub forces: Vec<AppliedForce>,
}

/// The numbers in which networks compute their forces, and, without an account, positions and velocities.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ForcePrecision {
    /// `f64`.
    #[default]
    Double,
    /// `f32`.
    Single,
}

crate::named!(ForcePrecision {
    "double" => Double,
    "single" => Single,
});

/// The damping of a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DampingRecipe {
    /// Rayleigh damping: α, 1/s, and β, s, of `C = α M + β K₀`.
    Rayleigh([f64; 2]),
    /// The damping ratio of a damper parallel to each spring.
    Ratio(f64),
}

/// A part with a prescribed displacement over time, m.
#[derive(Debug, Clone, PartialEq)]
pub struct PrescribedMotion {
    /// The part.
    pub part: Part,
    /// One expression in t, x, y, z per direction; `None` leaves a direction free.
    pub displacement: Vec<Option<Expr>>,
}

/// A force over time, N, on a part.
#[derive(Debug, Clone, PartialEq)]
pub struct AppliedForce {
    /// The part.
    pub part: Part,
    /// One expression in t per direction.
    pub force: Vec<Expr>,
    /// Whether the force acts on each point, instead of being the total.
    pub each: bool,
}

/// The keys of `[motion]`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MotionEntry {
    #[serde(deserialize_with = "value::time")]
    #[schemars(schema_with = "value::quantity")]
    duration: f64,
    #[serde(deserialize_with = "value::time")]
    #[schemars(schema_with = "value::quantity")]
    step: f64,
    #[schemars(extend("enum" = Integrator::NAMES))]
    integrator: Option<String>,
    iterations: Option<usize>,
    tolerance: Option<f64>,
    #[serde(default)]
    linear: bool,
    account: Option<bool>,
    #[schemars(extend("enum" = ForcePrecision::NAMES))]
    precision: Option<String>,
    #[schemars(extend("enum" = LinearSolver::NAMES))]
    solver: Option<String>,
    remainder: Option<f64>,
    #[schemars(extend("enum" = Lumping::NAMES))]
    mass: Option<String>,
    gravity: Option<Vec<f64>>,
    damping: Option<DampingEntry>,
    #[serde(default, deserialize_with = "value::optional_time")]
    #[schemars(schema_with = "value::quantity")]
    every: Option<f64>,
    watch: Option<WatchEntry>,
    finite_elements: Option<bool>,
    #[serde(default)]
    pull: Vec<PullEntry>,
    #[serde(default)]
    force: Vec<ForceEntry>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct DampingEntry {
    rayleigh: Option<[f64; 2]>,
    ratio: Option<f64>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct WatchEntry {
    group: Option<String>,
    #[serde(rename = "where")]
    condition: Option<String>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PullEntry {
    group: Option<String>,
    #[serde(rename = "where")]
    condition: Option<String>,
    displacement: Vec<Varying>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ForceEntry {
    group: Option<String>,
    #[serde(rename = "where")]
    condition: Option<String>,
    force: Vec<Varying>,
    #[serde(default)]
    each: bool,
}

/// A tolerance for the quotient of duration and step, because decimals are not exact in binary.
const SLACK: f64 = 1.0 - 1e-12;
/// The largest number of states that are written by default, after the first.
const STATES: f64 = 100.0;

impl MotionRecipe {
    /// The motion in words.
    pub fn title(&self) -> String {
        let (step, name) = (self.options.step, self.options.integrator.name());
        let precision = match self.precision {
            ForcePrecision::Double => "",
            ForcePrecision::Single => " in single precision",
        };
        format!("{:?} s in {} steps of {step:?} s by {name}{precision}", self.duration, self.steps)
    }

    /// The time at the end of the last step, s: that of the first step that reaches the duration.
    pub fn end(&self) -> f64 {
        self.steps as f64 * self.options.step
    }

    /// Whether the times between states that are written are alike but for the last one.
    pub fn is_even(&self) -> bool {
        let written = self.written();
        let apart: Vec<usize> = written.windows(2).map(|pair| pair[1] - pair[0]).collect();
        apart.split_last().is_none_or(|(_, apart)| apart.iter().all(|steps| *steps == apart[0]))
    }

    /// The steps at whose end a state is written: the first one at or after each multiple of `every`, and the last
    /// step.
    pub fn written(&self) -> Vec<usize> {
        let at = |state: usize| (state as f64 * self.every / self.options.step * SLACK).ceil() as usize;
        let mut steps: Vec<usize> = (0..).map(at).take_while(|step| *step < self.steps).collect();
        steps.push(self.steps);
        steps.dedup();
        steps
    }
}

impl MotionEntry {
    /// The motion of these keys.
    ///
    /// # Errors
    /// A value is unknown or out of range, or keys contradict each other.
    pub fn check(self) -> Result<MotionRecipe> {
        let positive = |key: &str, value: f64| range::positive(key, value, "s");
        let (duration, step) = (positive("duration", self.duration)?, positive("step", self.step)?);
        if duration < step * (1.0 - 1e-9) {
            return Err(Error::expected("duration", format!("at least one step of {step} s"), format!("{duration} s")));
        }
        let steps = (duration / step * SLACK).ceil();
        if steps > bound::STEPS as f64 {
            let expected = format!("at most {:e} steps in all", bound::STEPS as f64);
            return Err(Error::expected("step", expected, format!("{steps:e}")).of_kind(ErrorKind::Limit));
        }
        let every = match self.every {
            None => step * (duration / STATES / step * SLACK).ceil(),
            Some(every) => positive("every", every)?,
        };
        if every < step * (1.0 - 1e-9) {
            return Err(Error::expected("every", format!("at least one step of {step} s"), format!("{every} s")));
        }
        if duration / every > bound::STATES as f64 {
            let (expected, found) =
                (format!("at most {} states in all", bound::STATES), format!("{:.0}", duration / every));
            return Err(Error::expected("every", expected, found).of_kind(ErrorKind::Limit));
        }
        let gravity = self.gravity.unwrap_or_default();
        range::largest("gravity", gravity.iter().copied(), "m/s²")?;
        let finite_elements = self.finite_elements.unwrap_or(true);
        let damping = self.damping.map(|d| d.check(finite_elements).map_err(|e| e.under("damping"))).transpose()?;
        let part = |group, condition, key: String| Part::required(group, condition).map_err(|e| e.under(key));
        let watch = self.watch.map(|w| part(w.group, w.condition, "watch".into())).transpose()?;
        let mut pulls = Vec::new();
        for (i, pull) in self.pull.into_iter().enumerate() {
            let part = part(pull.group, pull.condition, format!("pull[{i}]"))?;
            let component = |(k, value)| {
                let free = matches!(&value, Varying::Text(text) if text == "free");
                let read =
                    || expression(value, &["t", "x", "y", "z"]).map_err(|e| e.under(format!("displacement[{k}]")));
                if free { Ok(None) } else { read().map(Some) }
            };
            let displacement: Result<Vec<_>> = pull.displacement.into_iter().enumerate().map(component).collect();
            let displacement = displacement.and_then(|given| match given.iter().all(Option::is_none) {
                true => Err(Error::expected("displacement", "a direction that is moved", "\"free\" in all")),
                false => Ok(given),
            });
            let displacement = displacement.map_err(|e| e.under(format!("pull[{i}]")))?;
            pulls.push(PrescribedMotion { part, displacement });
        }
        let mut forces = Vec::new();
        for (i, force) in self.force.into_iter().enumerate() {
            let part = part(force.group, force.condition, format!("force[{i}]"))?;
            let component = |(k, value)| expression(value, &["t"]).map_err(|e| e.under(format!("force[{k}]")));
            let components: Result<Vec<_>> = force.force.into_iter().enumerate().map(component).collect();
            let components = components.map_err(|e| e.under(format!("force[{i}]")))?;
            forces.push(AppliedForce { part, force: components, each: force.each });
        }
        let method = StepEntry {
            integrator: self.integrator.as_deref(),
            iterations: self.iterations,
            tolerance: self.tolerance,
            linear: self.linear,
            solver: self.solver.as_deref(),
            remainder: self.remainder,
        };
        let precision =
            choice("precision", self.precision.as_deref(), ForcePrecision::default(), ForcePrecision::named)?;
        let account = self.account.unwrap_or(precision == ForcePrecision::Double);
        let options = Options { step, account, ..method.check()? };
        let foreign = match (options.integrator, options.linear) {
            (Integrator::SymplecticEuler, false) => None,
            (Integrator::SymplecticEuler, true) => Some("linear = true".to_string()),
            (integrator, _) => Some(format!("integrator = \"{}\"", integrator.name())),
        };
        if let (ForcePrecision::Single, Some(foreign)) = (precision, foreign) {
            let problem = format!(
                "\"single\" belongs to integrator = \"symplectic-euler\" with springs that rotate, found with {foreign}"
            );
            return Err(Error::at("precision", problem));
        }
        Ok(MotionRecipe {
            options,
            precision,
            duration,
            steps: steps as usize,
            every,
            lumping: choice("mass", self.mass.as_deref(), Lumping::default(), Lumping::named)?,
            gravity,
            damping: damping.unwrap_or(DampingRecipe::Rayleigh([0.0; 2])),
            watch,
            finite_elements,
            pulls,
            forces,
        })
    }
}

/// The keys of the time integration.
struct StepEntry<'a> {
    integrator: Option<&'a str>,
    iterations: Option<usize>,
    tolerance: Option<f64>,
    linear: bool,
    solver: Option<&'a str>,
    remainder: Option<f64>,
}

impl StepEntry<'_> {
    fn check(&self) -> Result<Options> {
        let integrator = choice("integrator", self.integrator, Integrator::default(), Integrator::named)?;
        let foreign = match (integrator, self.linear) {
            (Integrator::SymplecticEuler, _) => Some("integrator = \"symplectic-euler\""),
            (_, true) => Some("linear = true"),
            (_, false) => None,
        };
        let given = [("iterations", self.iterations.is_some()), ("tolerance", self.tolerance.is_some())];
        if let (Some(foreign), Some((key, _))) = (foreign, given.iter().find(|(_, given)| *given)) {
            return Err(Error::at(*key, format!("belongs to Newton's method, found with {foreign}")));
        }
        if let (Integrator::SymplecticEuler, Some(_)) = (integrator, self.solver) {
            let problem = "belongs to implicit steps, found with integrator = \"symplectic-euler\"";
            return Err(Error::at("solver", problem));
        }
        let mut solver = choice("solver", self.solver, LinearSolver::default(), LinearSolver::named)?;
        match (&mut solver, self.remainder) {
            (LinearSolver::Factor, Some(_)) => {
                return Err(Error::at("remainder", "belongs to solver = \"conjugate-gradients\""));
            }
            (LinearSolver::ConjugateGradients { tolerance }, Some(remainder)) => {
                if !(LEAST_TOLERANCE..1.0).contains(&remainder) {
                    let found = format!("{remainder:?}");
                    return Err(Error::expected("remainder", "a share from 1e-15 to below 1", found));
                }
                *tolerance = remainder;
            }
            (LinearSolver::Factor | LinearSolver::ConjugateGradients { .. }, None) => {}
        }
        let options = Options { integrator, solver, linear: self.linear, ..Options::default() };
        let iterations = self.iterations.unwrap_or(options.iterations);
        let tolerance = self.tolerance.unwrap_or(options.tolerance);
        check_count("iterations", iterations as u64, 1, bound::ITERATIONS)?;
        if !(tolerance > 0.0 && tolerance < 1.0) {
            return Err(Error::expected("tolerance", "a share above 0 and below 1", tolerance));
        }
        Ok(Options { iterations, tolerance, ..options })
    }
}

impl DampingEntry {
    fn check(self, finite_elements: bool) -> Result<DampingRecipe> {
        match (self.rayleigh, self.ratio) {
            (Some(pair), None) => {
                for (value, unit) in pair.into_iter().zip(["1/s", "s"]) {
                    range::not_negative("rayleigh", value, unit)?;
                }
                Ok(DampingRecipe::Rayleigh(pair))
            }
            (None, Some(ratio)) => {
                range::not_negative("ratio", ratio, "as a damping ratio")?;
                if finite_elements {
                    let problem = "is that of springs, which finite elements have not: expected \"rayleigh\", or \
                                   finite_elements = false";
                    return Err(Error::at("ratio", problem));
                }
                Ok(DampingRecipe::Ratio(ratio))
            }
            (both, _) => {
                let found = if both.is_some() { "both" } else { "neither" };
                Err(Error::new(format!("expected either \"rayleigh\" or \"ratio\", found {found}")))
            }
        }
    }
}

fn expression(value: Varying, variables: &[&str]) -> Result<Expr> {
    match value {
        Varying::Number(number) if !(number.abs() <= range::LARGEST) => {
            Err(Error::new(format!("expected a number of at most {:e} in size, found {number:?}", range::LARGEST)))
        }
        Varying::Number(number) => Ok(Expr::Number(parse_rational(&format!("{number}"))?)),
        Varying::Text(text) => Scope::new(variables).expression(&text),
    }
}
