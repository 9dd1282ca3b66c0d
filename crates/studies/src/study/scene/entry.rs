//! The scene file as it is written, key by key, and what each entry must satisfy on its own.

use super::gauge::GaugeEntry;
use super::input::MeshInput;
use super::motion::MotionEntry;
use super::output::Output;
use super::recipe::{Recipe, SampledRecipe};
use super::sampled::{SampledEntry, ShapesEntry};
use super::value::{Given, Pressure, Varying};
use super::whole::{Start, WholeRecipe};
use super::{LoadCase, NamedFit, Part};
use crate::error::{Error, Result};
use crate::fit::published::Method;
use crate::fit::{Choices, Fit, Objective, Solver, Topology, Weights};
use crate::material::{Material, Plane};
use crate::model::{Action, Component};
use crate::solve::Newton;
use crate::symbolic::Scope;
use serde::Deserialize;
use std::path::{Path, PathBuf};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    pub title: Option<String>,
    pub mesh: MeshInput,
    pub material: MaterialEntry,
    #[serde(default)]
    pub fit: Vec<FitEntry>,
    pub newton: Option<NewtonEntry>,
    #[serde(default)]
    pub fix: Vec<FixEntry>,
    #[serde(default)]
    pub load: Vec<LoadEntry>,
    pub gauge: Option<GaugeEntry>,
    pub motion: Option<MotionEntry>,
    #[serde(default)]
    pub output: Output,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialEntry {
    pub young: Pressure,
    pub poisson: f64,
    pub plane: Option<Plane>,
    pub thickness: Option<f64>,
    /// The cross-section of rods, m².
    pub area: Option<f64>,
    pub density: Option<f64>,
    /// A shipped energy's name, or a path relative to the scene that ends in .toml. Loads are at large deformation then.
    pub law: Option<String>,
}

/// How large deformations are followed.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NewtonEntry {
    pub steps: Option<usize>,
    pub iterations: Option<usize>,
    pub tolerance: Option<f64>,
}

/// A `[[fit]]` as it is written.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitEntry {
    pub name: Option<String>,
    pub objective: String,
    pub weight: Option<String>,
    pub higher: Option<f64>,
    pub balance: Option<f64>,
    pub springs: Option<Vec<String>>,
    #[serde(default)]
    pub tied: bool,
    #[serde(default)]
    pub nonnegative: bool,
    pub solver: Option<String>,
    /// Of a general solver, as the two that follow.
    pub iterations: Option<u64>,
    #[serde(default)]
    pub topology: bool,
    pub sparsity: Option<f64>,
    pub force: Option<toml::Value>,
    pub norm: Option<String>,
    pub huber: Option<f64>,
    pub bounds: Option<toml::Table>,
    pub starts: Option<usize>,
    pub shapes: Option<ShapesEntry>,
    /// One, or a list of them.
    pub start: Option<toml::Value>,
    pub loads: Option<Vec<String>>,
    pub validate: Option<Vec<String>>,
    pub unknowns: Option<String>,
    pub residual: Option<String>,
    pub regularization: Option<f64>,
    pub range: Option<f64>,
    pub frequencies: Option<usize>,
    pub seed: Option<u64>,
    pub law: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FixEntry {
    pub group: Option<String>,
    #[serde(rename = "where")]
    pub condition: Option<String>,
    /// Directions that are held; all if absent.
    pub axes: Option<Vec<String>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoadEntry {
    pub name: Option<String>,
    pub group: Option<String>,
    #[serde(rename = "where")]
    pub condition: Option<String>,
    pub traction: Option<Vec<Varying>>,
    pub force: Option<Vec<f64>>,
    pub body: Option<Vec<Varying>>,
    pub displacement: Option<Vec<Given>>,
    /// What was measured under it.
    pub measured: Option<MeasuredEntry>,
}

/// A file of displacements.
#[derive(Debug, Clone, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct MeasuredEntry {
    /// Relative to the scene.
    pub file: PathBuf,
    /// Metres per unit of the file.
    #[serde(default = "one")]
    pub scale: f64,
    /// Of several.
    pub array: Option<String>,
}

fn one() -> f64 {
    1.0
}

impl MaterialEntry {
    /// What can be said before the dimension is known.
    pub fn check(&self) -> Result<()> {
        let dimension = if self.plane.is_some() || self.thickness.is_some() { 2 } else { 3 };
        // Plane stress admits more of ν than a solid; a solid is checked again when the mesh is known.
        let state = if dimension == 3 { Some(Plane::Stress) } else { self.plane };
        Material::for_body(2, self.young.0, self.poisson, state, self.thickness).map_err(|e| e.under("material"))?;
        match self.density {
            Some(density) if !(density > 0.0 && density.is_finite()) => {
                Err(Error::expected("material.density", "a positive number of kg/m³", density))
            }
            _ => Ok(()),
        }
    }
}

impl FitEntry {
    /// The fits that it stands for, one for each start; files are relative to `folder`.
    ///
    /// # Errors
    /// A key has a wrong value, or belongs to another objective.
    pub fn check(self, folder: &Path) -> Result<Vec<NamedFit>> {
        self.check_owners()?;
        let choices = Choices { weight: self.weight.as_deref(), higher: self.higher, balance: self.balance };
        let recipe = match self.objective.as_str() {
            "sampled" => Recipe::Forces(Box::new(self.sampled(folder)?)),
            "whole" => {
                let starts = Start::names(self.start.as_ref())?;
                let several = starts.len() > 1;
                let mut fits = Vec::new();
                for start in starts {
                    let begin = match start.as_str() {
                        "sampled" => Start::Sampled(Box::new(self.sampled(folder)?)),
                        name => Start::named(name, choices)?,
                    };
                    let recipe = Recipe::Whole(Box::new(WholeRecipe::new(&self, begin)?));
                    let own = |name: &String| if several { format!("{name} from {start}") } else { name.clone() };
                    let name = self.name.as_ref().map_or_else(|| recipe.name(self.springs.as_deref()), own);
                    fits.push(NamedFit { name, recipe, springs: self.springs.clone() });
                }
                return Ok(fits);
            }
            name if Method::of_name(name).is_ok() => Recipe::Published(Method::of_name(name)?),
            name => {
                let objective = Objective::named(name, choices).map_err(|e| match e.key() {
                    Some("objective") => {
                        let published = Method::ALL.map(Method::name).join(", ");
                        let expected = format!("one of {}, sampled, whole, {published}", Objective::NAMES.join(", "));
                        Error::expected("objective", expected, format!("\"{name}\""))
                    }
                    _ => e,
                })?;
                let topology = self.topology.then(|| Topology { sparsity: self.sparsity.unwrap_or(0.0) });
                if let (None, Some(_)) = (topology, self.sparsity) {
                    return Err(Error::at("sparsity", "belongs to topology = true"));
                }
                let solver = Solver::named(self.solver.as_deref().unwrap_or("native"), self.iterations, topology)?;
                Recipe::Stiffness(Fit { objective, tied: self.tied, nonnegative: self.nonnegative, solver })
            }
        };
        let name = self.name.unwrap_or_else(|| recipe.name(self.springs.as_deref()));
        Ok(vec![NamedFit { name, recipe, springs: self.springs }])
    }

    fn sampled(&self, folder: &Path) -> Result<SampledRecipe> {
        let sampled = SampledEntry {
            force: self.force.clone(),
            norm: self.norm.clone(),
            huber: self.huber,
            bounds: self.bounds.clone(),
            starts: self.starts,
            shapes: self.shapes.clone(),
            law: self.law.clone(),
        };
        let mut recipe = sampled.check(folder)?;
        recipe.fit.weights = match self.weight.as_deref() {
            None | Some("relative") => Weights::Relative,
            Some("none") => Weights::Alike,
            Some(other) => {
                let expected = "\"relative\" or \"none\" with the objective \"sampled\"";
                return Err(Error::expected("weight", expected, format!("\"{other}\"")));
            }
        };
        recipe.fit.higher = self.higher.unwrap_or(recipe.fit.higher);
        (recipe.fit.tied, recipe.fit.nonnegative) = (self.tied, self.nonnegative);
        Ok(recipe)
    }

    /// That no key is given that belongs to another objective, or does not go with this one.
    fn check_owners(&self) -> Result<()> {
        let objective = self.objective.as_str();
        let from_sampled =
            objective == "whole" && Start::names(self.start.as_ref()).is_ok_and(|s| s.contains(&"sampled".into()));
        let owned = [
            ("start", "whole", self.start.is_some()),
            ("loads", "whole", self.loads.is_some()),
            ("validate", "whole", self.validate.is_some()),
            ("unknowns", "whole", self.unknowns.is_some()),
            ("residual", "whole", self.residual.is_some()),
            ("regularization", "whole", self.regularization.is_some()),
            ("range", "whole", self.range.is_some()),
            ("frequencies", "whole", self.frequencies.is_some()),
            ("seed", "whole", self.seed.is_some()),
            ("force", "sampled", self.force.is_some()),
            ("norm", "sampled", self.norm.is_some()),
            ("huber", "sampled", self.huber.is_some()),
            ("bounds", "sampled", self.bounds.is_some()),
            ("starts", "sampled", self.starts.is_some()),
            ("shapes", "sampled", self.shapes.is_some()),
            ("law", "sampled", self.law.is_some()),
        ];
        let foreign = |owner: &str| owner != objective && !(owner == "sampled" && from_sampled);
        if let Some((key, owner, _)) = owned.iter().find(|(_, owner, given)| *given && foreign(owner)) {
            let problem = format!("belongs to the objective \"{owner}\", found with \"{objective}\"");
            return Err(Error::at(*key, problem));
        }
        let published = if Method::of_name(objective).is_ok() { objective } else { "" };
        let strange = [
            ("weight", published, self.weight.is_some()),
            ("higher", published, self.higher.is_some()),
            ("balance", published, self.balance.is_some()),
            ("tied", published, self.tied),
            ("nonnegative", published, self.nonnegative),
            ("solver", published, self.solver.is_some()),
            ("iterations", published, self.iterations.is_some()),
            ("topology", published, self.topology),
            ("sparsity", published, self.sparsity.is_some()),
            ("balance", "sampled", self.balance.is_some()),
            ("tied", "whole", self.tied),
            ("nonnegative", "whole", self.nonnegative && !from_sampled),
            ("solver", "sampled", self.solver.is_some()),
            ("iterations", "sampled", self.iterations.is_some()),
            ("topology", "sampled", self.topology),
            ("sparsity", "sampled", self.sparsity.is_some()),
            ("topology", "whole", self.topology),
            ("sparsity", "whole", self.sparsity.is_some()),
        ];
        match strange.iter().find(|(_, other, given)| *given && *other == objective) {
            Some((key, ..)) => Err(Error::at(*key, format!("does not go with the objective \"{objective}\""))),
            None => Ok(()),
        }
    }
}

impl NewtonEntry {
    pub fn check(self) -> Result<Newton> {
        let newton = Newton::default();
        let newton = Newton {
            steps: self.steps.unwrap_or(newton.steps),
            iterations: self.iterations.unwrap_or(newton.iterations),
            tolerance: self.tolerance.unwrap_or(newton.tolerance),
        };
        if !(1..=100_000).contains(&newton.steps) {
            return Err(Error::expected("steps", "a number from 1 to 100000", newton.steps));
        }
        if newton.iterations == 0 {
            return Err(Error::expected("iterations", "a number above 0", 0));
        }
        if !(newton.tolerance > 0.0 && newton.tolerance < 1.0) {
            return Err(Error::expected("tolerance", "a share above 0 and below 1", newton.tolerance));
        }
        Ok(newton)
    }
}

impl FixEntry {
    pub fn check(self) -> Result<(Part, Option<Vec<usize>>)> {
        let part = Part::said(self.group, self.condition)?;
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

impl LoadEntry {
    pub fn check(self, name: String) -> Result<LoadCase> {
        let finite = |key: &str, v: Vec<f64>| match v.iter().find(|x| !x.is_finite()) {
            Some(x) => Err(Error::expected(key, "finite numbers", x)),
            None => Ok(v),
        };
        let varying = |key: &str, v: Vec<Varying>| -> Result<Vec<Component>> {
            let scope = Scope::new(&["x", "y", "z"]);
            let component = |(i, v): (usize, Varying)| match v {
                Varying::Number(value) => Ok(Component::Constant(finite(key, vec![value])?[0])),
                Varying::Text(text) => {
                    scope.expression(&text).map(Component::Varying).map_err(|e| e.under(format!("{key}[{i}]")))
                }
            };
            v.into_iter().enumerate().map(component).collect()
        };
        let mut actions = Vec::new();
        if let Some(v) = self.traction {
            actions.push(Action::Traction(varying("traction", v)?));
        }
        if let Some(v) = self.force {
            actions.push(Action::Force(finite("force", v)?));
        }
        if let Some(v) = self.body {
            actions.push(Action::Body(varying("body", v)?));
        }
        if let Some(v) = self.displacement {
            actions.push(Action::Displacement(v.iter().map(|g| g.0).collect()));
        }
        if actions.len() != 1 {
            let expected = "one of \"traction\", \"force\", \"body\", \"displacement\"";
            return Err(Error::new(format!("expected {expected}, found {}", actions.len())));
        }
        let action = actions.remove(0);
        let part = match action {
            Action::Body(_) => Part::named(self.group, self.condition)?,
            _ => Part::said(self.group, self.condition)?,
        };
        Ok(LoadCase { name, part, action, measured: self.measured })
    }
}
