//! Faces on which a pressure acts, at rest and where they have moved.
//!
//! Theory: page *Stiffness and the reduced space* of the book.

use super::component::Component;
use crate::element::{Integrand, Tabulation};
use crate::error::{Error, Result};
use crate::material::CellMap;
use crate::mesh::{CellIndex, Mesh, Selection};
use crate::springs::cross;
use faer::sparse::Triplet;
use std::collections::HashMap;

/// Faces on which a pressure acts against their normals, wherever they move: sides of a solid or of a plane body, with the normals that point out of
/// it, or cells of a surface in space, see [`Mesh::turned`].
///
/// The nodal forces are `f_a(x) = −∫ N_a p n dA` with `n dA = (∂x/∂ξ × ∂x/∂η) dξ dη`, and in the plane `n dA = h (∂y/∂ξ, −∂x/∂ξ) dξ`. The rule
/// integrates them exactly on curved faces of polynomial elements. The pressure p belongs to the points of the body: it is evaluated
/// where they are at rest. So is the thickness h.
#[derive(Debug, Clone)]
pub struct PressedFaces {
    dimension: usize,
    /// The shape functions on faces of each kind.
    tables: Vec<Tabulation>,
    faces: Vec<Face>,
}

#[derive(Debug, Clone)]
struct Face {
    table: usize,
    /// The points of the mesh, in the order of the table.
    nodes: Vec<usize>,
    /// `−w_q p(X_q)`, in the plane times the thickness, `[points]`; the sign of a cell that is turned is that of its weights.
    weights: Vec<f64>,
}

impl PressedFaces {
    /// The faces of a part of a mesh under a pressure in Pa; `thickness` is that of the cells of a plane body, m.
    ///
    /// # Errors
    /// The part has no sides (of a surface in space no cells), or sides with cells on both sides of them, the body is a curve, a surface has one side only, or the pressure is not finite
    /// at a point.
    pub fn new(mesh: &Mesh, part: &Selection, pressure: &Component, thickness: &CellMap<f64>) -> Result<PressedFaces> {
        let mut pressed = PressedFaces { dimension: mesh.dimension, tables: Vec::new(), faces: Vec::new() };
        let integrand = Integrand::Load(pressure.degree());
        match (mesh.cell_dimension(), mesh.dimension) {
            // A part of a solid may name the membranes on it and no sides: the pressure acts on these.
            (3, 3) if part.sides(mesh)?.is_empty() && has_membranes(mesh, part)? => {
                pressed.add_cells(mesh, part, pressure, integrand)?;
            }
            (2, 3) => pressed.add_cells(mesh, part, pressure, integrand)?,
            (cells, space) if cells == space => pressed.add_sides(mesh, part, (pressure, thickness), integrand)?,
            (_, _) => {
                return Err(Error::at("load", "acts on nothing: curves have no sides that a pressure could act on"));
            }
        }
        Ok(pressed)
    }

    fn add_sides(
        &mut self,
        mesh: &Mesh,
        part: &Selection,
        (pressure, thickness): (&Component, &CellMap<f64>),
        integrand: Integrand,
    ) -> Result<()> {
        let sides = part.sides(mesh)?;
        if sides.is_empty() {
            return Err(Error::at("load", "acts on nothing: the selected part has no sides"));
        }
        // A side inside has two cells, out of which its normals point in opposite directions.
        if let Some((place, count)) = mesh.inner_sides(&sides) {
            let found =
                format!("{count} of {} inside it, with cells on both sides, the first at {place:?} m", sides.len());
            return Err(Error::expected(
                "load",
                "sides of the outside of the body, on which a pressure has a direction",
                found,
            ));
        }
        let mut firsts = Vec::new();
        for block in &mesh.blocks {
            firsts.push(self.tables.len());
            self.tables.extend(block.element.side_integration_tables(integrand));
        }
        for side in sides {
            let (block, nodes) = (&mesh.blocks[side.cell.block], mesh.cell_nodes(side.cell));
            let nodes = block.element.sides()[side.side].nodes.iter().map(|&a| nodes[a]).collect();
            let thickness = if mesh.dimension == 2 { *thickness.at(side.cell.block, side.cell.cell) } else { 1.0 };
            self.add(mesh, firsts[side.cell.block] + side.side, nodes, (pressure, thickness));
        }
        Ok(())
    }

    fn add_cells(&mut self, mesh: &Mesh, part: &Selection, pressure: &Component, integrand: Integrand) -> Result<()> {
        let mut cells = part.cells(mesh)?;
        cells.retain(|cell| mesh.blocks[cell.block].element.dimension() == 2);
        if cells.is_empty() {
            return Err(Error::at(
                "load",
                "acts on nothing: the selected part has no cells, on which a pressure acts of a surface in space",
            ));
        }
        // Blocks of other cells have tables that are not used.
        self.tables = mesh.blocks.iter().map(|block| block.element.integration_table(integrand)).collect();
        // How cells are turned is a matter of the whole surface, of which these may be a part.
        let is_sheet = |cell: &CellIndex| mesh.blocks[cell.block].element.dimension() == 2;
        let all: Vec<CellIndex> = mesh.cell_indices().filter(is_sheet).collect();
        let turned: HashMap<CellIndex, bool> = all.iter().copied().zip(mesh.turned(&all)?).collect();
        for cell in &cells {
            let is_turned = turned[cell];
            let sign = if is_turned { -1.0 } else { 1.0 };
            self.add(mesh, cell.block, mesh.cell_nodes(*cell).to_vec(), (pressure, sign));
        }
        Ok(())
    }

    /// Adds a face with these points, whose weights have a factor.
    fn add(&mut self, mesh: &Mesh, table: usize, nodes: Vec<usize>, (pressure, factor): (&Component, f64)) {
        let shapes = &self.tables[table];
        let at = |values: &[f64]| -> Vec<f64> {
            let along = |k: usize| nodes.iter().zip(values).map(|(&p, n)| n * mesh.point(p)[k]).sum();
            (0..mesh.dimension).map(along).collect()
        };
        let points = shapes.values.chunks_exact(shapes.nodes).zip(&shapes.weights);
        // A pressure acts against the outward normal.
        let weights = points.map(|(values, w)| -w * factor * pressure.at(&at(values))).collect();
        self.faces.push(Face { table, nodes, weights });
    }

    /// Adds the faces of another pressure on the same mesh.
    pub fn append(&mut self, other: PressedFaces) {
        let first = self.tables.len();
        self.tables.extend(other.tables);
        self.faces.extend(other.faces.into_iter().map(|face| Face { table: first + face.table, ..face }));
    }

    /// The points on which the pressure acts; one may come several times.
    pub fn points(&self) -> impl Iterator<Item = usize> + '_ {
        self.faces.iter().flat_map(|face| face.nodes.iter().copied())
    }

    /// Adds the nodal forces with the points at `x`, `[points · dimension]`, m, to `forces`, N.
    pub fn add_forces(&self, x: &[f64], forces: &mut [f64]) {
        let d = self.dimension;
        self.each_point(x, |face, values, _, weight, tangents| {
            let normal = normal(tangents);
            for (&node, n) in face.nodes.iter().zip(values) {
                (0..d).for_each(|k| forces[node * d + k] += weight * n * normal[k]);
            }
        });
    }

    /// The nodal forces with the points at `x`, `[points · dimension]`, N.
    pub fn forces(&self, x: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; x.len()];
        self.add_forces(x, &mut forces);
        forces
    }

    /// The derivatives of the forces in the positions, `∂f_i/∂x_j`, N/m: an entry for each pair of degrees of freedom of a face. They are symmetric
    /// if the faces close a space or end where points are held; then the pressure has a potential.
    pub fn tangent(&self, x: &[f64]) -> Vec<Triplet<usize, usize, f64>> {
        let d = self.dimension;
        let mut entries = Vec::new();
        for face in &self.faces {
            // One matrix for each face before its entries are listed: quadrature points add to the same pairs of nodes.
            let size = face.nodes.len() * d;
            let mut local = vec![0.0; size * size];
            self.each_point_of(face, x, |values, gradients, weight, tangents| {
                for (b, slopes) in gradients.chunks_exact(d - 1).enumerate() {
                    let turned = normal_derivative(tangents, slopes);
                    for (a, n) in values.iter().enumerate() {
                        for (k, row) in turned.iter().enumerate().take(d) {
                            let own = &mut local[(a * d + k) * size + b * d..][..d];
                            own.iter_mut().zip(row).for_each(|(own, slope)| *own += weight * n * slope);
                        }
                    }
                }
            });
            let dof = |i: usize| face.nodes[i / d] * d + i % d;
            let entry = |(place, value): (usize, &f64)| Triplet::new(dof(place / size), dof(place % size), *value);
            entries.extend(local.iter().enumerate().map(entry));
        }
        entries
    }

    /// The work of the pressure while the points move straight from `x` by `u`, J: `∫₀¹ f(x + t u)·u dt`, exact by Simpson's rule, because f is at most
    /// of second degree in t.
    pub fn work(&self, x: &[f64], u: &[f64]) -> f64 {
        let along = |t: f64| -> f64 {
            let at: Vec<f64> = x.iter().zip(u).map(|(x, u)| x + t * u).collect();
            self.forces(&at).iter().zip(u).map(|(f, u)| f * u).sum()
        };
        (along(0.0) + 4.0 * along(0.5) + along(1.0)) / 6.0
    }

    /// Calls `visit(face, values, gradients, weight, tangents)` at each quadrature point of each face.
    fn each_point(&self, x: &[f64], mut visit: impl FnMut(&Face, &[f64], &[f64], f64, &[[f64; 3]; 2])) {
        for face in &self.faces {
            self.each_point_of(face, x, |values, gradients, weight, tangents| {
                visit(face, values, gradients, weight, tangents);
            });
        }
    }

    fn each_point_of(&self, face: &Face, x: &[f64], mut visit: impl FnMut(&[f64], &[f64], f64, &[[f64; 3]; 2])) {
        let (d, table) = (self.dimension, &self.tables[face.table]);
        let along = d - 1;
        // Differences keep the digits of a face that is far from the origin.
        let origin = &x[face.nodes[0] * d..][..d];
        let points = table.values.chunks_exact(table.nodes).zip(table.gradients.chunks_exact(table.nodes * along));
        for ((values, gradients), &weight) in points.zip(&face.weights) {
            // In the plane the second tangent is the direction out of it.
            let mut tangents = [[0.0; 3], [0.0, 0.0, 1.0]];
            if d == 3 {
                tangents[1] = [0.0; 3];
            }
            for (&node, slopes) in face.nodes.iter().zip(gradients.chunks_exact(along)) {
                for (tangent, slope) in tangents.iter_mut().zip(slopes) {
                    (0..d).for_each(|k| tangent[k] += slope * (x[node * d + k] - origin[k]));
                }
            }
            visit(values, gradients, weight, &tangents);
        }
    }
}

/// Whether a part of a solid has membranes that are attached to it.
fn has_membranes(mesh: &Mesh, part: &Selection) -> Result<bool> {
    Ok(part.cells(mesh)?.iter().any(|cell| mesh.blocks[cell.block].element.dimension() == 2))
}

/// `∂x/∂ξ × ∂x/∂η`, which points out of the cell of a side.
fn normal([u, v]: &[[f64; 3]; 2]) -> [f64; 3] {
    cross(*u, *v)
}

/// The derivative of the normal in the position of a node with these slopes: rows are directions of the normal, columns of the position.
fn normal_derivative(&[u, v]: &[[f64; 3]; 2], slopes: &[f64]) -> [[f64; 3]; 3] {
    // δn = N_ξ δ × v + N_η u × δ = w × δ with w = N_η u − N_ξ v; in the plane v does not move.
    let along = |k: usize| slopes.get(1).map_or(0.0, |slope| slope * u[k]) - slopes[0] * v[k];
    let [x, y, z] = std::array::from_fn(along);
    [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]
}
