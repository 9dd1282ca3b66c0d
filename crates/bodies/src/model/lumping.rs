//! Masses at the points instead of a mass matrix.

use super::integration::each_cell_points;
use crate::element::Integrand;
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

/// Nodal masses, `[points]`, kg. `thickness` in m, 1 for a solid; `density` in kg/m³. The integrals have rules of their own, exact for
/// the shape functions whatever the rule of the stiffness: [`crate::element::Element::integration_table`].
pub fn lumped_masses(mesh: &Mesh, density: f64, thickness: f64, lumping: Lumping) -> Vec<f64> {
    let mut masses = vec![0.0; mesh.point_count()];
    match lumping {
        Lumping::RowSum => each_cell_points(
            mesh,
            Integrand::Load(0),
            |_| true,
            |cell| {
                for (values, v) in cell.each() {
                    cell.nodes.iter().zip(values).for_each(|(&p, n)| masses[p] += density * thickness * (v * n));
                }
            },
        ),
        Lumping::Hrz => each_cell_points(
            mesh,
            Integrand::Mass,
            |_| true,
            |cell| {
                let (mut diagonal, mut volume) = (vec![0.0; cell.nodes.len()], 0.0);
                for (values, v) in cell.each() {
                    diagonal.iter_mut().zip(values).for_each(|(m, n)| *m += v * n * n);
                    volume += v;
                }
                let scale = density * thickness * volume / diagonal.iter().sum::<f64>();
                cell.nodes.iter().zip(&diagonal).for_each(|(&p, m)| masses[p] += scale * m);
            },
        ),
    }
    masses
}

/// Nodal masses `m_a = ∫ ρ N_a dV`, `[points]`, kg: the row sums of the consistent mass matrix, which for a
/// tetrahedron are a quarter of its mass. `thickness` in m, 1 for a solid; `density` in kg/m³.
pub fn masses(mesh: &Mesh, density: f64, thickness: f64) -> Vec<f64> {
    lumped_masses(mesh, density, thickness, Lumping::RowSum)
}
