//! The finite element model.

use super::Entries;
use crate::material::Moduli;
use crate::mesh::{CellIndex, Mesh};
use crate::stiffness::{self, Geometry};
use faer::sparse::Triplet;

/// Calls `visit(cell, nodes, geometry)` for every cell of the mesh.
pub(super) fn each_cell(mesh: &Mesh, mut visit: impl FnMut(CellIndex, &[usize], &Geometry)) {
    for (index, block) in mesh.blocks.iter().enumerate() {
        let n = block.element.nodes();
        let visit = |cell, _: &[f64], geometry: &Geometry| {
            visit(CellIndex { block: index, cell }, &block.connectivity[cell * n..(cell + 1) * n], geometry);
        };
        stiffness::each_cell(&block.element.tabulation, &mesh.points, &block.connectivity, visit)
            .expect("a mesh holds only cells with a volume");
    }
}

/// The assembled stiffness of the mesh, N/m; degree of freedom `point · dimension + direction`.
pub fn finite_elements(mesh: &Mesh, moduli: Moduli) -> Entries {
    let d = mesh.dimension;
    let mut entries = Entries::new();
    each_cell(mesh, |_, nodes, geometry| {
        let r = geometry.stiffness(moduli);
        for (i, row) in dofs(nodes, d).enumerate() {
            for (j, column) in dofs(nodes, d).enumerate() {
                if row >= column {
                    entries.push(Triplet::new(row, column, r[(i, j)]));
                }
            }
        }
    });
    entries
}

/// The degrees of freedom of `nodes`, in order.
pub(super) fn dofs(nodes: &[usize], dimension: usize) -> impl Iterator<Item = usize> + Clone {
    nodes.iter().flat_map(move |n| (0..dimension).map(move |k| n * dimension + k))
}

/// Nodal masses `m_a = ∫ ρ N_a dV`, `[points]`, kg: the row sums of the consistent mass matrix, which for a
/// tetrahedron are a quarter of its mass. `thickness` in m, 1 for a solid; `density` in kg/m³.
pub fn masses(mesh: &Mesh, density: f64, thickness: f64) -> Vec<f64> {
    let mut masses = vec![0.0; mesh.point_count()];
    each_cell(mesh, |cell, nodes, geometry| {
        shares(mesh, cell, geometry, |a, share| masses[nodes[a]] += density * thickness * share);
    });
    masses
}

/// Calls `visit(a, share)` with `N_a w |J|` for every node a and quadrature point of a cell.
pub(super) fn shares(mesh: &Mesh, cell: CellIndex, geometry: &Geometry, mut visit: impl FnMut(usize, f64)) {
    let values = mesh.blocks[cell.block].element.tabulation.values.chunks_exact(geometry.nodes);
    for (values, v) in values.zip(&geometry.volumes) {
        values.iter().enumerate().for_each(|(a, n)| visit(a, v * n));
    }
}
