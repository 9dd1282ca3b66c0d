//! The springs by which rods resist bending and torsion.
//!
//! Each point is a joint with two directors, which three springs hold at right angles: the joint can turn, and nothing else. Five springs of each rod measure how its
//! ends have turned from its line. They are the beam of Euler and Bernoulli: its finite elements and its network are the same.
//!
//! Theory: page *Rods that bend* of the book.

use super::network::{LengthSpring, MeasureSpring, Network};
use crate::element::SpringKind;
use crate::material::{CellMap, Hooke};
use crate::mesh::{Directors, Mesh, axes_across};
use crate::springs::{Measure, Turns, cross, distance, dot, norm};
use nalgebra::{SMatrix, SVector};
use smallvec::SmallVec;

/// The points of a rod that bends: its ends, the directors of the first and those of the second.
const POINTS: usize = 6;

/// Turns that a rod measures, as places in its points: about the first axis of an end from the rod to the second axis, about the second axis to the first, about the
/// rod from the first axis to the second.
const INCLINED: [[usize; 4]; 6] = [[1, 0, 2, 3], [1, 0, 3, 2], [2, 0, 1, 3], [0, 1, 4, 5], [0, 1, 5, 4], [4, 1, 0, 5]];
/// Turns about the rod from each axis of its first end to one of its second. Of each two that is taken which is farther from half a turn, where angles jump.
const TWISTED: [[[usize; 4]; 2]; 2] = [[[2, 0, 1, 5], [2, 0, 1, 4]], [[3, 0, 1, 4], [3, 0, 1, 5]]];
/// How many turns a rod measures.
const TURNS: usize = INCLINED.len() + TWISTED.len();

/// The motions of the joints of a rod: turns of each end about two axes across the rod, of the second about the rod, and shears of each pair of directors, which levers hold.
const MOTIONS: usize = 7;
/// What a rod resists: for two planes the sum and the difference of the turns of its ends, and its twist.
const MEASURES: usize = 5;

/// A share of a turn that is a rounding error, and is left out.
// Shares are sums of a few products of numbers of size one, rounded by some 1e-16. A smaller share that is meant changes nothing
// in the first twelve digits of a measure, and a turn costs an arc tangent.
const ROUNDING: f64 = 1e-12;

/// The most that a rod with hinges has along an axis of its joint, as a share: joints turn by 30 degrees. Single turns mix bending with twist by it.
// Two rods that bend by 30° at their joint are each 15° off its mean direction, and sin 15° is 0.2588.
const ASKEW: f64 = 0.26;

/// The springs of rods as beams on their joints, by the stiffness E A of each, N: a rod has `E I` of it by its radius of gyration, and G J by `torsion`.
pub(super) fn beams(mesh: &Mesh, joints: &Directors, moduli: &CellMap<Hooke>) -> Network {
    rods(mesh, joints, moduli, bends)
}

/// The springs of rods with hinges, on single turns.
pub(super) fn hinges(mesh: &Mesh, joints: &Directors, moduli: &CellMap<Hooke>) -> Network {
    rods(mesh, joints, moduli, single_turns)
}

/// The first joint that has rods along an axis of its own, so that it is no joint of rods in line.
pub(super) fn askew(mesh: &Mesh, joints: &Directors) -> Option<usize> {
    let from = |a: usize, b: usize| -> [f64; 3] { std::array::from_fn(|k| mesh.point(b)[k] - mesh.point(a)[k]) };
    let is_askew = |end: usize, rod: &[f64; 3], directors: &[usize]| {
        directors.iter().any(|&director| {
            let axis = from(end, director);
            dot(&axis, rod).abs() > ASKEW * norm(&axis) * norm(rod)
        })
    };
    mesh.blocks[0].cells().enumerate().find_map(|(cell, nodes)| {
        let (own, rod) = (joints.of_cell(cell), from(nodes[0], nodes[1]));
        [0, 1].into_iter().find(|&end| is_askew(nodes[end], &rod, &own[2 * end..2 * end + 2])).map(|end| nodes[end])
    })
}

/// What the springs of a rod with these points are by E I and G J.
type Springs = fn(&Mesh, &[usize], [f64; 2]) -> Vec<MeasureSpring>;

fn rods(mesh: &Mesh, joints: &Directors, moduli: &CellMap<Hooke>, springs: Springs) -> Network {
    let mut network = Network { dimension: mesh.dimension, ..Network::default() };
    let first = mesh.node_count();
    let mut holds = vec![0.0; first];
    for (cell, nodes) in mesh.blocks[0].cells().enumerate() {
        let stretch = moduli.at(0, cell).entries(1).0[0];
        let [bend, twist] = [joints.gyration[cell] * stretch, joints.torsion[cell] * stretch];
        let own = joints.of_cell(cell);
        let points: SmallVec<[usize; POINTS]> = nodes.iter().chain(own).copied().collect();
        network.others.extend(springs(mesh, &points, [bend, twist]));
        let length = mesh.rod_length(nodes);
        for (end, director) in nodes.iter().zip([own[0], own[2]]) {
            let reach = distance(mesh.point(*end), mesh.point(director));
            // As stiff for the mass of the director as the rod is for that of its points, so that no explicit step is much shorter.
            holds[*end] += bend / (length * reach * reach);
        }
    }
    network.lengths = levers(mesh, &holds);
    network
}

/// The springs of a beam of the flexural stiffness E I and the torsional stiffness G J, N·m².
///
/// A beam of the length l whose ends have turned by a and b from its line, in one plane, has the energy `E I/(2 l) (4 a² + 4 a b + 4 b²)`, which is
/// `½ (3 E I/l) (a + b)² + ½ (E I/l) (a − b)²`: two springs in each of two planes, and `½ (G J/l) τ²` of the twist τ. The measures are l times these, in m, so that the constants are in N/m.
fn bends(mesh: &Mesh, points: &[usize], [bend, twist]: [f64; 2]) -> Vec<MeasureSpring> {
    let x: Vec<f64> = points.iter().flat_map(|&p| mesh.point(p)).copied().collect();
    let turns = turns(&x);
    let weights = weights(&x, &turns);
    let length = mesh.rod_length(&points[..2]);
    let constants = [3.0 * bend, bend, 3.0 * bend, bend, twist].map(|stiffness| stiffness / length.powi(3));
    let spring = |(measure, constant): (usize, f64)| {
        let row = weights.row(measure) * length;
        // A joint whose axes are across its rod sees each motion by one turn; the other shares are rounding, and would
        // make springs of all points.
        let least = ROUNDING * row.amax();
        let shares = turns.iter().zip(row.iter()).filter(|(_, share)| share.abs() > least);
        let turns = Turns::new(shares.map(|(places, share)| (places.as_slice(), *share)), POINTS);
        let turns = turns.expect("the places of a rod differ, and each measure has a share");
        MeasureSpring::turning(SpringKind::Bend, points.iter().copied().collect(), &x, turns, constant)
    };
    constants.into_iter().enumerate().map(spring).collect()
}

/// The springs of a rod with hinges: `½ (2 E I/l) a²` of each turn of an end about an axis of its joint, which two rods in line have as a spring `E I/l` on the angle
/// between both, and `½ (G J/l) τ²` of the twist, as halves on two turns: then both directors of a joint have the same torque, and their levers none.
fn single_turns(mesh: &Mesh, points: &[usize], [bend, twist]: [f64; 2]) -> Vec<MeasureSpring> {
    let x: Vec<f64> = points.iter().flat_map(|&p| mesh.point(p)).copied().collect();
    let length = mesh.rod_length(&points[..2]);
    let all = turns(&x);
    // The third turn of each end is about the rod, which the twist has already.
    let inclined = [0, 1, 3, 4].map(|place| (all[place], 2.0 * bend));
    let twisted = [all[INCLINED.len()], all[INCLINED.len() + 1]].map(|places| (places, twist / 2.0));
    let spring = |(places, stiffness): ([usize; 4], f64)| {
        let own: Vec<f64> = places.iter().flat_map(|&p| &x[3 * p..3 * p + 3]).copied().collect();
        let points = places.iter().map(|&p| points[p]).collect();
        MeasureSpring::turning(SpringKind::Hinge, points, &own, Turns::of_hinge(), stiffness / length)
    };
    inclined.into_iter().chain(twisted).map(spring).collect()
}

/// One turn of the points of a rod.
fn turn(places: &[usize; 4]) -> Measure {
    Measure::Turns(Box::new(Turns::new([(places.as_slice(), 1.0)], POINTS).expect("the places of a turn differ")))
}

/// The turns that a rod at x measures.
fn turns(x: &[f64]) -> [[usize; 4]; TURNS] {
    let size = |places: &[usize; 4]| turn(places).value(x, 3).abs();
    let twisted = TWISTED.map(|[a, b]| if size(&a) <= size(&b) { a } else { b });
    std::array::from_fn(|turn| *INCLINED.get(turn).unwrap_or_else(|| &twisted[turn - INCLINED.len()]))
}

/// The shares of the turns in each measure of a rod: the least ones whose sums are, to first order, what the motions of the joints are to be measured as.
///
/// A joint may stand askew to its rods, so that a turn about one of its axes sees some of another motion. The sums see each motion alone, and nothing of shears.
fn weights(x: &[f64], turns: &[[usize; 4]; TURNS]) -> SMatrix<f64, MEASURES, TURNS> {
    let mut slopes = SMatrix::<f64, TURNS, MOTIONS>::zeros();
    let motions = motions(x);
    for (row, places) in turns.iter().enumerate() {
        let gradient = SVector::<f64, 18>::from_vec(turn(places).gradient(x, 3));
        motions.iter().enumerate().for_each(|(column, motion)| slopes[(row, column)] = gradient.dot(motion));
    }
    #[rustfmt::skip]
    let wanted = SMatrix::<f64, MEASURES, MOTIONS>::from_row_slice(&[
        1.0, 0.0,  1.0,  0.0, 0.0, 0.0, 0.0,
        1.0, 0.0, -1.0,  0.0, 0.0, 0.0, 0.0,
        0.0, 1.0,  0.0,  1.0, 0.0, 0.0, 0.0,
        0.0, 1.0,  0.0, -1.0, 0.0, 0.0, 0.0,
        0.0, 0.0,  0.0,  0.0, 1.0, 0.0, 0.0,
    ]);
    // The motions are independent, because no rod is in the plane of the directors of its joints.
    let inverse = (slopes.transpose() * slopes).try_inverse().expect("a rod sees the motions of its joints");
    wanted * inverse * slopes.transpose()
}

/// The displacements of the points of a rod at x in each of its motions.
fn motions(x: &[f64]) -> [SVector<f64, 18>; MOTIONS] {
    let at = |place: usize| -> [f64; 3] { std::array::from_fn(|k| x[3 * place + k]) };
    let from = |a: usize, b: usize| -> [f64; 3] { std::array::from_fn(|k| at(b)[k] - at(a)[k]) };
    let rod = from(0, 1);
    let along = rod.map(|x| x / norm(&rod));
    let [first, second] = axes_across(along);
    let of = |parts: [(usize, [f64; 3]); 2]| {
        let mut motion = SVector::<f64, 18>::zeros();
        parts.into_iter().for_each(|(place, u)| motion.fixed_rows_mut::<3>(3 * place).copy_from_slice(&u));
        motion
    };
    let turn =
        |end: usize, axis: [f64; 3]| of([2, 3].map(|place| (2 * end + place, cross(axis, from(end, 2 * end + place)))));
    let shear = |end: usize| {
        let [a, b] = [2 * end + 2, 2 * end + 3];
        of([(a, from(end, b)), (b, from(end, a))])
    };
    [turn(0, first), turn(0, second), turn(1, first), turn(1, second), turn(1, along), shear(0), shear(1)]
}

/// The springs from each joint to its directors and between both. They hold the directors at right angles, and nothing pulls at them in linear theory.
fn levers(mesh: &Mesh, holds: &[f64]) -> Vec<LengthSpring> {
    let first = mesh.node_count();
    let lever = |(joint, &constant): (usize, &f64)| {
        let [a, b] = [first + 2 * joint, first + 2 * joint + 1];
        [[joint, a], [joint, b], [a, b]].map(|points| LengthSpring {
            points,
            constant,
            rest: distance(mesh.point(points[0]), mesh.point(points[1])),
        })
    };
    let mut all: Vec<LengthSpring> = holds.iter().enumerate().flat_map(lever).collect();
    all.sort_by_key(|spring| spring.points);
    all
}
