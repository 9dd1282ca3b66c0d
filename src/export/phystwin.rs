//! PhysTwin: the arrays of its simulator `SpringMassSystemWarp`.

use super::hinges::Hinges;
use super::job::{Holds, Job};
use super::names::named;
use super::relaxes::Relaxes;
use super::target::{Content, NamedFile, Stands, Target, dampers};
use springfit_foundation::error::{Error, ErrorKind, Result};
use springfit_report::report::{ArrayFile, LengthPart, NetworkRecord};
use std::io::{self, Cursor};

/// The stiffness of a spring is a logarithm, and its force is divided by its rest length.
const HOLDS: Holds = Holds {
    volumes: false,
    areas: false,
    membranes: false,
    hinges: Hinges::None("it has springs between two points alone"),
    negative: false,
    partial: false,
    plane: false,
    ..Holds::ALL
};

/// What this program holds, and how a network is written for it.
pub const TARGET: Target = Target {
    name: "phystwin",
    title: "the arrays of a spring-mass system of PhysTwin, with the logarithms of its stiffnesses",
    command: "",
    leaves_out: different_dampers,
    has_loads: false,
    divides: false,
    engines: &[],
    relaxes: Relaxes::Not("PhysTwin has one force law, without memory, for all its springs"),
    stands: Stands::Network,
    write,
};

/// m/s², along z, up or down.
const GRAVITY: f64 = 9.8;
/// A gravity that differs from that of the simulator by at most this share is accepted as equal; 9.81 m/s² is.
const SAME: f64 = 2e-3;
/// s, between two states.
const FRAME: f64 = 1.0 / 30.0;

fn write(network: &NetworkRecord, gravity: Option<&[f64]>) -> Result<Vec<NamedFile>> {
    let job = Job::new(network, gravity, "PhysTwin", &HOLDS)?;
    let [gx, gy, gz] = job.gravity;
    if gx != 0.0 || gy != 0.0 || (gz.abs() - GRAVITY).abs() > SAME * GRAVITY {
        let key = if gravity.is_some() { "--gravity" } else { "gravity" };
        let expected = format!("{GRAVITY} m/s² along z, down or up, which PhysTwin has");
        let error = Error::expected(key, expected, format!("{gx} {gy} {gz}")).of_kind(ErrorKind::Unsupported);
        return Err(error.followed_by("; --gravity \"0 0 -9.8\" takes that one"));
    }
    let is_outside = |spring: &&LengthPart| !(spring.rest > 0.0 && spring.constant > 0.0);
    if let Some(spring) = job.parts.lengths.iter().find(is_outside) {
        let expected = "constants and rest lengths above zero, which PhysTwin holds";
        let found = format!("{:e} N/m and {:e} m at {}", spring.constant, spring.rest, named(network, &spring.points));
        let error = Error::expected("springs", expected, found).of_kind(ErrorKind::Unsupported);
        return Err(error.followed_by("; objective = \"offdiag\" with nonnegative = true has such springs"));
    }
    let bytes = arrays(&job).expect("a Vec grows");
    Ok(vec![("phystwin.npz", Content::Bytes(bytes))])
}

/// The arrays, named as the simulator names its arguments. Points that are held come last: they are its controllers.
fn arrays(job: &Job) -> io::Result<Vec<u8>> {
    // Points that are held along some axes only were refused: the first axis tells of all.
    let held = job.held_along(0);
    let count = job.masses.len();
    let mut order: Vec<usize> = (0..count).filter(|p| held.binary_search(p).is_err()).collect();
    let free = order.len();
    order.extend(&held);
    let mut places = vec![0; count];
    order.iter().enumerate().for_each(|(place, &p)| places[p] = place);
    let shift = above_ground(job);
    let place = |&p: &usize| {
        let [x, y, z] = job.place(p);
        [x, y, z + shift]
    };
    let springs = &job.parts.lengths;
    // The force is exp(Y) (l/L − 1).
    let stiffness = || springs.iter().map(|s| s.constant * s.rest);
    // The longest stable step is that at rest: half of it leaves room for springs that stiffen.
    let substeps = (FRAME / (0.5 * job.step)).ceil().max(1.0);
    let mut file = ArrayFile::new(Cursor::new(Vec::new()));
    file.real("init_vertices", &[count, 3], order.iter().flat_map(place))?;
    file.whole("init_springs", &[springs.len(), 2], springs.iter().flat_map(|s| s.points.map(|p| places[p])))?;
    file.real("init_rest_lengths", &[springs.len()], springs.iter().map(|s| s.rest))?;
    file.real("spring_Y", &[springs.len()], stiffness().map(f64::ln))?;
    file.real("init_masses", &[count], order.iter().map(|&p| job.masses[p]))?;
    file.real("controller_points", &[2, held.len(), 3], [&held, &held].into_iter().flatten().flat_map(place))?;
    file.whole("num_object_points", &[], [free])?;
    file.whole("points", &[count], order.iter().copied())?;
    // Stiffnesses outside these bounds are left out or cut.
    file.real("spring_Y_min", &[], [0.0])?;
    file.real("spring_Y_max", &[], [2.0 * stiffness().fold(0.0, f64::max)])?;
    file.real("dashpot_damping", &[], [equal_damper(job.network).unwrap_or(0.0)])?;
    file.real("drag_damping", &[], [job.network.damping.mass])?;
    file.real("dt", &[], [FRAME / substeps])?;
    file.whole("num_substeps", &[], [substeps as usize])?;
    file.whole("reverse_z", &[], [usize::from(job.gravity[2] > 0.0)])?;
    file.real("shift", &[3], [0.0, 0.0, shift])?;
    Ok(file.finish()?.into_inner())
}

/// What is added to z so that the body is its own height above the ground, which is at z = 0 and cannot be left out.
fn above_ground(job: &Job) -> f64 {
    let along = || (0..job.masses.len()).map(|p| job.place(p)[2]);
    let (low, high) = (along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max));
    if job.gravity[2] > 0.0 { low - 2.0 * high } else { high - 2.0 * low }
}

/// The damper that all springs share, kg/s.
fn equal_damper(network: &NetworkRecord) -> Option<f64> {
    let first = network.springs.first()?.damper;
    // Dampers of one ratio are computed for each spring.
    network.springs.iter().all(|spring| (spring.damper - first).abs() <= 1e-9 * first).then_some(first)
}

/// There is one damper for all springs.
fn different_dampers(network: &NetworkRecord) -> Vec<String> {
    if equal_damper(network).is_some() { Vec::new() } else { dampers(network) }
}
