//! The assembled finite element model.
//!
//! Theory: page *Stiffness and the reduced space* of the book.

use super::Entries;
use super::bending::bending_springs;
use super::numbering::dofs;
use crate::element::Tabulation;
use crate::material::{CellMap, Hooke};
use crate::mesh::{CellBlock, CellIndex, Mesh};
use crate::stiffness::{self, Geometry, Placement};
use faer::sparse::Triplet;
use nalgebra::DMatrix;

/// Calls `visit(cell, nodes, geometry)` for every cell of the mesh.
pub(super) fn each_cell(mesh: &Mesh, mut visit: impl FnMut(CellIndex, &[usize], &Geometry)) {
    for (index, block) in mesh.blocks.iter().enumerate() {
        let visit = |cell, _: &[f64], geometry: &Geometry| {
            visit(CellIndex { block: index, cell }, block.cell(cell), geometry);
        };
        stiffness::each_cell(&block.element.tabulation, &mesh.points, &block.connectivity, visit)
            .expect("a mesh holds only cells with a volume");
    }
}

/// The length, area or volume of all cells, by the quadrature rules of their stiffness, over which averages of energies
/// are taken.
pub fn content(mesh: &Mesh) -> f64 {
    let mut content = 0.0;
    each_cell(mesh, |_, _, geometry| content += geometry.content());
    content
}

/// The number of entries in the lower triangle of a matrix with so many rows.
pub(super) fn triangle(rows: usize) -> usize {
    rows * (rows + 1) / 2
}

/// The number of entries of [`finite_elements`].
pub(super) fn body_entries(mesh: &Mesh) -> usize {
    let block = |block: &CellBlock| block.cells().len() * triangle(block.element.nodes() * mesh.dimension);
    mesh.blocks.iter().map(block).sum()
}

/// The assembled stiffness of the mesh, N/m, with the moduli of all cells or of each. A degree of freedom has the number `point · dimension + direction`.
pub fn finite_elements(mesh: &Mesh, moduli: impl Into<CellMap<Hooke>>) -> Entries {
    assembled(mesh, moduli.into())
}

/// [`finite_elements`], without parameters of type: compiled here, where code is optimised, and not with each caller.
fn assembled(mesh: &Mesh, moduli: CellMap<Hooke>) -> Entries {
    let d = mesh.dimension;
    let mut entries = Entries::with_capacity(body_entries(mesh));
    each_cell(mesh, |cell, nodes, geometry| {
        let r = cell_stiffness(mesh, (cell, nodes, geometry), moduli.at(cell.block, cell.cell));
        for (i, row) in dofs(nodes, d).enumerate() {
            for (j, column) in dofs(nodes, d).enumerate() {
                // The stiffness is symmetric: the lower triangle is all of it.
                if row >= column {
                    entries.push(Triplet::new(row, column, r[(i, j)]));
                }
            }
        }
    });
    // Plates and beams are springs in either model; other bodies have none.
    entries.extend(bending_springs(mesh, &moduli).stiffness(&mesh.points));
    entries
}

/// The stiffness of a cell in the space of its mesh, `[nodes · dimension]²`, N/m.
fn cell_stiffness(
    mesh: &Mesh,
    (cell, nodes, geometry): (CellIndex, &[usize], &Geometry),
    moduli: &Hooke,
) -> DMatrix<f64> {
    let r = geometry.stiffness(moduli);
    let table = &mesh.blocks[cell.block].element.tabulation;
    if table.dimension < mesh.dimension { in_space(table, &mesh.points, nodes, &r) } else { r }
}

/// What is done with the forces of a cell: its index, its nodes, and the forces of each part.
pub type ForceVisit<'a> = dyn FnMut(CellIndex, &[usize], &[Vec<Vec<f64>>]) + 'a;

/// Calls `visit(cell, nodes, forces)` with the forces `K_e u` of every cell for each of several moduli of it, which `moduli` lists, and each of
/// several displacements u, `[moduli][displacements]` of `[nodes · dimension]`, N.
pub fn each_cell_forces(
    mesh: &Mesh,
    displacements: &[&[f64]],
    moduli: &dyn Fn(CellIndex) -> Vec<Hooke>,
    visit: &mut ForceVisit,
) {
    let d = mesh.dimension;
    each_cell(mesh, |cell, nodes, geometry| {
        let of = |hooke: &Hooke| -> Vec<Vec<f64>> {
            let r = cell_stiffness(mesh, (cell, nodes, geometry), hooke);
            let product = |u: &&[f64]| {
                let local: Vec<f64> = dofs(nodes, d).map(|dof| u[dof]).collect();
                (0..local.len()).map(|i| local.iter().enumerate().map(|(j, u)| r[(i, j)] * u).sum()).collect()
            };
            displacements.iter().map(product).collect()
        };
        let forces: Vec<Vec<Vec<f64>>> = moduli(cell).iter().map(of).collect();
        visit(cell, nodes, &forces);
    });
}

/// The length, area or volume of each cell, by block, and its middle, the mean of its nodes.
pub fn cell_places(mesh: &Mesh) -> Vec<Vec<(f64, Vec<f64>)>> {
    let mut places: Vec<Vec<(f64, Vec<f64>)>> = mesh.blocks.iter().map(|_| Vec::new()).collect();
    each_cell(mesh, |cell, nodes, geometry| {
        let mean = |k: usize| nodes.iter().map(|&p| mesh.point(p)[k]).sum::<f64>() / nodes.len() as f64;
        places[cell.block].push((geometry.content(), (0..mesh.dimension).map(mean).collect()));
    });
    places
}

/// `Q R Qᵀ` of a cell of a surface or curve; Q maps the displacements in its own plane or line into space.
pub(super) fn in_space(table: &Tabulation, points: &[f64], nodes: &[usize], r: &DMatrix<f64>) -> DMatrix<f64> {
    let (n, d, space) = (table.nodes, table.dimension, table.space);
    let mut placement = Placement::new(table);
    placement.place(table, points, nodes, &mut vec![0.0; n * d]).expect("a mesh holds only cells with tangents");
    let mut q = DMatrix::zeros(n * space, n * d);
    for (a, k, l) in (0..n).flat_map(|a| (0..space).flat_map(move |k| (0..d).map(move |l| (a, k, l)))) {
        q[(a * space + k, a * d + l)] = placement.frame[l * space + k];
    }
    &q * r * q.transpose()
}
