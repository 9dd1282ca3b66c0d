//! Assembles the network of a mesh from the springs of its cells; springs between the same two points are added.

use super::network::{MeasureSpring, Network, SpringLaw};
use super::shares::merge;
use super::steady::is_steady;
use crate::element::{SpringKind, Tabulation};
use crate::fit::CellFits;
use crate::mesh::{CellBlock, Mesh};
use crate::springs::{Force, FunctionSpring, Law, Measure, distance};
use crate::stiffness::gather;
use smallvec::SmallVec;
use std::collections::HashMap;
use std::sync::Arc;

impl Network {
    /// Assembles the springs of all cells; `fits` has one entry per block of the mesh.
    pub fn assemble(mesh: &Mesh, fits: &[CellFits]) -> Network {
        let mut network = Network { dimension: mesh.dimension, ..Network::default() };
        let (lengths, steady) = merge(mesh, fits);
        network.lengths = lengths;
        network.others = lawful(mesh, fits);
        network.others.extend(steady);
        mesh.blocks.iter().zip(fits).for_each(|(block, fit)| add_others(mesh, block, fit, &mut network.others));
        network
    }
}

/// Adds the springs of one block that are not on lengths; each belongs to one cell.
fn add_others(mesh: &Mesh, block: &CellBlock, fit: &CellFits, all: &mut Vec<MeasureSpring>) {
    let (d, springs) = (mesh.dimension, &fit.springs);
    let (m, first) = (springs.len(), springs.pairs().len());
    let every: Vec<usize> = (0..springs.nodes()).collect();
    let function = |f: &FunctionSpring| Measure::Function(f.in_space.as_ref().unwrap_or(&f.function).clone());
    let functions = springs.functions().iter().map(|f| (f.kind, &f.nodes, function(f)));
    let of_cell = |kind: SpringKind| match springs.space() == springs.dimension() {
        true => Measure::Content(block.element.clone()),
        false => {
            let formula = Measure::of_kind(kind, springs.nodes(), d);
            Measure::Function(Arc::new(formula.expect("the area of a facet has a formula in any space").into()))
        }
    };
    let at_point =
        |&q: &usize| (SpringKind::PointContent, &every, Measure::PointContent(block.element.clone(), q as u32));
    let of_area = |table: &Arc<Tabulation>| (SpringKind::PointArea, &every, Measure::Span(table.clone()));
    let areas = springs.areas().iter().map(of_area);
    let points = springs.points().iter().map(at_point);
    let content = springs.content().map(|kind| (kind, &every, of_cell(kind)));
    let kinds: Vec<(SpringKind, &Vec<usize>, Measure)> = functions.chain(areas).chain(points).chain(content).collect();
    if kinds.is_empty() {
        return;
    }
    let places = fit.force.places(springs);
    let count = places[m];
    let mut x = Vec::new();
    // A list that grew would be copied, and more than twice as large for a moment.
    all.reserve_exact(kinds.len() * fit.constants.len() / m);
    for (cell, (nodes, constants)) in block.cells().zip(fit.constants.chunks_exact(m)).enumerate() {
        for (s, (kind, own, measure)) in (first..).zip(&kinds) {
            let constant = constants[s];
            let parameters = &fit.parameters[cell * count..][places[s]..places[s + 1]];
            let law = fit.force.law(springs, s);
            let is_idle = match law {
                Some(law) => is_idle(law, parameters),
                None => constant == 0.0 && parameters.iter().all(|p| *p == 0.0),
            };
            if is_idle {
                continue;
            }
            let points: SmallVec<[usize; 4]> = own.iter().map(|&a| nodes[a]).collect();
            // Those of exact networks have it beside their constants, and need no measure.
            if let (Force::Exact { .. }, None) = (&fit.force, law) {
                let rest = parameters.first().map_or(0.0, |slack| slack / constant);
                all.push(MeasureSpring { kind: *kind, points, constant, rest, measure: measure.clone(), law: None });
                continue;
            }
            x.resize(points.len() * d, 0.0);
            gather(&mesh.points, d, &points, &mut x);
            let now = measure.value(&x, d);
            let pull = match fit.force {
                Force::FreeRest => constant * now - parameters[0],
                Force::Linear | Force::Laws(_) | Force::Exact { .. } => 0.0,
            };
            // A constant of zero or next to it has no rest length: T/k is beyond all numbers, and the pull is stored
            // instead.
            if is_steady(constant, pull, now) {
                all.push(MeasureSpring::steady(*kind, points, measure.clone(), now, [constant, pull]));
                continue;
            }
            let rest = match &fit.force {
                Force::FreeRest => parameters[0] / constant,
                Force::Linear | Force::Laws(_) | Force::Exact { .. } => now,
            };
            let law = law.map(|law| Box::new(SpringLaw::new(law.clone(), parameters)));
            all.push(MeasureSpring { kind: *kind, points, constant, rest, measure: measure.clone(), law });
        }
    }
}

/// The length springs of the blocks with a force law. Springs between the same two points are added if the law is
/// linear in its parameters.
fn lawful(mesh: &Mesh, fits: &[CellFits]) -> Vec<MeasureSpring> {
    let mut all: Vec<MeasureSpring> = Vec::new();
    let mut known: HashMap<([usize; 2], (&str, usize)), usize> = HashMap::new();
    for (block, fit) in mesh.blocks.iter().zip(fits) {
        let Force::Laws(laws) = &fit.force else { continue };
        let m = fit.springs.len();
        let places = fit.force.places(&fit.springs);
        for (cell, nodes) in block.cells().enumerate() {
            for (s, &[a, b]) in fit.springs.pairs().iter().enumerate() {
                let at = cell * m + s;
                let parameters = &fit.parameters[cell * places[m]..][places[s]..places[s + 1]];
                let law = &laws[fit.springs.groups()[s]];
                if is_idle(law, parameters) {
                    continue;
                }
                let points = [nodes[a].min(nodes[b]), nodes[a].max(nodes[b])];
                let next = all.len();
                // Parameters of a law that is linear in them add up; of any other law two springs are not one.
                let place = if law.is_linear() { *known.entry((points, law.mark())).or_insert(next) } else { next };
                if place < next {
                    all[place].constant += fit.constants[at];
                    let sums = all[place].law.iter_mut().flat_map(|own| &mut own.parameters);
                    sums.zip(parameters).for_each(|(sum, p)| *sum += p);
                    continue;
                }
                all.push(MeasureSpring {
                    kind: SpringKind::Length,
                    points: points[..].into(),
                    constant: fit.constants[at],
                    rest: distance(mesh.point(points[0]), mesh.point(points[1])),
                    measure: Measure::Length,
                    law: Some(Box::new(SpringLaw::new(law.clone(), parameters))),
                });
            }
        }
    }
    all
}

/// Whether a law has no force with these parameters.
fn is_idle(law: &Law, parameters: &[f64]) -> bool {
    law.is_linear() && parameters.iter().all(|p| *p == 0.0)
}
