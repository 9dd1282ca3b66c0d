//! The scene file.

use crate::element::Element;
use crate::error::{Error, Result};
use crate::file;
use crate::fit::{Fit, Objective};
use crate::material::{Material, State, parse_pressure};
use crate::mesh::{BoxMesh, Mesh, MeshSource, Selection};
use crate::model::Action;
use crate::symbolic::Scope;
use serde::Deserialize;
use serde::de::{self, Deserializer, Visitor};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A mesh, a material, fits, supports and loads; proved as far as it can be without reading the mesh.
#[derive(Debug, Clone)]
pub struct Scene {
    pub path: PathBuf,
    pub title: String,
    pub mesh: MeshInput,
    material: MaterialEntry,
    pub fits: Vec<NamedFit>,
    /// The parts that are held, and in which directions (all if absent).
    pub supports: Vec<(Part, Option<Vec<usize>>)>,
    pub loads: Vec<LoadCase>,
    pub output: Output,
}

/// A fit, what a report calls it, and the spring groups it uses.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedFit {
    pub name: String,
    pub fit: Fit,
    /// All groups that are not optional, if absent.
    pub springs: Option<Vec<String>>,
}

#[derive(Debug, Clone)]
pub struct LoadCase {
    pub name: String,
    pub part: Part,
    pub action: Action,
}

/// A part of the mesh as a scene names it; a condition is parsed once the mesh's dimension is known.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    Group(String),
    Where(String),
    Everything,
}

#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// The springs and displacements as VTU files.
    pub vtu: bool,
    /// The springs as a CSV file.
    pub csv: bool,
    /// report.json; written unless switched off.
    pub report: Option<bool>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneFile {
    title: Option<String>,
    mesh: MeshInput,
    material: MaterialEntry,
    #[serde(default)]
    fit: Vec<FitEntry>,
    #[serde(default)]
    fix: Vec<FixEntry>,
    #[serde(default)]
    load: Vec<LoadEntry>,
    #[serde(default)]
    output: Output,
}

/// Where the mesh comes from.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeshInput {
    /// Relative to the scene.
    pub file: Option<PathBuf>,
    #[serde(rename = "box")]
    pub generated: Option<BoxEntry>,
    /// Mesh units to metres.
    #[serde(default = "one")]
    pub scale: f64,
    /// Element files to look in before the shipped ones, relative to the scene.
    #[serde(default)]
    pub elements: Vec<PathBuf>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoxEntry {
    /// A shipped element's name, or a path relative to the scene that ends in .toml.
    pub element: String,
    pub size: Vec<f64>,
    pub cells: Vec<usize>,
    pub origin: Option<Vec<f64>>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct MaterialEntry {
    young: Pressure,
    poisson: f64,
    plane: Option<Plane>,
    thickness: Option<f64>,
    density: Option<f64>,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Plane {
    Stress,
    Strain,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct FitEntry {
    name: Option<String>,
    objective: String,
    higher: Option<f64>,
    springs: Option<Vec<String>>,
    #[serde(default)]
    tied: bool,
    #[serde(default)]
    nonnegative: bool,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct FixEntry {
    group: Option<String>,
    #[serde(rename = "where")]
    condition: Option<String>,
    /// Directions that are held; all if absent.
    axes: Option<Vec<String>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct LoadEntry {
    name: Option<String>,
    group: Option<String>,
    #[serde(rename = "where")]
    condition: Option<String>,
    traction: Option<Vec<f64>>,
    force: Option<Vec<f64>>,
    body: Option<Vec<f64>>,
    displacement: Option<Vec<Given>>,
}

/// One direction of a prescribed displacement: a number of metres, or `"free"`.
#[derive(Debug, Clone, Copy)]
struct Given(Option<f64>);

/// A number of Pa, or a text with a unit.
#[derive(Debug, Clone, Copy)]
struct Pressure(f64);

fn one() -> f64 {
    1.0
}

impl Scene {
    /// Reads and checks a scene.
    ///
    /// # Errors
    /// Names the file, the key, what was expected and what was found.
    pub fn load(path: &Path) -> Result<Scene> {
        let text = file::read_text(path)?;
        Scene::parse(&text, path).map_err(|e| e.in_file(path))
    }

    fn parse(text: &str, path: &Path) -> Result<Scene> {
        let entry: SceneFile = file::parse_toml(text)?;
        let mesh = entry.mesh;
        if mesh.file.is_some() == mesh.generated.is_some() {
            let found = if mesh.file.is_some() { "both" } else { "neither" };
            return Err(Error::expected("mesh", "either \"file\" or \"box\"", found));
        }
        if !(mesh.scale > 0.0 && mesh.scale.is_finite()) {
            return Err(Error::expected("mesh.scale", "a positive number of metres per mesh unit", mesh.scale));
        }
        if entry.fit.is_empty() {
            return Err(Error::expected("fit", "at least one [[fit]]", "none"));
        }
        entry.material.check()?;
        let mut fits: Vec<NamedFit> = Vec::new();
        for (i, fit) in entry.fit.into_iter().enumerate() {
            let fit = fit.check().map_err(|e| e.under(format!("fit[{i}]")))?;
            if fits.iter().any(|f| f.name == fit.name) {
                let expected = "a name of its own";
                return Err(Error::expected(format!("fit[{i}].name"), expected, format!("\"{}\" again", fit.name)));
            }
            fits.push(fit);
        }
        let mut supports = Vec::new();
        for (i, fix) in entry.fix.into_iter().enumerate() {
            supports.push(fix.check().map_err(|e| e.under(format!("fix[{i}]")))?);
        }
        let mut loads: Vec<LoadCase> = Vec::new();
        for (i, load) in entry.load.into_iter().enumerate() {
            let name = load.name.clone().unwrap_or_else(|| format!("load {}", i + 1));
            if loads.iter().any(|l| l.name == name) {
                let expected = "a name of its own";
                return Err(Error::expected(format!("load[{i}].name"), expected, format!("\"{name}\" again")));
            }
            loads.push(load.check(name).map_err(|e| e.under(format!("load[{i}]")))?);
        }
        let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        Ok(Scene {
            path: path.to_path_buf(),
            title: entry.title.unwrap_or(stem),
            mesh,
            material: entry.material,
            fits,
            supports,
            loads,
            output: entry.output,
        })
    }

    /// Reads or generates the mesh.
    ///
    /// # Errors
    /// The file or an element is wrong, or a cell has no volume.
    pub fn build_mesh(&self) -> Result<Mesh> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        if let Some(file) = &self.mesh.file {
            let own = load_elements(&self.mesh.elements, folder)?;
            let path = folder.join(file);
            let source = MeshSource::read(&path)?;
            return Mesh::resolve(&source, &own, self.mesh.scale).map_err(|e| e.in_file(&path));
        }
        let entry = self.mesh.generated.as_ref().expect("a scene has a file or a box");
        let name = if entry.element.ends_with(".toml") {
            folder.join(&entry.element).to_string_lossy().into_owned()
        } else {
            entry.element.clone()
        };
        let in_box = |e: Error| if e.file().is_some() { e } else { e.under("mesh.box").in_file(&self.path) };
        let element = Arc::new(Element::load(&name).map_err(in_box)?);
        let scaled = |lengths: &[f64]| lengths.iter().map(|x| x * self.mesh.scale).collect::<Vec<_>>();
        let origin = entry.origin.clone().unwrap_or_else(|| vec![0.0; element.dimension()]);
        let spec = BoxMesh { element, size: scaled(&entry.size), cells: entry.cells.clone(), origin: scaled(&origin) };
        spec.build().map_err(in_box)
    }

    /// The material of a body of that dimension.
    ///
    /// # Errors
    /// A constant is out of range, or the plane state does not go with the dimension.
    pub fn material(&self, dimension: usize) -> Result<Material> {
        let entry = &self.material;
        material_for(dimension, entry.young.0, entry.poisson, entry.plane, entry.thickness)
            .map_err(|e| e.under("material").in_file(&self.path))
    }

    /// kg/m³, where the scene gives one.
    pub fn density(&self) -> Option<f64> {
        self.material.density
    }

    /// Names the scene in an error about one of its entries.
    pub fn at(&self, key: &str, error: Error) -> Error {
        error.under(key).in_file(&self.path)
    }
}

/// The element files, each on its own or relative to `folder`.
///
/// # Errors
/// A file is missing or wrong.
pub fn load_elements(paths: &[PathBuf], folder: &Path) -> Result<Vec<Arc<Element>>> {
    paths.iter().map(|p| Element::load(&folder.join(p).to_string_lossy()).map(Arc::new)).collect()
}

/// The material of a body of that dimension; in the plane `plane` defaults to stress and `thickness` to 1 m.
///
/// # Errors
/// A constant is out of range, or a plane state or thickness is given for a solid.
pub fn material_for(
    dimension: usize,
    young: f64,
    poisson: f64,
    plane: Option<Plane>,
    thickness: Option<f64>,
) -> Result<Material> {
    let state = match (dimension, plane) {
        (2, plane) => {
            let thickness = thickness.unwrap_or(1.0);
            match plane {
                Some(Plane::Strain) => State::PlaneStrain { thickness },
                _ => State::PlaneStress { thickness },
            }
        }
        (_, Some(_)) => return Err(Error::at("plane", "expected a plane mesh, found a solid one")),
        (_, None) if thickness.is_some() => {
            return Err(Error::at("thickness", "expected a plane mesh, found a solid one"));
        }
        _ => State::Solid,
    };
    Material::new(young, poisson, state)
}

impl MaterialEntry {
    /// What can be said before the dimension is known.
    fn check(&self) -> Result<()> {
        let dimension = if self.plane.is_some() || self.thickness.is_some() { 2 } else { 3 };
        // Plane stress admits more of ν than a solid; a solid is checked again when the mesh is known.
        let state = if dimension == 3 { Some(Plane::Stress) } else { self.plane };
        material_for(2, self.young.0, self.poisson, state, self.thickness).map_err(|e| e.under("material"))?;
        match self.density {
            Some(density) if !(density > 0.0 && density.is_finite()) => {
                Err(Error::expected("material.density", "a positive number of kg/m³", density))
            }
            _ => Ok(()),
        }
    }
}

impl FitEntry {
    fn check(self) -> Result<NamedFit> {
        let objective = Objective::named(&self.objective, self.higher)?;
        let fit = Fit { objective, tied: self.tied, nonnegative: self.nonnegative };
        let name = self.name.unwrap_or_else(|| fit_name(&fit, self.springs.as_deref()));
        Ok(NamedFit { name, fit, springs: self.springs })
    }
}

impl NamedFit {
    /// The fit under the name that says what it does, such as `modal 0.1 +bulk`.
    pub fn new(fit: Fit, springs: Option<Vec<String>>) -> NamedFit {
        NamedFit { name: fit_name(&fit, springs.as_deref()), fit, springs }
    }
}

fn fit_name(fit: &Fit, springs: Option<&[String]>) -> String {
    let mut name = fit.objective.name().to_string();
    if let Objective::Modal { higher } = fit.objective {
        name += &format!(" {higher}");
    }
    for group in springs.unwrap_or_default() {
        name += &format!(" +{group}");
    }
    if fit.tied {
        name += " tied";
    }
    if fit.nonnegative {
        name += " k>=0";
    }
    name
}

impl FixEntry {
    fn check(self) -> Result<(Part, Option<Vec<usize>>)> {
        let part = Part::named(self.group, self.condition)?;
        if part == Part::Everything {
            return Err(Error::new("expected \"group\" or \"where\", found neither"));
        }
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
    fn check(self, name: String) -> Result<LoadCase> {
        let finite = |key: &str, v: Vec<f64>| match v.iter().find(|x| !x.is_finite()) {
            Some(x) => Err(Error::expected(key, "finite numbers", x)),
            None => Ok(v),
        };
        let mut actions = Vec::new();
        if let Some(v) = self.traction {
            actions.push(Action::Traction(finite("traction", v)?));
        }
        if let Some(v) = self.force {
            actions.push(Action::Force(finite("force", v)?));
        }
        if let Some(v) = self.body {
            actions.push(Action::Body(finite("body", v)?));
        }
        if let Some(v) = self.displacement {
            actions.push(Action::Displacement(v.iter().map(|g| g.0).collect()));
        }
        if actions.len() != 1 {
            let expected = "one of \"traction\", \"force\", \"body\", \"displacement\"";
            return Err(Error::new(format!("expected {expected}, found {}", actions.len())));
        }
        let action = actions.remove(0);
        let part = Part::named(self.group, self.condition)?;
        if part == Part::Everything && !matches!(action, Action::Body(_)) {
            return Err(Error::new("expected \"group\" or \"where\", found neither"));
        }
        Ok(LoadCase { name, part, action })
    }
}

impl Part {
    fn named(group: Option<String>, condition: Option<String>) -> Result<Part> {
        match (group, condition) {
            (Some(_), Some(_)) => Err(Error::new("expected \"group\" or \"where\", found both")),
            (Some(name), None) => Ok(Part::Group(name)),
            (None, Some(text)) => {
                // Fails early on what is wrong in any dimension.
                Scope::new(&["x", "y", "z"]).predicate(&text).map_err(|e| e.under("where"))?;
                Ok(Part::Where(text))
            }
            (None, None) => Ok(Part::Everything),
        }
    }

    /// The part as a selection of a mesh of that dimension.
    ///
    /// # Errors
    /// The condition names z in the plane.
    pub fn selection(&self, dimension: usize) -> Result<Selection> {
        Ok(match self {
            Part::Group(name) => Selection::Group(name.clone()),
            Part::Where(text) => {
                let scope = Scope::new(&["x", "y", "z"][..dimension]);
                Selection::Where(scope.predicate(text).map_err(|e| e.under("where"))?)
            }
            Part::Everything => Selection::Everything,
        })
    }
}

impl<'de> Deserialize<'de> for Given {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Given, D::Error> {
        struct GivenVisitor;
        impl Visitor<'_> for GivenVisitor {
            type Value = Given;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a finite number of metres or \"free\"")
            }
            fn visit_i64<E: de::Error>(self, v: i64) -> std::result::Result<Given, E> {
                Ok(Given(Some(v as f64)))
            }
            fn visit_f64<E: de::Error>(self, v: f64) -> std::result::Result<Given, E> {
                if v.is_finite() { Ok(Given(Some(v))) } else { Err(E::invalid_value(de::Unexpected::Float(v), &self)) }
            }
            fn visit_str<E: de::Error>(self, v: &str) -> std::result::Result<Given, E> {
                if v == "free" { Ok(Given(None)) } else { Err(E::invalid_value(de::Unexpected::Str(v), &self)) }
            }
        }
        deserializer.deserialize_any(GivenVisitor)
    }
}

impl<'de> Deserialize<'de> for Pressure {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Pressure, D::Error> {
        struct PressureVisitor;
        impl Visitor<'_> for PressureVisitor {
            type Value = Pressure;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a number of Pa or a text such as \"10kPa\"")
            }
            fn visit_i64<E: de::Error>(self, v: i64) -> std::result::Result<Pressure, E> {
                Ok(Pressure(v as f64))
            }
            fn visit_f64<E: de::Error>(self, v: f64) -> std::result::Result<Pressure, E> {
                Ok(Pressure(v))
            }
            fn visit_str<E: de::Error>(self, v: &str) -> std::result::Result<Pressure, E> {
                parse_pressure(v).map(Pressure).map_err(|e| E::custom(e.problem()))
            }
        }
        deserializer.deserialize_any(PressureVisitor)
    }
}
