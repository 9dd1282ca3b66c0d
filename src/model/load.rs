//! Loads as nodal forces, consistent with the shape functions; the same for both models.

use super::system::{each_cell, shares};
use crate::element::Tabulation;
use crate::error::{Error, Result};
use crate::mesh::{Mesh, Selection, SideIndex};
use crate::stiffness::gather;

/// What acts on the selected part of the mesh; one entry per direction.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// Force per area on sides, Pa.
    Traction(Vec<f64>),
    /// Force in all, N: spread evenly over the sides, or over the points where the part has no sides.
    Force(Vec<f64>),
    /// Force per volume on cells, N/m³.
    Body(Vec<f64>),
    /// Given displacement of points, m; `None` leaves a direction free.
    Displacement(Vec<Option<f64>>),
}

/// `f_a = ∫ N_a t dA` and `f_a = ∫ N_a b dV`, `[points · dimension]`, N. A displacement gives none.
///
/// `thickness` in m, 1 for a solid.
///
/// # Errors
/// The part has no sides, points or cells to act on.
pub fn nodal_forces(mesh: &Mesh, part: &Selection, action: &Action, thickness: f64) -> Result<Vec<f64>> {
    let nothing = |what: &str| Err(Error::at("load", format!("acts on nothing: the selected part has no {what}")));
    match action {
        Action::Traction(traction) => {
            let sides = part.sides(mesh)?;
            if sides.is_empty() {
                return nothing("sides");
            }
            let weights = side_weights(mesh, &sides);
            Ok(spread(mesh, &weights, &traction.iter().map(|t| t * thickness).collect::<Vec<_>>()))
        }
        Action::Force(force) => {
            let sides = part.sides(mesh)?;
            let weights = if sides.is_empty() {
                part.points(mesh)?.into_iter().map(|p| (p, 1.0)).collect()
            } else {
                side_weights(mesh, &sides)
            };
            let total: f64 = weights.iter().map(|(_, w)| w).sum();
            if weights.is_empty() {
                return nothing("points");
            }
            Ok(spread(mesh, &weights, &force.iter().map(|f| f / total).collect::<Vec<_>>()))
        }
        Action::Body(body) => {
            let mut chosen: Vec<Vec<bool>> = mesh.blocks.iter().map(|b| vec![false; b.cells().len()]).collect();
            let cells = part.cells(mesh)?;
            if cells.is_empty() {
                return nothing("cells");
            }
            cells.iter().for_each(|c| chosen[c.block][c.cell] = true);
            let mut weights = Vec::new();
            each_cell(mesh, |cell, nodes, geometry| {
                if chosen[cell.block][cell.cell] {
                    shares(mesh, cell, geometry, |a, share| weights.push((nodes[a], share)));
                }
            });
            Ok(spread(mesh, &weights, &body.iter().map(|b| b * thickness).collect::<Vec<_>>()))
        }
        Action::Displacement(_) => {
            if part.points(mesh)?.is_empty() {
                return nothing("points");
            }
            Ok(vec![0.0; mesh.points.len()])
        }
    }
}

fn spread(mesh: &Mesh, weights: &[(usize, f64)], per_unit: &[f64]) -> Vec<f64> {
    let mut forces = vec![0.0; mesh.points.len()];
    for (point, weight) in weights {
        for (k, t) in per_unit.iter().enumerate() {
            forces[point * mesh.dimension + k] += weight * t;
        }
    }
    forces
}

/// `∫ N_a dA` of every node of every side, m² (m in two dimensions).
fn side_weights(mesh: &Mesh, sides: &[SideIndex]) -> Vec<(usize, f64)> {
    let d = mesh.dimension;
    let mut weights = Vec::new();
    for index in sides {
        let block = &mesh.blocks[index.cell.block];
        let n = block.element.nodes();
        let cell = &block.connectivity[index.cell.cell * n..(index.cell.cell + 1) * n];
        let side = &block.element.sides()[index.side];
        let nodes: Vec<usize> = side.nodes.iter().map(|&a| cell[a]).collect();
        let mut x = vec![0.0; nodes.len() * d];
        gather(&mesh.points, d, &nodes, &mut x);
        for (values, area) in side.tabulation.values.chunks_exact(nodes.len()).zip(areas(&side.tabulation, &x, d)) {
            weights.extend(nodes.iter().zip(values).map(|(&node, n)| (node, n * area)));
        }
    }
    weights
}

/// `w_q ‖∂x/∂s₁ × ∂x/∂s₂‖` (`w_q ‖∂x/∂s‖` of a curve) at each quadrature point of a side.
fn areas(table: &Tabulation, x: &[f64], d: usize) -> Vec<f64> {
    let tangents = table.dimension;
    let at_point = |(gradients, w): (&[f64], &f64)| {
        let tangent = |l: usize| -> Vec<f64> {
            (0..d).map(|k| (0..table.nodes).map(|a| x[a * d + k] * gradients[a * tangents + l]).sum()).collect()
        };
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let s = tangent(0);
        if tangents == 1 {
            return w * dot(&s, &s).sqrt();
        }
        let t = tangent(1);
        let cross = [s[1] * t[2] - s[2] * t[1], s[2] * t[0] - s[0] * t[2], s[0] * t[1] - s[1] * t[0]];
        w * dot(&cross, &cross).sqrt()
    };
    table.gradients.chunks_exact(table.nodes * tangents).zip(&table.weights).map(at_point).collect()
}
