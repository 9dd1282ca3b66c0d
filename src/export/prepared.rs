//! A network as programs hold it: without directors, and without springs on the volumes of hexahedra.
//!
//! Page of the book: *Networks in other programs*.

use super::rest::support;
use super::target::Target;
use crate::dynamics::largest_square;
use crate::error::Result;
use crate::report::{NetworkRecord, Parts};

impl Target {
    /// The network that is written, and a sentence on each way in which it is another one than that of the fit.
    ///
    /// # Errors
    /// A hexahedron is folded; or the equations of the network do not fit into memory.
    pub fn prepared(&self, network: NetworkRecord, gravity: Option<&[f64]>) -> Result<(NetworkRecord, Vec<String>)> {
        let mut sentences = Vec::new();
        let mut prepared = network;
        if let Some(mut hinged) = prepared.without_directors() {
            let count = prepared.points.len() - hinged.points.len();
            let directors = if count == 1 { "1 director".to_string() } else { format!("{count} directors") };
            sentences.push(format!(
                "{directors} at edges are left out: hinges between triangles have their place, which move the sheet alike at rest; its rotary inertia is left out"
            ));
            hinged.largest_step = Parts::of(&hinged).ok().and_then(|parts| longest_step(&hinged, &parts));
            prepared = hinged;
        }
        if let Some((divided, changed)) = self.divided(&prepared, gravity)? {
            sentences.push(changed);
            prepared = divided;
        }
        Ok((prepared, sentences))
    }
}

/// `2/ω` of the fastest motion at rest of a network with these springs, s; `None` without masses.
pub(super) fn longest_step(network: &NetworkRecord, parts: &Parts) -> Option<f64> {
    let (d, points) = (network.dimension, network.points.concat());
    let masses: Vec<f64> = network.masses.as_ref()?.iter().flat_map(|m| std::iter::repeat_n(*m, d)).collect();
    let support = support(network);
    let held: Vec<bool> = (0..points.len()).map(|dof| support.is_fixed(dof)).collect();
    let entries = parts.network(d).stiffness(&points);
    let square = largest_square(entries.iter().map(|e| (e.row, e.col, e.val)), &masses, &held);
    Some(2.0 / square.sqrt()).filter(|step| step.is_finite())
}
