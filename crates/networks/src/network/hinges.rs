//! Hinges between triangles in place of those on directors, for programs that have no directors.

use super::record::{HeldRecord, MeasureKind, NetworkRecord, NodalForceRecord, NodalLoadRecord, SpringRecord};
use crate::element::SpringKind;
use crate::springs::HINGE_POINTS;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// A hinge on a director, and its points.
type Half<'a> = (&'a SpringRecord<'static>, [usize; HINGE_POINTS]);

impl NetworkRecord {
    /// The network without the directors that only hinges turn from and levers hold; `None` if it has none, or loads pull at one.
    ///
    /// Springs of the constants k_i on the turns a_i of the triangles at an edge from its director ψ have the energy `½ Σ_i k_i (a_i − ψ)²`. Where nothing else turns
    /// the director it is at rest with `½ Σ_{i<j} k_i k_j/Σk (a_i − a_j)²`: springs on the angles between pairs of triangles, exact at any deformation. At a free
    /// edge nothing is left. A director that is held is a point that stays, and so do the springs on its triangles.
    ///
    /// The masses of the directors, the rotary inertia of the sheet, go to the ends of their edges. The longest step is not known.
    pub fn without_directors(&self) -> Option<NetworkRecord> {
        let directors = self.directors();
        let mut is_left_out = directors.clone();
        let held = self.held.iter().chain(self.loads.iter().flat_map(|load| &load.held));
        held.for_each(|held| is_left_out[held.point] = false);
        let pulled = self.loads.iter().flat_map(|load| &load.forces).any(|force| is_left_out[force.point]);
        if pulled || !is_left_out.contains(&true) {
            return None;
        }
        // A director that is held needs no lever.
        let is_lever = |spring: &SpringRecord| {
            self.measures[spring.measure].kind == MeasureKind::Length && spring.points.iter().any(|&p| directors[p])
        };
        let mut places = vec![None; self.points.len()];
        let kept: Vec<usize> = (0..self.points.len()).filter(|&p| !is_left_out[p]).collect();
        kept.iter().enumerate().for_each(|(place, &p)| places[p] = Some(place));
        let moved = |p: usize| places[p];
        let all = |points: &[usize]| points.iter().map(|&p| moved(p)).collect::<Option<Vec<usize>>>();
        let (mut springs, mut halves) = (Vec::new(), BTreeMap::<usize, Vec<Half>>::new());
        for spring in self.springs.iter().filter(|spring| !is_lever(spring)) {
            match (all(&spring.points), <[usize; HINGE_POINTS]>::try_from(&spring.points[..])) {
                (Some(points), _) => springs.push(SpringRecord { points: Cow::Owned(points), ..spring.clone() }),
                (None, Err(_)) => return None,
                (None, Ok(points)) => halves.entry(points[3]).or_default().push((spring, points)),
            }
        }
        for sides in halves.values() {
            let sum: f64 = sides.iter().map(|(spring, _)| spring.constant).sum();
            for (i, (first, own)) in sides.iter().enumerate() {
                for (second, other) in &sides[i + 1..] {
                    let points = all(&[own[0], own[1], own[2], other[0]])?;
                    // Triangles that run through the edge in opposite directions measure their turns towards one side.
                    let is_of_one_side = own[1] == other[2];
                    let turned = if is_of_one_side { first.rest + second.rest } else { first.rest - second.rest };
                    // The hinge measures what its halves do, of other points.
                    springs.push(SpringRecord {
                        points: Cow::Owned(points),
                        constant: first.constant * second.constant / sum,
                        rest: wrapped(turned - std::f64::consts::PI),
                        ..(*first).clone()
                    });
                }
            }
        }
        let mut masses = self.masses.clone();
        for masses in masses.iter_mut() {
            for (director, sides) in &halves {
                let (_, [_, a, b, _]) = sides[0];
                let half = masses[*director] / 2.0;
                [a, b].into_iter().for_each(|end| masses[end] += half);
            }
        }
        let held = |list: &[HeldRecord]| -> Vec<HeldRecord> {
            let kept = list.iter().filter_map(|held| Some(HeldRecord { point: moved(held.point)?, ..held.clone() }));
            kept.collect()
        };
        let loads = self.loads.iter().map(|load| {
            let force = |f: &NodalForceRecord| Some(NodalForceRecord { point: moved(f.point)?, ..f.clone() });
            let forces = load.forces.iter().filter_map(force).collect();
            NodalLoadRecord { forces, held: held(&load.held), ..load.clone() }
        });
        // Nodes are the first points, and stay where they are; so cells and the surface name the same ones.
        Some(NetworkRecord {
            points: kept.iter().map(|&p| self.points[p].clone()).collect(),
            nodes: self.nodes.as_ref().map(|nodes| kept.iter().map(|&p| nodes[p]).collect()),
            masses: masses.map(|masses| kept.iter().map(|&p| masses[p]).collect()),
            held: held(&self.held),
            loads: loads.collect(),
            largest_step: None,
            springs,
            ..self.clone()
        })
    }

    /// Whether each point is a director that nothing but hinges and levers knows. Directors are after all nodes.
    fn directors(&self) -> Vec<bool> {
        let is_hinge = |spring: &&SpringRecord| spring.kind == SpringKind::Hinge.name();
        let mut is_director = vec![false; self.points.len()];
        self.springs.iter().filter(is_hinge).for_each(|spring| is_director[spring.points[HINGE_POINTS - 1]] = true);
        let last = self.cells.iter().flat_map(|block| block.points.iter().flatten()).max();
        is_director.iter_mut().take(last.map_or(0, |last| last + 1)).for_each(|is| *is = false);
        for spring in self.springs.iter().filter(|spring| self.measures[spring.measure].kind != MeasureKind::Length) {
            let turned = usize::from(is_hinge(&spring));
            // What else knows a point makes it more than a director.
            spring.points[..spring.points.len() - turned].iter().for_each(|&p| is_director[p] = false);
        }
        is_director
    }
}

/// An angle between −π and π.
fn wrapped(angle: f64) -> f64 {
    let turn = 2.0 * std::f64::consts::PI;
    angle - turn * (angle / turn).round()
}
