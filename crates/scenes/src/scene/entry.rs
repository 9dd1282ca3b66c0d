//! The structure of a scene file, key by key, and the conditions on each entry alone.

use super::calibrate::CalibrateEntry;
use super::gauge::GaugeEntry;
use super::hold::Hold;
use super::input::MeshInput;
use super::load::LoadEntry;
use super::material::MaterialEntries;
use super::motion::MotionEntry;
use super::output::Output;
use super::part::Part;
use super::reference::ReferenceEntry;
use crate::bound::{self, check_count};
use crate::choice::choice;
use crate::error::{Error, Result, expect_none};
use crate::fits::FitEntry;
use crate::solve::{Newton, StaticMethod, StaticSolver};
use crate::sweep::SweepEntry;
use schemars::{JsonSchema, schema_for};
use serde::Deserialize;

/// The least error that iterations may be asked for: below it is rounding.
const LEAST_TOLERANCE: f64 = 1e-14;
/// The largest error that iterations may leave: above it nothing is solved.
const LARGEST_TOLERANCE: f64 = 1e-3;

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// The title is the headline of tables and report.
    #[schemars(extend("x-default" = "the name of the file"))]
    pub title: Option<String>,
    /// `[mesh]` says which mesh the body has.
    pub mesh: MeshInput,
    /// `[material]` says what the body is made of; a list `[[material]]` has one entry for each region.
    pub material: MaterialEntries,
    /// Each `[[fit]]` is one way to find the constants of the springs.
    #[serde(default)]
    #[schemars(extend("x-default" = "required, one or more, without `[calibrate]`"))]
    pub fit: Vec<FitEntry>,
    /// `[newton]` says how loads are followed at large deformation; it needs a law of the material.
    pub newton: Option<NewtonEntry>,
    /// `[solver]` says how linear equations are solved; it does not go with a law of the material.
    pub solver: Option<SolverEntry>,
    /// Each `[[fix]]` holds a part of the body.
    #[serde(default)]
    pub fix: Vec<FixEntry>,
    /// Each `[[load]]` is a case of its own, solved apart from the others. Without loads springs are fitted and nothing is solved.
    #[serde(default)]
    pub load: Vec<LoadEntry>,
    /// `[reference]` is a finer body with which the networks are compared.
    pub reference: Option<ReferenceEntry>,
    /// `[gauge]` is a tension test: Young's modulus and Poisson's ratio from the strain of a straight part.
    pub gauge: Option<GaugeEntry>,
    /// `[motion]` is a motion from rest in time; it needs a density.
    pub motion: Option<MotionEntry>,
    /// `[output]` says what is written and computed besides the tables.
    #[serde(default)]
    pub output: Output,
    /// `[calibrate]` says which moduli `springfit calibrate` finds from the measurements of the loads; other commands run the scene as it is.
    pub calibrate: Option<CalibrateEntry>,
    /// `[sweep]` has the studies of `springfit sweep`; other commands run the scene as it is.
    pub sweep: Option<SweepEntry>,
}

/// The materials of a body without a scene.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialTable {
    pub material: MaterialEntries,
}

/// How loads are applied at large deformation.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NewtonEntry {
    /// A load is applied in this number of steps at first, 1 or more; a step that fails is halved.
    #[schemars(extend("default" = Newton::default().steps))]
    pub steps: Option<usize>,
    /// A load step takes at most this number of iterations of Newton's method, 1 or more.
    #[schemars(extend("default" = Newton::default().iterations))]
    pub iterations: Option<usize>,
    /// A load step ends when its residual is this share of the forces that act, above 0 and below 1.
    #[schemars(extend("default" = Newton::default().tolerance))]
    pub tolerance: Option<f64>,
}

/// How linear equations are solved.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SolverEntry {
    /// The method is `cholesky`, a sparse factor, or `multigrid`, conjugate gradients on levels; `auto` takes the faster one by size and
    /// number of loads.
    #[schemars(extend("enum" = StaticMethod::NAMES, "default" = StaticSolver::default().method.name()))]
    pub method: Option<String>,
    /// Iterations end at this relative error in the norm of the energy, from 1e-14 to below 1e-3. An answer that leaves more than ten times
    /// as much of the forces, and more than 1e-6, is an error. The key does not go with `cholesky`.
    #[schemars(extend("default" = StaticSolver::default().tolerance))]
    pub tolerance: Option<f64>,
    /// Conjugate gradients take at most this number of iterations, 1 or more. The key does not go with `cholesky`.
    #[schemars(extend("default" = StaticSolver::default().iterations))]
    pub iterations: Option<usize>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FixEntry {
    /// The part that is held is this group of the mesh; one of `group` and `where` is required.
    pub group: Option<String>,
    /// The part that is held has the points that satisfy this condition on x, y, z in m, such as `z < 1e-9 && x^2 + y^2 < 0.005^2`; one of
    /// `group` and `where` is required.
    #[serde(rename = "where")]
    pub condition: Option<String>,
    /// The part is held in these directions, some of `x`, `y` and `z`.
    #[schemars(extend("x-default" = "all"))]
    pub axes: Option<Vec<String>>,
    /// The edges of a sheet keep their direction where both ends are held, and so do the joints of rods that are held; without it the body can turn about them. Such a body has
    /// `bending` in its material.
    #[serde(default)]
    pub clamp: bool,
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
        if method == StaticMethod::Cholesky {
            expect_none(given, "belongs to iterations, found with method = \"cholesky\"")?;
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
    pub fn check(self) -> Result<Hold> {
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
        Ok(Hold { part, axes, clamp: self.clamp })
    }
}
