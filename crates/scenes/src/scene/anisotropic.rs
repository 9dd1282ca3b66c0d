//! The anisotropic materials of a scene, and the axes of the material in each cell.

use super::distribution::{self, DataEntry, Distribution};
use super::value::Varying;
use crate::error::{Error, Result};
use crate::file::Forms;
use crate::material::Anisotropy;
use crate::symbolic::{Expr, Scope};
use nalgebra::Matrix6;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::Deserializer;
use std::borrow::Cow;
use std::path::PathBuf;

/// A pressure that may differ from place to place, Pa.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct PressureField(
    #[serde(deserialize_with = "distribution::pressure")]
    #[schemars(schema_with = "distribution::pressure_schema")]
    Distribution,
);

/// A number that may differ from place to place.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct NumberField(
    #[serde(deserialize_with = "distribution::ratio")]
    #[schemars(schema_with = "distribution::ratio_schema")]
    pub Distribution,
);

/// Three planes of symmetry.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OrthotropicEntry {
    /// The list has E1, E2 and E3 in Pa.
    #[schemars(extend("x-type" = "three pressures, or varying"))]
    young: Vec<PressureField>,
    /// The list has ν12, ν23 and ν13; `ν_ij` is the contraction along j per stretch along i under tension along i.
    #[schemars(extend("x-type" = "three numbers, or varying"))]
    poisson: Vec<NumberField>,
    /// The list has G12, G23 and G13 in Pa.
    #[schemars(extend("x-type" = "three pressures, or varying"))]
    shear: Vec<PressureField>,
}

/// One axis of symmetry, the first.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TransverseEntry {
    /// The list has Young's modulus along the axis and across it, in Pa.
    #[schemars(extend("x-type" = "two pressures, or varying"))]
    young: Vec<PressureField>,
    /// The list has Poisson's ratio across the axis per stretch along it under tension along it, and that within the plane across.
    #[schemars(extend("x-type" = "two numbers, or varying"))]
    poisson: Vec<NumberField>,
    /// The shear modulus along the axis is in Pa.
    shear: PressureField,
}

/// A crystal of cubic symmetry.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CubicEntry {
    /// The stiffness c11 is in Pa.
    c11: PressureField,
    /// The stiffness c12 is in Pa.
    c12: PressureField,
    /// The stiffness c44 is in Pa.
    c44: PressureField,
}

/// Six rows of six numbers, Pa.
pub type StiffnessEntry = Vec<Vec<PressureField>>;

/// An anisotropic law whose constants may differ from place to place.
#[derive(Debug)]
pub struct AnisotropicLaw<'a> {
    /// The key of the law in a material.
    pub key: &'static str,
    /// The constants, each with its key under that of the law.
    pub constants: Vec<(String, &'a Distribution)>,
    of: fn(&[f64]) -> Result<Anisotropy>,
}

impl<'a> AnisotropicLaw<'a> {
    /// The law with these values of the constants.
    ///
    /// # Errors
    /// A constant is out of its range, or the stiffness is not positive definite.
    pub fn at(&self, values: &[f64]) -> Result<Anisotropy> {
        // A stiffness that is wrong has its own name as its key.
        let keyed = |e: Error| if e.key() == Some("stiffness") { e.at_key(self.key) } else { e.under(self.key) };
        (self.of)(values).map_err(keyed)
    }

    /// The constants with their keys in a material.
    pub fn keyed(&self) -> Vec<(String, &'a Distribution)> {
        let key =
            |own: &str| if own.starts_with('[') { format!("{}{own}", self.key) } else { format!("{}.{own}", self.key) };
        self.constants.iter().map(|(own, constant)| (key(own), *constant)).collect()
    }

    /// The values of the constants, if they are the same everywhere.
    pub fn numbers(&self) -> Option<Vec<f64>> {
        self.constants.iter().map(|(_, constant)| constant.number()).collect()
    }
}

/// An axis of the material: a vector of numbers or expressions, or data of a file.
#[derive(Debug, Clone)]
pub enum AxisEntry {
    Vector(Vec<Varying>),
    Data(DataEntry),
}

impl<'de> Deserialize<'de> for AxisEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<AxisEntry, D::Error> {
        deserializer.deserialize_any(Forms {
            list: Some(|components| Ok(AxisEntry::Vector(components))),
            table: Some(AxisEntry::Data),
            ..Forms::expecting("a vector such as [1, 0, 0], or { file = … }")
        })
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
    /// The file of the values, if there is one.
    pub fn file(&self) -> Option<&PathBuf> {
        match self {
            AxisEntry::Vector(_) => None,
            AxisEntry::Data(data) => Some(&data.file),
        }
    }

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
        let scope = Scope::of_place(3);
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

/// The constants of a list, which must have this length.
fn constants<'a, T>(
    key: &str,
    list: &'a [T],
    length: usize,
    of: impl Fn(&'a T) -> &'a Distribution,
) -> Result<Vec<(String, &'a Distribution)>> {
    if list.len() != length {
        let expected = if length == 2 { "two numbers" } else { "three numbers" };
        return Err(Error::expected(key, expected, list.len()));
    }
    Ok(list.iter().enumerate().map(|(i, field)| (format!("{key}[{i}]"), of(field))).collect())
}

fn pressure(field: &PressureField) -> &Distribution {
    &field.0
}

fn ratio(field: &NumberField) -> &Distribution {
    &field.0
}

impl OrthotropicEntry {
    /// # Errors
    /// A list has another length.
    pub fn law(&self) -> Result<AnisotropicLaw<'_>> {
        let young = constants("young", &self.young, 3, pressure)?;
        let poisson = constants("poisson", &self.poisson, 3, ratio)?;
        let shear = constants("shear", &self.shear, 3, pressure)?;
        let of = |v: &[f64]| Anisotropy::orthotropic([v[0], v[1], v[2]], [v[3], v[4], v[5]], [v[6], v[7], v[8]]);
        Ok(AnisotropicLaw { key: "orthotropic", constants: [young, poisson, shear].concat(), of })
    }
}

impl TransverseEntry {
    /// # Errors
    /// A list has another length.
    pub fn law(&self) -> Result<AnisotropicLaw<'_>> {
        let young = constants("young", &self.young, 2, pressure)?;
        let poisson = constants("poisson", &self.poisson, 2, ratio)?;
        let shear = vec![("shear".into(), &self.shear.0)];
        let of = |v: &[f64]| Anisotropy::transversely_isotropic([v[0], v[1]], [v[2], v[3]], v[4]);
        Ok(AnisotropicLaw { key: "transversely-isotropic", constants: [young, poisson, shear].concat(), of })
    }
}

impl CubicEntry {
    pub fn law(&self) -> AnisotropicLaw<'_> {
        let all = [("c11", &self.c11), ("c12", &self.c12), ("c44", &self.c44)];
        let constants = all.map(|(key, field)| (key.into(), &field.0)).into();
        AnisotropicLaw { key: "cubic", constants, of: |v| Anisotropy::cubic(v[0], v[1], v[2]) }
    }
}

/// # Errors
/// A length is wrong.
pub fn of_rows(rows: &StiffnessEntry) -> Result<AnisotropicLaw<'_>> {
    if rows.len() != 6 || rows.iter().any(|row| row.len() != 6) {
        let lengths: Vec<usize> = rows.iter().map(Vec::len).collect();
        let problem = format!("expected six rows of six numbers, found rows of {lengths:?}");
        return Err(Error::new(problem));
    }
    let constants = rows
        .iter()
        .enumerate()
        .flat_map(|(i, row)| row.iter().enumerate().map(move |(j, field)| (format!("[{i}][{j}]"), &field.0)));
    let of = |v: &[f64]| Anisotropy::of_stiffness(Matrix6::from_row_slice(v));
    Ok(AnisotropicLaw { key: "stiffness", constants: constants.collect(), of })
}
