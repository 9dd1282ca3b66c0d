//! What a list of elements shows of each.

use super::ElementFile;
use super::cell::Cell;
use super::definition::Definition;
use super::groups::{SpringGroup, spring_groups};
use crate::error::Result;
use crate::file::parse_toml;
use serde::Serialize;
use std::path::Path;

/// What a list of elements shows of one: what its file says, without the proofs and tables of an [`Element`](super::Element), whose exact
/// arithmetic takes most of the time to load it.
#[derive(Debug, Clone, Serialize)]
pub struct Outline {
    /// The name in files and options.
    pub name: String,
    /// The name in headings.
    pub title: String,
    /// The reference cell.
    pub cell: Cell,
    /// The number of nodes.
    pub nodes: usize,
    /// The groups of springs, in the order of the file.
    pub springs: Vec<SpringGroup>,
    /// The number of its type in Gmsh files.
    pub gmsh: Option<i64>,
    /// The number of its type in VTK files.
    pub vtk: Option<i64>,
    /// Where the shape functions are published.
    pub source: Option<String>,
}

impl Outline {
    /// The outline of a shipped file.
    ///
    /// # Errors
    /// None for the shipped files, which are all tested.
    pub fn shipped(file: &ElementFile) -> Result<Outline> {
        Outline::parse(file).map_err(|e| e.in_file(Path::new(&format!("elements/{}.toml", file.name))))
    }

    fn parse(file: &ElementFile) -> Result<Outline> {
        let definition: Definition = parse_toml(file.text)?;
        let positions: Vec<f64> = definition.nodes.iter().flat_map(|n| n.at.iter().map(|c| c.value())).collect();
        let springs = spring_groups(&definition, &positions)?;
        Ok(Outline {
            nodes: definition.nodes.len(),
            name: definition.name,
            title: definition.title,
            cell: definition.cell,
            springs,
            gmsh: file.gmsh,
            vtk: file.vtk,
            source: definition.source,
        })
    }
}
