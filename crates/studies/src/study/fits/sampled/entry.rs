//! The keys of a `[[fit]]` with the objective "sampled".

use super::force::ForceRecipe;
use super::functions::FitFunctions;
use super::recipe::SampledRecipe;
use crate::bound;
use crate::error::{Error, Result};
use crate::file;
use crate::fit::{DeformationFamily, Norm, Source, Weights};
use crate::springs::Law;
use crate::study::choice::choice;
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The keys.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SampledEntry {
    /// Each shape counts by the inverse square of its force (`relative`), or all shapes count alike (`none`). The errors of the report are
    /// weighted alike: with `relative` they are the root mean square of each shape's error relative to its own force, and with `none` the
    /// root mean square of all errors relative to that of all forces, which the shapes with the largest forces decide.
    #[schemars(extend("enum" = Weights::NAMES, "default" = Weights::Relative.name()))]
    pub weight: Option<String>,
    /// Forces that do no work on homogeneous deformations have this scale.
    #[schemars(extend("default" = SampledRecipe::default().fit.higher))]
    pub higher: Option<f64>,
    /// All springs of a group have one set of parameters.
    pub tied: bool,
    /// No parameter is below zero.
    pub nonnegative: bool,
    /// The law of force is `linear`, `free-rest` or an expression such as `"k1*s + k3*s^3"`. A table has an expression for each spring
    /// group.
    #[schemars(with = "Option<serde_json::Value>", extend("x-type" = "text, or table of texts", "default" = "linear"))]
    pub force: Option<toml::Value>,
    /// The differences of the forces are measured in this norm.
    #[schemars(extend("enum" = Norm::NAMES, "default" = Norm::Two.name()))]
    pub norm: Option<String>,
    /// The Huber norm bends at this share of the root mean square of the weighted components of the forces; the key belongs to `norm =
    /// "huber"`.
    #[schemars(extend("default" = 0.5))]
    pub huber: Option<f64>,
    /// Parameters have these least and largest values, such as `{ a = [0, 10] }`.
    #[schemars(with = "Option<BTreeMap<String, [f64; 2]>>")]
    pub bounds: Option<toml::Table>,
    /// The search begins at this number of points; the key belongs to laws that are not linear in their parameters.
    #[schemars(extend("default" = SampledRecipe::default().fit.starts))]
    pub starts: Option<usize>,
    /// `shapes` says which deformed shapes the forces are fitted to.
    pub shapes: Option<ShapesEntry>,
    /// The forces of this energy are sampled: the name of a shipped law, or a path that ends in `.toml`. It may be absent where the
    /// material has a law.
    pub law: Option<String>,
}

#[derive(Debug, Clone, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShapesEntry {
    /// The shapes are of these families of deformations. At most one of `families`, `gradients` and `loads` is given.
    #[schemars(extend(
        "items" = json!({ "type": "string", "enum": DeformationFamily::NAMES }),
        "x-default" = "the first four",
    ))]
    pub families: Option<Vec<String>>,
    /// The shapes have the deformation gradients of this CSV file, relative to the scene, row by row. Four of five are fitted, each
    /// once, and each fifth is held out; a list of less than five is fitted as a whole, and held out with other displacements of the nodes.
    #[schemars(extend("x-type" = "path"))]
    pub gradients: Option<PathBuf>,
    /// The shapes are those that the finite elements take on the way to these loads of the scene. A cell that has fewer of them than `count`
    /// uses each equally often, with other displacements of the nodes each time.
    pub loads: Option<Vec<String>>,
    /// The springs are fitted to this number of shapes; to the first of them with `gradients`, which has to have as many to fit.
    #[schemars(extend("x-default" = format!("{}, all with `gradients`", SampledRecipe::default().fit.sampling.shapes)))]
    pub count: Option<usize>,
    /// The springs are tested on this number of other shapes, by the same rule.
    #[schemars(extend("x-default" = format!("{}, all with `gradients`", SampledRecipe::default().fit.sampling.held_out)))]
    pub held_out: Option<usize>,
    /// The amplitudes of `families` are between these two numbers; one number, such as 0.3, means −0.3 to 0.3.
    #[schemars(with = "Option<serde_json::Value>", extend("x-type" = "number, or pair of numbers", "default" = 0.3))]
    pub stretch: Option<toml::Value>,
    /// Each node is displaced at random by this share of the cell's size.
    #[schemars(extend("default" = SampledRecipe::default().fit.sampling.perturbation))]
    pub perturbation: Option<f64>,
    /// Another seed gives other random numbers.
    #[schemars(extend("default" = SampledRecipe::default().fit.sampling.seed))]
    pub seed: Option<u64>,
}

impl SampledEntry {
    /// The recipe, with the values of [`SampledRecipe::default`] for keys that are not given.
    ///
    /// # Errors
    /// A key has a wrong value, it is there beside a function in its place, or a file of gradients cannot be read.
    pub fn check(self, folder: &Path, functions: &FitFunctions) -> Result<SampledRecipe> {
        let law = self.law.map(|law| law_at(&law, folder));
        if let (Some(law), Some(energy)) = (&law, &functions.energy) {
            let found = format!("\"{law}\" beside the function \"{}\"", energy.name());
            return Err(Error::expected("law", "one energy", found));
        }
        let force = functions.force(self.force.as_ref().map(force_of).transpose()?)?;
        let mut recipe = SampledRecipe { law, energy: functions.energy.clone(), force, ..SampledRecipe::default() };
        recipe.fit.norm = choice("norm", self.norm.as_deref(), Norm::Two, Norm::named)?;
        if let Some(share) = self.huber {
            match recipe.fit.norm {
                Norm::Huber { .. } => recipe.fit.norm = Norm::Huber { share },
                Norm::Two | Norm::One | Norm::Max => {
                    return Err(Error::at("huber", "belongs to the norm \"huber\""));
                }
            }
        }
        for (name, value) in self.bounds.unwrap_or_default() {
            let range = pair(&value).ok_or_else(|| {
                Error::expected(format!("bounds.{name}"), "two numbers such as [0, 10]", shown(&value))
            })?;
            recipe.fit.bounds.push((name, range));
        }
        if self.starts.is_some() && recipe.force.is_linear() {
            return Err(Error::at("starts", "belongs to a law of force that is not linear in its parameters"));
        }
        recipe.fit.starts = self.starts.unwrap_or(recipe.fit.starts);
        if let Some(shapes) = self.shapes {
            shapes.check(folder, &mut recipe).map_err(|e| e.placed(|e| e.under("shapes")))?;
        }
        recipe.fit.weights = choice("weight", self.weight.as_deref(), Weights::Relative, Weights::named)?;
        recipe.fit.higher = self.higher.unwrap_or(recipe.fit.higher);
        (recipe.fit.tied, recipe.fit.nonnegative) = (self.tied, self.nonnegative);
        Ok(recipe)
    }
}

impl ShapesEntry {
    fn check(self, folder: &Path, recipe: &mut SampledRecipe) -> Result<()> {
        let sources = [self.families.is_some(), self.gradients.is_some(), self.loads.is_some()];
        if sources.iter().filter(|given| **given).count() > 1 {
            return Err(Error::new("expected one of \"families\", \"gradients\", \"loads\", found more"));
        }
        if self.stretch.is_some() && (self.gradients.is_some() || self.loads.is_some()) {
            return Err(Error::at("stretch", "belongs to \"families\": shapes of a list have their own"));
        }
        let sampling = &mut recipe.fit.sampling;
        if let Some(names) = &self.families {
            let families: Result<Vec<DeformationFamily>> =
                names.iter().map(|name| DeformationFamily::named(name)).collect();
            sampling.source = Source::Families(families.map_err(|e| e.under("families"))?);
        }
        if let Some(path) = &self.gradients {
            let path = folder.join(path);
            let numbers = numbers_of(&file::read_text(&path)?).map_err(|e| e.in_file(&path))?;
            // Each row is used once, whatever their number.
            let most = numbers.len().clamp(1, bound::SHAPES as usize);
            (sampling.shapes, sampling.held_out) = (most, most);
            sampling.source = Source::Gradients(Arc::new(numbers));
            recipe.gradients = Some(path);
            (recipe.count, recipe.held_out) = (self.count, self.held_out);
        }
        if let Some(loads) = self.loads {
            if loads.is_empty() {
                return Err(Error::expected("loads", "names of loads of the scene", "none"));
            }
            recipe.loads = loads;
        }
        let sampling = &mut recipe.fit.sampling;
        sampling.shapes = self.count.unwrap_or(sampling.shapes);
        sampling.held_out = self.held_out.unwrap_or(sampling.held_out);
        sampling.perturbation = self.perturbation.unwrap_or(sampling.perturbation);
        sampling.seed = self.seed.unwrap_or(sampling.seed);
        if let Some(value) = &self.stretch {
            let symmetric = number(value).map(|s| [-s, s]);
            let expected = "a share such as 0.3, or a range such as [-0.1, 0.4]";
            sampling.stretch =
                symmetric.or_else(|| pair(value)).ok_or_else(|| Error::expected("stretch", expected, shown(value)))?;
        }
        sampling.check_numbers().map_err(counted)
    }
}

/// An error of the settings of shapes with the key that the number of shapes has in scenes.
fn counted(error: Error) -> Error {
    if error.key() == Some("shapes") { error.at_key("count") } else { error }
}

/// An error of the settings of shapes that depends on the cells, with the path of its key.
pub(super) fn of_shapes(error: Error) -> Error {
    match error.key() {
        Some("families" | "gradients") => error.under("shapes"),
        _ => error,
    }
}

/// The name of a law, or the path of its file relative to `folder`.
pub fn law_at(law: &str, folder: &Path) -> String {
    if law.ends_with(".toml") { folder.join(law).to_string_lossy().into_owned() } else { law.into() }
}

/// One law for all springs, or a table of laws by group.
fn force_of(value: &toml::Value) -> Result<ForceRecipe> {
    match value {
        toml::Value::String(text) => ForceRecipe::parse(text),
        toml::Value::Table(groups) => {
            let law = |(group, value): (&String, &toml::Value)| {
                let key = format!("force.{group}");
                let text = value.as_str().ok_or_else(|| Error::expected(&key, "a law in quotes", value.type_str()))?;
                if text == "free-rest" {
                    return Err(Error::at(key, "\"free-rest\" is for all groups alike: force = \"free-rest\""));
                }
                let law = Law::parse(if text == "linear" { "k*(c - c0)" } else { text });
                Ok((group.clone(), law.map_err(|e| Error::at(key, e.problem()))?))
            };
            groups.iter().map(law).collect::<Result<_>>().map(ForceRecipe::Groups)
        }
        other => {
            let expected = "\"linear\", \"free-rest\", a law in quotes, or a table of laws by group";
            Err(Error::expected("force", expected, other.type_str()))
        }
    }
}

fn number(value: &toml::Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|i| i as f64))
}

fn shown(value: &toml::Value) -> String {
    match (value, number(value)) {
        (_, Some(number)) => number.to_string(),
        (toml::Value::String(text), _) => format!("\"{text}\""),
        (toml::Value::Array(items), _) => format!("[{}]", items.iter().map(shown).collect::<Vec<_>>().join(", ")),
        _ => format!("a {}", value.type_str()),
    }
}

fn pair(value: &toml::Value) -> Option<[f64; 2]> {
    let numbers: Option<Vec<f64>> = value.as_array()?.iter().map(number).collect();
    numbers?.try_into().ok()
}

/// Numbers separated by commas, spaces and line ends; `#` begins a comment.
fn numbers_of(text: &str) -> Result<Vec<f64>> {
    let mut numbers = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        for word in line.split(|c: char| c == ',' || c == ';' || c.is_whitespace()).filter(|word| !word.is_empty()) {
            let number = word.parse().ok().filter(|v: &f64| v.is_finite());
            numbers.push(
                number.ok_or_else(|| Error::new(format!("expected finite numbers, found {word}")).on_line(i + 1))?,
            );
        }
    }
    Ok(numbers)
}
