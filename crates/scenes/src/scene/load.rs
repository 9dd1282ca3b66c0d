//! A load of a scene.

use super::part::Part;
use super::value::{self, PRESCRIBED, PRESSURE, PrescribedComponent, Varying, VaryingPressure};
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::model::{Action, Component};
use crate::named::unknown;
use crate::own_name::expect_own_name;
use crate::quantity::Quantity;
use crate::range;
use crate::symbolic::Scope;
use schemars::JsonSchema;
use serde::Deserialize;
use std::path::PathBuf;

/// A load of a scene.
#[derive(Debug, Clone)]
pub struct LoadCase {
    /// The name in reports.
    pub name: String,
    /// What acts.
    pub kind: LoadKind,
    /// The file of displacements that were measured under it, if there is one.
    pub measured: Option<MeasuredEntry>,
    /// The forces that were measured under it.
    pub reactions: Vec<Reaction>,
}

/// A force that was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Reaction {
    /// It holds the points of this group.
    pub group: String,
    /// Its components, N; `None` where it was not measured.
    pub force: Vec<Option<f64>>,
    /// The standard deviation of the noise of each, N.
    pub sigma: Option<f64>,
}

/// What acts under a load.
#[derive(Debug, Clone)]
pub enum LoadKind {
    /// An action on a part of the mesh.
    Single {
        /// The part of the mesh.
        part: Part,
        /// What acts on that part.
        action: Action,
        /// Whether the body force is an acceleration, by which the density is multiplied.
        is_acceleration: bool,
        /// Whether a displacement moves directors as well.
        clamp: bool,
    },
    /// Other loads of the scene at the same time, by their indices.
    Sum(Vec<usize>),
}

impl LoadCase {
    /// The acceleration of gravity, m/s², `[dimension]`, of the load itself or of those of its sum among `all` loads; `None` if it has no gravity, or
    /// one that acts on a part of the mesh alone, which is a force on points as others are.
    pub fn gravity(&self, all: &[LoadCase], mesh: &Mesh) -> Option<Vec<f64>> {
        match &self.kind {
            // An acceleration is the same everywhere.
            LoadKind::Single { part, action: Action::Body(components), is_acceleration: true, .. } => {
                part.is_whole(mesh).then(|| components.iter().map(|component| component.at(&[])).collect())
            }
            LoadKind::Single { .. } => None,
            LoadKind::Sum(parts) => {
                let found: Vec<Vec<f64>> = parts.iter().filter_map(|&part| all[part].gravity(all, mesh)).collect();
                let sum = |k: usize| found.iter().map(|gravity| gravity[k]).sum();
                found.first().map(|first| (0..first.len()).map(sum).collect())
            }
        }
    }

    /// The key of what acts.
    pub fn key(&self) -> &'static str {
        match &self.kind {
            LoadKind::Sum(_) => "sum",
            LoadKind::Single { is_acceleration: true, .. } => "gravity",
            LoadKind::Single { action, .. } => match action {
                Action::Traction(_) => "traction",
                Action::Pressure(_) => "pressure",
                Action::Volume(_) => "volume",
                Action::Force(_) => "force",
                Action::Body(_) => "body",
                Action::Displacement(_) => "displacement",
                Action::Moment(_) => "moment",
            },
        }
    }

    /// Whether a displacement moves directors as well.
    pub fn is_clamped(&self) -> bool {
        matches!(self.kind, LoadKind::Single { clamp: true, .. })
    }

    /// Whether the body force is an acceleration, by which the density is multiplied.
    pub fn is_acceleration(&self) -> bool {
        matches!(self.kind, LoadKind::Single { is_acceleration: true, .. })
    }

    /// The part and what acts on it, unless the load is a sum of others.
    pub fn single(&self) -> Option<(&Part, &Action)> {
        match &self.kind {
            LoadKind::Single { part, action, .. } => Some((part, action)),
            LoadKind::Sum(_) => None,
        }
    }
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadEntry {
    /// Tables and files name the load so; each load has a name of its own.
    #[schemars(extend("x-default" = "`load 1`, …"))]
    pub name: Option<String>,
    /// The part that is loaded is this group of the mesh. One of `group` and `where` is required, unless the load is a `body` force,
    /// `gravity` or a `sum`.
    pub group: Option<String>,
    /// The part that is loaded has the points that satisfy this condition on x, y, z in m. One of `group` and `where` is required, unless
    /// the load is a `body` force, `gravity` or a `sum`.
    #[serde(rename = "where")]
    pub condition: Option<String>,
    /// A traction in Pa acts on the sides of the part: for each direction a number or an expression of x, y, z in m, such as `"-1e5*y"`.
    /// One of `traction`, `pressure`, `volume`, `force`, `body`, `gravity`, `displacement`, `moment` and `sum` is required.
    pub traction: Option<Vec<Varying>>,
    /// A pressure acts on the sides of the part against the normal that points out of the body: a number in Pa, a text with a unit such as
    /// `"1 kPa"`, or an expression of x, y, z in m. Of a surface in space it acts on the cells, against the outward normal of a closed surface and
    /// else against the one of most cells. With a law it follows the sides where they move and turn; in plane stress their thickness is that at rest.
    pub pressure: Option<VaryingPressure>,
    /// The sides of the part, which close a cavity, are filled until they enclose this volume: a number in m³ or a text with a unit such as
    /// `"30 ml"`; of a plane body the area times the thickness. The pressure is found. The material has a law. Where the sides end in a plane across
    /// an axis, and `[[fix]]` holds their points there along it, as on a plane of symmetry, the plane closes the cavity: of an eighth of a ball
    /// the volume is an eighth.
    #[serde(default, deserialize_with = "value::optional_volume")]
    #[schemars(schema_with = "value::volume_schema")]
    pub volume: Option<f64>,
    /// A force in N acts on the part in all. It is shared over sides, cells or points of the part.
    #[serde(default, deserialize_with = "value::force_vector")]
    #[schemars(schema_with = "value::force_vector_schema")]
    pub force: Option<Vec<f64>>,
    /// A body force in N/m³ acts on the cells: for each direction a number or an expression of x, y, z in m.
    pub body: Option<Vec<Varying>>,
    /// A body force of this acceleration in m/s², times the density of the material, acts on the cells.
    #[serde(default, deserialize_with = "value::acceleration_vector")]
    #[schemars(schema_with = "value::acceleration_vector_schema")]
    pub gravity: Option<Vec<f64>>,
    /// The part has this displacement in m: for each direction a number, an expression of x, y, z in m, such as `"-0.1*y"`, or `"free"`. At
    /// least one direction is moved.
    pub displacement: Option<Vec<PrescribedComponent>>,
    /// The directors of the part are displaced as well, each by the expressions at its own place: the edges of a sheet whose ends are in the part, and the joints of rods.
    /// So a rotation that is prescribed turns the body with its points. The key goes with `displacement`.
    #[serde(default)]
    pub clamp: bool,
    /// A moment in N·m acts on the part in all, a vector: on the joints of rods in equal shares, or on the edges of a sheet whose ends are in the part, in shares by
    /// their lengths. The material has `bending` and no law.
    #[serde(default, deserialize_with = "value::moment_vector")]
    #[schemars(schema_with = "value::moment_vector_schema")]
    pub moment: Option<Vec<f64>>,
    /// The load consists of these other loads at the same time: names of two or more loads of forces.
    pub sum: Option<Vec<String>>,
    /// `measured` has displacements that were measured under this load.
    pub measured: Option<MeasuredEntry>,
    /// Each entry is a force that was measured under this load, for `springfit calibrate`.
    #[serde(default)]
    #[schemars(extend("x-default" = "none"))]
    pub reactions: Vec<ReactionEntry>,
}

/// A force that was measured.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReactionEntry {
    /// The force holds the points of this group of the mesh, which are held or moved under the load.
    pub group: String,
    /// The components of the force on the body in N, each a number or `"free"` where it was not measured.
    #[schemars(with = "Vec<serde_json::Value>", extend("x-type" = "vector"))]
    pub force: Vec<PrescribedComponent>,
    /// The noise of each component has this standard deviation in N, above 0.
    #[schemars(extend("x-default" = "unknown"))]
    pub sigma: Option<f64>,
}

impl ReactionEntry {
    fn check(self) -> Result<Reaction> {
        let component = |given: PrescribedComponent| match given.0 {
            None => Ok(None),
            Some(Varying::Number(value)) if value.is_finite() => Ok(Some(value)),
            Some(Varying::Text(text)) => Quantity::Force.parse(&text).map(Some).map_err(|e| e.under("force")),
            Some(Varying::Number(_)) => Err(Error::expected("force", "numbers of N, or \"free\"", "another")),
        };
        let force: Vec<Option<f64>> = self.force.into_iter().map(component).collect::<Result<_>>()?;
        if force.iter().all(Option::is_none) {
            return Err(Error::expected("force", "a component that was measured", "none"));
        }
        if let Some(sigma) = self.sigma.filter(|sigma| !(*sigma > 0.0 && sigma.is_finite())) {
            return Err(Error::expected("sigma", "a standard deviation above zero, N", sigma));
        }
        Ok(Reaction { group: self.group, force, sigma: self.sigma })
    }
}

/// A file of displacements.
#[derive(Debug, Clone, Deserialize, JsonSchema, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct MeasuredEntry {
    /// The displacements are read from this file, relative to the scene. It is a table with the columns `x, y, z` (or `point`, from 0) and
    /// `ux, uy, uz`, also of some points only; or a `.vtu` or `.vtk`.
    #[schemars(extend("x-type" = "path"))]
    pub file: PathBuf,
    /// One unit of the file has this length in m, above 0.
    #[serde(default = "one", deserialize_with = "value::mesh_unit")]
    #[schemars(schema_with = "value::mesh_unit_schema")]
    pub scale: f64,
    /// The displacements are in this array of the VTK file.
    #[schemars(extend("x-default" = "the only one"))]
    pub array: Option<String>,
    /// The noise of each displacement has this standard deviation in m. Every load that is fitted has one, or none.
    #[serde(default, deserialize_with = "value::optional_length")]
    #[schemars(schema_with = "value::length_schema", extend("x-default" = "unknown"))]
    pub sigma: Option<f64>,
}

fn one() -> f64 {
    1.0
}

/// The loads of a scene.
///
/// # Errors
/// A load is wrong, two have one name, or a sum has loads that cannot be added.
pub fn read_loads(entries: Vec<LoadEntry>) -> Result<Vec<LoadCase>> {
    let mut loads: Vec<LoadCase> = Vec::new();
    let mut sums: Vec<Option<Vec<String>>> = Vec::new();
    for (i, mut load) in entries.into_iter().enumerate() {
        let name = load.name.clone().unwrap_or_else(|| format!("load {}", i + 1));
        expect_own_name(&format!("load[{i}].name"), &name, loads.iter().map(|load| load.name.as_str()))?;
        sums.push(load.sum.take());
        let is_sum = sums[i].is_some();
        loads.push(load.check(name, is_sum).map_err(|e| e.under(format!("load[{i}]")))?);
    }
    for (i, sum) in sums.into_iter().enumerate() {
        if let Some(names) = sum {
            let kind = summed(&names, &loads).map_err(|e| e.under(format!("load[{i}]")))?;
            loads[i].kind = kind;
        }
    }
    Ok(loads)
}

fn summed(names: &[String], loads: &[LoadCase]) -> Result<LoadKind> {
    let is_force = |load: &&LoadCase| {
        load.single().is_some_and(|(_, action)| !matches!(action, Action::Displacement(_) | Action::Volume(_)))
    };
    let able = || loads.iter().filter(is_force).map(|load| load.name.as_str());
    if names.len() < 2 || (1..names.len()).any(|i| names[..i].contains(&names[i])) {
        return Err(Error::expected("sum", "two loads or more, each once", format!("{names:?}")));
    }
    let place = |name: &String| {
        let known =
            able().any(|known| known == name).then(|| loads.iter().position(|load| load.name == *name)).flatten();
        known.ok_or_else(|| {
            let expected = format!("loads of forces ({})", able().collect::<Vec<_>>().join(", "));
            unknown(expected, able(), name).at_key("sum")
        })
    };
    Ok(LoadKind::Sum(names.iter().map(place).collect::<Result<_>>()?))
}

/// Checks the size of the components that are numbers. If others vary, the size of the load is known only on the mesh.
fn sized(key: &str, v: &[&Varying], unit: &str) -> Result<()> {
    let number = |v: &&Varying| if let Varying::Number(value) = v { Some(*value) } else { None };
    let varies = v.iter().any(|v| number(v).is_none());
    v.iter().filter_map(number).try_for_each(|value| range::bounded(key, value, unit).map(|_| ()))?;
    range::largest(key, v.iter().filter_map(number).filter(|_| !varies), unit)
}

fn component(v: Varying, quantity: Option<Quantity>) -> Result<Component> {
    match v {
        Varying::Number(value) => Ok(Component::Constant(value)),
        Varying::Text(text) => Scope::value_over(&["x", "y", "z"], quantity, &text).map(Component::Varying),
    }
}

/// The directions of a prescribed displacement.
fn prescribed(v: Vec<PrescribedComponent>) -> Result<Vec<Option<Component>>> {
    let given: Vec<&Varying> = v.iter().filter_map(|given| given.0.as_ref()).collect();
    if given.is_empty() {
        return Err(Error::expected("displacement", "a direction that is moved", "\"free\" in all"));
    }
    sized("displacement", &given, "m")?;
    let one = |(i, v): (usize, PrescribedComponent)| {
        let Some(v) = v.0 else { return Ok(None) };
        let key = format!("displacement[{i}]");
        component(v.clone(), Some(Quantity::Length)).map(Some).map_err(|e| match v {
            // A word alone is more likely meant as "free".
            Varying::Text(text) if text.chars().all(char::is_alphabetic) => {
                Error::expected(key, PRESCRIBED, format!("\"{text}\""))
            }
            Varying::Text(_) | Varying::Number(_) => e.under(key),
        })
    };
    v.into_iter().enumerate().map(one).collect()
}

impl LoadEntry {
    fn check(self, name: String, is_sum: bool) -> Result<LoadCase> {
        let varying =
            |key: &str, v: Vec<Varying>, (unit, quantity): (&str, Option<Quantity>)| -> Result<Vec<Component>> {
                sized(key, &v.iter().collect::<Vec<_>>(), unit)?;
                let component = |(i, v)| component(v, quantity).map_err(|e| e.under(format!("{key}[{i}]")));
                v.into_iter().enumerate().map(component).collect()
            };
        let reaction =
            |(i, entry): (usize, ReactionEntry)| entry.check().map_err(|e| e.under(format!("reactions[{i}]")));
        let reactions: Vec<Reaction> = self.reactions.into_iter().enumerate().map(reaction).collect::<Result<_>>()?;
        let mut actions = Vec::new();
        if let Some(v) = self.traction {
            actions.push(Action::Traction(varying("traction", v, ("Pa", Some(Quantity::Pressure)))?));
        }
        if let Some(VaryingPressure(v)) = self.pressure {
            sized("pressure", &[&v], "Pa")?;
            // A number before letters is meant with a unit, and a text without a number is no expression that someone meant.
            let is_quantity =
                |text: &str| text.trim_start_matches(|c: char| !c.is_alphabetic()).chars().all(char::is_alphabetic);
            let pressure = component(v.clone(), Some(Quantity::Pressure)).map_err(|e| match v {
                Varying::Text(text) if is_quantity(&text) => match Quantity::Pressure.parse(&text) {
                    Err(units) if text.chars().any(|c| c.is_ascii_digit()) => units.under("pressure"),
                    _ => Error::expected("pressure", PRESSURE, format!("\"{text}\"")),
                },
                Varying::Text(_) | Varying::Number(_) => e.under("pressure"),
            })?;
            actions.push(Action::Pressure(pressure));
        }
        if let Some(v) = self.volume {
            actions.push(Action::Volume(range::positive("volume", v, "m³")?));
        }
        if let Some(v) = self.force {
            range::largest("force", v.iter().copied(), "N")?;
            actions.push(Action::Force(v));
        }
        if let Some(v) = self.body {
            actions.push(Action::Body(varying("body", v, ("N/m³", Some(Quantity::ForceDensity)))?));
        }
        let is_acceleration = self.gravity.is_some();
        if let Some(v) = self.gravity {
            range::largest("gravity", v.iter().copied(), "m/s²")?;
            actions.push(Action::body(&v));
        }
        if let Some(v) = self.displacement {
            actions.push(Action::Displacement(prescribed(v)?));
        } else if self.clamp {
            return Err(Error::expected("clamp", "\"displacement\" beside it", "none"));
        }
        if let Some(v) = self.moment {
            range::largest("moment", v.iter().copied(), "N·m")?;
            actions.push(Action::Moment(v));
        }
        if is_sum {
            if !actions.is_empty() || self.group.is_some() || self.condition.is_some() {
                return Err(Error::at("sum", "stands alone: the loads that it names have parts and actions"));
            }
            return Ok(LoadCase { name, kind: LoadKind::Sum(Vec::new()), measured: self.measured, reactions });
        }
        if actions.len() != 1 {
            let expected = "one of \"traction\", \"pressure\", \"volume\", \"force\", \"body\", \"gravity\", \"displacement\", \"moment\", or \"sum\"";
            let hint = if actions.len() > 1 {
                "; loads that act together are a load with sum = [\"…\", \"…\"]"
            } else {
                ""
            };
            return Err(Error::new(format!("expected {expected}, found {}{hint}", actions.len())));
        }
        let action = actions.remove(0);
        let part = match action {
            Action::Body(_) => Part::optional(self.group, self.condition)?,
            _ => Part::required(self.group, self.condition)?,
        };
        Ok(LoadCase {
            name,
            kind: LoadKind::Single { part, action, is_acceleration, clamp: self.clamp },
            measured: self.measured,
            reactions,
        })
    }
}
