//! The scene file.

mod entry;
mod gauge;
mod input;
mod motion;
mod output;
mod recipe;
mod sampled;
mod value;
mod whole;

pub use entry::{FitEntry, MeasuredEntry};
pub use gauge::Gauge;
pub use input::{BoxEntry, DiscEntry, MeshInput};
pub use motion::{DampingRecipe, MotionRecipe, Pull, Push, integrator_name};
pub use output::Output;
pub use recipe::{ForceRecipe, Recipe, SampledRecipe};
pub use sampled::ShapesEntry;
use sampled::law_at;
use whole::RESERVED;
pub use whole::{Judge, Named, Sharing, Start, WholeRecipe};

use crate::element::Element;
use crate::error::{Error, Result};
use crate::file;
use crate::fit::Fit;
use crate::material::{Energy, Material};
use crate::mesh::Selection;
use crate::model::{Action, Component};
use crate::solve::Newton;
use crate::symbolic::Scope;
use entry::{MaterialEntry, SceneFile};
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
    /// The place in the file of the `[[fit]]` of each.
    pub entry_of: Vec<usize>,
    /// The parts that are held, and in which directions (all if absent).
    pub supports: Vec<(Part, Option<Vec<usize>>)>,
    pub loads: Vec<LoadCase>,
    /// How loads are followed where the material has a law.
    pub newton: Newton,
    /// Where a specimen's modulus and ratio are measured.
    pub gauge: Option<Gauge>,
    /// How the body moves in time, where the scene says so.
    pub motion: Option<MotionRecipe>,
    pub output: Output,
}

/// A fit, what a report calls it, and the spring groups it uses.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedFit {
    pub name: String,
    pub recipe: Recipe,
    /// All groups that are not optional, if absent.
    pub springs: Option<Vec<String>>,
}

#[derive(Debug, Clone)]
pub struct LoadCase {
    pub name: String,
    pub part: Part,
    pub action: Action,
    /// Displacements that were measured under it.
    pub measured: Option<MeasuredEntry>,
}

/// A part of the mesh as a scene names it; a condition is parsed once the mesh's dimension is known.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    Group(String),
    Where(String),
    Everything,
}

impl Scene {
    /// Reads and checks a scene.
    ///
    /// # Errors
    /// Names the file, the key, what was expected and what was found.
    pub fn load(path: &Path) -> Result<Scene> {
        Scene::parse(&file::read_text(path)?, path)
    }

    /// Checks the text of a scene that stands at `path`, from where other files are named.
    ///
    /// # Errors
    /// Those of [`Scene::load`].
    pub fn parse(text: &str, path: &Path) -> Result<Scene> {
        Scene::checked(text, path).map_err(|e| e.in_file(path))
    }

    fn checked(text: &str, path: &Path) -> Result<Scene> {
        let entry: SceneFile = file::parse_toml(text)?;
        let mesh = entry.mesh;
        mesh.check()?;
        if entry.fit.is_empty() {
            return Err(Error::expected("fit", "at least one [[fit]]", "none"));
        }
        entry.material.check()?;
        let (mut fits, mut entry_of): (Vec<NamedFit>, Vec<usize>) = Default::default();
        let folder = path.parent().unwrap_or(Path::new(""));
        for (i, fit) in entry.fit.into_iter().enumerate() {
            for fit in fit.check(folder).map_err(|e| e.placed(|e| e.under(format!("fit[{i}]"))))? {
                if fit.name.trim().is_empty() {
                    return Err(Error::expected(format!("fit[{i}].name"), "a name", format!("\"{}\"", fit.name)));
                }
                if fits.iter().any(|f| f.name == fit.name) {
                    let expected = "a name of its own";
                    return Err(Error::expected(format!("fit[{i}].name"), expected, format!("\"{}\" again", fit.name)));
                }
                fits.push(fit);
                entry_of.push(i);
            }
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
        if entry.newton.is_some() && entry.material.law.is_none() {
            return Err(Error::at("newton", "belongs to a material with a \"law\", found one without"));
        }
        let newton = entry.newton.map_or(Ok(Newton::default()), |e| e.check().map_err(|e| e.under("newton")))?;
        let motion = entry.motion.map(|e| e.check().map_err(|e| e.under("motion"))).transpose()?;
        if motion.is_some() && entry.material.density.is_none() {
            return Err(Error::expected("material.density", "a number of kg/m³, for [motion] moves masses", "none"));
        }
        if entry.output.frequencies > 0 && entry.material.density.is_none() {
            return Err(Error::expected("output.frequencies", "a density in [material]", "none"));
        }
        for (fit, i) in fits.iter().zip(&entry_of) {
            let unknown =
                |key: &str, wanted: &[String]| match wanted.iter().find(|w| loads.iter().all(|l| l.name != **w)) {
                    Some(name) => {
                        let names: Vec<&str> = loads.iter().map(|load| load.name.as_str()).collect();
                        let expected = format!("loads of the scene ({})", names.join(", "));
                        Err(Error::expected(format!("fit[{i}].{key}"), expected, format!("\"{name}\"")))
                    }
                    None => Ok(()),
                };
            if let Some(recipe) = fit.recipe.sampled() {
                if entry.material.law.is_none() && recipe.law.is_none() {
                    let expected = format!("the energy whose forces fit[{i}] samples, such as \"neo-hookean\"");
                    return Err(Error::expected("material.law", expected, "none"));
                }
                if let (Some(_), Some(law)) = (&entry.material.law, &recipe.law) {
                    let expected = "none, as the material has a law";
                    return Err(Error::expected(format!("fit[{i}].law"), expected, format!("\"{law}\"")));
                }
                if let (None, false) = (&entry.material.law, recipe.loads.is_empty()) {
                    let problem = "belongs to a material with a \"law\": without one no load is followed";
                    return Err(Error::at(format!("fit[{i}].shapes.loads"), problem));
                }
                unknown("shapes.loads", &recipe.loads)?;
            }
            if let Recipe::Whole(recipe) = &fit.recipe {
                let at = |e: Error| e.under(format!("fit[{i}]"));
                unknown("loads", &recipe.loads.names)?;
                if let Judge::Loads(named) = &recipe.validation {
                    unknown("validate", &named.names)?;
                }
                recipe.check(entry.material.law.is_some(), entry.material.density.is_some()).map_err(at)?;
            }
        }
        if let Some(i) = loads.iter().position(|load| RESERVED.contains(&load.name.as_str())) {
            let expected = format!("a name other than {}", RESERVED.join(", "));
            return Err(Error::expected(format!("load[{i}].name"), expected, format!("\"{}\"", loads[i].name)));
        }
        let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        Ok(Scene {
            path: path.to_path_buf(),
            title: entry.title.unwrap_or(stem),
            mesh,
            material: entry.material,
            fits,
            entry_of,
            supports,
            loads,
            newton,
            gauge: entry.gauge.map(|gauge| gauge.check().map_err(|e| e.under("gauge"))).transpose()?,
            motion,
            output: entry.output,
        })
    }

    /// Whether something in it is written in metres besides its mesh: conditions, and loads that vary.
    pub fn is_in_metres(&self) -> bool {
        let conditions = self.supports.iter().map(|(part, _)| part).chain(self.loads.iter().map(|load| &load.part));
        let varies = |load: &LoadCase| match &load.action {
            Action::Traction(v) | Action::Body(v) => v.iter().any(|c| matches!(c, Component::Varying(_))),
            _ => load.measured.is_some(),
        };
        conditions.into_iter().any(|part| matches!(part, Part::Where(_))) || self.loads.iter().any(varies)
    }

    /// The same scene with Young's modulus times `factor`, and of another Poisson's ratio where one is given.
    pub fn of_material(&self, factor: f64, poisson: Option<f64>) -> Scene {
        let mut scene = self.clone();
        scene.material.young.0 *= factor;
        scene.material.poisson = poisson.unwrap_or(scene.material.poisson);
        scene
    }

    /// The material of a body of that dimension.
    ///
    /// # Errors
    /// A constant is out of range, or the plane state does not go with the dimension.
    pub fn material(&self, dimension: usize) -> Result<Material> {
        let entry = &self.material;
        let material = Material::for_body(dimension, entry.young.0, entry.poisson, entry.plane, entry.thickness);
        material
            .and_then(|m| entry.area.map_or(Ok(m), |area| m.with_area(area)))
            .map_err(|e| e.under("material").in_file(&self.path))
    }

    /// The name of the material's law, where the scene gives one: loads are at large deformation then.
    pub fn law(&self) -> Option<&str> {
        self.material.law.as_deref()
    }

    /// The law's energy for a body of that material.
    ///
    /// # Errors
    /// There is no such law, or its file is wrong.
    pub fn energy(&self, material: Material) -> Result<Option<Energy>> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let load = |law: &str| {
            Energy::load(&law_at(law, folder), material)
                .map_err(|e| e.placed(|e| Error::at("material.law", e.problem()).in_file(&self.path)))
        };
        self.law().map(load).transpose()
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

/// The elements of that name, or in the files of that path relative to `folder`.
///
/// # Errors
/// A file is missing or wrong, or a name unknown; `elements[i]` is the key.
pub fn load_elements(names: &[String], folder: &Path) -> Result<Vec<Arc<Element>>> {
    let load = |(i, name): (usize, &String)| {
        load_element(name, folder).map_err(|e| e.placed(|e| Error::at(format!("elements[{i}]"), e.problem())))
    };
    names.iter().enumerate().map(load).collect()
}

/// The element of that name, or in the file of that path relative to `folder`.
pub(in crate::study) fn load_element(name: &str, folder: &Path) -> Result<Arc<Element>> {
    let place =
        if name.ends_with(".toml") { folder.join(name).to_string_lossy().into_owned() } else { name.to_string() };
    Element::load(&place).map(Arc::new)
}

impl NamedFit {
    /// The recipe under the name that says what it does, such as `modal 0.1 +bulk`.
    pub fn new(fit: Fit, springs: Option<Vec<String>>) -> NamedFit {
        NamedFit::of(Recipe::Stiffness(fit), springs)
    }

    pub fn of(recipe: Recipe, springs: Option<Vec<String>>) -> NamedFit {
        NamedFit { name: recipe.name(springs.as_deref()), recipe, springs }
    }
}

impl Part {
    pub(super) fn named(group: Option<String>, condition: Option<String>) -> Result<Part> {
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

    /// As [`Part::named`], but not everything.
    pub(super) fn said(group: Option<String>, condition: Option<String>) -> Result<Part> {
        match Part::named(group, condition)? {
            Part::Everything => Err(Error::new("expected \"group\" or \"where\", found neither")),
            part => Ok(part),
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
