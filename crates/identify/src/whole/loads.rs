//! Loads that are generated from a mesh and its supports.
//!
//! Theory: page *Whole-object fits* of the book.

use crate::material::CellMap;
use crate::mesh::{Mesh, Selection};
use crate::model::{Action, Support, Traction, boundary_forces, nodal_forces, point_contents};
use crate::springs::{cross, distance, dot, norm, unit};
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

/// A named set of nodal forces.
#[derive(Debug, Clone, PartialEq)]
pub struct NodalLoad {
    /// The name in reports.
    pub name: String,
    /// The forces, `[points · dimension]`, N.
    pub forces: Vec<f64>,
}

/// The name of the uniform pressure among varied loads.
pub const PRESSURE: &str = "pressure";
/// Forces below this share of the largest one of a load are the rounding of forces that cancel, such as those of uniform tractions between held
/// ends.
const ROUNDING: f64 = 1e-10;
/// Added to the seed of the slopes of a pressure that varies, so that the loads after it are the same with either pressure.
const SLOPES: u64 = 0x9e37_79b9;
/// The number of waves across the object in the random fields.
// With an eighth of a wave to two the ρ that such loads choose leaves errors under other loads that differ by 2 %,
// measured on a cube of 412 tetrahedra; with four waves errors are 13 % larger.
const WAVES: f64 = 0.5;
/// The number of sines of which a component of a random field is the sum.
// One to sixteen sines choose ρ alike there to a power of ten, and errors differ by 2 %.
const SINES: usize = 4;
/// The width of a patch of traction, relative to the size of the object.
// Widths of 0.02 to 0.1 and of 0.5 to 2 leave errors under other loads that differ by 2 %: a fit sees many patches.
const PATCH: std::ops::Range<f64> = 0.1..0.5;

/// Tractions `t = σ n` on the boundary, and body forces, of size 1 Pa and 1 N/m³:
///
/// - "stress xx", "stress xy", …: a uniform σ with one component equal to one;
/// - "torsion" of solids, `σ = (a × r) aᵀ + a (a × r)ᵀ`, and "bending" about each axis across, `σ = (e·r) a aᵀ`, where
///   a points from the support to the middle of the object, and r is the position from there in units of the object's
///   size; both are in equilibrium inside the object;
/// - "gravity x", …: a body force.
pub fn made_loads(mesh: &Mesh, support: &Support, thickness: impl Into<CellMap<f64>>) -> Vec<NodalLoad> {
    made(mesh, support, &thickness.into())
}

/// [`made_loads`], without parameters of type: compiled here, where code is optimised, and not with each caller.
fn made(mesh: &Mesh, support: &Support, thickness: &CellMap<f64>) -> Vec<NodalLoad> {
    let d = mesh.dimension;
    let names = ["x", "y", "z"];
    let e = |k: usize| (0..d).map(|l| f64::from(u8::from(k == l))).collect::<Vec<f64>>();
    let frame = Frame::of(mesh, support);
    let on_boundary =
        |name: String, traction: &Traction| NodalLoad { name, forces: boundary_forces(mesh, traction, thickness) };
    let mut loads = Vec::new();
    for k in 0..d {
        for l in 0..=k {
            let name = format!("stress {}{}", names[l], names[k]);
            let traction = |_: &[f64], n: &[f64]| {
                let mut t = vec![0.0; d];
                t[k] = n[l];
                t[l] = n[k];
                t
            };
            loads.push(on_boundary(name, &traction));
        }
    }
    if d == 3 {
        let twist = |x: &[f64], n: &[f64]| {
            let around = cross(three(&frame.axis), three(&frame.away(x)));
            let (along, turned) = (dot(&frame.axis, n), dot(&around, n));
            around.iter().zip(&frame.axis).map(|(t, a)| t * along + a * turned).collect()
        };
        loads.push(on_boundary("torsion".into(), &twist));
    }
    for (i, lever) in frame.across.iter().enumerate() {
        let bend = |x: &[f64], n: &[f64]| {
            let size = dot(lever, &frame.away(x)) * dot(&frame.axis, n);
            frame.axis.iter().map(|a| a * size).collect()
        };
        let name = if frame.across.len() == 1 { "bending".to_string() } else { format!("bending {}", i + 1) };
        loads.push(on_boundary(name, &bend));
    }
    loads.extend((0..d).map(|k| {
        NodalLoad {
            name: format!("gravity {}", names[k]),
            forces: nodal_forces(mesh, &Selection::Everything, &Action::body(&e(k)), thickness)
                .expect("a mesh has cells to act on"),
        }
    }));
    acting(loads, support)
}

/// The loads that move something: a chain of rods has no sides, all sides may be held, and tractions may cancel wherever points are free.
fn acting(loads: Vec<NodalLoad>, support: &Support) -> Vec<NodalLoad> {
    let acts = |load: &NodalLoad| {
        // A load of zeros has no force above its own largest, and is left out as well.
        let least = ROUNDING * largest(&load.forces);
        load.forces.iter().zip(&support.prescribed).any(|(f, held)| held.is_none() && f.abs() > least)
    };
    loads.into_iter().filter(acts).collect()
}

fn largest(forces: &[f64]) -> f64 {
    forces.iter().fold(0.0, |largest, f| largest.max(f.abs()))
}

/// The share of each degree of freedom in a body force of 1 N/m³.
fn weights(mesh: &Mesh, thickness: &CellMap<f64>) -> Vec<f64> {
    point_contents(mesh, thickness).into_iter().flat_map(|content| vec![content; mesh.dimension]).collect()
}

/// "random 1", …: smooth body forces, each component a sum of sines with up to half a wave across the object. The same
/// seed always gives the same loads.
pub fn random_loads(
    mesh: &Mesh,
    support: &Support,
    thickness: impl Into<CellMap<f64>>,
    count: usize,
    seed: u64,
) -> Vec<NodalLoad> {
    random(mesh, support, thickness.into(), count, seed)
}

/// [`random_loads`], without parameters of type: compiled here, where code is optimised, and not with each caller.
fn random(mesh: &Mesh, support: &Support, thickness: CellMap<f64>, count: usize, seed: u64) -> Vec<NodalLoad> {
    let d = mesh.dimension;
    let frame = Frame::of(mesh, support);
    let mut random = StdRng::seed_from_u64(seed);
    let weights = weights(mesh, &thickness);
    let mut field = |index: usize| {
        let sines: Vec<(Vec<f64>, f64, f64)> = (0..d * SINES)
            .map(|_| {
                let wave = (0..d).map(|_| std::f64::consts::TAU * WAVES * random.random_range(-1.0..1.0)).collect();
                (wave, random.random_range(0.0..std::f64::consts::TAU), random.random_range(-1.0..1.0))
            })
            .collect();
        let at = |(dof, weight): (usize, &f64)| {
            let r = frame.away(mesh.point(dof / d));
            let own = &sines[dof % d * SINES..(dof % d + 1) * SINES];
            weight * own.iter().map(|(wave, phase, size)| size * (dot(wave, &r) + phase).sin()).sum::<f64>()
        };
        NodalLoad { name: format!("random {index}"), forces: weights.iter().enumerate().map(at).collect() }
    };
    (1..=count).map(&mut field).collect()
}

/// The pressure with which varied loads begin. Few other loads see the resistance to a change of volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pressure {
    /// The pressure has one value everywhere; the load is called "pressure".
    Uniform,
    /// Linear in the position, with slopes from the seed: "varying pressure". No other seed has it, as none has the other varied loads.
    Varying,
}

/// A pressure on the whole boundary, then "patch 1", …: tractions of random direction around a random place of the boundary, and
/// "field 1", …: body forces that are linear in the position. Every third is a field. The same seed always gives the same loads.
pub fn varied_loads(
    mesh: &Mesh,
    support: &Support,
    thickness: &CellMap<f64>,
    pressure: Pressure,
    (count, seed): (usize, u64),
) -> Vec<NodalLoad> {
    let d = mesh.dimension;
    let frame = Frame::of(mesh, support);
    let mut random = StdRng::seed_from_u64(seed);
    let uniform = boundary_forces(mesh, &|_: &[f64], n: &[f64]| n.iter().map(|n| -n).collect(), thickness);
    // A pressure pushes on each point of the boundary and cancels at those within, but for rounding.
    let least = ROUNDING * largest(&uniform);
    let on_boundary: Vec<usize> =
        (0..mesh.point_count()).filter(|p| uniform[p * d..(p + 1) * d].iter().any(|f| f.abs() > least)).collect();
    let weights = weights(mesh, thickness);
    let mut loads = vec![match pressure {
        Pressure::Uniform => NodalLoad { name: PRESSURE.into(), forces: uniform },
        Pressure::Varying => {
            // A generator of its own: the one of the other loads is not moved on.
            let mut random = StdRng::seed_from_u64(seed ^ SLOPES);
            // Positions are relative to the middle in units of the longest side, about 1/2 in size at most: the
            // pressure changes by up to half of its mean towards each end of an axis.
            let slopes: Vec<f64> = (0..d).map(|_| random.random_range(-1.0..1.0)).collect();
            let push = |x: &[f64], n: &[f64]| n.iter().map(|n| -n * (1.0 + dot(&slopes, &frame.away(x)))).collect();
            NodalLoad { name: "varying pressure".into(), forces: boundary_forces(mesh, &push, thickness) }
        }
    }];
    for index in 1..count {
        let direction = unit(&(0..d).map(|_| random.random_range(-1.0..1.0)).collect::<Vec<f64>>());
        // Tractions alone leave the inside of a body without a load of its own.
        if index % 3 == 0 || on_boundary.is_empty() {
            // With positions of up to 1/2 the linear part is as large as the uniform one, of length one, at the ends of
            // the longest side.
            let slopes: Vec<f64> = (0..d * d).map(|_| random.random_range(-2.0..2.0)).collect();
            let at = |(dof, weight): (usize, &f64)| {
                let (r, k) = (frame.away(mesh.point(dof / d)), dof % d);
                weight * (direction[k] + dot(&slopes[k * d..(k + 1) * d], &r))
            };
            let forces = weights.iter().enumerate().map(at).collect();
            loads.push(NodalLoad { name: format!("field {index}"), forces });
            continue;
        }
        let place = mesh.point(on_boundary[random.random_range(0..on_boundary.len())]);
        let width = frame.size * random.random_range(PATCH);
        let around = |x: &[f64], _: &[f64]| {
            let share = (-0.5 * (distance(x, place) / width).powi(2)).exp();
            direction.iter().map(|t| share * t).collect()
        };
        loads.push(NodalLoad { name: format!("patch {index}"), forces: boundary_forces(mesh, &around, thickness) });
    }
    acting(loads, support)
}

/// The middle of the object, and its direction away from the supports.
struct Frame {
    middle: Vec<f64>,
    /// The longest side of the box around the object, m.
    size: f64,
    axis: Vec<f64>,
    /// Unit vectors that are orthogonal to the axis and to each other.
    across: Vec<Vec<f64>>,
}

impl Frame {
    fn of(mesh: &Mesh, support: &Support) -> Frame {
        let d = mesh.dimension;
        let mean = |points: &[usize]| -> Vec<f64> {
            (0..d).map(|k| points.iter().map(|&p| mesh.point(p)[k]).sum::<f64>() / points.len().max(1) as f64).collect()
        };
        let all: Vec<usize> = (0..mesh.point_count()).collect();
        let held: Vec<usize> = all.iter().copied().filter(|p| (0..d).any(|k| support.is_fixed(p * d + k))).collect();
        let range = |k: usize| {
            let coordinates = || all.iter().map(|&p| mesh.point(p)[k]);
            (coordinates().fold(f64::MAX, f64::min), coordinates().fold(f64::MIN, f64::max))
        };
        let sides: Vec<f64> = (0..d).map(|k| range(k).1 - range(k).0).collect();
        let size = sides.iter().copied().fold(0.0, f64::max);
        let middle = mean(&all);
        let mut axis: Vec<f64> = middle.iter().zip(mean(&held)).map(|(a, b)| a - b).collect();
        // An object that is held all around has no direction: its longest side is used.
        // A twentieth of the size is what unequal cells leave of a direction where supports surround the object: the
        // mean of points is not that of the volume.
        if held.is_empty() || !(norm(&axis) > 0.05 * size) {
            axis = (0..d).map(|k| sides[k]).collect();
            let longest = (0..d).fold(0, |best, k| if sides[k] > sides[best] { k } else { best });
            axis.iter_mut().enumerate().for_each(|(k, a)| *a = f64::from(u8::from(k == longest)));
        }
        axis = unit(&axis);
        // The coordinate direction farthest from the axis, made orthogonal to it.
        let farthest = (0..d).fold(0, |best, k| if axis[k].abs() < axis[best].abs() { k } else { best });
        let first: Vec<f64> = (0..d).map(|k| f64::from(u8::from(k == farthest)) - axis[farthest] * axis[k]).collect();
        let mut across = vec![unit(&first)];
        if d == 3 {
            across.push(cross(three(&axis), three(&across[0])).to_vec());
        }
        Frame { middle, size, axis, across }
    }

    fn away(&self, x: &[f64]) -> Vec<f64> {
        x.iter().zip(&self.middle).map(|(x, c)| (x - c) / self.size).collect()
    }
}

/// The three entries of a vector of space.
fn three(v: &[f64]) -> [f64; 3] {
    std::array::from_fn(|k| v[k])
}
