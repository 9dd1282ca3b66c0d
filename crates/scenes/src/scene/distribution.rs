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
    /// The quantity has this value everywhere.
    Number(f64),
    /// An expression of x, y and z in m.
    Expression(String),
    /// Numbers of a file.
    Data(DataEntry),
}

/// A file of numbers at places.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "data")]
pub struct DataEntry {
    /// The values are read from this file, relative to the scene: `.csv`, `.vtu` or `.vtk`. A table has a header with `x`, `y`, (`z`) and
    /// the column of the values.
    #[schemars(extend("x-type" = "path"))]
    pub file: PathBuf,
    /// The values are in this array of points or cells, or in this column.
    #[schemars(extend("x-default" = "the only one"))]
    pub array: Option<String>,
    /// The values have this unit, such as `"MPa"`, `"mm"` or `"g/cm^3"`.
    #[schemars(extend("x-default" = "the SI unit"))]
    pub unit: Option<String>,
    /// One unit of the positions in the file has this length in m, above 0.
    #[serde(default, deserialize_with = "value::optional_mesh_unit")]
    #[schemars(schema_with = "value::mesh_unit_schema", extend("x-default" = "1, or that of the mesh in the same file"))]
    pub scale: Option<f64>,
    /// Places with this value have none, such as −9999; they are left out and counted.
    pub missing: Option<f64>,
    /// Values between the places of the file are those of the nearest place (`nearest`), or of the plane through the nearest places by
    /// least squares within the range of their values (`linear`).
    #[schemars(extend("enum" = Interpolation::NAMES, "x-default" = "by what the values belong to"))]
    pub interpolation: Option<String>,
}

impl Distribution {
    /// Makes a quantity that has this value everywhere.
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

/// The schema of a distribution of a quantity, or of a number without a unit.
fn schema(quantity: Option<Quantity>, generator: &mut SchemaGenerator) -> Schema {
    let data = generator.subschema_for::<DataEntry>();
    let name = quantity.map_or("number", |quantity| value::name_and_unit(quantity).0);
    json_schema!({ "anyOf": [{ "type": ["number", "string"] }, data], "x-type": format!("{name}, or varies") })
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
            Err(not_number) => match Scope::value_over(&["x", "y", "z"], self.0, v) {
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

/// Functions for `deserialize_with` and `schema_with`.
macro_rules! distributions {
    ($($name:ident, $optional:ident, $schema:ident: $quantity:expr),+ $(,)?) => {$(
        pub fn $schema(generator: &mut SchemaGenerator) -> Schema {
            schema($quantity, generator)
        }

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
    pressure, optional_pressure, pressure_schema: Some(Quantity::Pressure),
    ratio, optional_ratio, ratio_schema: None,
    length, optional_length, length_schema: Some(Quantity::Length),
    density, optional_density, density_schema: Some(Quantity::Density),
}
