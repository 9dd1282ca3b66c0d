//! Newton, on Warp: particles, springs, and tetrahedra without shear modulus as volume springs.

use super::job::{Holds, Job, Tension};
use super::npz::arrays;
use super::target::{Content, NamedFile, Stands, Target, content_dampers, mass_damping, script};
use crate::engine::Engine;
use crate::error::Result;
use crate::report::NetworkRecord;

const HOLDS: Holds = Holds {
    volumes: true,
    areas: false,
    negative: true,
    tension: Tension::Any,
    partial: false,
    plane: true,
    off_edges: true,
};

/// What this program holds, and how a network is written for it.
pub const TARGET: Target = Target {
    name: "newton",
    title: "a Python script for Newton (Warp): springs with dampers, and volume springs",
    command: "python run.py",
    leaves_out: |network| [content_dampers(network), mass_damping(network)].concat(),
    has_loads: true,
    divides: true,
    engines: &[Engine::NewtonXpbd, Engine::NewtonVbd],
    stands: Stands::Network,
    write,
};

fn write(network: &NetworkRecord, gravity: Option<&[f64]>) -> Result<Vec<NamedFile>> {
    let job = Job::new(network, gravity, "Newton", &HOLDS)?;
    Ok(vec![("network.npz", Content::Bytes(arrays(&job))), ("run.py", script(include_str!("../../exports/newton.py")))])
}
