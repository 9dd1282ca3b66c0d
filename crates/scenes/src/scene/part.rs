//! A part of the mesh in a scene.

use crate::error::{Error, Result};
use crate::extent::extends;
use crate::mesh::{Mesh, Selection};
use crate::symbolic::Scope;

/// A part of the mesh, as a scene names it. A condition is parsed again once the dimension of the mesh is known.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    /// The group with this name.
    Group(String),
    /// The points that satisfy this condition on their coordinates.
    Where(String),
    /// The whole mesh.
    Everything,
}

impl Part {
    pub(super) fn optional(group: Option<String>, condition: Option<String>) -> Result<Part> {
        match (group, condition) {
            (Some(_), Some(_)) => Err(Error::new("expected \"group\" or \"where\", found both")),
            (Some(name), None) => Ok(Part::Group(name)),
            (None, Some(text)) => {
                // Reports at once what is wrong in any dimension.
                Scope::of_place(3).predicate(&text).map_err(|e| e.under("where"))?;
                Ok(Part::Where(text))
            }
            (None, None) => Ok(Part::Everything),
        }
    }

    /// Makes a part as [`Part::optional`] does, but does not accept the whole mesh.
    pub(super) fn required(group: Option<String>, condition: Option<String>) -> Result<Part> {
        match Part::optional(group, condition)? {
            Part::Everything => Err(Error::new("expected \"group\" or \"where\", found neither")),
            part => Ok(part),
        }
    }

    /// The part as a selection in a mesh of this dimension.
    ///
    /// # Errors
    /// The condition contains z in the plane.
    pub fn selection(&self, dimension: usize) -> Result<Selection> {
        Ok(match self {
            Part::Group(name) => Selection::Group(name.clone()),
            Part::Where(text) => {
                let scope = Scope::of_place(dimension);
                Selection::Where(scope.predicate(text).map_err(|e| e.under("where"))?)
            }
            Part::Everything => Selection::Everything,
        })
    }

    /// Whether all cells of the mesh belong to the part.
    pub(super) fn is_whole(&self, mesh: &Mesh) -> bool {
        let cells = self.selection(mesh.dimension).and_then(|selection| selection.cells(mesh));
        cells.is_ok_and(|cells| cells.len() == mesh.cell_count())
    }

    /// The error of a part that has no points or cells, with where the body is if a condition selects the part.
    pub(crate) fn without_members(&self, problem: &str, mesh: &Mesh) -> Error {
        match self {
            Part::Where(_) => Error::new(format!("{problem}: the body extends {}", extends(mesh))),
            Part::Group(_) | Part::Everything => Error::new(problem),
        }
    }
}
