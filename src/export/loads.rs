//! The loads of a scene in files of JSON.

use serde::Serialize;
use springfit_report::report::{NetworkRecord, NodalLoadRecord};
use std::collections::HashMap;

/// A load by its name.
#[derive(Serialize)]
pub(super) struct Load<'a> {
    name: &'a str,
    /// Whether it holds points in another way than the network, so that it is no load of forces.
    moves: bool,
    /// Points and their forces, N.
    forces: Vec<(usize, f64, f64, f64)>,
}

impl Load<'_> {
    /// The loads of a network.
    pub fn all(network: &NetworkRecord) -> Vec<Load<'_>> {
        let usual: HashMap<usize, _> = network.held.iter().map(|held| (held.point, held)).collect();
        let of = |x: &[f64], k: usize| x.get(k).copied().unwrap_or(0.0);
        let load = |load: &NodalLoadRecord| {
            let moves = load.held.iter().any(|held| usual.get(&held.point) != Some(&held));
            let forces = load.forces.iter().map(|f| (f.point, of(&f.force, 0), of(&f.force, 1), of(&f.force, 2)));
            (moves, forces.collect())
        };
        let named = |own| {
            let (moves, forces) = load(own);
            Load { name: &own.name, moves, forces }
        };
        network.loads.iter().map(named).collect()
    }
}
