//! The named parts of a mesh.

use super::quality::mesh_notes;
use super::summary::size;
use super::table::{Column, Table};
use crate::mesh::{ListedSides, Mesh};
use serde::Serialize;

/// A mesh in the JSON of `groups`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeshRecord {
    /// The file, or the title of the scene.
    pub mesh: String,
    /// The number of points.
    pub points: usize,
    /// How many cells of each element.
    pub elements: Vec<CellsRecord>,
    /// The size of the box around the body along each axis, m.
    pub extent: Vec<f64>,
    /// The groups of the file.
    pub groups: Vec<GroupRecord>,
    /// What must be known of the mesh, one sentence each.
    pub notes: Vec<String>,
}

/// The cells of one element.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CellsRecord {
    /// The name of the element.
    pub element: String,
    /// How many cells have it.
    pub cells: usize,
}

/// A named part of the mesh.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GroupRecord {
    /// The name by which scenes select the group.
    pub name: String,
    /// Cells of the dimension of the mesh.
    pub cells: usize,
    /// Faces of solids, edges of plane cells; those that no cell has are not counted.
    pub sides: usize,
    /// Edges of a curve in a solid.
    pub edges: usize,
    /// The points for which the name stands: those that are listed as such, or else those of the part of the lowest dimension.
    pub points: usize,
    /// The least coordinates of its points, m; empty without points.
    pub from: Vec<f64>,
    /// The greatest coordinates of its points, m; empty without points.
    pub to: Vec<f64>,
}

impl MeshRecord {
    /// What the mesh under this name has.
    pub fn of(name: String, mesh: &Mesh) -> MeshRecord {
        let group = |(name, group): (&String, &crate::mesh::Group)| {
            let bound = |start: f64, pick: fn(f64, f64) -> f64| -> Vec<f64> {
                let along = |k| group.points.iter().map(|&p| mesh.point(p)[k]).fold(start, pick);
                let axes = if group.points.is_empty() { 0 } else { mesh.dimension };
                (0..axes).map(along).collect()
            };
            GroupRecord {
                name: name.clone(),
                cells: group.cells.len(),
                sides: ListedSides::of(mesh, group).sides.len(),
                edges: group.edges.len(),
                points: group.points.len(),
                from: bound(f64::INFINITY, f64::min),
                to: bound(f64::NEG_INFINITY, f64::max),
            }
        };
        let cells = |block: &crate::mesh::CellBlock| CellsRecord {
            element: block.element.name.clone(),
            cells: block.cells().len(),
        };
        MeshRecord {
            mesh: name,
            points: mesh.point_count(),
            elements: mesh.blocks.iter().map(cells).collect(),
            extent: mesh.extent(),
            groups: mesh.groups.iter().map(group).collect(),
            notes: mesh_notes(mesh),
        }
    }

    /// The groups as a table under a line about the mesh.
    pub fn text(&self) -> String {
        let cells: Vec<String> = self.elements.iter().map(|e| format!("{} {}", e.cells, e.element)).collect();
        let head = format!("{}: {} points, {}; {}\n", self.mesh, self.points, cells.join(", "), size(&self.extent));
        let groups = match self.groups.is_empty() {
            true => "The mesh has no groups; a condition such as where = \"z < 0.01\" selects a part of it.\n".into(),
            false => self.table().text(),
        };
        let notes: String = self.notes.iter().map(|note| format!("note: {note}\n")).collect();
        let gap = if notes.is_empty() { "" } else { "\n" };
        format!("{head}\n{groups}{gap}{notes}")
    }

    /// The groups as a table.
    pub fn table(&self) -> Table {
        let mut columns = vec![Column::words("group")];
        columns.extend(["cells", "sides", "edges", "points"].map(Column::numbers));
        columns.extend(["from", "to"].map(|corner| Column::numbers(corner).unit("m")));
        let corner = |x: &[f64]| match x {
            [] => "-".into(),
            _ => x.iter().map(|x| format!("{x:.4}")).collect::<Vec<_>>().join(", "),
        };
        let row = |group: &GroupRecord| {
            let counts = [group.cells, group.sides, group.edges, group.points].map(|n| n.to_string());
            let mut row = vec![group.name.clone()];
            row.extend(counts.into_iter().chain([corner(&group.from), corner(&group.to)]));
            row
        };
        Table::new("groups", format!("Groups of {}", self.mesh), columns, self.groups.iter().map(row))
    }
}
