//! One load case on a mesh.

use crate::analysis::metrics::{DisplacementError, displacement_error, product};
use crate::mesh::{Field, Mesh};
use crate::model::{Cavity, PressedFaces, Support};
use crate::outcome::{Measured, Standard};
use crate::scalar::norm;
use crate::solve::Applied;

/// Nodes that move by less than this share of the directors' displacements stay where they are: a rod that twists alone.
// A solution moves such nodes by rounding. Relative to that, every error of theirs would be of the size of one.
const STILL: f64 = 1e-9;

/// A load case on a mesh: its support and nodal forces.
pub struct Case {
    /// The name of the load.
    pub name: String,
    /// What is held or moved.
    pub support: Support,
    /// `[points · dimension]`, N; those of pressures with the points at rest.
    pub forces: Vec<f64>,
    /// The faces of the pressures among them, which follow these at large deformation.
    pub pressed: Option<PressedFaces>,
    /// The load fills this cavity to a given volume. The pressure in it is found; `forces` do not have it.
    pub cavity: Option<Cavity>,
    /// Whether the load prescribes displacements or a volume; its work is then that of the forces that hold them.
    pub is_prescribed: bool,
    /// Displacements that were measured under the load, or are those of a finer body, `[points · dimension]`, m, if there are any.
    pub measured: Option<Field>,
    /// Whether these are from a file.
    pub is_measured: bool,
    /// What is known of the finer solution that gives them otherwise.
    pub finer: Option<FinerSolution>,
    /// The standard deviation of their noise, m.
    pub noise: Option<f64>,
}

/// A solution of the same body that is nearer to the truth than that of the finite elements of the mesh.
#[derive(Debug, Clone, Copy)]
pub struct FinerSolution {
    pub standard: Standard,
    /// J; see [`Case::work`].
    pub work: Option<f64>,
    /// The estimate of its own error, from the difference of two levels; `None` with a single level.
    pub uncertainty: Option<DisplacementError>,
}

impl Case {
    /// What acts, at large deformation.
    pub fn applied(&self) -> Applied<'_> {
        Applied { forces: &self.forces, pressed: self.pressed.as_ref() }
    }

    /// The work of the final forces along the final displacements, J, which is twice the energy of a linear model:
    /// `f·u`, or `gᵀu` under prescribed displacements, which `held` computes. `None` if it is not finite.
    pub fn work(&self, u: &[f64], held: impl FnOnce() -> Option<f64>) -> Option<f64> {
        let work = if self.is_prescribed { held()? } else { product(&self.forces, u) };
        Some(work).filter(|work| work.is_finite())
    }

    /// By how many percent the compliance of a model exceeds that of the finite elements, or of the finer solution; `None` for measured
    /// displacements. Under forces it is proportional to the work, under prescribed displacements to its inverse: of a network that
    /// is too soft forces do more work, and less work moves it as far.
    pub fn work_error(&self, fem: Option<f64>, found: Option<f64>) -> Option<f64> {
        let known = match (&self.measured, &self.finer) {
            (None, _) => fem,
            (Some(_), finer) => finer.as_ref()?.work,
        };
        // Either way the compliance of the model stands over that of the body.
        let ratio = if self.is_prescribed { known? / found? } else { found? / known? };
        let error = 100.0 * (ratio - 1.0);
        Some(error).filter(|error| error.is_finite())
    }

    /// The error of displacements: at the measured points if the load was measured, otherwise relative to the finite
    /// elements at the nodes of cells, and at directors as well where these alone move.
    pub fn error(&self, mesh: &Mesh, fem: &[f64], found: &[f64]) -> Option<DisplacementError> {
        let dimension = mesh.dimension;
        let Some(field) = &self.measured else {
            let largest = |u: &[f64]| u.iter().fold(0.0, |largest: f64, u| largest.max(u.abs()));
            let (nodes, directors) = fem.split_at(mesh.node_count() * dimension);
            let compared = if largest(nodes) < STILL * largest(directors) { fem.len() } else { nodes.len() };
            return displacement_error(&fem[..compared], &found[..compared], dimension);
        };
        let (mut wanted, mut own) = (Vec::new(), Vec::new());
        for (measured, u) in field.displacements.chunks_exact(dimension).zip(found.chunks_exact(dimension)) {
            if measured.iter().any(Option::is_some) {
                wanted.extend(measured.iter().map(|m| m.unwrap_or(0.0)));
                // A direction that was not measured counts as zero on both sides, so that it adds no error.
                own.extend(measured.iter().zip(u).map(|(m, u)| m.map_or(0.0, |_| *u)));
            }
        }
        displacement_error(&wanted, &own, dimension)
    }

    /// What errors are relative to, unless it is the finite elements, whose displacements are `fem` and whose work is `work`.
    pub fn measured(&self, mesh: &Mesh, fem: &[f64], work: Option<f64>) -> Option<Measured> {
        let known = |point: &&[Option<f64>]| point.iter().any(Option::is_some);
        let at_points = || self.measured.iter().flat_map(|field| field.displacements.chunks_exact(mesh.dimension));
        let points = self.measured.as_ref().map(|_| at_points().filter(known).count())?;
        let size = |point: &[Option<f64>]| norm(&point.iter().map(|u| u.unwrap_or(0.0)).collect::<Vec<_>>());
        let error = self.error(mesh, fem, fem);
        let uncertainty = self.finer.and_then(|finer| finer.uncertainty);
        Some(Measured {
            load: self.name.clone(),
            standard: self.finer.map_or(Standard::Measurement, |finer| finer.standard),
            points,
            largest: at_points().filter(known).map(size).reduce(f64::max),
            fem_e_rms: error.map(|error| error.rms),
            fem_e_max: error.map(|error| error.max),
            fem_e_tip: error.map(|error| error.tip),
            fem_e_energy: self.work_error(work, work),
            uncertainty_rms: uncertainty.map(|error| error.rms),
            uncertainty_max: uncertainty.map(|error| error.max),
        })
    }
}
