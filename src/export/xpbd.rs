//! XPBD: constraints in the order of a sweep, and the loop that moves them, for an engine of a user's own.

use super::job::{Holds, Job, Tension, has_compliance};
use super::loads::Load;
use super::relaxes::Relaxes;
use super::target::{Content, NamedFile, Stands, Target, dampers, mass_damping};
use serde::Serialize;
use springfit_bodies::engine::{Engine, Setting, colours};
use springfit_foundation::error::Result;
use springfit_report::report::NetworkRecord;

/// What is held is that of Jolt: constraints have compliances above zero and do not pull against each other at rest.
const HOLDS: Holds = Holds { negative: false, tension: Tension::None, ..Holds::ALL };

/// What this program holds, and how a network is written for it.
pub const TARGET: Target = Target {
    name: "xpbd",
    title: "constraints of XPBD in order, and their loop in C and NumPy, for your own engine",
    command: "cc -O2 -o run run.c -lm && ./run",
    leaves_out: |network| [dampers(network), mass_damping(network)].concat(),
    has_loads: true,
    divides: true,
    engines: &[Engine::Xpbd],
    relaxes: Relaxes::Springs,
    stands: Stands::Truncated,
    write,
};

/// What the key `format` of the file says.
const FORMAT: &str = "springfit xpbd";
/// The version changes when a key is removed, or its place or meaning changes.
const VERSION: u32 = 1;

/// What the loops read. The one in C reads the keys in this order.
#[derive(Serialize)]
struct Body<'a> {
    format: &'static str,
    version: u32,
    /// Whether the constants belong to the setting.
    fitted: bool,
    setting: Setting,
    /// m/s², with z = 0 in the plane.
    gravity: [f64; 3],
    /// m, with z = 0 in the plane.
    points: Vec<[f64; 3]>,
    /// kg.
    masses: &'a [f64],
    /// Points, and the axes along which they are held.
    held: Vec<(usize, usize)>,
    surface: &'a [[usize; 3]],
    loads: Vec<Load<'a>>,
    constraints: Vec<Constraint>,
    /// Shares of the stress that relax, and their times in s.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    relaxation: Vec<[f64; 2]>,
}

#[derive(Serialize)]
struct Constraint {
    kind: &'static str,
    points: Vec<usize>,
    compliance: f64,
    rest: f64,
    colour: usize,
}

impl Constraint {
    fn new(kind: &'static str, points: &[usize], constant: f64, rest: f64) -> Constraint {
        Constraint { kind, points: points.to_vec(), compliance: 1.0 / constant, rest, colour: 0 }
    }
}

/// The constraints in the order of a sweep, with their colours.
fn constraints(job: &Job, setting: &Setting) -> Vec<Constraint> {
    let lengths = job.parts.lengths.iter().filter(|part| has_compliance(part.constant));
    let mut all: Vec<Constraint> =
        lengths.map(|part| Constraint::new("length", &part.points, part.constant, part.rest)).collect();
    let count = all.len();
    let contents = job.parts.contents.iter().filter(|part| has_compliance(part.constant));
    all.extend(contents.map(|part| {
        // A cell that fills its space has a content with a sign; the area of a triangle in space has none.
        let kind = if part.points.len() > job.network.dimension { "content" } else { "area" };
        Constraint::new(kind, &part.points, part.constant, part.rest)
    }));
    let hinges = job.parts.hinges.iter().filter(|part| has_compliance(part.constant));
    all.extend(hinges.map(|part| Constraint::new("hinge", &part.points, part.constant, part.rest)));
    let sets: Vec<&[usize]> = all.iter().map(|constraint| &constraint.points[..]).collect();
    let (order, colours) = (job.order(&sets, count, setting.order), colours(&sets, job.masses.len()));
    all.iter_mut().zip(colours).for_each(|(constraint, colour)| constraint.colour = colour);
    let mut all: Vec<Option<Constraint>> = all.into_iter().map(Some).collect();
    order.into_iter().filter_map(|constraint| all[constraint].take()).collect()
}

fn write(network: &NetworkRecord, gravity: Option<&[f64]>) -> Result<Vec<NamedFile>> {
    let job = Job::new(network, gravity, "XPBD", &HOLDS)?;
    let setting = network.engine.unwrap_or(Setting::usual(Engine::Xpbd));
    let terms = network.motion.iter().flat_map(|motion| &motion.relaxation);
    let body = Body {
        format: FORMAT,
        version: VERSION,
        fitted: network.engine.is_some(),
        setting,
        gravity: job.gravity,
        points: (0..network.points.len()).map(|p| job.place(p)).collect(),
        masses: job.masses,
        held: (0..network.dimension)
            .flat_map(|axis| job.held_along(axis).into_iter().map(move |p| (p, axis)))
            .collect(),
        surface: &network.surface,
        loads: Load::all(network),
        constraints: constraints(&job, &setting),
        relaxation: terms.map(|term| [term.shear, term.time]).collect(),
    };
    let text = serde_json::to_vec(&body).expect("keys are text");
    let script = |bytes: &[u8]| Content::Bytes(bytes.to_vec());
    Ok(vec![
        ("network.json", script(&text)),
        ("run.c", script(include_bytes!("../../exports/xpbd.c"))),
        ("run.py", script(include_bytes!("../../exports/xpbd.py"))),
    ])
}
