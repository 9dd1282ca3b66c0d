//! Which hinges a program holds.
//!
//! Page of the book: *Sheets that bend*.

use super::names::{named, ordered, sorted};
use springfit_foundation::error::{Error, ErrorKind, Result};
use springfit_report::report::{HingePart, NetworkRecord};
use std::collections::{HashMap, HashSet};

/// Springs on the angle between two triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hinges {
    /// Any.
    Any,
    /// Hinges that are flat at rest.
    Flat,
    /// None, and why.
    None(&'static str),
}

/// The largest angle of a sheet that is flat at rest, rad: coordinates in files have six digits or more.
pub(super) const FLAT: f64 = 1e-5;

/// That the program has hinges, of their angles at rest.
///
/// # Errors
/// It has none, or flat ones alone.
pub(super) fn check_angles(network: &NetworkRecord, hinges: &[HingePart], program: &str, holds: Hinges) -> Result<()> {
    let is_node =
        |point: &usize| network.cells.iter().any(|block| block.points.iter().any(|cell| cell.contains(point)));
    let is_bent = |part: &&HingePart| part.rest.abs() > FLAT && is_node(&part.points[3]);
    let (part, expected, what, advice) = match holds {
        Hinges::Any => return Ok(()),
        Hinges::Flat => {
            let advice = "newton, lammps, xpbd, blender and npz hold bent hinges";
            (hinges.iter().find(is_bent), "sheets that are flat at rest", "a bent hinge at", advice.to_string())
        }
        Hinges::None(because) => {
            let advice = format!("{because}; mujoco, newton, lammps, xpbd, blender and npz hold hinges");
            (hinges.first(), "springs between two points", "a hinge at", advice)
        }
    };
    let Some(part) = part else { return Ok(()) };
    let found = format!("{what} {}", named(network, &part.points));
    let error = Error::expected("springs", format!("{expected}, which {program} holds"), found);
    Err(error.followed_by(format!("; {advice}")).of_kind(ErrorKind::Unsupported))
}

/// That each hinge is between the only two triangles at its edge.
///
/// # Errors
/// One is elsewhere.
pub(super) fn check_edges_of_hinges(
    network: &NetworkRecord,
    hinges: &[HingePart],
    program: &str,
    triangles: &HashSet<Vec<usize>>,
) -> Result<()> {
    let mut edges: HashMap<[usize; 2], usize> = HashMap::new();
    hinges.iter().for_each(|part| *edges.entry(ordered(part.points[1], part.points[2])).or_default() += 1);
    let is_held = |part: &&HingePart| {
        let [apex, a, b, other] = part.points;
        let are_cells = [apex, other].iter().all(|&corner| triangles.contains(&sorted(&[a, b, corner])));
        are_cells && edges[&ordered(a, b)] == 1
    };
    let Some(part) = hinges.iter().find(|part| !is_held(part)) else { return Ok(()) };
    let expected = format!("hinges between two triangles, which {program} holds");
    let found = format!("another at the edge of {}", named(network, &part.points[1..3]));
    let advice = "; at a clamped edge hold two rows of points and leave clamp out; joints of three leaves go to newton, lammps, xpbd, blender and npz";
    Err(Error::expected("springs", expected, found).followed_by(advice).of_kind(ErrorKind::Unsupported))
}
