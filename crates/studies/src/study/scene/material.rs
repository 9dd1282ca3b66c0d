//! The `[material]` or the `[[material]]` of a scene.

use super::distribution::{self, Distribution};
use super::part::Part;
use super::value;
use crate::error::{Error, Result};
use crate::material::{Material, Plane};
use crate::range;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};
use std::borrow::Cow;
use std::fmt;

/// The material of a body, or of one of its regions.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MaterialEntry {
    /// The group of cells that have the material.
    pub group: Option<String>,
    /// The condition on the nodes of the cells that have the material.
    #[serde(rename = "where")]
    pub condition: Option<String>,
    /// Young's modulus, Pa.
    #[serde(deserialize_with = "distribution::pressure")]
    #[schemars(schema_with = "distribution::schema")]
    pub young: Distribution,
    /// Poisson's ratio.
    #[serde(deserialize_with = "distribution::ratio")]
    #[schemars(schema_with = "distribution::schema")]
    pub poisson: Distribution,
    pub plane: Option<Plane>,
    /// The thickness, m.
    #[serde(default, deserialize_with = "distribution::optional_length")]
    #[schemars(schema_with = "distribution::schema")]
    pub thickness: Option<Distribution>,
    /// The cross-section of rods, m².
    #[serde(default, deserialize_with = "value::optional_area")]
    #[schemars(schema_with = "value::quantity")]
    pub area: Option<f64>,
    /// The density, kg/m³.
    #[serde(default, deserialize_with = "distribution::optional_density")]
    #[schemars(schema_with = "distribution::schema")]
    pub density: Option<Distribution>,
    /// The name of a shipped energy, or a path relative to the scene that ends in .toml. Deformations are large then.
    pub law: Option<String>,
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
        struct OneOrMany;
        impl<'de> Visitor<'de> for OneOrMany {
            type Value = MaterialEntries;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a table [material] or tables [[material]]")
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> std::result::Result<MaterialEntries, A::Error> {
                let one = MaterialEntry::deserialize(MapAccessDeserializer::new(map))?;
                Ok(MaterialEntries { all: vec![one], is_list: false })
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> std::result::Result<MaterialEntries, A::Error> {
                let all = Deserialize::deserialize(SeqAccessDeserializer::new(list))?;
                Ok(MaterialEntries { all, is_list: true })
            }
        }
        deserializer.deserialize_any(OneOrMany)
    }
}

impl JsonSchema for MaterialEntries {
    fn schema_name() -> Cow<'static, str> {
        "MaterialEntries".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let one = generator.subschema_for::<MaterialEntry>();
        json_schema!({
            "description": "One material for the whole body, or one for each region.",
            "anyOf": [one, { "type": "array", "items": one }],
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

    /// The name of the region in reports.
    pub fn name(&self) -> String {
        self.group.clone().or_else(|| self.condition.clone()).unwrap_or_else(|| "rest".into())
    }

    /// The quantities that may differ from place to place, with their keys.
    pub fn distributions(&self) -> impl Iterator<Item = (&'static str, &Distribution)> {
        let required = [("young", &self.young), ("poisson", &self.poisson)];
        let thickness = self.thickness.as_ref().map(|thickness| ("thickness", thickness));
        let density = self.density.as_ref().map(|density| ("density", density));
        required.into_iter().chain(thickness).chain(density)
    }

    /// The checks that do not depend on the mesh.
    fn check(&self) -> Result<()> {
        self.part()?;
        for (key, distribution) in self.distributions() {
            if let distribution::Source::Data(data) = &distribution.source {
                data.interpolation().map_err(|e| e.under(key))?;
                range::positive("scale", data.scale, "metres per unit of the file").map_err(|e| e.under(key))?;
            }
        }
        let dimension = if self.plane.is_some() || self.thickness.is_some() { 2 } else { 3 };
        // Plane stress admits larger ν than a solid; a solid is checked again when the mesh is known.
        let state = if dimension == 3 { Some(Plane::Stress) } else { self.plane };
        // A value that varies is checked in each cell.
        let young = self.young.number().unwrap_or(1.0);
        let poisson = self.poisson.number().unwrap_or(0.0);
        let thickness = self.thickness.as_ref().and_then(Distribution::number);
        Material::for_body(2, young, poisson, state, thickness)?;
        let density = self.density.as_ref().and_then(Distribution::number);
        density.map_or(Ok(()), |density| range::positive("density", density, "kg/m³").map(|_| ()))
    }
}

impl MaterialEntries {
    /// The key of an entry.
    pub fn key(&self, entry: usize) -> String {
        if self.is_list { format!("material[{entry}]") } else { "material".into() }
    }

    /// The first entry; there is one after [`MaterialEntries::check`].
    pub fn first(&self) -> &MaterialEntry {
        &self.all[0]
    }

    /// Whether all entries have a density.
    pub fn has_density(&self) -> bool {
        self.all.iter().all(|entry| entry.density.is_some())
    }

    /// Whether the material is the same in all cells.
    pub fn is_uniform(&self) -> bool {
        let varies = |entry: &MaterialEntry| entry.distributions().any(|(_, values)| values.number().is_none());
        self.all.len() == 1 && !self.all.iter().any(varies)
    }

    /// The checks that do not depend on the mesh.
    ///
    /// # Errors
    /// There is no entry, several have no part of the mesh, they do not go together, or a number is out of its range.
    pub fn check(&self) -> Result<()> {
        if self.all.is_empty() {
            return Err(Error::expected("material", "at least one [[material]]", "none"));
        }
        let mut rest = None;
        for (i, entry) in self.all.iter().enumerate() {
            entry.check().map_err(|e| e.under(self.key(i)))?;
            let first = self.first();
            if entry.part()? == Part::Everything
                && let Some(other) = rest.replace(i)
            {
                let expected = format!("\"group\" or \"where\": {} has what is left of the body", self.key(other));
                return Err(Error::expected(self.key(i), expected, "neither"));
            }
            let same = |key: &str, is_same: bool| match is_same {
                true => Ok(()),
                false => {
                    let expected = format!("that of {}", self.key(0));
                    Err(Error::expected(format!("{}.{key}", self.key(i)), expected, "another"))
                }
            };
            same("plane", entry.plane.unwrap_or(Plane::Stress) == first.plane.unwrap_or(Plane::Stress))?;
            same("law", entry.law == first.law)?;
            if entry.density.is_some() != first.density.is_some() {
                let expected = "a density in every [[material]] or in none";
                return Err(Error::expected(format!("{}.density", self.key(i)), expected, "one in some"));
            }
        }
        if self.first().law.is_some() && !self.is_uniform() {
            let expected = "one material in all cells with a \"law\"";
            return Err(Error::expected(format!("{}.law", self.key(0)), expected, "several, or one that varies"));
        }
        Ok(())
    }
}
