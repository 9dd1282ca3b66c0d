//! Both models at large deformation: their energy, forces and tangent at given positions.

use super::network::Network;
use super::system::{self, dofs};
use super::{Entries, Response};
use crate::material::{Energy, State};
use crate::mesh::Mesh;
use crate::springs::Measure;
use crate::stiffness::{Geometry, gather};
use faer::sparse::Triplet;

/// What resists deformation.
pub trait Elastic {
    /// The response with the points at `x`, `[points × dimension]`, m; `None` where there is none, as in a cell turned
    /// inside out.
    fn respond(&self, x: &[f64]) -> Option<Response>;
}

/// Hyperelastic finite elements.
#[derive(Debug)]
pub struct Body<'a> {
    pub mesh: &'a Mesh,
    pub energy: &'a Energy,
    pub state: State,
}

impl Body<'_> {
    /// How many cells have a quadrature point where `det F ≤ 0`.
    pub fn inverted(&self, x: &[f64]) -> usize {
        let mut inverted = 0;
        self.each_cell(|nodes, geometry| {
            let d = geometry.dimension;
            let mut local = vec![0.0; nodes.len() * d];
            gather(x, d, nodes, &mut local);
            inverted += usize::from(geometry.least_determinant(&local) <= 0.0);
            Some(())
        });
        inverted
    }

    /// Stops at the first cell without an answer.
    fn each_cell(&self, mut visit: impl FnMut(&[usize], &Geometry) -> Option<()>) -> Option<()> {
        let mut all = Some(());
        system::each_cell(self.mesh, |_, nodes, geometry| {
            if all.is_some() {
                all = visit(nodes, geometry);
            }
        });
        all
    }
}

impl Elastic for Body<'_> {
    fn respond(&self, x: &[f64]) -> Option<Response> {
        let d = self.mesh.dimension;
        let mut total = Response { energy: 0.0, force: vec![0.0; x.len()], tangent: Entries::new() };
        self.each_cell(|nodes, geometry| {
            let mut local = vec![0.0; nodes.len() * d];
            gather(x, d, nodes, &mut local);
            let cell = geometry.respond(self.energy, self.state, &local)?;
            total.energy += cell.energy;
            for (i, row) in dofs(nodes, d).enumerate() {
                total.force[row] += cell.force[i];
                for (j, column) in dofs(nodes, d).enumerate().filter(|(_, column)| row >= *column) {
                    total.tangent.push(Triplet::new(row, column, cell.tangent[(i, j)]));
                }
            }
            Some(())
        })?;
        Some(total)
    }
}

impl Elastic for Network {
    fn respond(&self, x: &[f64]) -> Option<Response> {
        let d = self.dimension;
        let mut total = Response { energy: 0.0, force: vec![0.0; x.len()], tangent: Entries::new() };
        let mut add = |measure: &Measure, points: &[usize], law: &dyn Fn(f64) -> [f64; 3]| -> Option<()> {
            let mut local = vec![0.0; points.len() * d];
            gather(x, d, points, &mut local);
            let spring = measure.respond_by(law, &local, d);
            let size = local.len();
            total.energy += spring.energy;
            for (i, row) in dofs(points, d).enumerate() {
                total.force[row] -= spring.force[i];
                for (j, column) in dofs(points, d).enumerate().filter(|(_, column)| row >= *column) {
                    total.tangent.push(Triplet::new(row, column, spring.tangent[i * size + j]));
                }
            }
            spring.energy.is_finite().then_some(())
        };
        for spring in &self.lengths {
            add(&Measure::Length, &spring.points, &|length| spring.pull(length))?;
        }
        for spring in &self.others {
            add(&spring.measure, &spring.points, &|c| spring.pull(c))?;
        }
        Some(total)
    }
}
