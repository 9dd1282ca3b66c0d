//! The structure of a scene file, key by key, and the conditions on each entry alone.

use super::gauge::GaugeEntry;
use super::input::MeshInput;
use super::load::LoadEntry;
use super::material::MaterialEntries;
use super::motion::MotionEntry;
use super::output::Output;
use super::part::Part;
use super::reference::ReferenceEntry;
use crate::bound::{self, check_count};
use crate::error::{Error, Result};
use crate::solve::{Newton, StaticMethod, StaticSolver};
use crate::study::choice::choice;
use crate::study::fits::FitEntry;
use crate::study::sweep::SweepEntry;
use schemars::{JsonSchema, schema_for};
use serde::Deserialize;

/// Errors that iterations may leave: below is rounding, above solves nothing.
const LEAST_TOLERANCE: f64 = 1e-14;
const LARGEST_TOLERANCE: f64 = 1e-3;

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    pub title: Option<String>,
    pub mesh: MeshInput,
    pub material: MaterialEntries,
    #[serde(default)]
    pub fit: Vec<FitEntry>,
    pub newton: Option<NewtonEntry>,
    pub solver: Option<SolverEntry>,
    #[serde(default)]
    pub fix: Vec<FixEntry>,
    #[serde(default)]
    pub load: Vec<LoadEntry>,
    /// The finer body with which the networks are compared.
    pub reference: Option<ReferenceEntry>,
    pub gauge: Option<GaugeEntry>,
    pub motion: Option<MotionEntry>,
    #[serde(default)]
    pub output: Output,
    /// What `springfit sweep` runs; other commands run the scene as it is.
    pub sweep: Option<SweepEntry>,
}

/// How loads are applied at large deformation.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NewtonEntry {
    pub steps: Option<usize>,
    pub iterations: Option<usize>,
    pub tolerance: Option<f64>,
}

/// How linear equations are solved.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SolverEntry {
    #[schemars(extend("enum" = StaticMethod::NAMES))]
    pub method: Option<String>,
    pub tolerance: Option<f64>,
    pub iterations: Option<usize>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FixEntry {
    pub group: Option<String>,
    #[serde(rename = "where")]
    pub condition: Option<String>,
    /// The directions that are held; all if absent.
    pub axes: Option<Vec<String>>,
}

/// The JSON Schema of scene files.
pub fn scene_schema() -> serde_json::Value {
    schema_for!(SceneFile).to_value()
}

impl NewtonEntry {
    pub fn check(self) -> Result<Newton> {
        let newton = Newton::default();
        let newton = Newton {
            steps: self.steps.unwrap_or(newton.steps),
            iterations: self.iterations.unwrap_or(newton.iterations),
            tolerance: self.tolerance.unwrap_or(newton.tolerance),
        };
        check_count("steps", newton.steps as u64, 1, bound::LOAD_STEPS)?;
        check_count("iterations", newton.iterations as u64, 1, bound::ITERATIONS)?;
        if !(newton.tolerance > 0.0 && newton.tolerance < 1.0) {
            return Err(Error::expected("tolerance", "a share above 0 and below 1", newton.tolerance));
        }
        Ok(newton)
    }
}

impl SolverEntry {
    pub fn check(self) -> Result<StaticSolver> {
        let solver = StaticSolver::default();
        let method = choice("method", self.method.as_deref(), solver.method, StaticMethod::named)?;
        let given = [("tolerance", self.tolerance.is_some()), ("iterations", self.iterations.is_some())];
        if let (StaticMethod::Cholesky, Some((key, _))) = (method, given.iter().find(|(_, given)| *given)) {
            return Err(Error::at(*key, "belongs to iterations, found with method = \"cholesky\""));
        }
        let tolerance = self.tolerance.unwrap_or(solver.tolerance);
        let iterations = self.iterations.unwrap_or(solver.iterations);
        check_count("iterations", iterations as u64, 1, bound::ITERATIONS)?;
        if !(LEAST_TOLERANCE..LARGEST_TOLERANCE).contains(&tolerance) {
            let expected = format!("a share from {LEAST_TOLERANCE:e} to below {LARGEST_TOLERANCE:e}");
            return Err(Error::expected("tolerance", expected, format!("{tolerance:?}")));
        }
        Ok(StaticSolver { method, tolerance, iterations })
    }
}

impl FixEntry {
    pub fn check(self) -> Result<(Part, Option<Vec<usize>>)> {
        let part = Part::required(self.group, self.condition)?;
        let axes = match self.axes {
            None => None,
            Some(axes) => {
                let directions = axes.iter().map(|a| ["x", "y", "z"].iter().position(|k| k == a));
                let directions: Option<Vec<usize>> = directions.collect();
                let valid = directions.filter(|d| !d.is_empty());
                Some(valid.ok_or_else(|| Error::expected("axes", "some of \"x\", \"y\", \"z\"", format!("{axes:?}")))?)
            }
        };
        Ok((part, axes))
    }
}
