//! The finer body with which the networks of a scene are compared.

use super::input::MeshInput;
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use schemars::JsonSchema;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// `[reference]`: the mesh of the scene with smaller cells, or another mesh of the same body with the same groups.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReferenceEntry {
    /// The edges of all cells are halved this number of times, from 1 to 6. One of `refine` and `mesh` is required.
    pub refine: Option<u32>,
    /// The finer body is another mesh of the same body with the same groups. It has the keys of `[mesh]`, such as `{ file = "fine.msh",
    /// scale = "mm" }`.
    pub mesh: Option<MeshInput>,
}

/// With six halvings a cell becomes 262 144.
const MOST: u32 = 6;

impl ReferenceEntry {
    pub(super) fn check(&self) -> Result<()> {
        match (self.refine, &self.mesh) {
            (Some(times), None) if (1..=MOST).contains(&times) => Ok(()),
            (Some(times), None) => Err(Error::expected("refine", format!("a number from 1 to {MOST}"), times)),
            (None, Some(mesh)) => mesh.check(),
            (Some(_), Some(_)) => Err(Error::new("expected one of \"refine\", \"mesh\", found both")),
            (None, None) => Err(Error::new("expected one of \"refine\", \"mesh\", found none")),
        }
    }

    /// The finer mesh of the body with this mesh; files are relative to the scene at `path`.
    ///
    /// # Errors
    /// The file is wrong, or a cell cannot be divided.
    pub fn build(&self, path: &Path, mesh: &Mesh) -> Result<Mesh> {
        match &self.mesh {
            Some(input) => input.build(path),
            None => {
                let mut fine = mesh.refined()?;
                for _ in 1..self.refine.unwrap_or(1) {
                    fine = fine.refined()?;
                }
                Ok(fine)
            }
        }
    }

    /// The files that it names, relative to `folder`.
    pub fn files(&self, folder: &Path) -> Vec<PathBuf> {
        self.mesh.as_ref().map_or(Vec::new(), |mesh| mesh.files(folder))
    }
}
