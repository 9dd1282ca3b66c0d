//! The directors of a sheet that bends: a point for each edge, which says how the sheet is inclined there. Those of rods are in `joints`.
//!
//! Theory: page *Sheets that bend* of the book.

use super::mesh::{Directors, Mesh};
use crate::element::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::springs::{cross, distance, norm};
use std::collections::HashMap;
use std::sync::Arc;

/// The sum of the normals at an edge, relative to their number, below which the sheet is folded onto itself there. The
/// mean normal would be that of rounding, or of whichever cell comes first.
const FOLDED: f64 = 0.1;

/// The least thickness of a sheet relative to its edges. The bending of a thinner one, which goes with the square of
/// this share, is lost in the rounding of its membrane.
const THINNEST: f64 = 1e-4;

impl Mesh {
    /// The number of points that are nodes of cells. Those after them are the directors of a sheet or of rods.
    pub fn node_count(&self) -> usize {
        self.point_count() - self.directors.as_ref().map_or(0, |directors| directors.edges.len())
    }

    /// A sheet with a director for each edge. It stands on the middle of the edge, along the mean normal of the triangles, and is as far from it as the edge is
    /// long, or as the sheet is thick if that is more. `gyration` is `t²/12` of each triangle, m².
    ///
    /// # Errors
    /// The mesh is no surface of triangles of three nodes in space, or is folded onto itself at an edge: kind `Unsupported`. The sheet is too thin to be computed:
    /// kind `Limit`.
    pub fn with_directors(mut self, gyration: Vec<f64>) -> Result<Mesh> {
        let unsupported = |found: String| {
            let expected = "a surface in space of triangles of three nodes";
            Err(Error::expected("bending", expected, found).of_kind(ErrorKind::Unsupported))
        };
        let [block] = &self.blocks[..] else {
            return unsupported(format!("cells of {} elements", self.blocks.len()));
        };
        if self.dimension != 3 || block.element.dimension() != 2 || block.element.nodes() != 3 {
            return unsupported(format!("cells of {} in {} dimensions", block.element.name, self.dimension));
        }
        let mut normals: Vec<([usize; 2], [f64; 3], f64)> = Vec::new();
        let mut places: HashMap<[usize; 2], usize> = HashMap::new();
        let mut of_cells = Vec::with_capacity(3 * block.cells().len());
        let first = self.point_count();
        for nodes in block.cells() {
            let area = self.area_vector(nodes);
            let normal = area.map(|a| a / norm(&area));
            of_cells.extend((0..3).map(|corner| {
                let edge = ascending([nodes[(corner + 1) % 3], nodes[(corner + 2) % 3]]);
                let place = *places.entry(edge).or_insert_with(|| {
                    normals.push((edge, [0.0; 3], 0.0));
                    normals.len() - 1
                });
                let (_, sum, count) = &mut normals[place];
                // Cells of either order belong to one sheet: its normals are turned to one side.
                let sign = if sum.iter().zip(normal).map(|(a, b)| a * b).sum::<f64>() < 0.0 { -1.0 } else { 1.0 };
                sum.iter_mut().zip(normal).for_each(|(sum, n)| *sum += sign * n);
                *count += 1.0;
                first + place
            }));
        }
        // A plate of the thickness t has the square t²/12 of the radius of gyration.
        let thicknesses = || gyration.iter().map(|own| (12.0 * own).sqrt());
        let (thinnest, thickest) = (thicknesses().fold(f64::INFINITY, f64::min), thicknesses().fold(0.0, f64::max));
        for ([a, b], normal, count) in &normals {
            let size = norm(normal);
            if size < FOLDED * count {
                let middle = self.mean_place(&[*a, *b]);
                return unsupported(format!("one that is folded onto itself at {middle:?} m"));
            }
            let length = distance(self.point(*a), self.point(*b));
            // The comparison is negated so that a thickness that is not a number is refused.
            if !(thinnest >= THINNEST * length) {
                let problem = format!(
                    "expected a sheet of at least {THINNEST:e} of its edges, found a thickness of {thinnest:.3e} m at an edge of {length:.3e} m: its bending is lost in \
                     rounding errors of its membrane"
                );
                return Err(Error::at("bending", problem).of_kind(ErrorKind::Limit));
            }
            let reach = length.max(thickest);
            let middle = self.mean_place(&[*a, *b]);
            self.points.extend(middle.iter().zip(normal).map(|(x, n)| x + reach * n / size));
        }
        let edges = normals.into_iter().map(|(edge, ..)| edge).collect();
        Ok(self.directed(Directors { edges, of_cells, gyration, torsion: Vec::new(), flat: false }))
    }

    /// The mesh with these directors, whose points are its last ones already.
    pub(super) fn directed(mut self, directors: Directors) -> Mesh {
        if let Some(numbering) = &mut self.numbering {
            let next = 1 + numbering.nodes.iter().copied().max().unwrap_or(0);
            numbering.nodes.extend((next..).take(directors.edges.len()));
        }
        self.directors = Some(directors);
        self
    }

    /// A plane mesh as a surface in space at z = 0.
    ///
    /// # Errors
    /// The mesh is no plane one, or the space has not three dimensions.
    pub fn in_space(mut self, space: usize) -> Result<Mesh> {
        if self.dimension != 2 || space != 3 {
            let found = format!("{} dimensions of a mesh in {}", space, self.dimension);
            return Err(Error::expected("space", "3 for a plane mesh", found));
        }
        self.points = self.points.chunks_exact(2).flat_map(|x| [x[0], x[1], 0.0]).collect();
        self.dimension = space;
        for block in &mut self.blocks {
            block.element = Arc::new(Element::clone(&block.element).in_space(space));
        }
        Ok(self)
    }

    /// The points with the directors of the edges of which both ends are among them, and those of the joints that are.
    pub fn with_directors_of(&self, points: &[usize]) -> Vec<usize> {
        let Some(Directors { edges, .. }) = &self.directors else { return points.to_vec() };
        let mut is_in = vec![false; self.point_count()];
        points.iter().for_each(|&p| is_in[p] = true);
        let first = self.node_count();
        let own = edges.iter().enumerate().filter(|(_, [a, b])| is_in[*a] && is_in[*b]).map(|(e, _)| first + e);
        points.iter().copied().chain(own).collect()
    }

    /// The area of a triangle in space with these corners, m², times its unit normal.
    pub fn area_vector(&self, nodes: &[usize]) -> [f64; 3] {
        let from = |b: usize| std::array::from_fn(|k| self.point(nodes[b])[k] - self.point(nodes[0])[k]);
        cross(from(1), from(2)).map(|twice| twice / 2.0)
    }
}

fn ascending([a, b]: [usize; 2]) -> [usize; 2] {
    [a.min(b), a.max(b)]
}
