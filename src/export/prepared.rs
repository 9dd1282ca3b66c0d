//! A network as programs hold it: without directors, and without springs on the volumes of hexahedra.
//!
//! Page of the book: *Networks in other programs*.

use super::job::spatial;
use super::rest::support;
use super::target::Target;
use springfit_bodies::dynamics::largest_square;
use springfit_foundation::error::Result;
use springfit_report::report::{NetworkRecord, NodalLoadRecord, Parts};

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
        sentences.extend(take_gravity(&mut prepared, gravity));
        if prepared.motion.as_ref().is_some_and(|drive| !(drive.forces.is_empty() && drive.pulls.is_empty())) {
            sentences.push("what [[motion.force]] and [[motion.pull]] prescribe in time is left out: the loads that are exported are constant".into());
        }
        if let Some((divided, changed)) = self.divided(&prepared, gravity)? {
            sentences.push(changed);
            prepared = divided;
        }
        Ok((prepared, sentences))
    }
}

/// Takes gravity out of the loads, since a program has its own on all points; what is left of a load acts beside it. Returns a sentence on each
/// load whose gravity is another one.
fn take_gravity(network: &mut NetworkRecord, asked: Option<&[f64]>) -> Vec<String> {
    let own = spatial(asked, network);
    let masses = network.masses.clone().unwrap_or_default();
    let pure: Vec<NodalLoadRecord> = network.loads.iter().filter(|load| load.is_gravity).cloned().collect();
    let mut sentences = Vec::new();
    let words = |g: &[f64]| g.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    for load in &mut network.loads {
        let Some(gravity) = load.gravity.take() else { continue };
        if gravity.iter().zip(&own).any(|(a, b)| a != b) {
            let [asked, used] = [words(&gravity), words(&own[..gravity.len()])];
            sentences.push(format!(
                "the gravity of the load \"{}\" is {asked} m/s², and that of the export {used}: --gravity \"{asked}\" takes the other",
                load.name
            ));
        }
        // Elements share their weight out in another way than masses do.
        let of_elements = pure.iter().find(|other| other.gravity.as_ref() == Some(&gravity));
        let largest = load.forces.iter().flat_map(|force| &force.force).fold(0.0, |most: f64, f| most.max(f.abs()));
        for force in &mut load.forces {
            let weight = match of_elements {
                Some(other) => other.forces.iter().find(|own| own.point == force.point).map(|own| own.force.clone()),
                None => masses.get(force.point).map(|mass| gravity.iter().map(|g| mass * g).collect()),
            };
            force.force.iter_mut().zip(weight.unwrap_or_default()).for_each(|(f, weight)| *f -= weight);
        }
        load.forces.retain(|force| force.force.iter().any(|f| f.abs() > ROUNDING * largest));
    }
    network.loads.retain(|load| !load.is_gravity);
    sentences
}

/// What is left of a force without gravity is rounding below this share of the largest.
const ROUNDING: f64 = 1e-9;

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
