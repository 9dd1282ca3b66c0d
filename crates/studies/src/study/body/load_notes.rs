//! What must be known of loads before their results are trusted.

use crate::mesh::{Filled, Mesh};
use crate::model::Action;
use crate::study::scene::{Part, Scene};

/// What must be known of the tractions of a scene on its mesh, one sentence each.
pub fn load_notes(scene: &Scene, mesh: &Mesh) -> Vec<String> {
    let is_sheet = mesh.cell_dimension() == 2 && mesh.dimension == 3;
    let steps = mesh.quality.filled.as_ref().and_then(Filled::steps);
    let mut notes = Vec::new();
    for load in scene.loads() {
        let Some((part, Action::Traction(_))) = load.single() else { continue };
        if is_sheet && !matches!(part, Part::Group(_)) {
            notes.push(format!(
                "the traction {} acts on the outline of the surface, not on its cells; a body force acts on cells",
                load.name
            ));
        }
        if let Some(steps) = &steps {
            notes.push(format!(
                "the traction {} acts on a stepped boundary: {steps}, and where the surface is not along the axes a traction is \
                 too large in proportion, whatever the size of the cells; boundary = \"smooth\" has no steps, and a force has its total",
                load.name
            ));
        }
    }
    notes
}
