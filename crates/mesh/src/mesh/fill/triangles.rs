//! Triangles as a file lists them, before it is known what they enclose.

use crate::error::{Error, ErrorKind, Result};
use crate::mesh::coincident::Coincident;
use crate::mesh::resolution::check_size;
use crate::mesh::source::{Format, MeshSource};
use crate::mesh::space::ends;
use crate::springs::{cross, distance, dot, norm};

/// Triangles between points; no triangle has a point twice.
#[derive(Clone)]
pub(super) struct Triangles {
    /// The coordinates, m.
    pub points: Vec<[f64; 3]>,
    pub corners: Vec<[usize; 3]>,
    /// The place among the faces of the file of each triangle, from 0; [`NOT_OF_FILE`] of those that close holes.
    pub faces: Vec<u32>,
    /// Triangles with a point twice, which were left out.
    pub flat: usize,
}

/// The place among the faces of the file of a triangle that is not in the file.
pub(super) const NOT_OF_FILE: u32 = u32::MAX;

impl Triangles {
    /// The triangles in `source`, with `scale` metres per unit. Points at equal coordinates are one point.
    ///
    /// # Errors
    /// It has other cells than triangles and quadrangles, or none, or coordinates out of range.
    pub fn of(source: &MeshSource, scale: f64) -> Result<Triangles> {
        let mut coincident = Coincident::default();
        let mut index = |node: usize| coincident.index(source.points[node].map(|x| x * scale));
        let mut triangles = Triangles { points: Vec::new(), corners: Vec::new(), faces: Vec::new(), flat: 0 };
        let mut face = 0;
        for block in source.blocks.iter().filter(|block| block.dimension > 1) {
            let is_known = match (source.format, block.cell_type) {
                (Format::Vtk, 5 | 9) | (Format::Gmsh, 2 | 3) => true,
                (Format::Vtk | Format::Gmsh, _) => false,
            };
            if !is_known {
                let found = format!("cells with {} nodes in {} dimensions", block.nodes_per_cell, block.dimension);
                return Err(
                    Error::expected("surface", "triangles or quadrangles", found).of_kind(ErrorKind::Unsupported)
                );
            }
            for cell in block.connectivity.chunks_exact(block.nodes_per_cell) {
                let nodes: Vec<usize> = cell.iter().map(|&node| index(node)).collect();
                for i in 2..nodes.len() {
                    triangles.add([nodes[0], nodes[i - 1], nodes[i]], face);
                }
                face += 1;
            }
        }
        if triangles.corners.is_empty() {
            return Err(Error::expected("surface", "triangles or quadrangles", "none"));
        }
        // A fill has a key for the number of points.
        check_size(coincident.points.iter().flatten().copied()).map_err(|e| e.at_key("surface"))?;
        Ok(Triangles { points: coincident.points, ..triangles })
    }

    /// Adds a triangle, or counts it as flat if it has a point twice.
    pub fn add(&mut self, triangle: [usize; 3], face: u32) {
        let [a, b, c] = triangle;
        if a == b || b == c || c == a {
            self.flat += 1;
        } else {
            self.corners.push(triangle);
            self.faces.push(face);
        }
    }

    /// Leaves out the triangles for which `is_kept` is `false`, by their places in the list.
    pub fn retain(&mut self, is_kept: impl Fn(usize) -> bool) {
        let kept: Vec<usize> = (0..self.corners.len()).filter(|&t| is_kept(t)).collect();
        self.corners = kept.iter().map(|&t| self.corners[t]).collect();
        self.faces = kept.iter().map(|&t| self.faces[t]).collect();
    }

    /// The least and the largest coordinates of the corners, m.
    pub fn ends(&self) -> [[f64; 3]; 2] {
        ends(self.corners.iter().flatten().map(|&p| self.points[p]))
    }

    /// The length of the diagonal of the box around the triangles, m.
    pub fn extent(&self) -> f64 {
        let [low, high] = self.ends();
        norm(&[0, 1, 2].map(|k| high[k] - low[k]))
    }

    /// The volume between a triangle and a place, `x·(y × z)/6` of its corners from there, m³: positive if it sees the outside of the place.
    pub fn volume(&self, triangle: [usize; 3], from: [f64; 3]) -> f64 {
        let [x, y, z] = triangle.map(|p| self.along(from, p));
        // Volumes have a sign: those of tetrahedra from any one place to the triangles of a closed surface add up to
        // what it encloses.
        dot(&x, &cross(y, z)) / 6.0
    }

    /// The area of a triangle, m².
    pub fn area(&self, [a, b, c]: [usize; 3]) -> f64 {
        let from = self.points[a];
        norm(&cross(self.along(from, b), self.along(from, c))) / 2.0
    }

    /// The height of a triangle over its longest edge, m.
    pub fn height(&self, triangle: [usize; 3]) -> f64 {
        let edge = |i: usize| distance(&self.points[triangle[i]], &self.points[triangle[(i + 1) % 3]]);
        // The least of the three heights stands on the longest edge.
        2.0 * self.area(triangle) / (0..3).map(edge).fold(0.0, f64::max)
    }

    /// The middle of the edge between two points, m.
    pub fn middle(&self, [a, b]: [usize; 2]) -> [f64; 3] {
        std::array::from_fn(|k| (self.points[a][k] + self.points[b][k]) / 2.0)
    }

    fn along(&self, from: [f64; 3], point: usize) -> [f64; 3] {
        std::array::from_fn(|k| self.points[point][k] - from[k])
    }
}
