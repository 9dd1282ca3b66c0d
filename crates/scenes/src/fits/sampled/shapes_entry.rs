//! The shapes of a sampled fit as a scene has them: one set, or a list of sets.

use crate::file::Forms;
use crate::fit::{DeformationFamily, Design};
use crate::fits::sampled::recipe::SampledRecipe;
use crate::scene::value;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny};
use serde_json::json;
use std::path::PathBuf;

/// The keys of a set of shapes.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShapesEntry {
    /// The shapes are of these families of deformations, which take turns. At most one of `families`, `gradients`, `loads` and `states` is
    /// given, or `run`.
    #[schemars(extend(
        "items" = json!({ "type": "string", "enum": DeformationFamily::NAMES }),
        "x-default" = "the first four, or those that the dimension has",
    ))]
    pub families: Option<Vec<String>>,
    /// The axes of `families` are along these directions, which take turns: `[[1, 0, 0], [0, 0, 1]]`. A direction with twice as many numbers
    /// gives two axes, such as the direction in which a shear slides and the normal of the planes that slide.
    #[schemars(extend("x-default" = "random axes"))]
    pub directions: Option<Vec<Vec<f64>>>,
    /// Amplitudes and axes of `families` are points of a scrambled Sobol sequence (`scrambled`), of a Sobol sequence of each family
    /// (`sobol`), of a Latin hypercube of each family over `count` (`latin-hypercube`), or independent random numbers (`random`).
    #[schemars(extend("enum" = Design::NAMES, "default" = Design::default().name()))]
    pub design: Option<String>,
    /// The shapes have the deformation gradients of this CSV file, relative to the scene, row by row, or of this list. Four of five are
    /// fitted, each once, and each fifth is held out, unless `held_out` has shapes of its own; a list of less than five is fitted as a
    /// whole, and held out with other displacements of the nodes. A row with det F below 0.001 is refused.
    #[schemars(with = "Option<serde_json::Value>", extend("x-type" = "path, or list of lists of numbers"))]
    pub gradients: Option<toml::Value>,
    /// The shapes are those that the finite elements take on the way to these loads of the scene; with `run` they are those under these
    /// loads of the run. A cell that has fewer of them than `count` uses each equally often, with other displacements of the nodes each time.
    pub loads: Option<Vec<String>>,
    /// The shapes are those of the finite elements in the folder of a run of the same mesh, relative to the scene: under its loads
    /// (`mesh.vtu`) and, without `loads`, in its motion.
    #[schemars(extend("x-type" = "path"))]
    pub run: Option<PathBuf>,
    /// The shapes are those in this file or these files, relative to the scene: `.vtu`, `.vtk` and `.csv` of displacements of all points of
    /// the mesh, or a collection `.pvd` of them. Each array of three components is a state.
    #[schemars(with = "Option<serde_json::Value>", extend("x-type" = "path, or list of paths"))]
    pub states: Option<PathsEntry>,
    /// One unit of the files of `states` has this length in m, above 0.
    #[serde(default, deserialize_with = "value::optional_mesh_unit")]
    #[schemars(schema_with = "value::mesh_unit_schema", extend("x-default" = "1 m"))]
    pub scale: Option<f64>,
    /// The springs are fitted to this number of shapes; to the first of them with `gradients`, which has to have as many to fit.
    #[schemars(extend("x-default" = format!("{}, all with `gradients`", SampledRecipe::default().fit.sampling.shapes)))]
    pub count: Option<usize>,
    /// The springs are tested on this number of other shapes, by the same rule; or on the shapes of this table, which has the keys of this
    /// one, such as `{ families = ["torsion"], stretch = [0.3, 0.6], count = 200 }`. Keys that it lacks are those of the shapes of the fit.
    #[schemars(
        with = "Option<ShapesEntry>",
        extend(
            "x-type" = "whole number, or [table](#fit-sampled-shapes)",
            "x-default" = format!("{}, all with `gradients`", SampledRecipe::default().fit.sampling.held_out),
        )
    )]
    pub held_out: Option<HeldOutEntry>,
    /// The amplitudes of `families` are between these two numbers; one number, such as 0.3, means −0.3 to 0.3.
    #[schemars(with = "Option<serde_json::Value>", extend("x-type" = "number, or pair of numbers", "default" = 0.3))]
    pub stretch: Option<toml::Value>,
    /// Each node is displaced at random by this share of the cell's size.
    #[schemars(extend("default" = SampledRecipe::default().fit.sampling.perturbation))]
    pub perturbation: Option<f64>,
    /// Another seed gives other random numbers.
    #[schemars(extend("default" = SampledRecipe::default().fit.sampling.seed))]
    pub seed: Option<u64>,
    /// All shapes of the set together have this weight beside those of the other sets of a list, however many they are.
    #[schemars(extend("x-default" = "1"))]
    pub weight: Option<f64>,
}

/// The paths of files.
#[derive(Debug, Clone, PartialEq)]
pub struct PathsEntry(pub Vec<PathBuf>);

impl<'de> Deserialize<'de> for PathsEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<PathsEntry, D::Error> {
        deserializer.deserialize_any(Forms::<_, _, IgnoredAny> {
            text: Some(&|path| Ok(PathsEntry(vec![path.into()]))),
            list: Some(|all| Ok(PathsEntry(all))),
            ..Forms::expecting("the path of a file, or a list of paths")
        })
    }
}

/// The shapes that are held out: a number of them, or shapes of their own.
#[derive(Debug, Clone, PartialEq)]
pub enum HeldOutEntry {
    Count(usize),
    Shapes(Box<ShapesEntry>),
}

impl<'de> Deserialize<'de> for HeldOutEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<HeldOutEntry, D::Error> {
        // Far above 1e15 a double no longer holds every whole number.
        let count = |v: f64| (v.fract() == 0.0 && (0.0..=1e15).contains(&v)).then_some(HeldOutEntry::Count(v as usize));
        deserializer.deserialize_any(Forms::<_, IgnoredAny, _> {
            number: Some(count),
            table: Some(|shapes| HeldOutEntry::Shapes(Box::new(shapes))),
            ..Forms::expecting("a whole number of shapes from 0, or a table of shapes")
        })
    }
}

/// The sets of shapes of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapeSetsEntry {
    pub all: Vec<ShapesEntry>,
    /// Whether they are written as a list.
    pub is_list: bool,
}

impl<'de> Deserialize<'de> for ShapeSetsEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<ShapeSetsEntry, D::Error> {
        deserializer.deserialize_any(Forms {
            list: Some(|all: Vec<ShapesEntry>| match all.is_empty() {
                true => Err("expected at least one table of shapes, found none"),
                false => Ok(ShapeSetsEntry { all, is_list: true }),
            }),
            table: Some(|one| ShapeSetsEntry { all: vec![one], is_list: false }),
            ..Forms::expecting("a table of shapes, or a list of tables")
        })
    }
}

impl ShapeSetsEntry {
    /// The key of a set among those of the fit.
    pub fn key(&self, set: usize) -> String {
        if self.is_list { format!("shapes[{set}]") } else { "shapes".into() }
    }
}

/// The schema of one set or of a list of them.
pub fn schema(generator: &mut SchemaGenerator) -> Schema {
    let one = generator.subschema_for::<ShapesEntry>();
    json_schema!({ "anyOf": [one, { "type": "array", "items": one }, { "type": "null" }] })
}
