//! A load of a scene.

use super::part::Part;
use super::value::{self, PrescribedComponent, Varying};
use crate::error::{Error, Result};
use crate::model::{Action, Component};
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
    /// The part of the mesh on which it acts.
    pub part: Part,
    /// What acts on that part.
    pub action: Action,
    /// The file of displacements that were measured under it, if there is one.
    pub measured: Option<MeasuredEntry>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadEntry {
    pub name: Option<String>,
    pub group: Option<String>,
    #[serde(rename = "where")]
    pub condition: Option<String>,
    pub traction: Option<Vec<Varying>>,
    pub force: Option<Vec<f64>>,
    pub body: Option<Vec<Varying>>,
    pub displacement: Option<Vec<PrescribedComponent>>,
    /// The file of displacements that were measured under it.
    pub measured: Option<MeasuredEntry>,
}

/// A file of displacements.
#[derive(Debug, Clone, Deserialize, JsonSchema, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct MeasuredEntry {
    /// The path, relative to the scene.
    pub file: PathBuf,
    /// The length of a unit of the file, m.
    #[serde(default = "one", deserialize_with = "value::mesh_unit")]
    #[schemars(schema_with = "value::quantity")]
    pub scale: f64,
    /// The name of the array, if the file has several.
    pub array: Option<String>,
}

fn one() -> f64 {
    1.0
}

impl LoadEntry {
    pub fn check(self, name: String) -> Result<LoadCase> {
        let varying = |key: &str, v: Vec<Varying>, unit: &str| -> Result<Vec<Component>> {
            let scope = Scope::new(&["x", "y", "z"]);
            let number = |v: &Varying| if let Varying::Number(value) = v { Some(*value) } else { None };
            let component = |(i, v): (usize, Varying)| match v {
                Varying::Number(value) => Ok(Component::Constant(value)),
                Varying::Text(text) => {
                    scope.expression(&text).map(Component::Varying).map_err(|e| e.under(format!("{key}[{i}]")))
                }
            };
            // If components vary, their size is known only on the mesh.
            let varies = v.iter().any(|v| number(v).is_none());
            v.iter().filter_map(number).try_for_each(|value| range::bounded(key, value, unit).map(|_| ()))?;
            range::largest(key, v.iter().filter_map(number).filter(|_| !varies), unit)?;
            v.into_iter().enumerate().map(component).collect()
        };
        let mut actions = Vec::new();
        if let Some(v) = self.traction {
            actions.push(Action::Traction(varying("traction", v, "Pa")?));
        }
        if let Some(v) = self.force {
            range::largest("force", v.iter().copied(), "N")?;
            actions.push(Action::Force(v));
        }
        if let Some(v) = self.body {
            actions.push(Action::Body(varying("body", v, "N/m³")?));
        }
        if let Some(v) = self.displacement {
            range::largest("displacement", v.iter().filter_map(|g| g.0), "m")?;
            actions.push(Action::Displacement(v.iter().map(|g| g.0).collect()));
        }
        if actions.len() != 1 {
            let expected = "one of \"traction\", \"force\", \"body\", \"displacement\"";
            return Err(Error::new(format!("expected {expected}, found {}", actions.len())));
        }
        let action = actions.remove(0);
        let part = match action {
            Action::Body(_) => Part::optional(self.group, self.condition)?,
            _ => Part::required(self.group, self.condition)?,
        };
        Ok(LoadCase { name, part, action, measured: self.measured })
    }
}
