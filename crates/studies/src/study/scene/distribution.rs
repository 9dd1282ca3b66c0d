//! A quantity of the material that may differ from place to place: a number, an expression, or data of a file.

use super::value;
use crate::error::{self, Error};
use crate::mesh::Interpolation;
use crate::quantity::Quantity;
use crate::symbolic::Scope;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{self, Deserializer, MapAccess, Visitor};
use std::fmt;
use std::path::PathBuf;

/// A quantity in each cell, in the SI unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Distribution {
    pub source: Source,
    /// By which the values of the source are multiplied.
    pub factor: f64,
}

/// Where the values come from.
#[derive(Debug, Clone, PartialEq)]
pub enum Source {
    /// The same value everywhere.
    Number(f64),
    /// An expression of x, y and z in m.
    Expression(String),
    /// Numbers of a file.
    Data(DataEntry),
}

/// A file of numbers at places.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DataEntry {
    /// The path, relative to the scene.
    pub file: PathBuf,
    /// The name of the array, if the file has several.
    pub array: Option<String>,
    /// The unit of the numbers; the SI unit if absent.
    pub unit: Option<String>,
    /// The length of a unit of the file's positions, m.
    #[serde(default = "one", deserialize_with = "value::mesh_unit")]
    #[schemars(schema_with = "value::quantity")]
    pub scale: f64,
    /// How numbers between the places of the file are found.
    #[schemars(extend("enum" = Interpolation::NAMES))]
    pub interpolation: Option<String>,
}

fn one() -> f64 {
    1.0
}

impl Distribution {
    /// The same value everywhere.
    pub fn of_number(value: f64) -> Distribution {
        Distribution { source: Source::Number(value), factor: 1.0 }
    }

    /// The value, if it is the same everywhere.
    pub fn number(&self) -> Option<f64> {
        match self.source {
            Source::Number(value) => Some(value * self.factor),
            Source::Expression(_) | Source::Data(_) => None,
        }
    }

    /// The file of the values, if there is one.
    pub fn file(&self) -> Option<&PathBuf> {
        match &self.source {
            Source::Data(data) => Some(&data.file),
            Source::Number(_) | Source::Expression(_) => None,
        }
    }
}

impl DataEntry {
    /// How numbers between the places are found, if the file says so.
    ///
    /// # Errors
    /// There is no such interpolation.
    pub fn interpolation(&self) -> error::Result<Option<Interpolation>> {
        self.interpolation.as_deref().map(Interpolation::named).transpose().map_err(|e| e.at_key("interpolation"))
    }
}

/// The schema of a distribution.
pub fn schema(generator: &mut SchemaGenerator) -> Schema {
    let data = generator.subschema_for::<DataEntry>();
    json_schema!({ "anyOf": [{ "type": ["number", "string"] }, data] })
}

struct DistributionVisitor(Option<Quantity>);

impl<'de> Visitor<'de> for DistributionVisitor {
    type Value = Distribution;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.0.map_or("a number", Quantity::expected))?;
        f.write_str(", an expression of x, y and z, or { file = … }")
    }

    fn visit_i64<E: de::Error>(self, v: i64) -> Result<Distribution, E> {
        Ok(Distribution::of_number(v as f64))
    }

    fn visit_f64<E: de::Error>(self, v: f64) -> Result<Distribution, E> {
        Ok(Distribution::of_number(v))
    }

    fn visit_str<E: de::Error>(self, v: &str) -> Result<Distribution, E> {
        let number = match self.0 {
            Some(quantity) => quantity.parse(v),
            None => v.trim().parse().map_err(|_| Error::expected("value", "a number", v)),
        };
        match number {
            Ok(value) => Ok(Distribution::of_number(value)),
            Err(not_number) => match Scope::new(&["x", "y", "z"]).expression(v) {
                Ok(_) => Ok(Distribution { source: Source::Expression(v.into()), factor: 1.0 }),
                // What has an operator is meant as an expression.
                Err(e) if v.contains(['*', '+', '(', '^']) => Err(E::custom(e.problem())),
                Err(_) if self.0.is_none() => {
                    Err(E::invalid_value(de::Unexpected::Str(v), &"a number, or an expression"))
                }
                Err(_) => Err(E::custom(not_number.problem())),
            },
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Distribution, A::Error> {
        let data = DataEntry::deserialize(MapAccessDeserializer::new(map))?;
        let unit = |unit: &String| match self.0 {
            Some(quantity) => quantity.parse(&format!("1 {unit}")).map_err(|e| de::Error::custom(e.problem())),
            None => Err(de::Error::custom("the quantity has no unit")),
        };
        let factor = data.unit.as_ref().map_or(Ok(1.0), unit)?;
        Ok(Distribution { source: Source::Data(data), factor })
    }
}

fn read<'de, D: Deserializer<'de>>(quantity: Option<Quantity>, deserializer: D) -> Result<Distribution, D::Error> {
    deserializer.deserialize_any(DistributionVisitor(quantity))
}

/// Functions for `deserialize_with`.
macro_rules! distributions {
    ($($name:ident, $optional:ident: $quantity:expr),+ $(,)?) => {$(
        // Not every quantity is used both as a required and as an optional key.
        #[allow(dead_code)]
        pub fn $name<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Distribution, D::Error> {
            read($quantity, deserializer)
        }

        #[allow(dead_code)]
        pub fn $optional<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Distribution>, D::Error> {
            read($quantity, deserializer).map(Some)
        }
    )+};
}

distributions! {
    pressure, optional_pressure: Some(Quantity::Pressure),
    ratio, optional_ratio: None,
    length, optional_length: Some(Quantity::Length),
    density, optional_density: Some(Quantity::Density),
}
