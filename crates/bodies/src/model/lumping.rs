//! Masses at the points instead of a mass matrix.
//!
//! Theory: page *Dynamics* of the book.

use super::integration::each_cell_points;
use crate::element::Integrand;
use crate::material::CellMap;
use crate::mesh::{CellIndex, Mesh};
use crate::springs::{distance, norm};

/// How the mass of a cell is distributed among its nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Lumping {
    /// `m_a = ∫ ρ N_a dV`, the row sums of the consistent mass matrix. They represent the weight of the body exactly,
    /// but those of the corners of quadratic cells are zero or negative.
    #[default]
    RowSum,
    /// `m_a = m ∫ N_a² dV/Σ_b ∫ N_b² dV`, the diagonal of the consistent mass matrix scaled to the mass m of the cell:
    /// positive for every element (Hinton, Rock, Zienkiewicz, Earthquake Eng. Struct. Dyn. 4, 1976). On linear
    /// simplices it is equal to `RowSum`.
    Hrz,
}

crate::named!(Lumping { "row-sum" => RowSum, "hrz" => Hrz });

/// The nodal masses, `[points]`, kg. `thickness` is in m, 1 for a solid; `density` is in kg/m³; each is that
/// of all cells, or one of each. The quadrature rules
/// are exact for the shape functions, whatever the rule of the stiffness is:
/// [`crate::element::Element::integration_table`].
pub fn lumped_masses(
    mesh: &Mesh,
    density: impl Into<CellMap<f64>>,
    thickness: impl Into<CellMap<f64>>,
    lumping: Lumping,
) -> Vec<f64> {
    lumped(mesh, density.into(), thickness.into(), lumping)
}

/// [`lumped_masses`], without parameters of type: compiled here, where code is optimised, and not with each caller.
fn lumped(mesh: &Mesh, density: CellMap<f64>, thickness: CellMap<f64>, lumping: Lumping) -> Vec<f64> {
    let of = |cell: CellIndex| density.at(cell.block, cell.cell) * thickness.at(cell.block, cell.cell);
    let mut masses = vec![0.0; mesh.point_count()];
    match lumping {
        Lumping::RowSum => each_cell_points(
            mesh,
            Integrand::Load(0),
            |_| true,
            |cell| {
                // Shape functions add up to one, so that the sum of a row of the mass matrix is the integral of its own
                // function.
                for (values, v) in cell.each() {
                    cell.nodes.iter().zip(values).for_each(|(&p, n)| masses[p] += of(cell.index) * (v * n));
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
                let scale = of(cell.index) * volume / diagonal.iter().sum::<f64>();
                cell.nodes.iter().zip(&diagonal).for_each(|(&p, m)| masses[p] += scale * m);
            },
        ),
    }
    let turning = turning_masses(mesh, &of);
    for TurningMass { director, ends, mass, .. } in turning {
        masses[director] += mass;
        // So the body has its mass.
        ends.iter().for_each(|&end| masses[end] -= mass / 2.0);
    }
    masses
}

/// How many times the rotary inertia of a plate directors have: as much as no explicit step of theirs is much shorter than one of the membrane. Thin plates move
/// as if they had none.
const INERTIA: f64 = 4.0;

/// The share of a cell in the mass of a director.
pub(super) struct TurningMass {
    /// The director.
    pub director: usize,
    /// The ends of its edge, or its joint twice.
    pub ends: [usize; 2],
    /// The mass that it has for explicit steps, kg.
    pub mass: f64,
    /// The mass by which it has the rotary inertia of the body, kg.
    pub own: f64,
}

/// The masses of the directors of a sheet or of rods. A plate of thickness t has the rotary inertia `ρ t³/12` per area; a director at the distance r from an edge
/// has `m r²` of some times that for a third of the triangles there. A rod has `ρ I` per length, and twice that about itself; each of the two directors of a joint has
/// it for half of the rods there. `of` is the mass per content of a cell, kg/m² or kg/m.
pub(super) fn turning_masses(mesh: &Mesh, of: &impl Fn(CellIndex) -> f64) -> Vec<TurningMass> {
    let Some(directors) = &mesh.directors else { return Vec::new() };
    let first = mesh.node_count();
    let mut masses = Vec::new();
    let is_rod = mesh.cell_dimension() == 1;
    for (index, gyration) in mesh.cell_indices().zip(&directors.gyration) {
        let nodes = mesh.cell_nodes(index);
        let (share, inertia) = match is_rod {
            true => (mesh.rod_length(nodes) / 2.0, 1.0),
            // Each of the three directors of a triangle has a third of it; each end of a rod has a half.
            false => (norm(&mesh.area_vector(nodes)) / 3.0, INERTIA),
        };
        for &point in directors.of_cell(index.cell) {
            let ends = directors.edges[point - first];
            let reach = distance(mesh.point(point), &mesh.mean_place(&ends));
            let own = of(index) * share * gyration / reach.powi(2);
            masses.push(TurningMass { director: point, ends, mass: inertia * own, own });
        }
    }
    masses
}

/// The nodal masses `m_a = ∫ ρ N_a dV`, `[points]`, kg: the row sums of the consistent mass matrix. Each node of a
/// linear tetrahedron gets a quarter of its mass. `thickness` is in m, 1 for a solid; `density` is in kg/m³.
pub fn masses(mesh: &Mesh, density: impl Into<CellMap<f64>>, thickness: impl Into<CellMap<f64>>) -> Vec<f64> {
    lumped_masses(mesh, density, thickness, Lumping::RowSum)
}
