//! LAMMPS: a data file with one bond type per spring, and its input script.

use super::hinges::FLAT;
use super::job::{Holds, Job};
use super::relaxes::Relaxes;
use super::target::{Content, NamedFile, Stands, Target, dampers};
use springfit_foundation::error::Result;
use springfit_report::report::{HingePart, NetworkRecord};
use std::collections::BTreeSet;
use std::fmt::Write;

const HOLDS: Holds = Holds { volumes: false, areas: false, membranes: false, ..Holds::ALL };

/// What this program holds, and how a network is written for it.
pub const TARGET: Target = Target {
    name: "lammps",
    title: "a data file and an input script for LAMMPS: harmonic bonds, hinges as dihedrals",
    command: "lmp -in in.network",
    leaves_out: dampers,
    has_loads: false,
    divides: false,
    engines: &[],
    relaxes: Relaxes::Not("the constants of bonds in LAMMPS stay as they are during a run"),
    stands: Stands::Network,
    write,
};

fn write(network: &NetworkRecord, gravity: Option<&[f64]>) -> Result<Vec<NamedFile>> {
    let job = Job::new(network, gravity, "LAMMPS", &HOLDS)?;
    Ok(vec![
        ("network.data", Content::Bytes(data(&job).into_bytes())),
        ("in.network", Content::Bytes(input(&job).into_bytes())),
    ])
}

/// Atoms, bonds and dihedrals count from 1. Atoms of equal mass share a type.
fn data(job: &Job) -> String {
    // LAMMPS has one mass for each type of atoms: points of the same mass share a type.
    let mut masses = job.masses.to_vec();
    masses.sort_by(f64::total_cmp);
    masses.dedup();
    let kind = |mass: f64| masses.partition_point(|other| *other < mass) + 1;
    let (atoms, bonds) = (job.masses.len(), job.parts.lengths.len());
    let mut text = String::from("springfit network: K of a bond is half of the spring constant, units si\n\n");
    let mut line = |words: std::fmt::Arguments| writeln!(text, "{words}").expect("a String grows");
    let dihedrals = job.parts.hinges.len();
    line(format_args!("{atoms} atoms\n{bonds} bonds\n{} atom types\n{bonds} bond types", masses.len()));
    if dihedrals > 0 {
        line(format_args!("{dihedrals} dihedrals\n{dihedrals} dihedral types"));
    }
    line(format_args!(""));
    for (k, axis) in ["x", "y", "z"].iter().enumerate() {
        let along = || (0..atoms).map(|p| job.place(p)[k]);
        let (low, high) = (along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max));
        // In the plane the box has a thickness, which LAMMPS asks for and does not use.
        let room = if high > low { high - low } else { 1.0 };
        line(format_args!("{:e} {:e} {axis}lo {axis}hi", low - room, high + room));
    }
    line(format_args!("\nMasses\n"));
    masses.iter().enumerate().for_each(|(i, mass)| line(format_args!("{} {mass:e}", i + 1)));
    line(format_args!("\nBond Coeffs # harmonic\n"));
    let springs = || job.parts.lengths.iter().enumerate().map(|(i, spring)| (i + 1, spring));
    springs().for_each(|(i, s)| line(format_args!("{i} {:e} {:e}", s.constant / 2.0, s.rest)));
    let hinges = || job.parts.hinges.iter().enumerate().map(|(i, hinge)| (i + 1, hinge));
    if dihedrals > 0 {
        let styles = dihedral_styles(job);
        let all = if styles.len() > 1 { "hybrid" } else { styles.first().copied().unwrap_or_default() };
        line(format_args!("\nDihedral Coeffs # {all}\n"));
        hinges().for_each(|(i, s)| {
            let own = of_hinge(s);
            let name = if styles.len() > 1 { format!("{own} ") } else { String::new() };
            match own {
                "harmonic" => line(format_args!("{i} {name}{:e} 1 1", s.constant)),
                // The dihedral of a flat sheet is 180°.
                _ => line(format_args!("{i} {name}{:e} {:e}", s.constant / 2.0, 180.0 - s.rest.to_degrees())),
            }
        });
    }
    line(format_args!("\nAtoms # {}\n", style(job)));
    for p in 0..atoms {
        let [x, y, z] = job.place(p);
        line(format_args!("{} 1 {} {x:e} {y:e} {z:e}", p + 1, kind(job.masses[p])));
    }
    line(format_args!("\nBonds\n"));
    springs().for_each(|(i, s)| line(format_args!("{i} {i} {} {}", s.points[0] + 1, s.points[1] + 1)));
    if dihedrals > 0 {
        line(format_args!("\nDihedrals\n"));
        hinges().for_each(|(i, s)| {
            let [apex, a, b, other] = s.points.map(|p| p + 1);
            line(format_args!("{i} {i} {apex} {a} {b} {other}"));
        });
    }
    text
}

/// The style of atoms.
fn style(job: &Job) -> &'static str {
    if job.parts.hinges.is_empty() { "bond" } else { "molecular" }
}

/// The style of the dihedral of a hinge. `K (φ − φ₀)²` takes φ from its cosine, which does not know angles near 180°, those of flat sheets; `K (1 + cos φ)` does,
/// and bends softer at large angles.
fn of_hinge(hinge: &HingePart) -> &'static str {
    if hinge.rest.abs() <= FLAT { "harmonic" } else { "quadratic" }
}

/// The styles of all dihedrals, by their names.
fn dihedral_styles(job: &Job) -> BTreeSet<&'static str> {
    job.parts.hinges.iter().map(of_hinge).collect()
}

fn input(job: &Job) -> String {
    let d = job.network.dimension;
    let longest = job.parts.lengths.iter().map(|s| {
        let [a, b] = s.points.map(|p| job.place(p));
        a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    });
    let longest = longest.fold(0.0, f64::max);
    let [gx, gy, gz] = job.gravity;
    let mut held = String::new();
    for (k, axis) in ["x", "y", "z"].iter().enumerate().take(d) {
        let points: Vec<String> = job.held_along(k).iter().map(|p| (p + 1).to_string()).collect();
        if !points.is_empty() {
            let zero = ["0 NULL NULL", "NULL 0 NULL", "NULL NULL 0"][k];
            // A line of input may not be too long; each adds to the group, of which there may be 32.
            for some in points.chunks(500) {
                writeln!(held, "group held{axis} id {}", some.join(" ")).expect("a String grows");
            }
            writeln!(held, "fix held{axis} held{axis} setforce {zero}").expect("a String grows");
        }
    }
    let (boundary, plane) = if d == 2 { ("s s p", "fix plane all enforce2d\n") } else { ("s s s", "") };
    // The longest stable step is that at rest: a fifth of it leaves room for springs that stiffen.
    let (longest_step, step) = (job.step, 0.2 * job.step);
    // A ten-thousandth of a millionth of the weight.
    let weight = job.masses.iter().sum::<f64>() * (gx * gx + gy * gy + gz * gz).sqrt();
    // LAMMPS finds the atoms of a bond within this reach alone: springs may stretch to twice the longest.
    let (reach, least) = (2.1 * longest, 1e-10 * weight);
    let style = style(job);
    let styles: Vec<&str> = dihedral_styles(job).into_iter().collect();
    let dihedrals = match &styles[..] {
        [] => String::new(),
        [one] => format!("dihedral_style {one}\n"),
        several => format!("dihedral_style hybrid {}\n", several.join(" ")),
    };
    let hinges = match &styles[..] {
        [] => "",
        ["harmonic"] => "flat hinges are harmonic dihedrals with K = k, one type each; ",
        ["quadratic"] => "bent hinges are quadratic dihedrals with K = k/2, one type each; ",
        _ => {
            "flat hinges are harmonic dihedrals with K = k, and bent ones quadratic ones with K = k/2, one type each; "
        }
    };
    let most = if styles.is_empty() { "100000 1000000" } else { "1000000 10000000" };
    // Membranes are much stiffer than hinges, where conjugate gradients end early. Damped motion by steps that stay below the longest stable one does not.
    let minimiser = match !styles.is_empty() {
        true => format!("  \"timestep {step:e}\" &\n  \"min_style fire\" &\n  \"min_modify tmax 1\" &\n"),
        false => format!("  \"min_style cg\" &\n  \"min_modify dmax {:e} line quadratic\" &\n", 0.1 * longest),
    };
    let damping = job.network.damping.mass;
    let drag = match damping > 0.0 {
        false => String::new(),
        true => {
            let along =
                ["x", "y", "z"].map(|axis| format!("  \"variable d{axis} atom -{damping:e}*mass*v{axis}\" &\n"));
            along.concat() + "  \"fix drag all addforce v_dx v_dy v_dz\" &\n"
        }
    };
    format!(
        "# A springfit network in LAMMPS (package MOLECULE).
#
#   lmp -in in.network                    half a second of motion
#   lmp -in in.network -var seconds 2     two seconds
#   lmp -in in.network -var mode rest     comes to rest
#
# Both write the positions to positions.txt, by id; point p of the network is atom p + 1.
#
# What was converted: springs are harmonic bonds with K = k/2, one type each; {hinges}supports are forces set to zero; gravity is a force on
# each atom. The step is 0.2 of the longest stable one at rest, {longest_step:e} s.

variable mode index move
variable seconds index 0.5
units si
dimension {d}
boundary {boundary}
atom_style {style}
atom_modify map array sort 0 0
bond_style harmonic
{dihedrals}comm_modify cutoff {reach:e}
neighbor {reach:e} bin
special_bonds lj/coul 1 1 1
read_data network.data
variable wx atom mass*({gx:e})
variable wy atom mass*({gy:e})
variable wz atom mass*({gz:e})
variable height atom -mass*(({gx:e})*x+({gy:e})*y+({gz:e})*z)
fix weight all addforce v_wx v_wy v_wz energy v_height
fix_modify weight energy yes
{held}{plane}thermo 1000
if \"${{mode}} == rest\" then &
{minimiser}  \"minimize 0 {least:e} {most}\" &
else &
  \"fix nve all nve\" &
{drag}  \"timestep {step:e}\" &
  \"variable steps equal round(${{seconds}}/{step:e})\" &
  \"run ${{steps}}\"
write_dump all custom positions.txt id x y z modify sort id format float %.17g
"
    )
}
