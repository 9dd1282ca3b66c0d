//! Cells whose centres are inside a closed surface.

use super::columns::Columns;
use super::filled::Filled;
use super::lattice::{Pattern, patterns};
use super::parts::kept;
use super::surface::Surface;
use crate::bound;
use crate::element::{Cell, Element, ElementFile, SHIPPED};
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::affine::Affine;
use crate::mesh::mesh::{CellBlock, CellIndex, Group, Mesh, sorted};
use crate::mesh::polytope::CellType;
use crate::mesh::selection::Selection;
use crate::mesh::source::MeshSource;
use std::collections::HashMap;
use std::sync::Arc;

/// A closed surface that is filled with cubes, or with the tetrahedra of a body-centred cubic lattice.
///
/// A cell belongs to the body if its centre is inside: if the surface winds around it at least once. The groups of the mesh
/// are `surface` for the outer sides and `body` for the cells.
#[derive(Debug, Clone)]
pub struct FillMesh {
    /// The element of all cells, a hexahedron or a tetrahedron.
    pub element: Arc<Element>,
    /// The edge of a cube, m.
    pub cell: f64,
}

const MOST_CELLS: usize = bound::CELLS as usize;
/// The largest number of cubes around the surface, filled or not.
const MOST_CUBES: f64 = 5e8;

/// The lattice: cubes from `origin`, so many along each axis, with one more around them.
struct Grid {
    origin: [f64; 3],
    counts: [i32; 3],
    edge: f64,
}

impl Grid {
    fn place(&self, quarters: [i32; 3]) -> [f64; 3] {
        std::array::from_fn(|k| self.origin[k] + f64::from(quarters[k]) / 8.0 * self.edge)
    }
}

impl FillMesh {
    /// The name of the shipped element of cubes with corners alone.
    pub fn cube() -> &'static str {
        let is_cube = |file: &&ElementFile| file.vtk == Some(i64::from(CellType::HEX8.0));
        SHIPPED.iter().find(is_cube).map_or("", |file| file.name)
    }

    /// Fills the surface in `source`, with `scale` metres per unit.
    ///
    /// # Errors
    /// The surface is open or its triangles are turned differently; the element has other cells; or there are no cells or too
    /// many.
    pub fn build(&self, source: &MeshSource, scale: f64) -> Result<Mesh> {
        let patterns = patterns(self.element.cell);
        if patterns.is_empty() {
            return Err(Error::expected("element", "an element of hexahedra or tetrahedra", &self.element.name));
        }
        let edge = self.cell;
        if !(edge > 0.0 && edge.is_finite()) {
            return Err(Error::expected("cell", "a positive length", format!("{edge} m")));
        }
        let surface = Surface::of(source, scale)?;
        let mut filled = Filled {
            surface_volume: surface.volume,
            turned: surface.is_turned,
            flat: surface.flat,
            branched: surface.branched,
            ..Filled::default()
        };
        self.forecast(&surface, patterns.len())?;
        let counts = [0, 1, 2].map(|k| ((surface.high[k] - surface.low[k]) / edge - 1e-9).ceil().max(1.0) as i32);
        let middle = |k: usize| surface.low[k] / 2.0 + surface.high[k] / 2.0;
        let origin = std::array::from_fn(|k| middle(k) - f64::from(counts[k]) / 2.0 * edge);
        let grid = Grid { origin, counts, edge };
        let cells = inside(&surface, &grid, &patterns, &mut filled)?;
        if cells.is_empty() {
            let expected = "cells whose centres are inside the surface: a smaller cell";
            let found = format!("none of {edge:e} m in a volume of {:.3e} m³", surface.volume);
            return Err(Error::expected("cell", expected, found));
        }
        let mut mesh = self.mesh(&grid, &patterns, &cells, &mut filled)?;
        filled.cells = mesh.cell_count();
        let of_cell = edge.powi(3) / if self.element.cell == Cell::Tetrahedron { 12.0 } else { 1.0 };
        filled.volume = filled.cells as f64 * of_cell;
        mesh.quality.filled = Some(filled);
        Ok(mesh)
    }

    /// That the number of cells, which the volume gives, and of cubes around the surface are in their bounds.
    fn forecast(&self, surface: &Surface, of_cube: usize) -> Result<()> {
        let cells = surface.volume / self.cell.powi(3) * of_cube as f64;
        let cubes = (0..3).map(|k| (surface.high[k] - surface.low[k]) / self.cell + 3.0).product::<f64>();
        if cells > 1.2 * MOST_CELLS as f64 || cubes > MOST_CUBES {
            return Err(self.too_many((cells / MOST_CELLS as f64).max(cubes / MOST_CUBES).cbrt(), cells));
        }
        Ok(())
    }

    /// The error for too many cells, of which the edge has to grow by `factor`.
    fn too_many(&self, factor: f64, cells: f64) -> Error {
        let fits = self.cell * factor * 1.02;
        let digit = 10f64.powf(fits.log10().floor() - 1.0);
        let fits = (fits / digit).ceil() * digit;
        let expected = format!("at most {MOST_CELLS} cells, which edges of {fits:.1e} m give");
        Error::expected("cell", expected, format!("about {cells:.0}")).of_kind(ErrorKind::Limit)
    }

    /// The mesh of the cells, without those that hang on others by an edge or a corner alone.
    fn mesh(&self, grid: &Grid, patterns: &[Pattern], cells: &[([i32; 3], u8)], filled: &mut Filled) -> Result<Mesh> {
        let corner = |cube: &[i32; 3], c: &[i32; 3]| -> [i32; 3] { std::array::from_fn(|k| 2 * cube[k] + c[k]) };
        let mut known: HashMap<[i32; 3], usize> = HashMap::new();
        let mut corners: Vec<Vec<usize>> = Vec::with_capacity(cells.len());
        for (cube, pattern) in cells {
            let place = |c: &[i32; 3]| {
                let next = known.len();
                *known.entry(corner(cube, c)).or_insert(next)
            };
            corners.push(patterns[usize::from(*pattern)].corners.iter().map(place).collect());
        }
        let faces: Vec<&[usize]> = self.element.cell.sides().iter().map(|side| side.corners).collect();
        let keep = kept(&corners, &faces);
        filled.loose = keep.iter().filter(|keep| !**keep).count();
        // The map of the reference cell onto the cell, in half edges.
        let map = |cube: &[i32; 3], pattern: &Pattern| {
            let at = |c: &[i32; 3]| corner(cube, c).map(f64::from).to_vec();
            match self.element.cell {
                Cell::Tetrahedron => {
                    let corners: Vec<Vec<f64>> = pattern.corners.iter().map(at).collect();
                    Affine::onto_simplex(&corners)
                }
                _ => {
                    let unit = |k: usize| (0..3).map(|i| if i == k { 1.0 } else { 0.0 }).collect();
                    let origin = at(&[1, 1, 1]);
                    Affine { origin, edges: (0..3).map(unit).collect() }
                }
            }
        };
        let mut mesh = Mesh::of_points(3, Vec::new());
        let mut connectivity = Vec::with_capacity(cells.len() * self.element.nodes());
        // Points of neighbouring cells coincide; their positions are compared in units of 2⁻²⁰ of half an edge.
        let mut known: HashMap<[i64; 3], usize> = HashMap::new();
        for ((cube, pattern), _) in cells.iter().zip(&keep).filter(|(_, keep)| **keep) {
            let map = map(cube, &patterns[usize::from(*pattern)]);
            for at in self.element.positions.chunks_exact(3) {
                let place = map.place(at);
                let key = std::array::from_fn(|k| (place[k] * (1u64 << 20) as f64).round() as i64);
                let next = mesh.point_count();
                let index = *known.entry(key).or_insert(next);
                if index == next {
                    mesh.points.extend((0..3).map(|k| grid.origin[k] + place[k] / 2.0 * grid.edge));
                }
                connectivity.push(index);
            }
        }
        mesh.blocks.push(CellBlock { element: self.element.clone(), connectivity });
        mesh.orient(false)?;
        mesh.reversed = 0;
        let outer = Selection::Everything.sides(&mesh)?;
        let sides: Vec<Vec<usize>> = outer.iter().map(|side| sorted(&mesh.side_nodes(side))).collect();
        let points = sorted(&sides.concat());
        let mut surface = Group { points, sides, ..Group::default() };
        surface.points.dedup();
        let body = Group {
            points: (0..mesh.point_count()).collect(),
            cells: (0..mesh.cell_count()).map(|cell| CellIndex { block: 0, cell }).collect(),
            ..Group::default()
        };
        mesh.groups.insert("surface".into(), surface);
        mesh.groups.insert("body".into(), body);
        mesh.quality.pieces = Some(mesh.pieces().len());
        Ok(mesh)
    }
}

/// The cells whose centres are inside: their cubes and patterns, sorted.
fn inside(surface: &Surface, grid: &Grid, patterns: &[Pattern], filled: &mut Filled) -> Result<Vec<([i32; 3], u8)>> {
    let columns = Columns::of(surface);
    let mut cells = Vec::new();
    let mut crossings = Vec::new();
    let around = |k: usize| -1..grid.counts[k] + 1;
    let height = around(2).len();
    let mut changes = vec![0; height + 1];
    let note = |place: &mut Option<(usize, [f64; 3])>, at: [f64; 3]| match place {
        Some((count, _)) => *count += 1,
        None => *place = Some((1, at)),
    };
    for i in around(0) {
        for j in around(1) {
            for (index, pattern) in patterns.iter().enumerate() {
                let centre = |k: i32| {
                    let cube = [i, j, k];
                    grid.place(std::array::from_fn(|axis| 8 * cube[axis] + pattern.centre[axis]))
                };
                let start = centre(-1);
                columns.crossings(start[0], start[1], &mut crossings);
                if crossings.is_empty() {
                    continue;
                }
                changes.fill(0);
                for crossing in &crossings {
                    changes[0] += crossing.sign;
                    changes[columns.below(crossing, start, grid.edge, height)] -= crossing.sign;
                }
                let mut winding = 0;
                for (k, change) in around(2).zip(&changes) {
                    winding += change;
                    if winding > 0 {
                        cells.push(([i, j, k], index as u8));
                    }
                    match winding {
                        0 | 1 => {}
                        2.. => note(&mut filled.overlaps, centre(k)),
                        _ => note(&mut filled.inverted, centre(k)),
                    }
                }
                if cells.len() > MOST_CELLS {
                    let expected = format!("at most {MOST_CELLS} cells: a larger cell");
                    return Err(Error::expected("cell", expected, "more").of_kind(ErrorKind::Limit));
                }
            }
        }
    }
    cells.sort_unstable_by_key(|([i, j, k], pattern)| (*k, *j, *i, *pattern));
    Ok(cells)
}
