//! The table `[compare]` of a comparison, as it is written.

use crate::analysis::shapes::{ShapeFamily, ShapeSet};
use crate::error::{Error, Result};
use crate::fit::Solver;
use crate::material::Plane;
use schemars::{JsonSchema, schema_for};
use serde::Deserialize;
use std::path::PathBuf;
use toml::{Table, Value};

/// The file of a comparison.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "comparison")]
pub struct CompareFile {
    /// Tables and figures have this title.
    pub title: Option<String>,
    /// `compare` says what is compared: each fit on each case.
    pub compare: CompareEntry,
}

/// What is compared. Cases are all combinations of `elements`, `poisson`, `laws` or `shapes`, and each of `scenes`.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct CompareEntry {
    /// The elements are shipped ones by their names, or files that end in `.toml`, relative to this file.
    pub elements: Vec<String>,
    /// The material of elements has these Poisson's ratios.
    #[schemars(with = "Option<serde_json::Value>", extend("x-type" = "number, or list of numbers", "default" = 0.3))]
    pub poisson: Option<Value>,
    /// Plane elements are in plane `stress` or plane `strain`.
    #[schemars(extend("enum" = ["stress", "strain"], "default" = "stress"))]
    pub plane: Option<Plane>,
    /// `shapes` says on which shapes of an element the springs are fitted. Each number in it may be a list, and each combination is a case.
    #[schemars(with = "Option<ShapesKeys>", extend("x-type" = "table, or list of tables"))]
    pub shapes: Option<Value>,
    /// With these energies, shipped ones by their names or files that end in `.toml`, a box of each element is held at both ends and
    /// stretched, in place of shapes.
    pub laws: Vec<String>,
    /// Fits to sampled forces that are not listed reach from a tenth of compression to this stretch; the key belongs to `laws`.
    #[schemars(extend("default" = 0.35))]
    pub stretch: Option<f64>,
    /// Each of these scenes is run with the fits that are compared in place of its own; paths are relative to this file.
    pub scenes: Vec<PathBuf>,
    /// Each entry is a fit with the keys of a `[[fit]]` of a scene. Each key may have a list of values in place of one, and each combination
    /// is a fit of its own; of a key whose value is a list it is a list of lists.
    #[schemars(with = "Vec<serde_json::Value>", extend("x-type" = "list of tables", "x-default" = "all objectives, and by `solver` all methods"))]
    pub fit: Vec<Table>,
    /// General optimisers take this number of iterations where no fit is listed, 1 or more.
    #[schemars(extend("default" = Solver::DEFAULT_ITERATIONS))]
    pub iterations: Option<u64>,
    /// What fits and models cost is measured: processor time of one thread, in passes that take turns.
    #[schemars(extend("default" = true))]
    pub time: Option<bool>,
}

/// Shapes of an element.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[allow(dead_code)]
pub struct ShapesKeys {
    /// The reference cell has each node moved at random (`distorted`), or as well a random affine map (`random`).
    #[schemars(extend("x-type" = "text, or list of texts", "enum" = ShapeFamily::NAMES, "default" = "random"))]
    family: Option<String>,
    /// Each coordinate of a node is moved by up to this length, in units of the reference cell, from 0 to 1.
    #[schemars(with = "Option<serde_json::Value>", extend("x-type" = "number, or list of numbers", "default" = ShapeSet::default().distortion))]
    distortion: Option<Value>,
    /// The shapes are stretched along x by this factor, from 1/1000 to 1000.
    #[schemars(with = "Option<serde_json::Value>", extend("x-type" = "number, or list of numbers", "default" = 1))]
    aspect: Option<Value>,
    /// Another seed gives other shapes.
    #[schemars(with = "Option<serde_json::Value>", extend("x-type" = "number, or list of numbers", "default" = ShapeSet::default().seed))]
    seed: Option<Value>,
    /// Each case has this number of shapes, 1 or more.
    #[schemars(with = "Option<serde_json::Value>", extend("x-type" = "number, or list of numbers", "default" = ShapeSet::default().count))]
    count: Option<Value>,
}

/// The JSON Schema of comparisons.
pub fn compare_schema() -> serde_json::Value {
    schema_for!(CompareFile).to_value()
}

/// One value or a list of them, none of which is missing.
///
/// # Errors
/// The list is empty.
pub fn values(key: &str, value: Option<&Value>) -> Result<Vec<Value>> {
    match value {
        None => Ok(Vec::new()),
        Some(Value::Array(list)) if list.is_empty() => Err(Error::expected(key, "at least one value", "an empty list")),
        Some(Value::Array(list)) => Ok(list.clone()),
        Some(value) => Ok(vec![value.clone()]),
    }
}

/// Reads one number or a list of numbers; without a value it returns `usual` alone.
///
/// # Errors
/// The list is empty, or an entry is no number.
pub fn numbers(key: &str, value: Option<&Value>, usual: f64) -> Result<Vec<f64>> {
    let number = |value: &Value| {
        let number = value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
        number.ok_or_else(|| Error::expected(key, "a number, or a list of numbers", value.type_str()))
    };
    match values(key, value)? {
        none if none.is_empty() => Ok(vec![usual]),
        list => list.iter().map(number).collect(),
    }
}
