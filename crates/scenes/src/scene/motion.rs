//! The keys of `[motion]`: the motion of a scene in time.
//!
//! Theory: page *Dynamics* of the book.

use super::damping::{DampingMeasurement, MeasuredDamping};
use super::motion_recipe::{AppliedForce, DampingRecipe, ForcePrecision, MotionRecipe, PrescribedMotion, SLACK};
use super::part::Part;
use super::value::{self, Varying};
use crate::bound::{self, check_count};
use crate::choice::choice;
use crate::dynamics::{Integrator, LEAST_TOLERANCE, LinearSolver, Options};
use crate::error::{Error, ErrorKind, Result, expect_none};
use crate::model::Lumping;
use crate::quantity::Quantity;
use crate::range;
use crate::symbolic::{Expr, Scope, parse_rational};
use schemars::JsonSchema;
use serde::Deserialize;
use std::mem::take;

/// The keys of `[motion]`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MotionEntry {
    /// The motion ends with the first step that reaches this time in s. A note says so if that is later.
    #[serde(deserialize_with = "value::time")]
    #[schemars(schema_with = "value::time_schema")]
    duration: f64,
    /// A step in time has this length in s, above 0 and at most the duration.
    #[serde(deserialize_with = "value::time")]
    #[schemars(schema_with = "value::time_schema")]
    step: f64,
    /// Steps are made by this method. `symplectic-euler` is explicit and returns an error if the step exceeds 2/ω.
    #[schemars(extend("enum" = Integrator::NAMES, "default" = Integrator::default().name()))]
    integrator: Option<String>,
    /// An implicit step takes at most this number of iterations of Newton's method, 1 or more; 1 is the linearised step of real-time
    /// programs. The key does not go with `linear` and `symplectic-euler`.
    #[schemars(extend("default" = Options::default().iterations))]
    iterations: Option<usize>,
    /// An implicit step ends when its residual is this share of the forces that act, above 0 and below 1. The key does not go with `linear`
    /// and `symplectic-euler`.
    #[schemars(extend("default" = Options::default().tolerance))]
    tolerance: Option<f64>,
    /// Networks keep their stiffness at rest, as the finite elements do, so that one factor serves all steps.
    #[serde(default)]
    linear: bool,
    /// Inertia is left out: every state is in equilibrium with the loads of its time, as in creep and relaxation. The key does not go with
    /// `integrator` and `damping`, and the density then counts for gravity alone.
    #[serde(default, rename = "quasi-static")]
    quasi_static: bool,
    /// With `quasi-static` and a material that relaxes, a step is divided until the error that is estimated of it is this share of the largest
    /// displacement, above 0 and below 1.
    #[schemars(extend("x-default" = "steps are not divided"))]
    error: Option<f64>,
    /// Work, dissipation and drift are reported.
    #[schemars(extend("x-default" = "true; false with `precision = \"single\"`"))]
    account: Option<bool>,
    /// Networks compute the forces of explicit steps in these numbers. `single` rounds them to 6e-8 of the body, and without `account`
    /// positions and velocities as well; it belongs to `symplectic-euler` without `linear`.
    #[schemars(extend("enum" = ForcePrecision::NAMES, "default" = ForcePrecision::default().name()))]
    precision: Option<String>,
    /// The equations of implicit steps are solved by a Cholesky factor (`factor`) or by `conjugate-gradients`. The key does not go with
    /// `symplectic-euler`.
    #[schemars(extend("enum" = LinearSolver::NAMES, "default" = LinearSolver::default().name()))]
    solver: Option<String>,
    /// Conjugate gradients stop at this relative residual, from 1e-15 to below 1. The key belongs to `solver = "conjugate-gradients"`.
    #[schemars(extend("default" = 1e-8))]
    remainder: Option<f64>,
    /// Masses are lumped by row sums (`row-sum`), or by `hrz`, which is above zero for every element.
    #[schemars(extend("enum" = Lumping::NAMES, "default" = Lumping::default().name()))]
    mass: Option<String>,
    /// This acceleration acts on all points, in m/s².
    #[serde(default, deserialize_with = "value::acceleration_vector")]
    #[schemars(schema_with = "value::acceleration_vector_schema")]
    gravity: Option<Vec<f64>>,
    /// `damping` says how motions die away; without it they do not.
    damping: Option<DampingEntry>,
    /// States are written this time in s apart, one step or more. Each is that of the first step at or beyond a multiple of it, and a note
    /// says so if the times between them are not alike.
    #[serde(default, deserialize_with = "value::optional_time")]
    #[schemars(schema_with = "value::time_schema", extend("x-default" = "whole steps, a hundredth of the duration or more"))]
    every: Option<f64>,
    /// `watch` names the points whose mean displacement is written.
    watch: Option<WatchEntry>,
    /// The finite elements move as well, as reference.
    #[schemars(extend("default" = true))]
    finite_elements: Option<bool>,
    /// Each `[[motion.pull]]` prescribes the displacement of a part in time.
    #[serde(default)]
    pull: Vec<PullEntry>,
    /// Each `[[motion.force]]` is a force on a part in time.
    #[serde(default)]
    force: Vec<ForceEntry>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct DampingEntry {
    /// The α and β of `rayleigh` are found for this damping; a table has the error that they leave.
    measured: Option<DampingMeasurement>,
    /// The damping is `C = α M + β K₀`; the pair has α in 1/s and β in s, both 0 or more. One of `rayleigh`, `measured` and `ratio` is required.
    rayleigh: Option<[f64; 2]>,
    /// Each spring has a damper beside it with this damping ratio, 0 or more. It needs `finite_elements = false`, because finite elements
    /// have no springs.
    ratio: Option<f64>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct WatchEntry {
    /// The watched points are those of this group of the mesh; one of `group` and `where` is required.
    group: Option<String>,
    /// The watched points satisfy this condition on x, y, z in m; one of `group` and `where` is required.
    #[serde(rename = "where")]
    condition: Option<String>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PullEntry {
    /// The part that is moved is this group of the mesh; one of `group` and `where` is required.
    group: Option<String>,
    /// The part that is moved has the points that satisfy this condition on x, y, z in m; one of `group` and `where` is required.
    #[serde(rename = "where")]
    condition: Option<String>,
    /// The part has this displacement in m: for each direction a number, an expression of t in s and x, y, z in m, or `"free"`. At least
    /// one direction is moved.
    displacement: Vec<Varying>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ForceEntry {
    /// The part on which the force acts is this group of the mesh; one of `group` and `where` is required.
    group: Option<String>,
    /// The part on which the force acts has the points that satisfy this condition on x, y, z in m; one of `group` and `where` is required.
    #[serde(rename = "where")]
    condition: Option<String>,
    /// The force in N has a number or an expression of t in s for each direction. It is shared over sides, cells or points of the part, as
    /// that of a load is.
    force: Vec<Varying>,
    /// The force acts on each point as much, instead of in all.
    #[serde(default)]
    each: bool,
}

/// The largest number of states that are written by default, after the first.
// A curve of so many points looks smooth, and files of large bodies stay of a size that other programs open.
const STATES: f64 = 100.0;

impl MotionEntry {
    /// The motion of these keys.
    ///
    /// # Errors
    /// A value is unknown or out of range, or keys contradict each other.
    pub fn check(mut self) -> Result<MotionRecipe> {
        let positive = |key: &str, value: f64| range::positive(key, value, "s");
        let (duration, step) = (positive("duration", self.duration)?, positive("step", self.step)?);
        // A duration that is meant to be one step may be a rounding below it.
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
        // Parts are taken out of the keys to be checked: from here on the keys lack them, and the checked parts are asked instead.
        let gravity = self.gravity.take().unwrap_or_default();
        range::largest("gravity", gravity.iter().copied(), "m/s²")?;
        let finite_elements = self.finite_elements.unwrap_or(true);
        let damping =
            self.damping.take().map(|d| d.check(finite_elements).map_err(|e| e.under("damping"))).transpose()?;
        let part = |group, condition, key: String| Part::required(group, condition).map_err(|e| e.under(key));
        let watch = self.watch.take().map(|w| part(w.group, w.condition, "watch".into())).transpose()?;
        let mut pulls = Vec::new();
        for (i, pull) in take(&mut self.pull).into_iter().enumerate() {
            let part = part(pull.group, pull.condition, format!("pull[{i}]"))?;
            let component = |(k, value)| {
                let free = matches!(&value, Varying::Text(text) if text == "free");
                let read = || {
                    expression(value, &["t", "x", "y", "z"], Some(Quantity::Length))
                        .map_err(|e| e.under(format!("displacement[{k}]")))
                };
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
        for (i, force) in take(&mut self.force).into_iter().enumerate() {
            let part = part(force.group, force.condition, format!("force[{i}]"))?;
            let component = |(k, value)| {
                expression(value, &["t"], Some(Quantity::Force)).map_err(|e| e.under(format!("force[{k}]")))
            };
            let components: Result<Vec<_>> = force.force.into_iter().enumerate().map(component).collect();
            let components = components.map_err(|e| e.under(format!("force[{i}]")))?;
            forces.push(AppliedForce { part, force: components, each: force.each });
        }
        let beside = [("integrator", self.integrator.is_some()), ("damping", damping.is_some())];
        if self.quasi_static {
            expect_none(beside, "belongs to motions with inertia, found with quasi-static = true")?;
        }
        match self.error {
            Some(_) if !self.quasi_static => {
                return Err(Error::at("error", "belongs to quasi-static = true"));
            }
            Some(error) if !(error > 0.0 && error < 1.0) => {
                return Err(Error::expected("error", "a share above 0 and below 1", error));
            }
            Some(_) | None => {}
        }
        let precision =
            choice("precision", self.precision.as_deref(), ForcePrecision::default(), ForcePrecision::named)?;
        let account = self.account.unwrap_or(precision == ForcePrecision::Double);
        let options = Options { step, account, quasi_static: self.quasi_static, error: self.error, ..self.method()? };
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
            damping: damping.as_ref().map_or(DampingRecipe::Rayleigh([0.0; 2]), |(recipe, _)| *recipe),
            measured_damping: damping.and_then(|(_, measured)| measured),
            watch,
            finite_elements,
            pulls,
            forces,
        })
    }

    /// The time integration.
    fn method(&self) -> Result<Options> {
        let integrator = choice("integrator", self.integrator.as_deref(), Integrator::default(), Integrator::named)?;
        let foreign = match (integrator, self.linear) {
            (Integrator::SymplecticEuler, _) => Some("integrator = \"symplectic-euler\""),
            (_, true) => Some("linear = true"),
            (_, false) => None,
        };
        let given = [("iterations", self.iterations.is_some()), ("tolerance", self.tolerance.is_some())];
        if let Some(foreign) = foreign {
            expect_none(given, format!("belongs to Newton's method, found with {foreign}"))?;
        }
        if let (Integrator::SymplecticEuler, Some(_)) = (integrator, &self.solver) {
            let problem = "belongs to implicit steps, found with integrator = \"symplectic-euler\"";
            return Err(Error::at("solver", problem));
        }
        let mut solver = choice("solver", self.solver.as_deref(), LinearSolver::default(), LinearSolver::named)?;
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
    /// The damping, and what was measured of it.
    fn check(self, finite_elements: bool) -> Result<(DampingRecipe, Option<MeasuredDamping>)> {
        match (self.rayleigh, self.ratio, self.measured) {
            (None, None, Some(measured)) => {
                let measured = measured.rayleigh().map_err(|e| e.under("measured"))?.at("motion.damping.measured");
                Ok((DampingRecipe::Rayleigh(measured.rayleigh.unwrap_or_default()), Some(measured)))
            }
            (Some(pair), None, None) => {
                for (value, unit) in pair.into_iter().zip(["1/s", "s"]) {
                    range::not_negative("rayleigh", value, unit)?;
                }
                Ok((DampingRecipe::Rayleigh(pair), None))
            }
            (None, Some(ratio), None) => {
                range::not_negative("ratio", ratio, "as a damping ratio")?;
                if finite_elements {
                    let problem = "is that of springs, which finite elements have not: expected \"rayleigh\", or \
                                   finite_elements = false";
                    return Err(Error::at("ratio", problem));
                }
                Ok((DampingRecipe::Ratio(ratio), None))
            }
            (rayleigh, ratio, measured) => {
                let given =
                    [("rayleigh", rayleigh.is_some()), ("ratio", ratio.is_some()), ("measured", measured.is_some())];
                let given: Vec<&str> = given.iter().filter_map(|(name, given)| given.then_some(*name)).collect();
                let found = if given.is_empty() { "neither".into() } else { given.join(" and ") };
                Err(Error::new(format!("expected one of \"rayleigh\", \"measured\" and \"ratio\", found {found}")))
            }
        }
    }
}

fn expression(value: Varying, variables: &[&str], quantity: Option<Quantity>) -> Result<Expr> {
    match value {
        Varying::Number(number) if !(number.abs() <= range::LARGEST) => {
            Err(Error::new(format!("expected a number of at most {:e} in size, found {number:?}", range::LARGEST)))
        }
        Varying::Number(number) => Ok(Expr::Number(parse_rational(&format!("{number}"))?)),
        Varying::Text(text) => Scope::value_over(variables, quantity, &text),
    }
}
