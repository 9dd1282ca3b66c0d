//! Newton, on Warp: particles, springs, tetrahedra without shear modulus as volume springs, and hinges as its bending edges.

use super::job::{Holds, Job};
use super::names::named;
use super::npz::arrays_with;
use super::relaxes::Relaxes;
use super::target::{Content, NamedFile, Stands, Target, content_dampers, dampers, mass_damping, script};
use springfit_bodies::engine::{Engine, Setting, point_colours};
use springfit_element::springs::{cross, norm};
use springfit_foundation::error::{Error, ErrorKind, Result};
use springfit_report::report::{ArrayFile, NetworkRecord};
use std::io::{self, Seek, Write};

const HOLDS: Holds = Holds { areas: false, membranes: false, partial: false, ..Holds::ALL };

/// What this program holds, and how a network is written for it.
pub const TARGET: Target = Target {
    name: "newton",
    title: "a Python script for Newton (Warp): springs with dampers, volume springs, and hinges",
    command: "python run.py",
    leaves_out: |network| {
        // Where iterations end early, dampers change where the body rests, and constants were fitted without them.
        let left_out = if network.engine.is_some() { dampers } else { content_dampers };
        [left_out(network), mass_damping(network)].concat()
    },
    has_loads: true,
    divides: true,
    engines: &[Engine::NewtonXpbd, Engine::NewtonVbd],
    relaxes: Relaxes::Branches,
    stands: Stands::Network,
    write,
};

fn write(network: &NetworkRecord, gravity: Option<&[f64]>) -> Result<Vec<NamedFile>> {
    let job = Job::new(network, gravity, "Newton", &HOLDS)?;
    check_hinges(&job)?;
    let bytes = arrays_with(&job, |file| {
        network.engine.map_or(Ok(()), |setting| write_setting(&setting, file))?;
        // Hinges are moved by VBD, whatever the constants are fitted for.
        let is_by_points = network.engine.is_some_and(|setting| setting.is_by_points()) || !job.parts.hinges.is_empty();
        if is_by_points { write_colours(&job, file) } else { Ok(()) }
    });
    Ok(vec![("network.npz", Content::Bytes(bytes)), ("run.py", script(include_str!("../../exports/newton.py")))])
}

/// Newton leaves hinges out of which a triangle has at most `2 A = 10⁻⁶ m²`; twice that is room for its motion.
const LEAST: f64 = 2e-6;

/// That Newton moves the hinges. Its solver XPBD has gradients of angles without the factor `1/(2 A)`, so that forces of a hinge make angular momentum.
fn check_hinges(job: &Job) -> Result<()> {
    let unsupported = |key: &str, expected: String, found: String, advice: &str| {
        let error = Error::expected(key, expected, found).followed_by(format!("; {advice}"));
        Err(error.of_kind(ErrorKind::Unsupported))
    };
    let Some(first) = job.parts.hinges.first() else { return Ok(()) };
    if job.network.engine.is_some_and(|setting| setting.engine == Engine::NewtonXpbd) {
        let expected =
            format!("constants for {} or for equations that are solved beside hinges", Engine::NewtonVbd.name());
        let found =
            format!("constants for {} and a hinge at {}", Engine::NewtonXpbd.name(), named(job.network, &first.points));
        let advice = "the bending forces of SolverXPBD, and of SolverSemiImplicit, lack a factor and do not balance: a free sheet begins to spin";
        return unsupported("engine", expected, found, advice);
    }
    for hinge in &job.parts.hinges {
        let [apex, a, b, other] = hinge.points;
        for corner in [apex, other] {
            let [p, q, r] = [corner, a, b].map(|point| job.place(point));
            let edge = |end: [f64; 3]| [0, 1, 2].map(|k| end[k] - p[k]);
            let twice = norm(&cross(edge(q), edge(r)));
            if twice < LEAST {
                let expected = format!("triangles of at least {:e} m² beside hinges, which Newton moves", LEAST / 2.0);
                let found = format!("{:.1e} m² at {}", twice / 2.0, named(job.network, &[corner, a, b]));
                return unsupported(
                    "springs",
                    expected,
                    found,
                    "mujoco, lammps, xpbd, blender and npz hold smaller ones",
                );
            }
        }
    }
    Ok(())
}

/// Adds the arrays of a setting that the constants were fitted for: `method`, `step` in s, `substeps`, `iterations` and `relaxation`.
fn write_setting(setting: &Setting, file: &mut ArrayFile<impl Write + Seek>) -> io::Result<()> {
    file.texts("method", &[setting.engine.name()])?;
    file.real("step", &[], [setting.step])?;
    file.whole("substeps", &[], [setting.substeps])?;
    file.whole("iterations", &[], [setting.iterations])?;
    file.real("relaxation", &[], [setting.relaxation])
}

/// Adds the colour of each point, in which all points of a spring differ, for Newton's own colours leave springs out.
fn write_colours(job: &Job, file: &mut ArrayFile<impl Write + Seek>) -> io::Result<()> {
    let lengths = job.parts.lengths.iter().map(|part| &part.points[..]);
    let contents = job.parts.contents.iter().map(|part| &part.points[..]);
    let hinges = job.parts.hinges.iter().map(|part| &part.points[..]);
    let springs: Vec<&[usize]> = lengths.chain(contents).chain(hinges).collect();
    let colours = point_colours(&springs, job.masses.len());
    file.whole("colours", &[colours.len()], colours)
}
