//! Jolt: the edge and volume constraints of a soft body.

use super::hinges::Hinges;
use super::job::{Holds, Job, Tension, has_compliance};
use super::loads::Load;
use super::relaxes::Relaxes;
use super::target::{Content, NamedFile, Stands, Target, dampers, mass_damping};
use serde::Serialize;
use springfit_bodies::engine::{Engine, Setting};
use springfit_foundation::error::Result;
use springfit_report::report::NetworkRecord;

/// A constraint has a compliance, the inverse of a constant above zero. Constraints that pull against each other at rest do not
/// converge in a step: exact networks without negative springs were 27 times as soft.
const HOLDS: Holds = Holds {
    areas: false,
    membranes: false,
    hinges: Hinges::None("its bend constraints are not written"),
    negative: false,
    tension: Tension::None,
    partial: false,
    ..Holds::ALL
};

/// What this program holds, and how a network is written for it.
pub const TARGET: Target = Target {
    name: "jolt",
    title: "a Node script for Jolt: edge and volume constraints of a soft body",
    command: "npm install jolt-physics@1.1.0 && node run.mjs",
    leaves_out: |network| [dampers(network), mass_damping(network)].concat(),
    has_loads: true,
    divides: true,
    engines: &[Engine::Jolt],
    relaxes: Relaxes::Not(
        "Jolt takes rest lengths and compliances of a soft body when it is made, and no others while it moves",
    ),
    stands: Stands::Network,
    write,
};

/// Substeps of a step for constants of equations that are solved: fewer make the body much softer.
const SUBSTEPS: usize = 50;

/// What the script reads.
#[derive(Serialize)]
struct SoftBody<'a> {
    /// Whether the constants belong to the setting.
    fitted: bool,
    setting: Setting,
    /// The order in which constraints were taken when the constants were fitted.
    #[serde(skip_serializing_if = "Option::is_none")]
    sweep: Option<Sweep>,
    points: Vec<[f64; 3]>,
    masses: Vec<f64>,
    held: Vec<usize>,
    gravity: [f64; 3],
    /// Ends, constant, rest length.
    edges: Vec<(usize, usize, f64, f64)>,
    /// Corners, constant, rest volume.
    volumes: Vec<(Vec<usize>, f64, f64)>,
    surface: Vec<[usize; 3]>,
    loads: Vec<Load<'a>>,
}

/// The places of edges and volumes in their lists, in the order of a sweep.
#[derive(Serialize)]
struct Sweep {
    edges: Vec<usize>,
    volumes: Vec<usize>,
}

impl Sweep {
    fn of(body: &SoftBody, job: &Job, setting: &Setting) -> Sweep {
        let edges = body.edges.iter().map(|(a, b, ..)| vec![*a, *b]);
        let springs: Vec<Vec<usize>> = edges.chain(body.volumes.iter().map(|(corners, ..)| corners.clone())).collect();
        let lengths = body.edges.len();
        let order = job.order(&springs, lengths, setting.order);
        let (edges, volumes): (Vec<usize>, Vec<usize>) = order.into_iter().partition(|&spring| spring < lengths);
        Sweep { edges, volumes: volumes.into_iter().map(|spring| spring - lengths).collect() }
    }
}

fn write(network: &NetworkRecord, gravity: Option<&[f64]>) -> Result<Vec<NamedFile>> {
    let job = Job::new(network, gravity, "Jolt", &HOLDS)?;
    let setting = network.engine.unwrap_or(Setting::usual(Engine::Jolt).with_substeps(SUBSTEPS));
    let mut body = SoftBody {
        fitted: network.engine.is_some(),
        setting,
        sweep: None,
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
        loads: Load::all(network),
    };
    if body.fitted {
        body.sweep = Some(Sweep::of(&body, &job, &setting));
    }
    let text = serde_json::to_vec(&body).expect("keys are text");
    Ok(vec![
        ("network.json", Content::Bytes(text)),
        ("run.mjs", Content::Bytes(include_bytes!("../../exports/jolt.mjs").to_vec())),
    ])
}
