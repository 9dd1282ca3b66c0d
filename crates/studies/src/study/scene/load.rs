//! A load of a scene.

use super::part::Part;
use super::value::{self, PrescribedComponent, Varying};
use crate::error::{Error, Result};
use crate::model::{Action, Component};
use crate::symbolic::Scope;
use serde::Deserialize;
use std::path::PathBuf;

#[derive(Debug, Clone)]
pub struct LoadCase {
    pub name: String,
    pub part: Part,
    pub action: Action,
    /// Displacements that were measured under it.
    pub measured: Option<MeasuredEntry>,
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
    pub displacement: Option<Vec<PrescribedComponent>>,
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
    #[serde(default = "one", deserialize_with = "value::mesh_unit")]
    pub scale: f64,
    /// Of several.
    pub array: Option<String>,
}

fn one() -> f64 {
    1.0
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
            Action::Body(_) => Part::optional(self.group, self.condition)?,
            _ => Part::required(self.group, self.condition)?,
        };
        Ok(LoadCase { name, part, action, measured: self.measured })
    }
}
