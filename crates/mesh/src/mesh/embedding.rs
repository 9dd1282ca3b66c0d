//! Where the points of one mesh lie in the cells of another mesh of the same body.

use super::mesh::{CellIndex, Mesh};
use super::space::{ends, spatial};
use crate::error::{Error, ErrorKind, Result};
use crate::springs::distance;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};

/// The shape functions of the cells of a mesh at given points: with `P_pa` the function of its point a at point p, values at
/// its points become `Σ_a P_pa u_a` at the given points, and forces on these become `Σ_p P_pa f_p` on its own points, which do the
/// same work.
#[derive(Debug, Clone, PartialEq)]
pub struct Embedding {
    /// The points of the mesh whose functions do not vanish at each given point, with their values.
    rows: Vec<Vec<(usize, f64)>>,
    /// The cell of the mesh in which each given point is, or the nearest to it.
    pub cells: Vec<CellIndex>,
    dimension: usize,
    /// The number of points of the mesh.
    points: usize,
    /// The number of given points outside all cells, whose values are extrapolated from the nearest cell.
    pub outside: usize,
    /// How many times as large, about its centre, the cell of each given point has to be to have it; 1 for a point that it has.
    pub multiples: Vec<f64>,
}

/// The largest distance of a point from the centre of its cell, as a multiple of that of the border in its direction. Meshes of one
/// curved body differ near its surface, most of all at sharp rims, where cells are thin.
const FARTHEST: f64 = 3.0;
/// The multiples that are tried. The first one is the cell itself, but for rounding; the steps grow, because few points
/// lie far outside.
const MULTIPLES: [f64; 9] = [1.0 + 1e-8, 1.02, 1.08, 1.2, 1.4, 1.6, 2.0, 2.5, FARTHEST];
/// Newton's steps to the place of a point at most: a point that is not found then is outside, where a curved cell is
/// folded.
const ITERATIONS: usize = 30;
/// A shape function below this vanishes at a point: places in cells are found to rounding, and cells that were halved six times have
/// functions of 1/64.
const VANISHING: f64 = 1e-6;
/// A point that is as far inside a cell, relative to the size of the cell, is not on a side that two bodies share, but for coarse digits.
const DEEP: f64 = 1e-3;

impl Embedding {
    /// Finds the cells of `points`, `[points × dimension]`, m.
    ///
    /// # Errors
    /// The cells have another dimension than the space (kind `Unsupported`), or a point is far from all cells.
    pub fn of(points: &[f64], mesh: &Mesh) -> Result<Embedding> {
        let d = mesh.dimension;
        if mesh.cell_dimension() != d {
            let found = "surfaces or curves in space";
            return Err(
                Error::expected("cells", "solids, or plane cells in the plane", found).of_kind(ErrorKind::Unsupported)
            );
        }
        let bins = Bins::of(mesh);
        // Points are searched for independently and collected in their order.
        let found: Vec<Option<Found>> = points.par_chunks_exact(d).map(|x| bins.find(mesh, x)).collect();
        let (mut rows, mut cells, mut outside) = (Vec::with_capacity(found.len()), Vec::with_capacity(found.len()), 0);
        let mut multiples = Vec::with_capacity(found.len());
        for (found, x) in found.into_iter().zip(points.chunks_exact(d)) {
            let far = || {
                Error::expected(
                    "points",
                    "points in the cells of the other mesh, or near them",
                    format!("one at {x:?} m"),
                )
            };
            let (row, cell, multiple) = found.ok_or_else(far)?;
            outside += usize::from(multiple > 0);
            multiples.push(if multiple > 0 { MULTIPLES[multiple] } else { 1.0 });
            rows.push(row);
            cells.push(cell);
        }
        Ok(Embedding { rows, cells, dimension: d, points: mesh.point_count(), outside, multiples })
    }

    /// The values at the given points of values at the points of the mesh, both `[points · dimension]`.
    pub fn interpolate(&self, values: &[f64]) -> Vec<f64> {
        let d = self.dimension;
        let at = |row: &[(usize, f64)], k: usize| row.iter().map(|(a, n)| n * values[a * d + k]).sum();
        self.rows.iter().flat_map(|row| (0..d).map(move |k| at(row, k))).collect()
    }

    /// The given points, ascending, where only functions of selected points of the mesh do not vanish: those on its selected points, and on
    /// edges, sides and cells with all points selected.
    pub(super) fn carried_by(&self, is_selected: &[bool]) -> Vec<usize> {
        let is_carried = |row: &[(usize, f64)]| row.iter().all(|&(a, n)| is_selected[a] || n.abs() < VANISHING);
        (0..self.rows.len()).filter(|&p| is_carried(&self.rows[p])).collect()
    }

    /// The forces on the points of the mesh that do the same work as forces on the given points, both `[points · dimension]`.
    pub fn restrict(&self, forces: &[f64]) -> Vec<f64> {
        let d = self.dimension;
        let mut own = vec![0.0; self.points * d];
        for (row, force) in self.rows.iter().zip(forces.chunks_exact(d)) {
            for (a, n) in row {
                own[a * d..(a + 1) * d].iter_mut().zip(force).for_each(|(own, f)| *own += n * f);
            }
        }
        own
    }
}

/// The cells of a mesh that have a part of another piece inside them: a point, the middle of a cell, or a place half way from there to a node.
/// `piece_of` is the piece of each point.
pub(super) fn cells_of_two_pieces(mesh: &Mesh, piece_of: &[usize]) -> HashSet<CellIndex> {
    let bins = Bins::of(mesh);
    let cells: Vec<CellIndex> = mesh.cell_indices().filter(|cell| mesh.is_of_body(*cell)).collect();
    let piece = |cell: CellIndex| piece_of[mesh.cell_nodes(cell)[0]];
    let at = |x: &[f64], own: usize| bins.around(mesh, x, |cell| piece(cell) != own);
    let of_points = (0..mesh.point_count()).into_par_iter().filter_map(|p| at(mesh.point(p), piece_of[p]));
    let of_cell = |&cell: &CellIndex| {
        let middle = mesh.mean_place(mesh.cell_nodes(cell));
        let half_way = |&p: &usize| mesh.point(p).iter().zip(&middle).map(|(a, b)| 0.5 * (a + b)).collect::<Vec<f64>>();
        let places = std::iter::once(middle.clone()).chain(mesh.cell_nodes(cell).iter().map(half_way));
        places.filter_map(|x| at(&x, piece(cell))).collect::<Vec<CellIndex>>()
    };
    of_points.chain(cells.par_iter().flat_map_iter(of_cell)).collect()
}

/// The shape functions at a point that do not vanish, the cell, and the index of the least multiple of it that has the point.
type Found = (Vec<(usize, f64)>, CellIndex, usize);

/// The cells by the bins that their surroundings meet.
struct Bins {
    width: f64,
    boxes: Vec<CellBox>,
    /// Indices of boxes.
    cells: HashMap<[i64; 3], Vec<usize>>,
}

impl Bins {
    fn of(mesh: &Mesh) -> Bins {
        let of_body = mesh.cell_indices().filter(|cell| mesh.is_of_body(*cell));
        let boxes: Vec<CellBox> = of_body.map(|cell| CellBox::of(mesh, cell)).collect();
        // Bins as wide as the mean box: a cell is in few of them, and a bin has few cells.
        let mean =
            boxes.iter().map(|of| distance(&of.around(0), &of.around(1))).sum::<f64>() / boxes.len().max(1) as f64;
        let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
        for (index, of) in boxes.iter().enumerate() {
            let (from, to) = (bin(&of.around(0), mean), bin(&of.around(1), mean));
            for i in from[0]..=to[0] {
                for j in from[1]..=to[1] {
                    for k in from[2]..=to[2] {
                        cells.entry([i, j, k]).or_default().push(index);
                    }
                }
            }
        }
        Bins { width: mean, boxes, cells }
    }

    /// An accepted cell that has x inside, farther from its sides than [`DEEP`].
    fn around(&self, mesh: &Mesh, x: &[f64], accepts: impl Fn(CellIndex) -> bool) -> Option<CellIndex> {
        let place = spatial(x);
        let near = self.cells.get(&bin(&place, self.width))?.iter().map(|&index| &self.boxes[index]);
        let is_deep = |of: &&CellBox| {
            let cell = mesh.blocks[of.cell.block].element.cell;
            local(mesh, of.cell, x).is_some_and(|(_, at)| {
                let grown: Vec<f64> = at.iter().zip(cell.centre()).map(|(a, c)| c + (a - c) / (1.0 - DEEP)).collect();
                cell.contains(&grown)
            })
        };
        near.filter(|of| of.least(&place) == 0 && accepts(of.cell)).find(is_deep).map(|of| of.cell)
    }

    /// The shape functions at x of the cell that has it, or is nearest to having it, and whether it has it. Cells whose boxes have x come
    /// first, because a search in a cell is dear.
    fn find(&self, mesh: &Mesh, x: &[f64]) -> Option<Found> {
        let place = spatial(x);
        let near = self.cells.get(&bin(&place, self.width))?;
        let mut near: Vec<(usize, &CellBox)> =
            near.iter().map(|&index| (self.boxes[index].least(&place), &self.boxes[index])).collect();
        near.sort_by_key(|(least, _)| *least);
        let mut best: Option<(usize, CellIndex, Vec<f64>)> = None;
        for &(least, of) in &near {
            let found = best.as_ref().map_or(MULTIPLES.len(), |best| best.0);
            if found == 0 {
                break;
            }
            // A straight cell lies in its box, and its multiples in those of the box.
            if of.is_straight && least > found {
                continue;
            }
            let Some((multiple, at)) = local(mesh, of.cell, x) else { continue };
            if best.as_ref().is_none_or(|best| multiple < best.0) {
                best = Some((multiple, of.cell, at));
            }
        }
        let row = |(multiple, cell, at): (usize, CellIndex, Vec<f64>)| {
            let functions = &mesh.blocks[cell.block].element.functions.values;
            let values = mesh.cell_nodes(cell).iter().zip(functions).map(|(a, n)| (*a, n.evaluate(&at)));
            // One that is not finite is kept.
            // A node of a side on which the point lies has a function of zero but for rounding, and is left out of the
            // sum.
            let row: Vec<(usize, f64)> = values.filter(|(_, n)| !(n.abs() <= 1e-14)).collect();
            row.iter().all(|(_, n)| n.is_finite()).then_some((row, cell, multiple))
        };
        let found = best.and_then(row);
        // The functions of pyramids have no value at the apex.
        if !matches!(found, Some((.., 0)))
            && let Some((node, cell)) = near.iter().find_map(|(_, of)| Some((of.node_at(mesh, &place)?, of.cell)))
        {
            return Some((vec![(node, 1.0)], cell, 0));
        }
        found
    }
}

fn bin(x: &[f64; 3], width: f64) -> [i64; 3] {
    x.map(|x| (x / width).floor() as i64)
}

/// The box of the nodes of a cell.
struct CellBox {
    cell: CellIndex,
    /// Its lower and its upper corner.
    ends: [[f64; 3]; 2],
    /// The mean of the nodes.
    centre: [f64; 3],
    /// Whether the cell is a simplex with straight edges.
    is_straight: bool,
}

/// The distance of a point from a node that it is, relative to the size of a box. Then it has the displacement of that
/// node to the last digit.
const SAME: f64 = 1e-9;
/// The rounding of a place relative to the size of a box.
// Boxes sort out cells before places are looked for in them: more slack would cost searches alone, and less would lose places on
// sides that are written with seven digits.
const SLACK: f64 = 1e-6;

impl CellBox {
    fn of(mesh: &Mesh, cell: CellIndex) -> CellBox {
        let element = &mesh.blocks[cell.block].element;
        let points: Vec<[f64; 3]> = mesh.cell_nodes(cell).iter().map(|&p| spatial(mesh.point(p))).collect();
        let centre = std::array::from_fn(|k| points.iter().map(|x| x[k]).sum::<f64>() / points.len() as f64);
        let is_straight = element.cell.is_simplex() && element.has_corners_alone();
        CellBox { cell, ends: ends(points.iter().copied()), centre, is_straight }
    }

    /// The node of the cell at x.
    fn node_at(&self, mesh: &Mesh, x: &[f64; 3]) -> Option<usize> {
        let near = SAME * distance(&self.ends[0], &self.ends[1]);
        mesh.cell_nodes(self.cell).iter().copied().find(|&p| distance(&spatial(mesh.point(p)), x) <= near)
    }

    /// The lower (0) or upper (1) corner of a box that also has the points that may lie outside the cell.
    fn around(&self, end: usize) -> [f64; 3] {
        let margin = 0.5 * (FARTHEST - 1.0) * distance(&self.ends[0], &self.ends[1]);
        self.ends[end].map(|x| if end == 0 { x - margin } else { x + margin })
    }

    /// The index of the least multiple of the box about the centre of the cell that has x; their number if none has it.
    fn least(&self, x: &[f64; 3]) -> usize {
        let slack = SLACK * distance(&self.ends[0], &self.ends[1]);
        let has = |multiple: &f64| {
            (0..3).all(|k| {
                let (c, [low, high]) = (self.centre[k], [self.ends[0][k], self.ends[1][k]]);
                c + multiple * (low - c) - slack <= x[k] && x[k] <= c + multiple * (high - c) + slack
            })
        };
        MULTIPLES.iter().position(has).unwrap_or(MULTIPLES.len())
    }
}

/// The position in the coordinates of a cell, by Newton's method, and the index of the least multiple of the cell that has it.
fn local(mesh: &Mesh, cell: CellIndex, x: &[f64]) -> Option<(usize, Vec<f64>)> {
    let (element, nodes, d) = (&mesh.blocks[cell.block].element, mesh.cell_nodes(cell), mesh.dimension);
    let centre = element.cell.centre();
    let mut at = centre.clone();
    for _ in 0..ITERATIONS {
        let mut rest = DVector::from_column_slice(x);
        let mut jacobian = DMatrix::zeros(d, d);
        for (a, &p) in nodes.iter().enumerate() {
            let value = element.functions.values[a].evaluate(&at);
            for (k, x) in mesh.point(p).iter().enumerate() {
                rest[k] -= value * x;
                for (l, gradient) in element.functions.gradients[a].iter().enumerate() {
                    jacobian[(k, l)] += x * gradient.evaluate(&at);
                }
            }
        }
        // A singular Jacobian is that of a place far outside, where a curved cell is folded.
        let step = jacobian.lu().solve(&rest)?;
        // Cells are of size one: a place this far away does not return.
        if !step.iter().all(|step| step.is_finite()) || at.iter().any(|at| at.abs() > 100.0) {
            return None;
        }
        at.iter_mut().zip(&step).for_each(|(at, step)| *at += step);
        // The next step would be its square, which is no number beside one.
        if step.amax() < 1e-12 {
            break;
        }
    }
    let within = |multiple: &f64| {
        let shrunk: Vec<f64> = at.iter().zip(&centre).map(|(a, c)| c + (a - c) / multiple).collect();
        element.cell.contains(&shrunk)
    };
    MULTIPLES.iter().position(within).map(|multiple| (multiple, at))
}
