//! Jolt: the edge and volume constraints of a soft body.

use super::job::{Holds, Job, Tension};
use super::target::{Content, NamedFile, Stands, Target, dampers, mass_damping};
use crate::engine::Engine;
use crate::error::Result;
use crate::report::NetworkRecord;
use serde::Serialize;

/// A constraint has a compliance, the inverse of a constant above zero. Constraints that pull against each other at rest do not
/// converge in a step: exact networks without negative springs were 27 times as soft.
const HOLDS: Holds = Holds {
    volumes: true,
    areas: false,
    negative: false,
    tension: Tension::None,
    partial: false,
    plane: true,
    off_edges: true,
};

/// What this program holds, and how a network is written for it.
pub const TARGET: Target = Target {
    name: "jolt",
    title: "a Node script for Jolt: edge and volume constraints of a soft body",
    command: "npm install jolt-physics@1.1.0 && node run.mjs",
    leaves_out: |network| [dampers(network), mass_damping(network)].concat(),
    has_loads: false,
    divides: true,
    engines: &[Engine::Jolt],
    stands: Stands::Network,
    write,
};

/// What the script reads.
#[derive(Serialize)]
struct SoftBody {
    points: Vec<[f64; 3]>,
    masses: Vec<f64>,
    held: Vec<usize>,
    gravity: [f64; 3],
    /// Ends, constant, rest length.
    edges: Vec<(usize, usize, f64, f64)>,
    /// Corners, constant, rest volume.
    volumes: Vec<(Vec<usize>, f64, f64)>,
    surface: Vec<[usize; 3]>,
}

/// Whether the inverse of the constant is a number of single precision. A spring that is softer has no force.
fn has_compliance(constant: f64) -> bool {
    1.0 / constant <= f64::from(f32::MAX)
}

fn write(network: &NetworkRecord, gravity: Option<&[f64]>) -> Result<Vec<NamedFile>> {
    let job = Job::new(network, gravity, "Jolt", &HOLDS)?;
    let body = SoftBody {
        points: (0..network.points.len()).map(|p| job.place(p)).collect(),
        masses: job.masses.to_vec(),
        held: job.held_along(0),
        gravity: job.gravity,
        edges: job
            .parts
            .lengths
            .iter()
            .filter(|s| has_compliance(s.constant))
            .map(|s| (s.points[0], s.points[1], s.constant, s.rest))
            .collect(),
        volumes: job.parts.contents.iter().map(|s| (s.points.to_vec(), s.constant, s.rest)).collect(),
        surface: network.surface.clone(),
    };
    let text = serde_json::to_vec(&body).expect("keys are text");
    Ok(vec![
        ("network.json", Content::Bytes(text)),
        ("run.mjs", Content::Bytes(include_bytes!("../../exports/jolt.mjs").to_vec())),
    ])
}
