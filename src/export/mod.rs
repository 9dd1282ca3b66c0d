//! Networks as the files and scripts of other programs.
//!
//! A target is a file here and a row of `TARGETS`; its script, where it has one, is in the folder `exports`.
//!
//! Page of the book: *Networks in other programs*.

mod blender;
mod divided;
mod extent;
mod hinges;
mod job;
mod jolt;
mod lammps;
mod loads;
mod mujoco;
mod names;
mod newton;
mod npz;
mod phystwin;
mod prepared;
mod relaxes;
mod rest;
mod sofa;
mod target;
mod vtu;
mod xpbd;

pub use hinges::Hinges;
pub use job::{Holds, Job, Tension, used_gravity};
pub use target::{Content, NamedFile, Target, with_warnings, write_files};

use springfit_foundation::error::Result;
use springfit_foundation::named::unknown;

/// A new target is a row here.
pub const TARGETS: [Target; 10] = [
    mujoco::TARGET,
    newton::TARGET,
    lammps::TARGET,
    jolt::TARGET,
    xpbd::TARGET,
    sofa::TARGET,
    blender::TARGET,
    phystwin::TARGET,
    npz::TARGET,
    vtu::TARGET,
];

/// The target of this name.
///
/// # Errors
/// There is none; the key is `--to`.
pub fn target_named(name: &str) -> Result<&'static Target> {
    let names = || TARGETS.iter().map(|target| target.name);
    let expected = format!("one of {}", names().collect::<Vec<_>>().join(", "));
    let found = TARGETS.iter().find(|target| target.name == name);
    found.ok_or_else(|| unknown(expected, names(), name).at_key("--to"))
}

/// A line for each target: its name and its title.
pub fn target_list() -> String {
    TARGETS.iter().map(|target| format!("  {:8} {}\n", target.name, target.title)).collect()
}
