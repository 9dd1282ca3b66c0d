//! The `[material]` or the `[[material]]` of a scene.

use super::anisotropic::{
    AnisotropicLaw, Axis, AxisEntry, CubicEntry, NumberField, OrthotropicEntry, StiffnessEntry, TransverseEntry,
    of_rows,
};
use super::bending::{Bending, RestShape};
use super::constants::{Constant, young_and_poisson};
use super::distribution::{self, Distribution};
use super::part::Part;
use super::relaxation::RelaxationEntry;
use super::value;
use crate::error::{Error, Result, expect_none};
use crate::file::Forms;
use crate::material::{Material, Plane};
use crate::range;
use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::Deserializer;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The material of a body, or of one of its regions.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("anyOf" = [
    { "required": ["young"] },
    { "required": ["poisson"] },
    { "required": ["shear_modulus"] },
    { "required": ["bulk_modulus"] },
    { "required": ["orthotropic"] },
    { "required": ["transversely-isotropic"] },
    { "required": ["cubic"] },
    { "required": ["stiffness"] },
]))]
pub struct MaterialEntry {
    /// Reports name the region so.
    #[schemars(extend("x-default" = "its group or condition, or `rest`"))]
    pub name: Option<String>,
    /// The cells of this group of the mesh have the material.
    #[schemars(extend("x-default" = "the rest"))]
    pub group: Option<String>,
    /// The cells whose middle, the mean of their nodes, satisfies this condition on x, y, z in m have the material.
    #[serde(rename = "where")]
    #[schemars(extend("x-default" = "the rest"))]
    pub condition: Option<String>,
    /// Young's modulus in Pa is above 0. An isotropic material has two of `young`, `poisson`, `shear_modulus`, `bulk_modulus` and `lambda`.
    #[serde(default, deserialize_with = "distribution::optional_pressure")]
    #[schemars(schema_with = "distribution::pressure_schema", extend("x-default" = "required if isotropic"))]
    pub young: Option<Distribution>,
    /// Poisson's ratio is above −1 and below 0.5; 0.5 itself is possible in plane stress.
    #[serde(default, deserialize_with = "distribution::optional_ratio")]
    #[schemars(schema_with = "distribution::ratio_schema", extend("x-default" = "required if isotropic"))]
    pub poisson: Option<Distribution>,
    /// The shear modulus μ in Pa is above 0. It is a number, one of two constants of an isotropic material.
    #[serde(default, deserialize_with = "distribution::optional_pressure")]
    #[schemars(schema_with = "distribution::pressure_schema")]
    pub shear_modulus: Option<Distribution>,
    /// The bulk modulus K in Pa is above 0. It is a number, one of two constants of an isotropic material.
    #[serde(default, deserialize_with = "distribution::optional_pressure")]
    #[schemars(schema_with = "distribution::pressure_schema")]
    pub bulk_modulus: Option<Distribution>,
    /// Lamé's first constant λ in Pa. It is a number, one of two constants of an isotropic material.
    #[serde(default, deserialize_with = "distribution::optional_pressure")]
    #[schemars(schema_with = "distribution::pressure_schema")]
    pub lambda: Option<Distribution>,
    /// The material has three planes of symmetry. The key stands in place of `young` and `poisson`.
    pub orthotropic: Option<OrthotropicEntry>,
    /// The material has one axis of symmetry, which is its first axis. The key stands in place of `young` and `poisson`.
    #[serde(rename = "transversely-isotropic")]
    pub transverse: Option<TransverseEntry>,
    /// The material is a cubic crystal. The key stands in place of `young` and `poisson`.
    pub cubic: Option<CubicEntry>,
    /// The material has this stiffness in Pa, with rows and columns in the order xx, yy, zz, yz, xz, xy, for shear strains 2 ε. The key
    /// stands in place of `young` and `poisson`.
    #[schemars(extend("x-type" = "six lists of six pressures, or varying"))]
    pub stiffness: Option<StiffnessEntry>,
    /// An anisotropic material has these first and second axes. Each is a vector of numbers or expressions of x, y, z in m, or data of a
    /// file; lengths do not matter, and the second is made orthogonal to the first.
    #[schemars(extend("x-type" = "list of vectors", "x-default" = "x and y"))]
    pub axes: Option<Vec<AxisEntry>>,
    /// A plane mesh or a surface is in plane stress or in plane strain.
    #[schemars(extend("default" = "stress"))]
    pub plane: Option<Plane>,
    /// A plane mesh or a surface has this thickness in m, above 0. A surface in space requires it.
    #[serde(default, deserialize_with = "distribution::optional_length")]
    #[schemars(schema_with = "distribution::length_schema", extend("x-default" = "1 m in the plane"))]
    pub thickness: Option<Distribution>,
    /// A surface of triangles or lines of two nodes, in space, resist bending as this says. It is the same in every entry of `[[material]]`.
    #[serde(default)]
    pub bending: Bending,
    /// A sheet that bends is without bending in this shape. `flat` needs a `law`, and is the same in every entry of `[[material]]`.
    #[serde(default)]
    pub rest: RestShape,
    /// A sheet that bends has this flexural stiffness D in N·m, and rods that bend have this E I in N·m², above 0, in place of that of thickness or
    /// area. It is the same in every entry of `[[material]]`.
    #[schemars(extend("x-default" = "`E t³/(12 (1 − ν²))`, `E A²/(4 π)`"))]
    pub flexural: Option<f64>,
    /// Rods that bend have this torsional stiffness G J in N·m², above 0. It is the same in every entry of `[[material]]`.
    #[schemars(extend("x-default" = "flexural / (1 + ν)"))]
    pub torsional: Option<f64>,
    /// Rods have this cross-section in m², above 0.
    #[serde(default, deserialize_with = "value::optional_area")]
    #[schemars(schema_with = "value::area_schema", extend("x-default" = "1 m²"))]
    pub area: Option<f64>,
    /// The density in kg/m³ is above 0; it gives the points masses.
    #[serde(default, deserialize_with = "distribution::optional_density")]
    #[schemars(schema_with = "distribution::density_schema")]
    pub density: Option<Distribution>,
    /// Stress relaxes in a `[motion]`: the moduli are those against a sudden strain, and `relaxation` says what becomes of them. Entries of
    /// `[[material]]` may relax unlike, or not at all.
    pub relaxation: Option<RelaxationEntry>,
    /// Loads are solved at large deformation with this law: the name of a shipped one, or a path relative to the scene that ends in
    /// `.toml`. It is there in every entry of `[[material]]` or in none.
    pub law: Option<String>,
    /// Parameters of the law have these values.
    #[schemars(extend("x-type" = "table of numbers, or varying", "x-default" = "those of the law"))]
    pub parameters: Option<BTreeMap<String, NumberField>>,
    /// The fibres of the law have this direction: a vector of numbers or expressions of x, y, z in m, or data of a file with three numbers.
    #[schemars(extend("x-type" = "vector", "x-default" = "that of the law"))]
    pub fibre: Option<AxisEntry>,
}

/// One material for the whole body, or one for each region.
#[derive(Debug, Clone)]
pub struct MaterialEntries {
    pub all: Vec<MaterialEntry>,
    /// Whether they are written as a list.
    pub is_list: bool,
}

impl<'de> Deserialize<'de> for MaterialEntries {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<MaterialEntries, D::Error> {
        deserializer.deserialize_any(Forms {
            list: Some(|all| Ok(MaterialEntries { all, is_list: true })),
            table: Some(|one| MaterialEntries { all: vec![one], is_list: false }),
            ..Forms::expecting("a table [material] or tables [[material]]")
        })
    }
}

impl MaterialEntry {
    /// The part of the mesh that has the material; the rest of the mesh if the entry names none.
    ///
    /// # Errors
    /// Two parts are given, or the condition is wrong.
    pub fn part(&self) -> Result<Part> {
        Part::optional(self.group.clone(), self.condition.clone())
    }

    /// Replaces the shear modulus, the bulk modulus and Lamé's first constant by Young's modulus and Poisson's ratio.
    ///
    /// # Errors
    /// Three constants are given or one alone, one of those that are replaced or the other beside it is not a number, or there is no such material.
    pub(super) fn complete(&mut self) -> Result<()> {
        let others = [
            ("shear_modulus", self.shear_modulus.take()),
            ("bulk_modulus", self.bulk_modulus.take()),
            ("lambda", self.lambda.take()),
        ];
        if others.iter().all(|(_, given)| given.is_none()) {
            return Ok(());
        }
        let own = [("young", self.young.take()), ("poisson", self.poisson.take())];
        let given: Vec<(&str, Distribution)> =
            own.into_iter().chain(others).filter_map(|(key, value)| Some((key, value?))).collect();
        let keys = given.iter().map(|(key, _)| format!("\"{key}\"")).collect::<Vec<_>>().join(" and ");
        let [(first, a), (second, b)] = &given[..] else {
            let expected = "two of \"young\", \"poisson\", \"shear_modulus\", \"bulk_modulus\" and \"lambda\"";
            return Err(Error::new(format!("expected {expected}, found {keys}")));
        };
        let number = |key: &str, value: &Distribution| {
            let expected = "a number: young and poisson alone may differ from place to place";
            value.number().ok_or_else(|| Error::expected(key, expected, "an expression or a file"))
        };
        let constants = Constant::named(first).zip(Constant::named(second)).expect("these keys are those of constants");
        let (young, poisson) = young_and_poisson(constants, number(first, a)?, number(second, b)?);
        if !(young > 0.0 && young.is_finite() && poisson > -1.0 && poisson < 0.5) {
            let expected = "constants of a material with E above 0 and Poisson's ratio between -1 and 0.5";
            return Err(Error::expected(keys, expected, format!("E = {young:.4e} Pa and {poisson:.4}")));
        }
        (self.young, self.poisson) = (Some(Distribution::of_number(young)), Some(Distribution::of_number(poisson)));
        Ok(())
    }

    /// The name of the region in reports.
    pub fn name(&self) -> String {
        let place = || self.group.clone().or_else(|| self.condition.clone());
        self.name.clone().or_else(place).unwrap_or_else(|| "rest".into())
    }

    /// The quantities that may differ from place to place, with their keys.
    pub fn distributions(&self) -> Vec<(String, &Distribution)> {
        let own = [
            ("young", &self.young),
            ("poisson", &self.poisson),
            ("thickness", &self.thickness),
            ("density", &self.density),
        ];
        let mut all: Vec<_> =
            own.into_iter().filter_map(|(key, values)| Some((key.to_string(), values.as_ref()?))).collect();
        all.extend(self.laws().into_iter().flatten().flat_map(|law| law.keyed()));
        all.extend(self.parameters().map(|(name, values)| (format!("parameters.{name}"), values)));
        all
    }

    /// The parameters of the law that have values here.
    pub fn parameters(&self) -> impl Iterator<Item = (&String, &Distribution)> {
        self.parameters.iter().flatten().map(|(name, field)| (name, &field.0))
    }

    /// The files of data that the entry names.
    pub fn files(&self) -> Vec<&PathBuf> {
        let axes = self.axes.iter().flatten().chain(&self.fibre).filter_map(AxisEntry::file);
        self.distributions().into_iter().filter_map(|(_, values)| values.file()).chain(axes).collect()
    }

    /// The anisotropic laws that are given; a list of constants may have a wrong length.
    fn laws(&self) -> Vec<Result<AnisotropicLaw<'_>>> {
        let all = [
            ("orthotropic", self.orthotropic.as_ref().map(OrthotropicEntry::law)),
            ("transversely-isotropic", self.transverse.as_ref().map(TransverseEntry::law)),
            ("cubic", self.cubic.as_ref().map(|entry| Ok(entry.law()))),
            ("stiffness", self.stiffness.as_ref().map(of_rows)),
        ];
        all.into_iter().filter_map(|(key, law)| Some(law?.map_err(|e| e.under(key)))).collect()
    }

    /// The anisotropic law in the axes of the material; `None` if the material is isotropic.
    ///
    /// # Errors
    /// Constants are missing, those of two laws are given, or the stiffness is not positive definite if it is the same everywhere.
    pub fn anisotropy(&self) -> Result<Option<AnisotropicLaw<'_>>> {
        let mut found: Option<AnisotropicLaw> = None;
        for law in self.laws() {
            let law = law?;
            if let Some(numbers) = law.numbers() {
                law.at(&numbers)?;
            }
            let key = law.key;
            if let Some(other) = found.replace(law) {
                return Err(Error::expected(key, "one law", format!("\"{}\" as well", other.key)));
            }
        }
        let isotropic = [("young", self.young.is_some()), ("poisson", self.poisson.is_some())];
        if let Some(AnisotropicLaw { key: law, .. }) = &found {
            let own = isotropic.into_iter().chain([("law", self.law.is_some())]);
            expect_none(own, format!("belongs to isotropic materials, found with \"{law}\""))?;
        } else {
            if let Some((key, _)) = isotropic.into_iter().find(|(_, given)| !given) {
                return Err(Error::new(format!("missing field \"{key}\"")));
            }
            if self.axes.is_some() {
                return Err(Error::at("axes", "belongs to anisotropic materials, found an isotropic one"));
            }
        }
        Ok(found)
    }

    /// The axes of the material; x and y if the entry names none.
    ///
    /// # Errors
    /// There are not two, or one of a material with one axis of symmetry, or a vector is wrong.
    pub fn axes(&self) -> Result<Vec<Axis>> {
        let Some(axes) = &self.axes else { return Ok(Vec::new()) };
        let fewest = if self.transverse.is_some() { 1 } else { 2 };
        if !(fewest..=2).contains(&axes.len()) {
            let expected = if fewest == 1 { "one or two vectors" } else { "two vectors" };
            return Err(Error::expected("axes", expected, axes.len()));
        }
        axes.iter().enumerate().map(|(i, axis)| axis.check().map_err(|e| e.under(format!("axes[{i}]")))).collect()
    }

    /// Whether a number differs from cell to cell. Masses may.
    pub fn varies(&self) -> bool {
        self.distributions().iter().any(|(_, values)| values.number().is_none())
    }

    /// The checks that do not depend on the mesh.
    pub(super) fn check(&self) -> Result<()> {
        self.part()?;
        let law = self.anisotropy()?;
        self.axes()?;
        let of_law = [("parameters", self.parameters.is_some()), ("fibre", self.fibre.is_some())];
        if self.law.is_none() {
            expect_none(of_law, "belongs to a law, found no \"law\"")?;
        }
        self.fibre.as_ref().map_or(Ok(()), |fibre| fibre.check().map(|_| ()).map_err(|e| e.under("fibre")))?;
        for (key, distribution) in self.distributions() {
            if let distribution::Source::Data(data) = &distribution.source {
                data.interpolation().map_err(|e| e.under(&key))?;
                let scale = data.scale.unwrap_or(1.0);
                range::positive("scale", scale, "metres per unit of the file").map_err(|e| e.under(&key))?;
            }
        }
        let dimension = if self.plane.is_some() || self.thickness.is_some() { 2 } else { 3 };
        self.relaxation.as_ref().map(RelaxationEntry::check).transpose()?;
        // Plane stress admits larger ν than a solid; a solid is checked again when the mesh is known.
        let state = if dimension == 3 { Some(Plane::Stress) } else { self.plane };
        // A value that varies is checked in each cell.
        let number = |values: &Option<Distribution>| values.as_ref().and_then(Distribution::number);
        let young = number(&self.young).unwrap_or(1.0);
        let poisson = number(&self.poisson).unwrap_or(0.0);
        if law.is_some() && self.area.is_some() {
            return Err(Error::at("area", "belongs to rods, which are isotropic"));
        }
        let thickness = self.thickness.as_ref().and_then(Distribution::number);
        Material::for_body(2, young, poisson, state, thickness)?;
        number(&self.density).map_or(Ok(()), |density| range::positive("density", density, "kg/m³").map(|_| ()))
    }
}
