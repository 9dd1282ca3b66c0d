//! MuJoCo: a flex of tetrahedra, or of triangles that bend, whose stiffness is that of the springs.

use super::hinges::Hinges;
use super::job::{Holds, Job, Tension};
use super::npz::arrays;
use super::relaxes::Relaxes;
use super::target::{Content, NamedFile, Stands, Target, dampers, script};
use springfit_foundation::error::Result;
use springfit_report::report::NetworkRecord;

/// A flex has the quadratic energy of its squared edge lengths: no tension edge by edge, and no springs elsewhere.
const HOLDS: Holds = Holds {
    areas: false,
    hinges: Hinges::Flat,
    tension: Tension::Balanced,
    partial: false,
    plane: false,
    off_edges: false,
    ..Holds::ALL
};

/// What this program holds, and how a network is written for it.
pub const TARGET: Target = Target {
    name: "mujoco",
    title: "a Python script for MuJoCo: a flex of tetrahedra, or of triangles with hinges, with the stiffness of the springs",
    command: "python run.py",
    leaves_out: dampers,
    has_loads: true,
    divides: false,
    engines: &[],
    relaxes: Relaxes::Not(
        "MuJoCo reads the elasticity of tetrahedra once, and has no rest lengths that change in a motion",
    ),
    stands: Stands::SquaredLengths,
    write,
};

fn write(network: &NetworkRecord, gravity: Option<&[f64]>) -> Result<Vec<NamedFile>> {
    let job = Job::new(network, gravity, "MuJoCo", &HOLDS)?;
    Ok(vec![("network.npz", Content::Bytes(arrays(&job))), ("run.py", script(include_str!("../../exports/mujoco.py")))])
}
