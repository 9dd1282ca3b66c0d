//! Cells whose centres are inside a closed surface.

use super::bound::{MOST_CELLS, too_many};
use super::columns::Columns;
use super::crossings::crossings;
use super::filled::Filled;
use super::grid::Grid;
use super::lattice::{Pattern, patterns};
use super::layers::FillLayers;
use super::parts::kept;
use super::repair::repaired;
use super::smooth::smooth;
use super::spacing::FillSpacing;
use super::surface::Surface;
use super::triangles::Triangles;
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
/// A place is inside if the surface winds around it at least once. With a stepped boundary a cell belongs to the body if its centre is
/// inside; with a smooth one the corners of all cells are inside or on the surface. The groups of the mesh are `surface` for the outer
/// sides and `body` for the cells.
#[derive(Debug, Clone)]
pub struct FillMesh {
    /// The element of all cells, a hexahedron or a tetrahedron.
    pub element: Arc<Element>,
    /// The edge of a cube.
    pub spacing: FillSpacing,
    /// The boundary; a smooth one needs tetrahedra.
    pub boundary: FillBoundary,
    /// What happens if layers of the surface overlap.
    pub layers: FillLayers,
    /// Whether a damaged surface is mended first, see [`Repair`](super::Repair).
    pub repair: bool,
}

/// The largest number of cubes around the surface, filled or not.
const MOST_CUBES: f64 = 5e8;

/// The boundary of a filled surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FillBoundary {
    /// Cells of the lattice whose centres are inside.
    #[default]
    Stepped,
    /// Tetrahedra that are cut off at the surface.
    Smooth,
}

crate::named!(FillBoundary { "stepped" => Stepped, "smooth" => Smooth });

impl FillMesh {
    /// The name of the shipped element of cubes with corners alone.
    pub fn cube() -> &'static str {
        let is_cube = |file: &&ElementFile| file.vtk == Some(i64::from(CellType::HEX8.0));
        SHIPPED.iter().find(is_cube).map_or("", |file| file.name)
    }

    /// Fills the surface in `source`, with `scale` metres per unit.
    ///
    /// # Errors
    /// The surface is open, its triangles are turned differently, or its layers overlap and are refused, or it cannot be repaired; the element
    /// has other cells; or there are no cells or too many.
    pub fn build(&self, source: &MeshSource, scale: f64) -> Result<Mesh> {
        let patterns = patterns(self.element.cell);
        if patterns.is_empty() {
            return Err(Error::expected("element", "an element of hexahedra or tetrahedra", &self.element.name));
        }
        if self.boundary == FillBoundary::Smooth && self.element.cell != Cell::Tetrahedron {
            let expected = "an element of tetrahedra, which a smooth boundary needs";
            return Err(Error::expected("element", expected, &self.element.name));
        }
        self.spacing.check()?;
        let triangles = Triangles::of(source, scale)?;
        let (surface, repair) = match self.repair {
            true => repaired(triangles, scale).map(|(surface, repair)| (surface, Some(repair)))?,
            false => (Surface::given(triangles, scale)?, None),
        };
        let columns = Columns::of(&surface);
        let edge = self.spacing.edge(surface.volume, patterns.len(), |edge| {
            let (mesh, _) = self.lay(edge, &surface, &columns, &patterns)?;
            Ok(mesh.point_count())
        })?;
        let (mut mesh, mut filled) = self.lay(edge, &surface, &columns, &patterns)?;
        (filled.scale, filled.repair) = (scale, repair);
        // A crossing near a faulty place is most likely its cause, and is the one that is told.
        let faulty = filled.overlaps.or(filled.inverted).map(|(_, place)| place);
        filled.crossings = crossings(source, &surface, &columns, faulty, faulty.is_some());
        self.layers.check(&filled)?;
        filled.cells = mesh.cell_count();
        // Too coarse a lattice has no cell inside; an empty mesh would fail later with no hint at that.
        if filled.cells == 0 {
            let needs = match self.boundary {
                FillBoundary::Stepped => "cells whose centres are inside the surface",
                FillBoundary::Smooth => "a lattice with a point inside the surface",
            };
            let found = format!("none of {edge:e} m in a volume of {:.3e} m³", surface.volume);
            let (key, way_out) = match self.spacing {
                FillSpacing::Edge(_) => ("cell", "a smaller cell"),
                FillSpacing::Points(_) => ("points", "more points"),
            };
            return Err(Error::expected(key, format!("{needs}: {way_out}"), found));
        }
        if let Some((most, volumes)) = filled.another_body() {
            let (key, found) = match self.spacing {
                FillSpacing::Edge(_) => ("cell", format!("edges of {edge:e} m: {volumes}")),
                FillSpacing::Points(points) => ("points", format!("{points}, edges of {edge:.3e} m: {volumes}")),
            };
            let expected = format!(
                "cells with the volume of the surface within a factor of two, such as edges of at most {most:.1e} m"
            );
            return Err(Error::expected(key, expected, found));
        }
        let sides = group(&mut mesh)?;
        filled.stepped_area = (self.boundary == FillBoundary::Stepped).then(|| sides as f64 * self.side_area(edge));
        filled.asked = match self.spacing {
            FillSpacing::Edge(_) => None,
            FillSpacing::Points(points) => Some(points),
        };
        (filled.edge, filled.points) = (edge, mesh.point_count());
        mesh.quality.filled = Some(filled);
        Ok(mesh)
    }

    /// The cells of a lattice with this edge in the surface, without groups, and what is known of them.
    ///
    /// # Errors
    /// There are too many.
    fn lay(&self, edge: f64, surface: &Surface, columns: &Columns, patterns: &[Pattern]) -> Result<(Mesh, Filled)> {
        let mut filled = Filled {
            surface_volume: surface.volume,
            surface_area: surface.area,
            turned: surface.is_turned,
            flat: surface.flat,
            branched: surface.branched,
            ..Filled::default()
        };
        // Without the forecast an edge in the wrong unit would fill the memory before it is refused.
        forecast(edge, surface, patterns.len())?;
        let grid = Grid::around(surface, edge);
        let mesh = match self.boundary {
            FillBoundary::Stepped => {
                let cells = inside(columns, &grid, patterns, &mut filled)?;
                self.stepped(&grid, patterns, &cells, &mut filled)
            }
            FillBoundary::Smooth => smooth(&self.element, &grid, columns, patterns, &mut filled)?,
        };
        Ok((mesh, filled))
    }

    /// The area of a side of a cell of the lattice, m². Those of the tetrahedra are equal: two edges of a half diagonal of a
    /// cube at an edge of a cube.
    fn side_area(&self, edge: f64) -> f64 {
        let of_square = if self.element.cell == Cell::Tetrahedron { f64::sqrt(0.125) } else { 1.0 };
        of_square * edge.powi(2)
    }

    /// The mesh of the cells, without those that hang on others by an edge or a corner alone.
    fn stepped(&self, grid: &Grid, patterns: &[Pattern], cells: &[([i32; 3], u8)], filled: &mut Filled) -> Mesh {
        let corner = |cube: &[i32; 3], c: &[i32; 3]| -> [i32; 3] { std::array::from_fn(|k| 2 * cube[k] + c[k]) };
        // Corners are compared as whole numbers, without any rounding.
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
                // Places in units of a millionth of a cube: nodes that cells share are computed apart, and differ by
                // rounding.
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
        let of_cell = grid.edge.powi(3) / if self.element.cell == Cell::Tetrahedron { 12.0 } else { 1.0 };
        filled.volume = mesh.cell_count() as f64 * of_cell;
        mesh
    }
}

/// That the number of cells, which the volume gives, and of cubes around the surface are in their bounds.
fn forecast(edge: f64, surface: &Surface, of_cube: usize) -> Result<()> {
    let cells = surface.volume / edge.powi(3) * of_cube as f64;
    let cubes = (0..3).map(|k| (surface.high[k] - surface.low[k]) / edge + 3.0).product::<f64>();
    // The volume gives the number of cells only about: what is filled is counted again.
    if cells <= 1.2 * MOST_CELLS as f64 && cubes <= MOST_CUBES {
        return Ok(());
    }
    // The advice is rounded up to two digits, and a fiftieth more than fits
    // exactly, because the volume tells the number of cells only about.
    let fits = edge * (cells / MOST_CELLS as f64).max(cubes / MOST_CUBES).cbrt() * 1.02;
    let digit = 10f64.powf(fits.log10().floor() - 1.0);
    let fits = (fits / digit).ceil() * digit;
    let expected = format!("at most {MOST_CELLS} cells, which edges of {fits:.1e} m give");
    Err(Error::expected("cell", expected, format!("about {cells:.0}")).of_kind(ErrorKind::Limit))
}

/// Turns all cells alike, and adds the groups; returns the number of outer sides.
fn group(mesh: &mut Mesh) -> Result<usize> {
    mesh.orient(false)?;
    mesh.reversed = 0;
    let outer = Selection::Everything.sides(mesh)?;
    let sides: Vec<Vec<usize>> = outer.iter().map(|side| sorted(&mesh.side_nodes(side))).collect();
    let points = sorted(&sides.concat());
    let mut surface = Group { points, sides, ..Group::default() };
    // A point belongs to several sides, and the list is ascending already.
    surface.points.dedup();
    let body = Group {
        points: (0..mesh.point_count()).collect(),
        cells: (0..mesh.cell_count()).map(|cell| CellIndex { block: 0, cell }).collect(),
        ..Group::default()
    };
    mesh.groups.insert("surface".into(), surface);
    mesh.groups.insert("body".into(), body);
    mesh.quality.pieces = Some(mesh.pieces().len());
    Ok(outer.len())
}

/// The cells whose centres are inside: their cubes and patterns, sorted.
fn inside(columns: &Columns, grid: &Grid, patterns: &[Pattern], filled: &mut Filled) -> Result<Vec<([i32; 3], u8)>> {
    let mut cells = Vec::new();
    let (mut crossings, mut windings) = (Vec::new(), Vec::new());
    for i in grid.along(0) {
        for j in grid.along(1) {
            for (index, pattern) in patterns.iter().enumerate() {
                let centre = |k: i32| {
                    let cube = [i, j, k];
                    grid.place(std::array::from_fn(|axis| 8 * cube[axis] + pattern.centre[axis]))
                };
                columns.windings(centre(-1), grid.edge, grid.along(2).len(), &mut crossings, &mut windings);
                for (k, winding) in grid.along(2).zip(&windings) {
                    if *winding > 0 {
                        cells.push(([i, j, k], index as u8));
                    }
                    filled.note(*winding, || centre(k));
                }
                // The forecast is by the volume alone; the count of what is inside is the one that binds.
                if cells.len() > MOST_CELLS {
                    return Err(too_many());
                }
            }
        }
    }
    // Cells were found column by column, and are numbered layer by layer.
    cells.sort_unstable_by_key(|([i, j, k], pattern)| (*k, *j, *i, *pattern));
    Ok(cells)
}
