//! What a whole-object fit requires of a finer mesh of the body.

use crate::error::Result;
use crate::mesh::Mesh;
use crate::model::{Moments, Support};
use crate::progress::Progress;
use crate::whole::{MakeLoads, NodalLoad, StretchedLoads};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Loads on the points of the mesh of the scene, and the displacements there.
pub type Answers = Arc<Vec<(NodalLoad, Vec<f64>)>>;

/// The factors on μ and λ of the cells that belong to the same groups.
pub type RegionFactors = BTreeMap<Vec<String>, [f64; 2]>;

/// A finer mesh of the body that gives the displacements.
pub trait Finer {
    /// The finer mesh.
    fn mesh(&self) -> &Mesh;

    /// The support of the `[[fix]]` entries on it.
    fn support(&self) -> &Support;

    /// The loads on the points of the mesh of the scene that do the same work as `loads` on the finer mesh, which holds
    /// `support`; and the displacements of the finer body at those points. `name` says which loads and which support they are, so that
    /// no load is solved twice.
    ///
    /// # Errors
    /// The finer body has no solution.
    fn answers(
        &self,
        name: String,
        support: &Support,
        loads: &dyn Fn() -> Vec<NodalLoad>,
        progress: &mut Progress,
    ) -> Result<Answers>;

    /// The loads that stretch the finer body so far at large deformation, on the points of the mesh of the scene, and its displacements there.
    /// `name` says which loads and which support they are, so that no load is followed twice.
    ///
    /// # Errors
    /// The equations do not fit into memory.
    fn stretched(
        &self,
        name: String,
        support: &Support,
        make: &MakeLoads,
        stretch: f64,
        progress: &mut Progress,
    ) -> Result<Arc<StretchedLoads>>;

    /// The squares ω² of the `count` lowest frequencies under a support of the finer mesh, rad²/s².
    ///
    /// # Errors
    /// They are not found, or the material has no density.
    fn vibrations(&self, support: &Support, count: usize) -> Result<Vec<f64>>;

    /// The displacements of the finer body with other moduli, at the points of the mesh of the scene, under loads of the scene.
    ///
    /// # Errors
    /// It has a region without factors, or no solution.
    fn moved(&self, loads: &[usize], factors: &RegionFactors, progress: &mut Progress) -> Result<Vec<Vec<f64>>>;

    /// How many times as large as its own the cells of another mesh are.
    fn coarseness(&self, mesh: &Mesh) -> f64;

    /// Seconds of a linear implicit step of the finer body: one solution with the equations under a support that are there.
    ///
    /// # Errors
    /// There is no solution.
    fn seconds_per_step(&self, support: &Support) -> Result<f64>;

    /// The mass, centre and second moments of the finer body.
    fn moments(&self) -> Moments;
}
