//! Whether the triangles of a sheet that bends are small enough for its loads.

use super::case::Case;
use super::quadratic_reference::{Allowance, Level};
use crate::analysis::metrics::displacement_error;
use crate::mesh::Mesh;
use crate::outcome::Standard;
use crate::progress::Progress;
use crate::scene::Scene;

/// What triangles of half the size leave of the error: they are of second order.
const LEFT: f64 = 0.25;
/// A note says so from this error on, in percent of the largest displacement.
// It was chosen: errors of fits are of this size, and a smaller one of the sheet itself changes no choice among them.
const TOLD: f64 = 5.0;

/// Says under which loads the finite elements of a sheet differ much from those on halved triangles, as far as these take no longer than a reference may.
///
/// The exact network of a sheet is its finite elements, whose errors nothing else shows: clamped plates of eight by eight squares move a third too far.
pub fn judge_sheet<'a>(
    scene: &Scene,
    mesh: &Mesh,
    cases: &[Case],
    displacements: impl Iterator<Item = &'a Vec<f64>>,
    progress: &mut Progress,
) -> Option<String> {
    let is_asked = scene.reference().is_none() && mesh.directors.is_some() && mesh.cell_dimension() == 2;
    let judged = |case: &Case| !case.is_measured;
    if !is_asked || !cases.iter().any(judged) {
        return None;
    }
    // A sheet whose triangles cannot be halved has no other note: its own answers are there.
    let finer = Allowance::of(scene, mesh, cases.len()).afford(1, || scene.build_refined()).ok().flatten()?;
    let level = Level::solve(scene, &finer, Standard::FinerBody, "halved triangles", progress).ok()?;
    let nodes = mesh.node_count() * mesh.dimension;
    let apart = |(own, finer): (&Vec<f64>, &[f64])| {
        // What both differ by is the error less the quarter of it that halved triangles have.
        displacement_error(&own[..nodes], &finer[..nodes], mesh.dimension).map(|error| error.max / (1.0 - LEFT))
    };
    let answers = level.answers.iter().map(|answer| &*answer.displacement);
    let found = cases.iter().zip(displacements.zip(answers)).filter(|(case, _)| judged(case));
    let worst = found.filter_map(|(case, both)| Some((case, apart(both)?)));
    let (case, worst) = worst.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, apart)| *apart > TOLD)?;
    Some(format!(
        "the triangles of this sheet are too large: its displacements under {} are about {worst:.0} % from those of small ones, as halved triangles show, \
         and those of its exact network as well; errors are relative to the finite elements of the mesh. Smaller triangles, or springfit converge, tell more",
        case.name
    ))
}
