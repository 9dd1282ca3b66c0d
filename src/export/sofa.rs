//! SOFA: a mass-spring file of the format Xsp 3.0.

use super::hinges::Hinges;
use super::job::{Holds, Job};
use super::relaxes::Relaxes;
use super::target::{Content, NamedFile, Stands, Target, mass_damping};
use springfit_foundation::error::Result;
use springfit_report::report::NetworkRecord;
use std::collections::HashSet;
use std::fmt::Write;

const HOLDS: Holds = Holds {
    volumes: false,
    areas: false,
    membranes: false,
    hinges: Hinges::None("its bending springs have one constant of a whole component, and not one of each hinge"),
    partial: false,
    ..Holds::ALL
};

/// What this program holds, and how a network is written for it.
pub const TARGET: Target = Target {
    name: "sofa",
    title: "a file of the format Xsp for SOFA: masses and springs with dampers",
    command: "",
    leaves_out: mass_damping,
    has_loads: false,
    divides: false,
    engines: &[],
    relaxes: Relaxes::Not("SOFA reads constants and rest lengths of its springs from a file, once"),
    stands: Stands::Network,
    write,
};

fn write(network: &NetworkRecord, gravity: Option<&[f64]>) -> Result<Vec<NamedFile>> {
    let job = Job::new(network, gravity, "SOFA", &HOLDS)?;
    Ok(vec![
        ("network.xs3", Content::Bytes(text(&job).into_bytes())),
        ("network.scn", Content::Bytes(scene(&job).into_bytes())),
    ])
}

/// Points count from 1 and are on the surface, `s`, or in the volume, `v`; a held point has a negative mass.
fn text(job: &Job) -> String {
    let held = job.held_along(0);
    let surface: HashSet<usize> = job.network.surface.iter().flatten().copied().collect();
    let mut text = String::from("Xsp 3.0\n");
    let mut line = |words: std::fmt::Arguments| writeln!(text, "{words}").expect("a String grows");
    line(format_args!("numm {}", job.masses.len()));
    line(format_args!("nums {}", job.parts.lengths.len()));
    let [gx, gy, gz] = job.gravity;
    line(format_args!("grav {gx:e} {gy:e} {gz:e}"));
    for (p, mass) in job.masses.iter().enumerate() {
        let [x, y, z] = job.place(p);
        let mass = if held.binary_search(&p).is_ok() { -mass } else { *mass };
        let place = if surface.contains(&p) { "s" } else { "v" };
        line(format_args!("mass {} {place} {x:e} {y:e} {z:e} 0 0 0 {mass:e} 0", p + 1));
    }
    for (i, s) in job.parts.lengths.iter().enumerate() {
        let [a, b] = s.points;
        line(format_args!("lspg {} {} {} {:e} {:e} {:e}", i + 1, a + 1, b + 1, s.constant, s.damper, s.rest));
    }
    text
}

fn scene(job: &Job) -> String {
    let [gx, gy, gz] = job.gravity;
    let held = job.held_along(0).iter().map(usize::to_string).collect::<Vec<_>>().join(" ");
    format!(
        "<?xml version=\"1.0\"?>
<!-- A springfit network in SOFA. Springs are springs, with their constants, dampers and rest lengths; a point that is held has a
     negative mass in network.xs3. The solver is implicit; the longest stable step of an explicit one is {:e} s. -->
<Node name=\"root\" dt=\"0.002\" gravity=\"{gx:e} {gy:e} {gz:e}\">
  <RequiredPlugin pluginName=\"Sofa.Component\"/>
  <DefaultAnimationLoop/>
  <Node name=\"network\">
    <EulerImplicitSolver rayleighStiffness=\"0\" rayleighMass=\"0\"/>
    <CGLinearSolver iterations=\"200\" tolerance=\"1e-12\" threshold=\"1e-18\"/>
    <MechanicalObject template=\"Vec3d\" filename=\"network.xs3\"/>
    <DiagonalMass filename=\"network.xs3\"/>
    <FixedProjectiveConstraint indices=\"{held}\"/>
    <SpringForceField fileSprings=\"network.xs3\"/>
  </Node>
</Node>
",
        job.step
    )
}
