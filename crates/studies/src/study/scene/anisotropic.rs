//! The anisotropic materials of a scene, and the axes of the material in each cell.

use super::distribution::DataEntry;
use super::value::{Pressure, Varying};
use crate::error::{Error, Result};
use crate::material::Anisotropy;
use crate::symbolic::{Expr, Scope};
use nalgebra::Matrix6;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};
use std::borrow::Cow;
use std::fmt;

/// Three planes of symmetry.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OrthotropicEntry {
    /// E1, E2, E3, Pa.
    pub young: Vec<Pressure>,
    /// ν12, ν23, ν13.
    pub poisson: Vec<f64>,
    /// G12, G23, G13, Pa.
    pub shear: Vec<Pressure>,
}

/// One axis of symmetry, the first.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TransverseEntry {
    /// Along the axis and across it, Pa.
    pub young: Vec<Pressure>,
    /// Across under tension along, and in the plane across.
    pub poisson: Vec<f64>,
    /// Of planes along the axis, Pa.
    pub shear: Pressure,
}

/// A crystal of cubic symmetry.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CubicEntry {
    pub c11: Pressure,
    pub c12: Pressure,
    pub c44: Pressure,
}

/// An axis of the material: a vector of numbers or expressions, or data of a file.
#[derive(Debug, Clone)]
pub enum AxisEntry {
    Vector(Vec<Varying>),
    Data(DataEntry),
}

impl<'de> Deserialize<'de> for AxisEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<AxisEntry, D::Error> {
        struct VectorOrData;
        impl<'de> Visitor<'de> for VectorOrData {
            type Value = AxisEntry;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a vector such as [1, 0, 0], or { file = … }")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> std::result::Result<AxisEntry, A::Error> {
                Deserialize::deserialize(SeqAccessDeserializer::new(list)).map(AxisEntry::Vector)
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> std::result::Result<AxisEntry, A::Error> {
                DataEntry::deserialize(MapAccessDeserializer::new(map)).map(AxisEntry::Data)
            }
        }
        deserializer.deserialize_any(VectorOrData)
    }
}

impl JsonSchema for AxisEntry {
    fn schema_name() -> Cow<'static, str> {
        "AxisEntry".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let (component, data) = (generator.subschema_for::<Varying>(), generator.subschema_for::<DataEntry>());
        json_schema!({
            "description": "A vector of numbers or expressions, or data of a file.",
            "anyOf": [{ "type": "array", "items": component }, data],
        })
    }
}

/// An axis whose values are known in each cell.
#[derive(Debug, Clone)]
pub enum Axis {
    /// Expressions of x, y and z.
    Vector([Expr; 3]),
    Data(DataEntry),
}

impl AxisEntry {
    /// # Errors
    /// A vector has another number of components than two or three, or an expression is wrong.
    pub fn check(&self) -> Result<Axis> {
        let components = match self {
            AxisEntry::Data(data) => {
                data.interpolation()?;
                if let Some(unit) = &data.unit {
                    return Err(Error::expected("unit", "none: a direction has no unit", format!("\"{unit}\"")));
                }
                return Ok(Axis::Data(data.clone()));
            }
            AxisEntry::Vector(components) => components,
        };
        if !(2..=3).contains(&components.len()) {
            let found = format!("{} components", components.len());
            return Err(Error::new(format!("expected a vector of two or three components, found {found}")));
        }
        let scope = Scope::new(&["x", "y", "z"]);
        let expression = |component: &Varying| match component {
            Varying::Number(value) => scope.expression(&format!("{value:?}")),
            Varying::Text(text) => scope.expression(text),
        };
        let mut vector = [Expr::integer(0), Expr::integer(0), Expr::integer(0)];
        for (place, component) in vector.iter_mut().zip(components) {
            *place = expression(component)?;
        }
        Ok(Axis::Vector(vector))
    }
}

/// Three numbers of a key.
fn three<T: Copy>(key: &str, list: &[T]) -> Result<[T; 3]> {
    list.try_into().map_err(|_| Error::expected(key, "three numbers", list.len()))
}

fn two<T: Copy>(key: &str, list: &[T]) -> Result<[T; 2]> {
    list.try_into().map_err(|_| Error::expected(key, "two numbers", list.len()))
}

impl OrthotropicEntry {
    /// # Errors
    /// A list has another length, or the stiffness is not positive definite.
    pub fn anisotropy(&self) -> Result<Anisotropy> {
        let young = three("young", &self.young)?.map(|e| e.0);
        let shear = three("shear", &self.shear)?.map(|g| g.0);
        Anisotropy::orthotropic(young, three("poisson", &self.poisson)?, shear)
    }
}

impl TransverseEntry {
    /// # Errors
    /// A list has another length, or the stiffness is not positive definite.
    pub fn anisotropy(&self) -> Result<Anisotropy> {
        let young = two("young", &self.young)?.map(|e| e.0);
        Anisotropy::transversely_isotropic(young, two("poisson", &self.poisson)?, self.shear.0)
    }
}

impl CubicEntry {
    /// # Errors
    /// The stiffness is not positive definite.
    pub fn anisotropy(&self) -> Result<Anisotropy> {
        Anisotropy::cubic(self.c11.0, self.c12.0, self.c44.0)
    }
}

/// A stiffness of six rows of six numbers, Pa.
///
/// # Errors
/// A length is wrong, or the stiffness is not symmetric and positive definite.
pub fn of_rows(rows: &[Vec<Pressure>]) -> Result<Anisotropy> {
    if rows.len() != 6 || rows.iter().any(|row| row.len() != 6) {
        let lengths: Vec<usize> = rows.iter().map(Vec::len).collect();
        return Err(Error::new(format!("expected six rows of six numbers, found rows of {lengths:?}")));
    }
    Anisotropy::of_stiffness(Matrix6::from_fn(|i, j| rows[i][j].0))
}
