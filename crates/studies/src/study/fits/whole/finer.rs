//! What a whole-object fit requires of a finer mesh of the body.

use crate::error::Result;
use crate::mesh::Mesh;
use crate::model::Support;
use crate::study::progress::Progress;
use crate::whole::NodalLoad;
use std::sync::Arc;

/// Loads on the points of the mesh of the scene, and the displacements there.
pub type Answers = Arc<Vec<(NodalLoad, Vec<f64>)>>;

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
}
