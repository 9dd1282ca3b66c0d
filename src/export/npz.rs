//! Arrays of NumPy.

use super::extent::check_parts;
use super::job::{Job, spatial};
use super::relaxes::Relaxes;
use super::target::{Content, EVERY_ENGINE, NamedFile, Stands, Target, content_dampers, script};
use springfit_foundation::error::Result;
use springfit_report::report::{ArrayFile, NetworkRecord, Parts, network_npz, network_npz_with};
use std::io::Cursor;

/// What this program holds, and how a network is written for it.
pub const TARGET: Target = Target {
    name: "npz",
    title: "arrays of NumPy, for scripts of your own",
    command: "",
    leaves_out: content_dampers,
    has_loads: true,
    divides: true,
    engines: EVERY_ENGINE,
    relaxes: Relaxes::Passed,
    stands: Stands::Network,
    write,
};

fn write(network: &NetworkRecord, gravity: Option<&[f64]>) -> Result<Vec<NamedFile>> {
    let gravity = spatial(gravity, network)[..network.dimension].to_vec();
    let network = NetworkRecord { gravity: Some(gravity), ..network.clone() };
    let mut bytes = Cursor::new(Vec::new());
    let parts = Parts::of(&network)?;
    check_parts(&parts)?;
    network_npz(&network, &parts, &mut bytes).expect("a Vec grows");
    let mut files = vec![("network.npz", Content::Bytes(bytes.into_inner()))];
    if network.motion.as_ref().is_some_and(|motion| !motion.relaxation.is_empty()) {
        files.push(("run.py", script(include_str!("../../exports/relaxing.py"))));
    }
    Ok(files)
}

/// The arrays of a job, with its gravity.
pub fn arrays(job: &Job) -> Vec<u8> {
    arrays_with(job, |_| Ok(()))
}

/// The arrays of a job, with its gravity, and those that `more` adds to them.
pub fn arrays_with(
    job: &Job,
    more: impl FnOnce(&mut ArrayFile<&mut Cursor<Vec<u8>>>) -> std::io::Result<()>,
) -> Vec<u8> {
    let d = job.network.dimension;
    let network = NetworkRecord { gravity: Some(job.gravity[..d].to_vec()), ..job.network.clone() };
    let mut bytes = Cursor::new(Vec::new());
    network_npz_with(&network, &job.parts, &mut bytes, more).expect("a Vec grows");
    bytes.into_inner()
}
