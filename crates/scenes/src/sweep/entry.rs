//! The table `[sweep]` of a scene.

use super::design::{Design, Plan};
use super::range::{RangeEntry, Values};
use crate::bound::{self, check_count};
use crate::error::{Error, Result};
use crate::scene::Setting;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use toml::{Table, Value};

/// Which studies are made of a scene.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepEntry {
    /// Each key of the scene in this table has a list of values or a range; or a list has one table of keys and values for each study.
    #[schemars(schema_with = "over")]
    over: Value,
    /// The studies are all combinations with the last key fastest (`grid`), independent samples (`random`), or points of Sobol's sequence
    /// (`sobol`).
    #[schemars(extend("default" = "grid"))]
    design: Option<Design>,
    /// A random or Sobol design has this number of studies, 1 or more.
    #[schemars(extend("x-default" = "required for `random` and `sobol`"))]
    samples: Option<usize>,
    /// Another seed gives other samples. Without one, Sobol's sequence begins at the lower ends.
    #[schemars(extend("x-default" = "0; for `sobol` none"))]
    seed: Option<u64>,
}

fn over(generator: &mut SchemaGenerator) -> Schema {
    let range = generator.subschema_for::<RangeEntry>();
    json_schema!({
        "anyOf": [
            { "type": "object", "additionalProperties": { "anyOf": [{ "type": "array" }, range, { "type": "object" }] } },
            { "type": "array" },
        ],
        "x-type": "table, or list of tables",
    })
}

impl SweepEntry {
    /// The plan of the studies.
    ///
    /// # Errors
    /// A key of the scene is no such path, its values are no list and no range, or there is no number of studies.
    pub fn check(&self) -> Result<Plan> {
        let design = self.design.unwrap_or_default();
        let unused = |key: &str, given: bool| match given {
            true => Err(Error::at(key, "belongs to the designs \"random\" and \"sobol\"")),
            false => Ok(()),
        };
        let table = match &self.over {
            Value::Table(table) => table,
            Value::Array(list) => {
                unused("samples", self.samples.is_some())?;
                unused("seed", self.seed.is_some())?;
                if self.design.is_some() {
                    return Err(Error::at("design", "belongs to lists and ranges by key, not to a list of studies"));
                }
                return self.listed(list);
            }
            other => {
                let expected = "a table of keys and their values, or a list of studies";
                return Err(Error::expected("over", expected, format!("a value of type {}", other.type_str())));
            }
        };
        let mut keys = Vec::new();
        flatten("", table, &mut |key, value| {
            let values = Values::read(&key, value)?;
            Setting::of(&key, &values.at(0.0))?;
            keys.push((key, values));
            Ok(())
        })
        .map_err(|e| e.under("over"))?;
        if keys.is_empty() {
            return Err(Error::expected("over", "at least one key of the scene with its values", "none"));
        }
        if design == Design::Grid {
            unused("samples", self.samples.is_some())?;
            unused("seed", self.seed.is_some())?;
        } else if let Some((key, _)) =
            keys.iter().find(|(_, v)| matches!(v, Values::Range(range) if range.count.is_some()))
        {
            return Err(Error::at(format!("over.{key}.count"), "belongs to the design \"grid\""));
        }
        Plan::new(design, keys, self.samples, self.seed)
    }

    fn listed(&self, list: &[Value]) -> Result<Plan> {
        check_count("over", list.len() as u64, 1, bound::STUDIES)?;
        let study = |(i, entry): (usize, &Value)| {
            let place = format!("over[{i}]");
            let Value::Table(table) = entry else {
                return Err(Error::expected(
                    place,
                    "a table of keys and values",
                    format!("a value of type {}", entry.type_str()),
                ));
            };
            let mut settings = Vec::new();
            let mut push = |key: String, value: &Value| {
                settings.push(Setting::of(&key, value)?);
                Ok(())
            };
            // A value that is a table is taken as keys that lie deeper: either sets the same.
            flatten("", table, &mut push).map_err(|e| e.under(place))?;
            Ok(settings)
        };
        Ok(Plan::Listed(list.iter().enumerate().map(study).collect::<Result<_>>()?))
    }
}

/// Visits the entries of tables in tables, by the paths of their keys.
fn flatten(parent: &str, table: &Table, visit: &mut dyn FnMut(String, &Value) -> Result<()>) -> Result<()> {
    for (key, value) in table {
        let path = if parent.is_empty() { key.clone() } else { format!("{parent}.{key}") };
        match value {
            Value::Table(inner) if !inner.is_empty() && !Values::is_range(inner) => flatten(&path, inner, visit)?,
            value => visit(path, value)?,
        }
    }
    Ok(())
}
