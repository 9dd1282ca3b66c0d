//! Newton, on Warp: particles, springs, and tetrahedra without shear modulus as volume springs.

use super::job::{Hinges, Holds, Job, Tension};
use super::npz::arrays_with;
use super::target::{Content, NamedFile, Stands, Target, content_dampers, dampers, mass_damping, script};
use crate::engine::{Engine, Setting, point_colours};
use crate::error::Result;
use crate::report::{ArrayFile, NetworkRecord};
use std::io::{self, Seek, Write};

const HOLDS: Holds = Holds {
    volumes: true,
    areas: false,
    membranes: false,
    hinges: Hinges::None,
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
    leaves_out: |network| {
        // Where iterations end early, dampers change where the body rests, and constants were fitted without them.
        let left_out = if network.engine.is_some() { dampers } else { content_dampers };
        [left_out(network), mass_damping(network)].concat()
    },
    has_loads: true,
    divides: true,
    engines: &[Engine::NewtonXpbd, Engine::NewtonVbd],
    relaxes: false,
    stands: Stands::Network,
    write,
};

fn write(network: &NetworkRecord, gravity: Option<&[f64]>) -> Result<Vec<NamedFile>> {
    let job = Job::new(network, gravity, "Newton", &HOLDS)?;
    let bytes = arrays_with(&job, |file| network.engine.map_or(Ok(()), |setting| write_setting(&job, &setting, file)));
    Ok(vec![("network.npz", Content::Bytes(bytes)), ("run.py", script(include_str!("../../exports/newton.py")))])
}

/// Adds the arrays of a setting that the constants were fitted for: `method`, `step` in s, `substeps`, `iterations`, `relaxation`, and of VBD
/// the colour of each point, for Newton's own colours leave springs out.
fn write_setting(job: &Job, setting: &Setting, file: &mut ArrayFile<impl Write + Seek>) -> io::Result<()> {
    file.texts("method", &[setting.engine.name()])?;
    file.real("step", &[], [setting.step])?;
    file.whole("substeps", &[], [setting.substeps])?;
    file.whole("iterations", &[], [setting.iterations])?;
    file.real("relaxation", &[], [setting.relaxation])?;
    if setting.is_by_points() {
        let lengths = job.parts.lengths.iter().map(|part| &part.points[..]);
        let springs: Vec<&[usize]> = lengths.chain(job.parts.contents.iter().map(|part| &part.points[..])).collect();
        let colours = point_colours(&springs, job.masses.len());
        file.whole("colours", &[colours.len()], colours)?;
    }
    Ok(())
}
