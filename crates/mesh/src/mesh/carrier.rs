//! What a total force on a part of a mesh is shared over.

use super::mesh::{CellIndex, Mesh, SideIndex};
use super::selection::{Selection, group, is_selected, outer_sides, whole_cells};
use crate::error::Result;

/// What a total force on a part is shared over.
#[derive(Debug, Clone, PartialEq)]
pub enum Carrier {
    /// Sides, by their shape functions.
    Sides(Vec<SideIndex>),
    /// Cells, by their shape functions.
    Cells(Vec<CellIndex>),
    /// Points alone, in equal shares.
    Points(Vec<usize>),
}

impl Selection {
    /// What a total force on the part is shared over.
    ///
    /// A group that lists curves, sides or cells has them, in this order; curves have points alone. If it lists points besides, which are not those of
    /// what else it lists, it is a set of points. A condition and a set of points select what has all
    /// its points in them: of a solid its outer sides or else its cells; of a plane mesh or a surface its cells or its outer sides, whichever have more of
    /// the points; of a curve its points alone. A set of points has sides or cells only if no point is left over: it would have no force.
    ///
    /// # Errors
    /// There is no such group, or it lists sides that no cell has.
    pub fn carrier(&self, mesh: &Mesh) -> Result<Carrier> {
        let points = self.points(mesh)?;
        let mut least = 1;
        if let Selection::Group(name) = self {
            let group = group(mesh, name)?;
            // Listed points are a set of points, unless they are those of what else is listed.
            let is_meant = |of: &mut dyn Iterator<Item = usize>| {
                let mut of: Vec<usize> = if group.lists_points { of.collect() } else { return true };
                of.sort_unstable();
                of.dedup();
                of == points
            };
            let has_edges = !group.edges.is_empty();
            if has_edges && !group.lists_points {
                return Ok(Carrier::Points(points));
            }
            if !group.sides.is_empty() && is_meant(&mut group.sides.iter().flatten().copied()) {
                return Ok(Carrier::Sides(self.sides(mesh)?));
            }
            if !group.cells.is_empty() && is_meant(&mut group.cells.iter().flat_map(|c| mesh.cell_nodes(*c)).copied()) {
                return Ok(Carrier::Cells(group.cells.clone()));
            }
            least = points.len().max(1);
        }
        let is_selected = is_selected(mesh, &points);
        let covered = |nodes: &mut dyn Iterator<Item = usize>| {
            let mut left = is_selected.clone();
            nodes.filter(|&p| std::mem::take(&mut left[p])).count()
        };
        let (sides, cells) = match mesh.cell_dimension() {
            1 => (Vec::new(), Vec::new()),
            _ => (outer_sides(mesh, &is_selected), whole_cells(mesh, &is_selected)),
        };
        let on_sides = covered(&mut sides.iter().flat_map(|side| mesh.side_points(side)));
        let in_cells = covered(&mut cells.iter().flat_map(|cell| mesh.cell_nodes(*cell).iter().copied()));
        // An ear, a cell whose points are all on the outline, is no area; a column of cells is one.
        let is_area = mesh.cell_dimension() == 2 && in_cells >= on_sides;
        Ok(match (on_sides >= least, in_cells >= least) {
            (_, true) if is_area => Carrier::Cells(cells),
            (true, _) => Carrier::Sides(sides),
            (false, true) => Carrier::Cells(cells),
            (false, false) => Carrier::Points(points),
        })
    }
}
