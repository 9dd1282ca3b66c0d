//! The named parts of a mesh.

use super::object::Object;
use super::quality::mesh_notes;
use super::summary::size;
use super::table::{Column, Table};
use crate::mesh::{CellBlock, Group, ListedSides, Mesh};
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};
use serde_json::{Value, json};

/// A mesh with the name of its file or scene, whose groups are listed.
#[derive(Debug, Clone)]
pub struct NamedMesh {
    /// The file, or the title of the scene.
    pub name: String,
    /// The mesh.
    pub mesh: Mesh,
}

/// What is counted of a group: cells of the dimension of the mesh; faces of solids or edges of plane cells, without those that no cell has; edges
/// of a curve in a solid; and the points for which the name stands, those that are listed as such, or else those of the part of the lowest
/// dimension.
const COUNTS: [&str; 4] = ["cells", "sides", "edges", "points"];
/// The least and the greatest coordinates of the points of a group, m; empty without points.
const CORNERS: [&str; 2] = ["from", "to"];

impl Serialize for NamedMesh {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let NamedMesh { name, mesh } = self;
        let cells = |block: &CellBlock| {
            Object(vec![("element", json!(block.element.name)), ("cells", json!(block.cells().len()))])
        };
        let group = |(name, group): (&String, &Group)| {
            let counts = COUNTS.into_iter().zip(self.counts(group).map(Value::from));
            let corners = CORNERS.into_iter().zip(self.corners(group).map(Value::from));
            Object([("name", json!(name))].into_iter().chain(counts).chain(corners).collect())
        };
        let mut keys = to.serialize_struct("NamedMesh", 6)?;
        keys.serialize_field("mesh", name)?;
        keys.serialize_field("points", &mesh.point_count())?;
        keys.serialize_field("elements", &mesh.blocks.iter().map(cells).collect::<Vec<_>>())?;
        keys.serialize_field("extent", &mesh.extent())?;
        keys.serialize_field("groups", &mesh.groups.iter().map(group).collect::<Vec<_>>())?;
        keys.serialize_field("notes", &mesh_notes(mesh))?;
        keys.end()
    }
}

impl NamedMesh {
    /// By [`COUNTS`].
    fn counts(&self, group: &Group) -> [usize; 4] {
        let sides = ListedSides::of(&self.mesh, group).sides.len();
        [group.cells.len(), sides, group.edges.len(), group.points.len()]
    }

    /// By [`CORNERS`].
    fn corners(&self, group: &Group) -> [Vec<f64>; 2] {
        let bound = |(start, pick): (f64, fn(f64, f64) -> f64)| {
            let along = |k| group.points.iter().map(|&p| self.mesh.point(p)[k]).fold(start, pick);
            let axes = if group.points.is_empty() { 0 } else { self.mesh.dimension };
            (0..axes).map(along).collect()
        };
        [(f64::INFINITY, f64::min as fn(f64, f64) -> f64), (f64::NEG_INFINITY, f64::max)].map(bound)
    }

    /// The groups as a table under a line about the mesh.
    pub fn text(&self) -> String {
        let NamedMesh { name, mesh } = self;
        let cells: Vec<String> =
            mesh.blocks.iter().map(|block| format!("{} {}", block.cells().len(), block.element.name)).collect();
        let head = format!("{name}: {} points, {}; {}\n", mesh.point_count(), cells.join(", "), size(&mesh.extent()));
        let groups = match mesh.groups.is_empty() {
            true => "The mesh has no groups; a condition such as where = \"z < 0.01\" selects a part of it.\n".into(),
            false => self.table().text(),
        };
        let notes: String = mesh_notes(mesh).iter().map(|note| format!("note: {note}\n")).collect();
        let gap = if notes.is_empty() { "" } else { "\n" };
        format!("{head}\n{groups}{gap}{notes}")
    }

    /// The groups as a table.
    pub fn table(&self) -> Table {
        let mut columns = vec![Column::words("group")];
        columns.extend(COUNTS.map(Column::numbers));
        columns.extend(CORNERS.map(|corner| Column::numbers(corner).unit("m")));
        let corner = |x: Vec<f64>| match &x[..] {
            [] => "-".into(),
            _ => x.iter().map(|x| format!("{x:.4}")).collect::<Vec<_>>().join(", "),
        };
        let row = |(name, group): (&String, &Group)| {
            let counts = self.counts(group).map(|n| n.to_string()).into_iter();
            [name.clone()].into_iter().chain(counts).chain(self.corners(group).map(corner)).collect::<Vec<_>>()
        };
        Table::new("groups", format!("Groups of {}", self.name), columns, self.mesh.groups.iter().map(row))
    }
}
