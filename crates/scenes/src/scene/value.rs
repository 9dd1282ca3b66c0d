//! Values of a scene that can be written in more than one way.

use crate::file::{Forms, PlainForms as Plain};
use crate::quantity::Quantity;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny};
use std::borrow::Cow;

/// One direction of a load: a number, or an expression in x, y, z in m.
#[derive(Debug, Clone)]
pub enum Varying {
    Number(f64),
    Text(String),
}

/// A pressure: a number in Pa, a text with a unit, or an expression in x, y, z in m.
#[derive(Debug, Clone)]
pub struct VaryingPressure(pub Varying);

/// One direction of a prescribed displacement: a number in m, an expression in x, y, z in m, or none if it is `"free"`.
#[derive(Debug, Clone)]
pub struct PrescribedComponent(pub Option<Varying>);

/// A length of a mesh: a number of mesh units, or a text with a unit of length.
#[derive(Debug, Clone, PartialEq)]
pub enum MeshLength {
    /// A number of mesh units.
    Units(f64),
    /// A text with a unit, and the length in m.
    Stated(String, f64),
}

impl MeshLength {
    /// The length that a text stands for.
    ///
    /// # Errors
    /// It is neither a number nor a length.
    pub fn parse(text: &str) -> crate::error::Result<MeshLength> {
        match text.trim().parse() {
            Ok(number) => Ok(MeshLength::Units(number)),
            Err(_) => Quantity::Length.parse(text).map(|metres| MeshLength::Stated(text.trim().into(), metres)),
        }
    }

    /// The length in m, with `scale` metres per mesh unit.
    pub fn metres(&self, scale: f64) -> f64 {
        match self {
            MeshLength::Units(number) => number * scale,
            MeshLength::Stated(_, metres) => *metres,
        }
    }

    /// The length as TOML.
    pub fn toml(&self) -> String {
        match self {
            MeshLength::Units(number) => number.to_string(),
            MeshLength::Stated(text, _) => crate::text::toml(text).to_string(),
        }
    }
}

/// One number, or a list of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Numbers(pub Vec<f64>);

impl<'de> Deserialize<'de> for Numbers {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Numbers, D::Error> {
        deserializer.deserialize_any(Forms::<_, _, IgnoredAny> {
            number: Some(|v| Some(Numbers(vec![v]))),
            list: Some(|all| Ok(Numbers(all))),
            ..Forms::expecting("a number or a list of numbers")
        })
    }
}

impl JsonSchema for Numbers {
    fn schema_name() -> Cow<'static, str> {
        "Numbers".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "type": ["number", "array"],
            "items": { "type": "number" },
            "x-type": "number or list of numbers",
            "description": "A number, or a list of numbers.",
        })
    }
}

/// What a direction of a prescribed displacement is.
pub const PRESCRIBED: &str = "a finite number of metres, an expression of x, y, z, or \"free\"";

/// What a pressure is.
pub const PRESSURE: &str = "a pressure such as 1000 or \"1 kPa\", or an expression of x, y, z in Pa such as \"1e4*z\"";

impl<'de> Deserialize<'de> for PrescribedComponent {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<PrescribedComponent, D::Error> {
        deserializer.deserialize_any(Plain {
            number: Some(|v| v.is_finite().then_some(PrescribedComponent(Some(Varying::Number(v))))),
            text: Some(&|v| Ok(PrescribedComponent((v != "free").then(|| Varying::Text(v.into()))))),
            ..Plain::expecting(PRESCRIBED)
        })
    }
}

impl<'de> Deserialize<'de> for VaryingPressure {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<VaryingPressure, D::Error> {
        deserializer.deserialize_any(Plain {
            number: Some(|v| Some(VaryingPressure(Varying::Number(v)))),
            text: Some(&|v| {
                let is_quantity = Quantity::Pressure.parse(v);
                Ok(VaryingPressure(is_quantity.map_or_else(|_| Varying::Text(v.into()), Varying::Number)))
            }),
            ..Plain::expecting(PRESSURE)
        })
    }
}

impl<'de> Deserialize<'de> for MeshLength {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<MeshLength, D::Error> {
        deserializer.deserialize_any(Plain {
            number: Some(|v| Some(MeshLength::Units(v))),
            text: Some(&|v| MeshLength::parse(v).map_err(|e| Some(e.problem().into()))),
            ..Plain::expecting("a number of mesh units, or a length with a unit such as \"4 mm\"")
        })
    }
}

impl<'de> Deserialize<'de> for Varying {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Varying, D::Error> {
        deserializer.deserialize_any(Plain {
            number: Some(|v| Some(Varying::Number(v))),
            text: Some(&|v| Ok(Varying::Text(v.into()))),
            ..Plain::expecting("a number or an expression of x, y, z such as \"1e5*x\"")
        })
    }
}

/// The name of a quantity in tables of keys, and its SI unit.
pub fn name_and_unit(quantity: Quantity) -> (&'static str, &'static str) {
    match quantity {
        Quantity::Length | Quantity::MeshUnit => ("length", "m"),
        Quantity::Area => ("area", "m²"),
        Quantity::Volume => ("volume", "m³"),
        Quantity::Pressure => ("pressure", "Pa"),
        Quantity::Density => ("density", "kg/m³"),
        Quantity::Time => ("time", "s"),
        Quantity::Force => ("force", "N"),
        Quantity::Moment => ("moment", "N·m"),
        Quantity::Acceleration => ("acceleration", "m/s²"),
        Quantity::ForceDensity => ("force density", "N/m³"),
    }
}

/// The schema of a quantity, with its name and unit.
fn schema(quantity: Quantity) -> Schema {
    let (name, unit) = name_and_unit(quantity);
    json_schema!({ "type": ["number", "string"], "x-type": name, "x-unit": unit })
}

/// The schemas of values that are written as a number or as a text.
macro_rules! schemas {
    ($($type:ident: $name:literal, $description:literal);+ $(;)?) => {$(
        impl JsonSchema for $type {
            fn schema_name() -> Cow<'static, str> {
                stringify!($type).into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!({ "type": ["number", "string"], "x-type": $name, "description": $description })
            }
        }
    )+};
}

schemas! {
    MeshLength: "number or length", "A number of mesh units, or a length with a unit such as \"4 mm\".";
    Varying: "number or expression", "A number, or an expression of x, y, z (m) such as \"1e5*x\".";
    VaryingPressure: "pressure or expression", "A number of Pa, a text with a unit such as \"1 kPa\", or an expression of x, y, z (m) in Pa such as \"1e4*z\".";
    PrescribedComponent: "number, expression or `\"free\"`", "A number of metres, an expression of x, y, z (m) such as \"-0.1*y\", or \"free\".";
}

/// A number in the SI unit, or a text with a unit.
fn read<'de, D: Deserializer<'de>>(quantity: Quantity, deserializer: D) -> Result<f64, D::Error> {
    deserializer.deserialize_any(Plain {
        number: Some(Some),
        text: Some(&|v| quantity.parse(v).map_err(|e| Some(e.problem().into()))),
        ..Plain::expecting(quantity.expected())
    })
}

/// Functions for `deserialize_with` and `schema_with` of keys that hold a quantity, in the SI unit.
macro_rules! quantities {
    ($($one:ident, $optional:ident, $schema:ident: $quantity:ident),+ $(,)?) => {$(
        pub fn $schema(_: &mut SchemaGenerator) -> Schema {
            schema(Quantity::$quantity)
        }

        // Not every quantity is used both as a required and as an optional key.
        #[allow(dead_code)]
        pub fn $one<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
            read(Quantity::$quantity, deserializer)
        }

        #[allow(dead_code)]
        pub fn $optional<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
            read(Quantity::$quantity, deserializer).map(Some)
        }
    )+};
}

quantities! {
    length, optional_length, length_schema: Length,
    area, optional_area, area_schema: Area,
    volume, optional_volume, volume_schema: Volume,
    time, optional_time, time_schema: Time,
    stress, optional_stress, stress_schema: Pressure,
    mesh_unit, optional_mesh_unit, mesh_unit_schema: MeshUnit,
}

/// Functions for `deserialize_with` and `schema_with` of keys that hold a vector of a quantity, in the SI unit.
macro_rules! vectors {
    ($($vector:ident, $schema:ident: $quantity:ident),+ $(,)?) => {$(
        pub fn $schema(_: &mut SchemaGenerator) -> Schema {
            let (name, unit) = name_and_unit(Quantity::$quantity);
            let items = json_schema!({ "type": ["number", "string"] });
            json_schema!({ "type": "array", "items": items, "x-type": format!("vector of {name}"), "x-unit": unit })
        }

        pub fn $vector<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Vec<f64>>, D::Error> {
            struct Component(f64);

            impl<'de> Deserialize<'de> for Component {
                fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Component, D::Error> {
                    read(Quantity::$quantity, deserializer).map(Component)
                }
            }

            let components = Vec::<Component>::deserialize(deserializer)?;
            Ok(Some(components.into_iter().map(|Component(value)| value).collect()))
        }
    )+};
}

vectors! {
    force_vector, force_vector_schema: Force,
    moment_vector, moment_vector_schema: Moment,
    acceleration_vector, acceleration_vector_schema: Acceleration,
}
