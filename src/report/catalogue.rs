//! The shipped elements and materials, one line each.

use super::table::{Column, Table};
use crate::element::{Cell, ElementFile, Outline};
use crate::material::Energy;
use serde::Serialize;
use std::collections::BTreeMap;

/// An element in the JSON of `elements`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ElementRecord {
    /// The name by which scenes and commands select it.
    pub name: String,
    /// What the element is.
    pub title: String,
    /// The shape of its cell.
    pub cell: Cell,
    /// The number of nodes.
    pub nodes: usize,
    /// The groups of springs, in the order of the file.
    pub springs: Vec<SpringGroupRecord>,
    /// The number of its type in Gmsh files.
    pub gmsh: Option<i64>,
    /// The number of its type in VTK files.
    pub vtk: Option<i64>,
    /// Where the shape functions are published.
    pub source: Option<String>,
}

/// A group of springs of an element.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpringGroupRecord {
    /// The name by which fits select it.
    pub name: String,
    /// What a spring measures.
    pub kind: String,
    /// How many springs a cell has; one where the whole cell is measured.
    pub springs: usize,
    /// Whether a fit uses the group only where it names it.
    pub optional: bool,
}

/// A material in the JSON of `materials`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MaterialRecord {
    /// The name by which scenes select the energy.
    pub name: String,
    /// What the energy is.
    pub title: String,
    /// The numbers of the energy beside the moduli, with their defaults.
    pub parameters: BTreeMap<String, f64>,
    /// Whether it has a direction of fibres.
    pub fibres: bool,
    /// Where the energy is published.
    pub source: Option<String>,
}

impl ElementRecord {
    /// What the file of an element says of it.
    pub fn of(element: &Outline, file: &ElementFile) -> ElementRecord {
        let springs = element.springs.iter().map(|group| SpringGroupRecord {
            name: group.name.clone(),
            kind: group.kind.name().into(),
            springs: group.nodes.len().max(1),
            optional: group.optional,
        });
        ElementRecord {
            name: element.name.clone(),
            title: element.title.clone(),
            cell: element.cell,
            nodes: element.nodes,
            springs: springs.collect(),
            gmsh: file.gmsh,
            vtk: file.vtk,
            source: element.source.clone(),
        }
    }
}

impl From<&Energy> for MaterialRecord {
    fn from(energy: &Energy) -> MaterialRecord {
        MaterialRecord {
            name: energy.name().into(),
            title: energy.title().into(),
            parameters: energy.parameters().map(|(name, value)| (name.into(), value)).collect(),
            fibres: energy.has_fibres(),
            source: energy.source().map(String::from),
        }
    }
}

/// The elements as a table; groups in parentheses are optional.
pub fn elements_table(elements: &[ElementRecord]) -> Table {
    let columns = vec![
        Column::words("element"),
        Column::numbers("nodes"),
        Column::words("title"),
        Column::sentences("spring groups"),
    ];
    let group = |group: &SpringGroupRecord| match group.optional {
        true => format!("({})", group.name),
        false => group.name.clone(),
    };
    let row = |element: &ElementRecord| {
        let groups: Vec<String> = element.springs.iter().map(group).collect();
        vec![element.name.clone(), element.nodes.to_string(), element.title.clone(), groups.join(", ")]
    };
    let note = "A fit uses the groups in parentheses only where its \"springs\" name them.";
    Table::new("elements", "Elements", columns, elements.iter().map(row)).with_notes([note.to_string()])
}

/// The materials as a table.
pub fn materials_table(materials: &[MaterialRecord]) -> Table {
    let columns = vec![Column::words("material"), Column::words("title"), Column::sentences("parameters")];
    let row = |material: &MaterialRecord| {
        let parameters: Vec<String> =
            material.parameters.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        vec![material.name.clone(), material.title.clone(), parameters.join(", ")]
    };
    let note = "The moduli of every energy follow from \"young\" and \"poisson\" of the scene.";
    Table::new("materials", "Hyperelastic materials", columns, materials.iter().map(row)).with_notes([note.to_string()])
}
