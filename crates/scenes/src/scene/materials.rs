//! The materials of a body that has no scene.

use super::entry::MaterialTable;
use super::in_memory::InMemory;
use super::material::{MaterialEntries, MaterialEntry};
use crate::error::Result;
use crate::file;
use crate::material::{EnergyMap, MaterialMap};
use crate::mesh::Mesh;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use std::borrow::Cow;
use std::path::Path;
use toml::Table;

/// What a body is made of: one material, or one for each region, as `[material]` and `[[material]]` of a scene state it.
#[derive(Debug, Clone)]
pub struct Materials(MaterialEntries);

impl Materials {
    /// Reads the key `material` of a table, and checks what does not depend on a mesh.
    ///
    /// # Errors
    /// A key is unknown or of the wrong type, a number is out of its range, or the entries do not go together; keys begin with `material`.
    pub fn parse(table: Table) -> Result<Materials> {
        let MaterialTable { mut material } = file::parse_table(table)?;
        material.complete()?;
        material.check()?;
        Ok(Materials(material))
    }

    /// The value of a quantity of the first entry, in the SI unit, if it is the same everywhere.
    pub fn number(&self, key: &str) -> Option<f64> {
        let all = self.0.first().distributions();
        let own = all.into_iter().find(|(own, _)| own == key).and_then(|(_, values)| values.number());
        own.or_else(|| self.0.first().area.filter(|_| key == "area"))
    }

    /// The mesh with membranes and rods where a region names sides of the body.
    ///
    /// # Errors
    /// No shipped element has the functions of a side.
    pub fn attached<'a>(&self, mesh: &'a Mesh) -> Result<Cow<'a, Mesh>> {
        let names: Vec<String> = self.0.all.iter().filter_map(|entry| entry.group.clone()).collect();
        let lists_sides = |name: &String| {
            mesh.groups.get(name).is_some_and(|group| group.cells.is_empty() && !group.sides.is_empty())
        };
        if !names.iter().any(lists_sides) {
            return Ok(Cow::Borrowed(mesh));
        }
        let mut own = mesh.clone();
        own.attach_sides(&names)?;
        Ok(Cow::Owned(own))
    }

    /// The materials of the cells of a mesh, with their density if it is given; files are relative to the folder, unless their names are of
    /// what is in memory.
    ///
    /// # Errors
    /// A cell is in two regions or in none, a region is empty or unknown, data are wrong or do not cover the mesh, or a value is out of
    /// its range; or a surface in space has no thickness.
    pub fn on(&self, mesh: &Mesh, folder: &Path, memory: &InMemory) -> Result<MaterialMap> {
        self.0.on(mesh, folder, None, memory)
    }

    /// Whether every entry has a law of large deformation.
    pub fn has_law(&self) -> bool {
        self.0.all.iter().all(|entry| entry.law.is_some())
    }

    /// The energies of the laws of all cells, if there are laws.
    ///
    /// # Errors
    /// There is no such law, its file is wrong, or a parameter or a direction of fibres is.
    pub fn laws(
        &self,
        mesh: &Mesh,
        material: &MaterialMap,
        folder: &Path,
        memory: &InMemory,
    ) -> Result<Option<EnergyMap>> {
        super::laws::laws_of_cells(&self.0, mesh, material, (folder, memory))
    }

    /// A sentence about what is assumed of the body because no entry gives it, if anything is.
    pub fn assumption(&self, mesh: &Mesh) -> Option<String> {
        self.0.assumption(mesh)
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
