//! The lowest vibrations of a free body, whose energies a network should have.

use crate::error::Result;
use crate::mesh::Mesh;
use crate::model::{Entries, Lumping, Support, lumped_masses, unheld_bodies};
use crate::solve::{System, lowest_modes};
use faer::sparse::Triplet;

/// The largest number of separate bodies. Each has rigid motions of its own, and with more of them the modes take too
/// long.
const BODIES: usize = 20;
/// An ω² below this share of the shift is a rigid motion, or that of a hinge.
// Rounding of ω² on slender bodies is some 1e-8 of it (`modes.rs`).
const RIGID: f64 = 1e-7;
/// A network is unstable if it has a negative ω² of this share of the least ω² of the body.
// The rounding of the factor, some 1e-16 of the largest ω², is smaller unless that is 1e12 times the least.
const UNSTABLE: f64 = 1e-4;

/// The lowest vibrations of a free body with unit density.
#[derive(Debug, Clone, Default)]
pub(super) struct Vibrations {
    /// The displacements of each mode, `[points × dimension]`.
    pub shapes: Vec<Vec<f64>>,
    /// The least ω² of a motion that is not rigid.
    least: Option<f64>,
    masses: Vec<f64>,
}

impl Vibrations {
    /// The `count` lowest modes of a body with this stiffness; `modulus` is a typical one, Pa. A surface or curve in
    /// space has none, because a membrane has no resistance across itself.
    ///
    /// # Errors
    /// The equations do not fit into memory, or the modes are not found.
    pub fn new(mesh: &Mesh, stiffness: &Entries, modulus: f64, count: usize) -> Result<Vibrations> {
        let d = mesh.dimension;
        // Row sums are below zero at corners of some quadratic cells; modes need masses above zero.
        let masses = lumped_masses(mesh, 1.0, 1.0, Lumping::Hrz);
        let support = Support::free(mesh);
        let unheld = unheld_bodies(mesh, &support);
        if mesh.cell_dimension() < d || unheld.len() > BODIES {
            return Ok(Vibrations { masses, ..Vibrations::default() });
        }
        let size = extent(mesh);
        // The free body has a singular stiffness. A shift by σ M makes it regular, adds σ to each ω² and leaves the
        // shapes; with unit density this σ has the size of the lowest ω².
        let shift = modulus / (size * size);
        let system = System::new(&raised(stiffness, &masses, d, shift), &support)?.placed(&mesh.points, d);
        let rigid: usize = unheld.iter().map(|body| body.motions).sum();
        let Some(factor) = system.cholesky()? else { return Ok(Vibrations { masses, ..Vibrations::default() }) };
        // Rigid motions are found first, as those of the least ω².
        let modes = lowest_modes(&system, &factor, &masses, d, (rigid + count).min(system.size()))?;
        let (mut shapes, mut least) = (Vec::new(), None);
        for (square, shape) in modes.squares.iter().zip(modes.shapes) {
            if square - shift > RIGID * shift {
                least.get_or_insert(square - shift);
                shapes.push(shape);
            }
        }
        Ok(Vibrations { shapes, least, masses })
    }

    /// Whether a network with this stiffness and without supports has no motion that releases energy.
    ///
    /// # Errors
    /// The equations do not fit into memory.
    pub fn are_stable(&self, mesh: &Mesh, stiffness: &Entries) -> Result<bool> {
        // Without modes there is no scale of ω² by which a negative one could be told from rounding.
        let Some(least) = self.least else { return Ok(true) };
        let raised = raised(stiffness, &self.masses, mesh.dimension, UNSTABLE * least);
        let system = System::new(&raised, &Support::free(mesh))?.placed(&mesh.points, mesh.dimension);
        Ok(system.cholesky()?.is_some())
    }
}

/// `K + σ M`.
fn raised(stiffness: &Entries, masses: &[f64], dimension: usize, shift: f64) -> Entries {
    let mut entries = stiffness.clone();
    let dofs = masses.iter().enumerate().flat_map(|(p, m)| (0..dimension).map(move |k| (p * dimension + k, *m)));
    entries.extend(dofs.map(|(dof, m)| Triplet::new(dof, dof, shift * m)));
    entries
}

/// The longest side of the box around the mesh, m.
fn extent(mesh: &Mesh) -> f64 {
    let d = mesh.dimension;
    let side = |k: usize| {
        let x = || mesh.points.iter().skip(k).step_by(d).copied();
        x().fold(f64::NEG_INFINITY, f64::max) - x().fold(f64::INFINITY, f64::min)
    };
    (0..d).map(side).fold(0.0, f64::max)
}
