//! The keys of a `[[fit]]` with the objective "sampled".

use super::force::ForceRecipe;
use super::functions::FitFunctions;
use super::recipe::SampledRecipe;
use super::shapes_entry::{self, ShapeSetsEntry};
use super::values::{pair, shown};
use crate::choice::choice;
use crate::error::{Error, Result};
use crate::fit::{Norm, Weights};
use crate::springs::Law;
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

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
    /// `shapes` says which deformed shapes the forces are fitted to. A list of tables gives several sets, each with its `weight`.
    #[schemars(schema_with = "shapes_entry::schema")]
    pub shapes: Option<ShapeSetsEntry>,
    /// The error of each shape and the end of each start are written as tables beside the network, `shapes-NAME.csv` and `starts-NAME.csv`,
    /// of one cell of each shape.
    pub data: bool,
    /// The forces of this energy are sampled: the name of a shipped law, or a path that ends in `.toml`. It may be absent where the
    /// material has a law.
    pub law: Option<String>,
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
        if let (Some(norm), Some(objective)) = (&self.norm, &functions.norm) {
            let found = format!("\"{norm}\" beside the function \"{}\"", objective.name());
            return Err(Error::expected("norm", "one norm", found));
        }
        recipe.fit.objective = functions.norm.clone();
        recipe.fit.data = self.data;
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
        if let Some(sets) = self.shapes {
            recipe.fit.beside.clear();
            recipe.origins.clear();
            let keys: Vec<String> = (0..sets.all.len()).map(|set| sets.key(set)).collect();
            for (i, (entry, key)) in sets.all.into_iter().zip(keys).enumerate() {
                let own = entry.check(folder, &SampledRecipe::default().fit.sampling, sets.is_list);
                let (sampling, origin) = own.map_err(|e| e.placed(|e| e.under(key)))?;
                recipe.origins.push(origin);
                match i {
                    0 => recipe.fit.sampling = sampling,
                    _ => recipe.fit.beside.push(sampling),
                }
            }
        }
        if recipe.fit.data && recipe.fit.sets().all(|set| set.held_out == 0 && set.others.is_none()) {
            let expected = "shapes that are held out, whose errors are the data";
            return Err(Error::expected("shapes.held_out", expected, "0"));
        }
        recipe.fit.weights = choice("weight", self.weight.as_deref(), Weights::Relative, Weights::named)?;
        recipe.fit.higher = self.higher.unwrap_or(recipe.fit.higher);
        (recipe.fit.tied, recipe.fit.nonnegative) = (self.tied, self.nonnegative);
        Ok(recipe)
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
