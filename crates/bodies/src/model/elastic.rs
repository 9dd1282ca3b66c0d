//! Both models at large deformation: their energy, forces and tangent at given positions.

use super::bending::bending_at_large_deformation;
use super::blocks::BlockStiffness;
use super::network::Network;
use super::numbering::dofs;
use super::rows::Rows;
use super::system;
use super::{Entries, Response};
use crate::material::{Energy, EnergyMap, State};
use crate::mesh::{CellIndex, Mesh};
use crate::stiffness::{Geometry, gathered};
use faer::sparse::Triplet;

/// A model that resists deformation.
pub trait Elastic {
    /// Energy, forces and tangent with the points at `x`, `[points × dimension]`, m; `None` if the model has none, for
    /// example in an inverted cell.
    fn respond(&self, x: &[f64]) -> Option<Response>;

    /// The energy alone, as in [`Elastic::respond`], J.
    fn energy(&self, x: &[f64]) -> Option<f64> {
        self.respond(x).map(|response| response.energy)
    }

    /// Writes the forces alone, `[points × dimension]`, N, into `force`; false if there are none.
    fn forces(&self, x: &[f64], force: &mut [f64]) -> bool {
        self.respond(x).map(|response| force.copy_from_slice(&response.force)).is_some()
    }

    /// The tangent at x in blocks, without a list of entries, for models that can assemble it so.
    fn blocks(&self, _x: &[f64]) -> Option<BlockStiffness> {
        None
    }

    /// The network with its points and forces in rows of its own numbers, if this model is one, for explicit steps without an account.
    fn rows(&self) -> Option<Rows<'_>> {
        None
    }

    /// Writes the response of [`Elastic::respond`] into existing memory: the forces, and the values of the entries of the tangent, with the
    /// positions and order that they have at rest. Returns the energy, J.
    fn refill(&self, x: &[f64], force: &mut [f64], tangent: &mut [f64]) -> Option<f64> {
        let response = self.respond(x)?;
        force.copy_from_slice(&response.force);
        tangent.iter_mut().zip(&response.tangent).for_each(|(value, entry)| *value = entry.val);
        Some(response.energy)
    }

    /// Writes forces and tangent as [`Elastic::refill`] does. If the model has a positive semidefinite approximation of the tangent, that
    /// is written in its place.
    fn refill_definite(&self, x: &[f64], force: &mut [f64], tangent: &mut [f64]) -> Option<f64> {
        self.refill(x, force, tangent)
    }
}

/// The strain by which a cell of a surface in space may differ from a flat one: coordinates in files have six digits or more.
const BENT: f64 = 1e-5;

/// The finite element model of a hyperelastic body.
#[derive(Debug)]
pub struct Body<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// The energy per volume and the state of each cell.
    pub laws: &'a EnergyMap,
    /// What resists bending: the springs of a sheet, which are its finite elements too; none of other bodies.
    plate: Network,
}

impl<'a> Body<'a> {
    /// A body at large deformation. A sheet bends as its laws are at rest.
    pub fn new(mesh: &'a Mesh, laws: &'a EnergyMap) -> Body<'a> {
        Body { mesh, laws, plate: bending_at_large_deformation(mesh, laws) }
    }

    /// The number of cells with a quadrature point at which `det F ≤ 0`.
    pub fn inverted(&self, x: &[f64]) -> usize {
        inverted(self.mesh, x)
    }

    /// The first cell of a surface or curve in space that is bent at rest, and how far: it would not be at rest as a flat one.
    pub fn bent(&self) -> Option<(CellIndex, f64)> {
        let mut bent = None;
        system::each_cell(self.mesh, |cell, nodes, geometry| {
            if bent.is_none() && geometry.dimension < self.mesh.dimension {
                let bend = geometry.bend(&self.places(&self.mesh.points, nodes));
                bent = (bend > BENT).then_some((cell, bend));
            }
        });
        bent
    }

    /// Visits the cells until one has no answer, with the positions of their nodes at x.
    fn each_cell(
        &self,
        x: &[f64],
        mut visit: impl FnMut(&[usize], &Geometry, (&Energy, State), &[f64]) -> Option<()>,
    ) -> Option<()> {
        let mut all = Some(());
        system::each_cell(self.mesh, |cell, nodes, geometry| {
            // The visit of a mesh cannot be ended: cells after the first without an answer are passed over.
            if all.is_some() {
                all = visit(nodes, geometry, self.laws.at(cell.block, cell.cell), &self.places(x, nodes));
            }
        });
        all
    }

    fn places(&self, x: &[f64], nodes: &[usize]) -> Vec<f64> {
        places(self.mesh, x, nodes)
    }
}

fn places(mesh: &Mesh, x: &[f64], nodes: &[usize]) -> Vec<f64> {
    gathered(x, mesh.dimension, nodes)
}

/// The number of cells with a quadrature point at which `det F ≤ 0`, with the points at x, `[points · dimension]`, m. Membranes and rods
/// have no inside.
pub fn inverted(mesh: &Mesh, x: &[f64]) -> usize {
    let mut inverted = 0;
    let has_inside = |block: usize| mesh.blocks[block].element.dimension() == mesh.dimension;
    system::each_cell(mesh, |cell, nodes, geometry| {
        if has_inside(cell.block) {
            inverted += usize::from(geometry.least_determinant(&places(mesh, x, nodes)) <= 0.0);
        }
    });
    inverted
}

impl Elastic for Body<'_> {
    fn respond(&self, x: &[f64]) -> Option<Response> {
        let d = self.mesh.dimension;
        let mut total = Response { energy: 0.0, force: vec![0.0; x.len()], tangent: Entries::new() };
        self.each_cell(x, |nodes, geometry, (energy, state), local| {
            let cell = geometry.respond(energy, state, local)?;
            total.energy += cell.energy;
            for (i, row) in dofs(nodes, d).enumerate() {
                total.force[row] += cell.force[i];
                // The tangent of an energy is symmetric: the lower triangle is all of it.
                for (j, column) in dofs(nodes, d).enumerate().filter(|(_, column)| row >= *column) {
                    total.tangent.push(Triplet::new(row, column, cell.tangent[(i, j)]));
                }
            }
            Some(())
        })?;
        if !self.plate.is_empty() {
            let bent = self.plate.respond(x)?;
            total.energy += bent.energy;
            total.force.iter_mut().zip(bent.force).for_each(|(f, own)| *f += own);
            total.tangent.extend(bent.tangent);
        }
        Some(total)
    }

    fn forces(&self, x: &[f64], force: &mut [f64]) -> bool {
        force.fill(0.0);
        let all = self.each_cell(x, |nodes, geometry, (energy, state), local| {
            let mut own = vec![0.0; local.len()];
            if !geometry.forces(energy, state, local, f64::NEG_INFINITY, &mut own) {
                return None;
            }
            dofs(nodes, self.mesh.dimension).zip(&own).for_each(|(dof, f)| force[dof] += f);
            Some(())
        });
        if all.is_some() && !self.plate.is_empty() {
            let mut bent = vec![0.0; x.len()];
            let has_forces = self.plate.pull(x, &mut bent);
            force.iter_mut().zip(bent).for_each(|(f, own)| *f += own);
            return has_forces;
        }
        all.is_some()
    }
}

impl Elastic for Network {
    fn respond(&self, x: &[f64]) -> Option<Response> {
        let mut tangent: Entries = self.places().map(|(row, column)| Triplet::new(row, column, 0.0)).collect();
        let (mut force, mut values) = (vec![0.0; x.len()], vec![0.0; tangent.len()]);
        let energy = self.refill(x, &mut force, &mut values)?;
        tangent.iter_mut().zip(values).for_each(|(entry, value)| entry.val = value);
        Some(Response { energy, force, tangent })
    }

    fn energy(&self, x: &[f64]) -> Option<f64> {
        self.stored(x)
    }

    fn forces(&self, x: &[f64], force: &mut [f64]) -> bool {
        self.pull(x, force)
    }

    fn blocks(&self, x: &[f64]) -> Option<BlockStiffness> {
        // Columns of blocks are numbers of 32 bits, and blocks are those of the plane or of space.
        let is_stored = self.dimension > 1 && x.len() / self.dimension < u32::MAX as usize;
        is_stored.then(|| BlockStiffness::of_network(self, x, None))
    }

    fn refill(&self, x: &[f64], force: &mut [f64], tangent: &mut [f64]) -> Option<f64> {
        self.pull_and_stiffen(x, force, tangent, false)
    }

    fn refill_definite(&self, x: &[f64], force: &mut [f64], tangent: &mut [f64]) -> Option<f64> {
        self.pull_and_stiffen(x, force, tangent, true)
    }
}
