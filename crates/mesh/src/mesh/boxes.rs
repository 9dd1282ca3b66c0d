//! Generates rectangles and bricks that are filled with one element.

use super::affine::Affine;
use super::mesh::{CellBlock, CellIndex, Group, Mesh, sorted};
use super::places::Places;
use crate::bound;
use crate::element::{Cell, Element};
use crate::error::{Error, ErrorKind, Result};
use crate::range;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// The largest number of cells, see [`bound::CELLS`].
const MOST_CELLS: usize = bound::CELLS as usize;

/// A box of `cells` equal cells per direction.
///
/// A simplex divides each square or cube into d! simplices along its main diagonal (Kuhn 1960), a wedge into two
/// wedges, a pyramid into six pyramids around the centre. The groups of the mesh are `xmin`, `xmax`, `ymin`, … for the
/// faces and `body` for the cells.
#[derive(Debug, Clone)]
pub struct BoxMesh {
    /// The element of all cells.
    pub element: Arc<Element>,
    /// The lengths of the sides, `[dimension]`, m.
    pub size: Vec<f64>,
    /// The number of cells in each direction, `[dimension]`.
    pub cells: Vec<usize>,
    /// The corner with the least coordinates, `[dimension]`, m.
    pub origin: Vec<f64>,
}

impl BoxMesh {
    /// Generates the mesh.
    ///
    /// # Errors
    /// A list does not have one entry per dimension, or a size or a number of cells is not positive or is too large.
    pub fn build(&self) -> Result<Mesh> {
        let d = self.element.dimension();
        self.check(d)?;
        let parts = parts(self.element.cell);
        let mut mesh = Mesh::of_points(d, Vec::new());
        let mut connectivity = Vec::new();
        // Points of neighbouring cells coincide; their positions are compared in units of 2⁻²⁰ of a cell.
        let mut known: HashMap<Vec<u64>, usize> = HashMap::new();
        for cube in 0..self.cells.iter().product() {
            let mut rest = cube;
            let corner: Vec<usize> = self
                .cells
                .iter()
                .map(|n| {
                    let i = rest % n;
                    rest /= n;
                    i
                })
                .collect();
            for (part, at) in
                parts.iter().flat_map(|part| self.element.positions.chunks_exact(d).map(move |at| (part, at)))
            {
                let unit = part.place(at);
                let place: Vec<f64> = corner.iter().zip(&unit).map(|(c, u)| *c as f64 + u).collect();
                // Places in units of a millionth of a cell: nodes that cells share are computed apart, and differ by
                // rounding.
                let key = place.iter().map(|p| (p * (1u64 << 20) as f64).round() as u64).collect();
                let next = mesh.point_count();
                let index = *known.entry(key).or_insert(next);
                if index == next {
                    mesh.points.extend((0..d).map(|k| self.origin[k] + place[k] / self.cells[k] as f64 * self.size[k]));
                }
                connectivity.push(index);
            }
        }
        mesh.blocks.push(CellBlock { element: self.element.clone(), connectivity });
        mesh.groups = self.groups(&mesh);
        mesh.orient(false)?;
        // Simplices of a cube come in both orientations by construction, which is no fault of a file that should be told.
        mesh.reversed = 0;
        mesh.quality.pieces = Some(mesh.pieces().len());
        mesh.quality.coincident = Places::of(&mesh).map(|places| places.coincident());
        Ok(mesh)
    }

    fn check(&self, d: usize) -> Result<()> {
        if d < 2 {
            return Err(Error::expected("element", "an element of two or three dimensions", &self.element.name));
        }
        if parts(self.element.cell).is_empty() {
            return Err(Error::expected("element", "an element whose cells fill a box", &self.element.name));
        }
        let lengths = [("size", self.size.len()), ("cells", self.cells.len()), ("origin", self.origin.len())];
        if let Some((key, found)) = lengths.iter().find(|(_, found)| *found != d) {
            return Err(Error::expected(*key, format!("{d} entries for {}", self.element.name), found));
        }
        self.size.iter().try_for_each(|size| range::positive("size", *size, "m").map(|_| ()))?;
        self.origin.iter().try_for_each(|x| range::bounded("origin", *x, "m").map(|_| ()))?;
        // Counts of a user may overflow the product, which then is above any limit.
        let total = self.cells.iter().try_fold(1usize, |a, &n| a.checked_mul(n)).unwrap_or(usize::MAX);
        if total == 0 || total > MOST_CELLS {
            let expected = format!("1 to {MOST_CELLS} cells in all");
            let error = Error::expected("cells", expected, format!("{:?}", self.cells));
            return Err(if total == 0 { error } else { error.of_kind(ErrorKind::Limit) });
        }
        Ok(())
    }

    fn groups(&self, mesh: &Mesh) -> BTreeMap<String, Group> {
        let mut groups: BTreeMap<String, Group> = BTreeMap::new();
        let body = groups.entry("body".into()).or_default();
        body.points = (0..mesh.point_count()).collect();
        body.cells = (0..mesh.blocks[0].cells().len()).map(|cell| CellIndex { block: 0, cell }).collect();
        for (k, axis) in ["x", "y", "z"].iter().enumerate().take(mesh.dimension) {
            for (end, at) in [("min", self.origin[k]), ("max", self.origin[k] + self.size[k])] {
                // The last layer is a product of the size and a share, which may be a rounding beside the end.
                let near = |&p: &usize| (mesh.point(p)[k] - at).abs() <= 1e-9 * self.size[k];
                let mut group = Group { points: (0..mesh.point_count()).filter(near).collect(), ..Group::default() };
                for nodes in mesh.blocks[0].cells() {
                    for side in self.element.sides() {
                        let points: Vec<usize> = side.nodes.iter().map(|&a| nodes[a]).collect();
                        if points.iter().all(near) {
                            group.sides.push(sorted(&points));
                        }
                    }
                }
                groups.insert(format!("{axis}{end}"), group);
            }
        }
        groups
    }
}

/// The maps of reference cells that fill the unit cube; none for a cell that does not fill a box.
pub(super) fn parts(cell: Cell) -> Vec<Affine> {
    let d = cell.dimension();
    let unit = |k: usize, length: f64| (0..d).map(|i| if i == k { length } else { 0.0 }).collect::<Vec<_>>();
    // The simplices 0, e_p, e_p + e_q, … for each order p, q, … of the directions.
    let walk = |order: &&[usize]| {
        let mut corner = vec![0.0; d];
        let step = |&k: &usize| {
            corner[k] = 1.0;
            corner.clone()
        };
        Affine { origin: vec![0.0; d], edges: order.iter().map(step).collect() }
    };
    let plane: &[&[usize]] = &[&[0, 1], &[1, 0]];
    let space: &[&[usize]] = &[&[0, 1, 2], &[0, 2, 1], &[1, 0, 2], &[1, 2, 0], &[2, 0, 1], &[2, 1, 0]];
    match cell {
        Cell::Interval | Cell::Quadrilateral | Cell::Hexahedron => {
            vec![Affine { origin: vec![0.5; d], edges: (0..d).map(|k| unit(k, 0.5)).collect() }]
        }
        Cell::Triangle => plane.iter().map(walk).collect(),
        Cell::Tetrahedron => space.iter().map(walk).collect(),
        Cell::Wedge => {
            let raise = |mut part: Affine| {
                part.origin[2] = 0.5;
                part.edges.push(unit(2, 0.5));
                part
            };
            plane.iter().map(walk).map(raise).collect()
        }
        // The base of each is a face of the cube, and its apex is the centre.
        Cell::Pyramid => {
            let stand = |k: usize, at: f64| {
                let origin: Vec<f64> = (0..3).map(|i| if i == k { at } else { 0.5 }).collect();
                Affine { origin, edges: vec![unit((k + 1) % 3, 0.5), unit((k + 2) % 3, 0.5), unit(k, 0.5 - at)] }
            };
            (0..3).flat_map(|k| [stand(k, 0.0), stand(k, 1.0)]).collect()
        }
        Cell::Pentagon => Vec::new(),
    }
}
