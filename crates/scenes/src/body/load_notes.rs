//! What must be known of loads before their results are trusted.

use super::case::Case;
use super::part_notes::part_notes;
use crate::mesh::{Filled, Mesh};
use crate::model::Action;
use crate::scene::{LoadCase, Part, Scene};

/// The share of a force on held points from which on it is reported. Tractions on sides that meet a held side have a few percent there.
const SWALLOWED: f64 = 0.1;
/// The distance of a measured displacement from the one that its support prescribes, relative to the largest, that is more than noise.
// A support that gives way by a share of the displacements makes a body look softer by about this share. The bound was chosen above
// the noise of most measurements, so that notes name wrong groups and units.
const CONTRADICTS: f64 = 0.05;

/// What must be known of the loads of a scene on its mesh, one sentence each.
pub fn load_notes(scene: &Scene, mesh: &Mesh, cases: &[Case]) -> Vec<String> {
    let of_cases = cases
        .iter()
        .zip(scene.loads())
        .flat_map(|(case, load)| [swallowed(case, load, mesh), contradicted(case, mesh)]);
    part_notes(scene, mesh)
        .into_iter()
        .chain(scene.relaxation_note())
        .chain(of_tractions(scene, mesh))
        .chain(of_cases.flatten())
        .collect()
}

/// That a part of a force acts on held points, where it does nothing. Of a body force that is the weight of what is held.
fn swallowed(case: &Case, load: &LoadCase, mesh: &Mesh) -> Option<String> {
    // A moment turns edges and joints that are held in their place, unless their directors are held as well.
    let (first, what, place) = match load.single()?.1 {
        Action::Body(_) | Action::Displacement(_) | Action::Volume(_) => return None,
        Action::Moment(_) => (mesh.node_count() * mesh.dimension, "moment", "joints or edges that are clamped"),
        Action::Force(_) | Action::Traction(_) | Action::Pressure(_) => (0, "force", "held points"),
    };
    let forces = || case.forces.iter().enumerate().skip(first);
    let all: f64 = forces().map(|(_, force)| force.abs()).sum();
    let held: f64 = forces().filter(|(dof, _)| case.support.is_fixed(*dof)).map(|(_, force)| force.abs()).sum();
    (held > SWALLOWED * all).then(|| {
        format!("{:.0} % of the {what} of {} acts on {place}, where it does nothing", 100.0 * held / all, case.name)
    })
}

/// The note that a measured displacement contradicts the support.
fn contradicted(case: &Case, mesh: &Mesh) -> Option<String> {
    let field = case.measured.as_ref().filter(|_| case.is_measured)?;
    let largest = field.displacements.iter().flatten().fold(0.0, |largest: f64, u| largest.max(u.abs()));
    let pairs = field.displacements.iter().zip(&case.support.prescribed).enumerate();
    let apart = pairs.filter_map(|(dof, (measured, held))| Some((dof, (*measured)?, (*held)?)));
    let (dof, measured, held) = apart.max_by(|a, b| (a.1 - a.2).abs().total_cmp(&(b.1 - b.2).abs()))?;
    // A support at rest has no size of its own: what it contradicts is measured by the displacements.
    ((measured - held).abs() > CONTRADICTS * largest.max(held.abs())).then(|| {
        let (point, axis) = (dof / mesh.dimension, ["x", "y", "z"][dof % mesh.dimension]);
        format!(
            "under {} the displacement of {} along {axis} was measured as {measured:.3e} m, where the support holds it at {held:.3e} m",
            case.name,
            mesh.point_title(point)
        )
    })
}

/// What must be known of the tractions of a scene on its mesh.
fn of_tractions(scene: &Scene, mesh: &Mesh) -> Vec<String> {
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
