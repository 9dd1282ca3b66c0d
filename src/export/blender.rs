//! Blender: meshes with the springs and hinges as edges and their numbers as attributes, and the motion as shape keys.

use super::job::{Holds, Job};
use super::npz::arrays;
use super::relaxes::Relaxes;
use super::target::{Content, NamedFile, Stands, Target, content_dampers, script};
use springfit_foundation::error::Result;
use springfit_report::report::NetworkRecord;

/// The script moves the network itself, so that it holds what the arrays hold.
const HOLDS: Holds = Holds { areas: false, ..Holds::ALL };

/// What this program holds, and how a network is written for it.
pub const TARGET: Target = Target {
    name: "blender",
    title: "a Python script for Blender: springs and hinges as edges with attributes, the motion as shape keys",
    command: "python run.py",
    leaves_out: content_dampers,
    has_loads: true,
    divides: true,
    engines: &[],
    relaxes: Relaxes::Branches,
    stands: Stands::Network,
    write,
};

fn write(network: &NetworkRecord, gravity: Option<&[f64]>) -> Result<Vec<NamedFile>> {
    let job = Job::new(network, gravity, "Blender", &HOLDS)?;
    Ok(vec![
        ("network.npz", Content::Bytes(arrays(&job))),
        ("run.py", script(include_str!("../../exports/blender.py"))),
    ])
}
