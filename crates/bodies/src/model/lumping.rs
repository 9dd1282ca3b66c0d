//! Masses at the points instead of a mass matrix.

use super::masses;
use super::system::{each_cell, shares};
use crate::mesh::Mesh;

/// How the mass of a cell is shared among its nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Lumping {
    /// `m_a = ∫ ρ N_a dV`, the row sums of the consistent mass matrix. They balance the weight of the body exactly; of quadratic
    /// cells those of the corners are zero or negative.
    #[default]
    RowSum,
    /// `m_a = m ∫ N_a² dV / Σ_b ∫ N_b² dV`, the diagonal of the consistent mass matrix scaled to the mass m of the cell: above
    /// zero for every element (Hinton, Rock, Zienkiewicz, Earthquake Eng. Struct. Dyn. 4, 1976). Of linear simplices the same.
    Hrz,
}

crate::named!(Lumping { "row-sum" => RowSum, "hrz" => Hrz });

/// Nodal masses, `[points]`, kg. `thickness` in m, 1 for a solid; `density` in kg/m³.
pub fn lumped_masses(mesh: &Mesh, density: f64, thickness: f64, lumping: Lumping) -> Vec<f64> {
    if lumping == Lumping::RowSum {
        return masses(mesh, density, thickness);
    }
    let mut masses = vec![0.0; mesh.point_count()];
    each_cell(mesh, |cell, nodes, geometry| {
        let values = &mesh.blocks[cell.block].element.tabulation.values;
        let mut diagonal = vec![0.0; nodes.len()];
        for (n, v) in values.chunks_exact(nodes.len()).zip(&geometry.volumes) {
            diagonal.iter_mut().zip(n).for_each(|(m, n)| *m += v * n * n);
        }
        let mut volume = 0.0;
        shares(mesh, cell, geometry, |_, share| volume += share);
        let scale = density * thickness * volume / diagonal.iter().sum::<f64>();
        nodes.iter().zip(&diagonal).for_each(|(&p, m)| masses[p] += scale * m);
    });
    masses
}
