//! The finer body with which the networks of a scene are compared.

use super::input::MeshInput;
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::outcome::Standard;
use schemars::JsonSchema;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// `[reference]`: what errors of displacements are relative to. Besides the finite elements of the mesh these are the same cells with
/// quadratic functions, smaller cells, or another mesh of the same body with the same groups.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReferenceEntry {
    /// Errors are relative to the finite elements of the mesh (`cells`), or to those of the same cells with quadratic functions (`quadratic`),
    /// after `refine`. One of `from`, `refine` and `mesh` is required. Without `[reference]` errors are relative to quadratic elements where linear
    /// cells lock (from Poisson's ratio 0.4 on, without a law) or a body of one cell across bends, and that takes at most three times the time of the run,
    /// and to the cells elsewhere.
    pub from: Option<From>,
    /// The edges of all cells are halved this number of times, from 1 to 6.
    pub refine: Option<u32>,
    /// The finer body is another mesh of the same body with the same groups. It has the keys of `[mesh]`, such as `{ file = "fine.msh",
    /// scale = "mm" }`.
    pub mesh: Option<MeshInput>,
}

/// The functions of the cells that errors are relative to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum From {
    /// The cells of the mesh keep their own functions.
    Cells,
    /// The same cells get quadratic functions.
    Quadratic,
}

/// With six halvings a cell becomes 262 144.
const MOST: u32 = 6;

impl ReferenceEntry {
    /// The finite elements of the mesh of the scene.
    pub(super) fn of_cells() -> ReferenceEntry {
        ReferenceEntry { from: Some(From::Cells), refine: None, mesh: None }
    }

    pub(super) fn check(&self) -> Result<()> {
        if let Some(times) = self.refine
            && !(1..=MOST).contains(&times)
        {
            return Err(Error::expected("refine", format!("a number from 1 to {MOST}"), times));
        }
        match (self.from, self.refine, &self.mesh) {
            (None, None, None) => Err(Error::new("expected one of \"from\", \"refine\", \"mesh\", found none")),
            (Some(_), _, Some(_)) => Err(Error::new("expected one of \"from\", \"mesh\", found both")),
            (None, Some(_), Some(_)) => Err(Error::new("expected one of \"refine\", \"mesh\", found both")),
            (Some(From::Cells), Some(_), None) => {
                Err(Error::expected("refine", "no key beside from = \"cells\"", self.refine.unwrap_or_default()))
            }
            (None, None, Some(mesh)) => mesh.check(),
            (_, _, None) => Ok(()),
        }
    }

    /// Whether errors are relative to the finite elements of the mesh of the scene.
    pub fn is_of_cells(&self) -> bool {
        self.from == Some(From::Cells)
    }

    /// What they are relative to otherwise.
    pub fn standard(&self) -> Standard {
        match (self.from, self.refine) {
            (Some(From::Quadratic), None) => Standard::Quadratic,
            (Some(From::Quadratic), Some(_)) => Standard::QuadraticHalved,
            (Some(From::Cells) | None, _) => Standard::FinerBody,
        }
    }

    /// The finer mesh of the body with this mesh; files are relative to the scene at `path`.
    ///
    /// # Errors
    /// The file is wrong, or a cell cannot be divided.
    pub fn build(&self, path: &Path, mesh: &Mesh) -> Result<Mesh> {
        match &self.mesh {
            Some(input) => input.build(path, &|_| {}),
            None => {
                let mut fine = mesh.clone();
                for _ in 0..self.refine.unwrap_or(0) {
                    fine = fine.refined()?;
                }
                if self.from == Some(From::Quadratic) { fine.elevated() } else { Ok(fine) }
            }
        }
    }

    /// The files that it names, relative to `folder`.
    pub fn files(&self, folder: &Path) -> Vec<PathBuf> {
        self.mesh.as_ref().map_or(Vec::new(), |mesh| mesh.files(folder))
    }
}
