//! Springs on the volumes of hexahedra, which no program holds, as springs on those of tetrahedra, and what that changes.
//!
//! Page of the book: *Networks in other programs*.

use super::job::spatial;
use super::prepared::longest_step;
use super::rest::{affordable, cases, support};
use super::target::Target;
use springfit_bodies::model::{MeasureSpring, Network, Support};
use springfit_bodies::solve::System;
use springfit_element::element::SpringKind;
use springfit_foundation::error::Result;
use springfit_report::report::{Division, NetworkRecord, Parts};

impl Target {
    /// The network with springs on tetrahedra in place of those on hexahedra, where this program holds volumes of tetrahedra alone, and a sentence on how
    /// far it moves otherwise; `None` if nothing is divided.
    ///
    /// # Errors
    /// A hexahedron is folded; or the equations of the network do not fit into memory.
    pub(super) fn divided(
        &self,
        network: &NetworkRecord,
        gravity: Option<&[f64]>,
    ) -> Result<Option<(NetworkRecord, String)>> {
        if !self.divides {
            return Ok(None);
        }
        let Some(division) = Division::of(network)? else { return Ok(None) };
        // What else no program holds is refused where the network is written.
        let Some(whole) = undivided(network, &division) else { return Ok(None) };
        let Division { network: mut divided, hexahedra, .. } = division;
        let parts = Parts::of(&divided)?;
        let own = parts.network(3);
        let points: Vec<f64> = network.points.concat();
        let support = support(network);
        divided.largest_step = longest_step(&divided, &parts);
        let changed = changes(network, gravity, [&whole, &own], &points, &support, &parts)?;
        let count = hexahedra.len();
        let cells = if count == 1 { "1 hexahedron".to_string() } else { format!("{count} hexahedra") };
        let known = match &changed[..] {
            [] => "by how much is not known: the body is not held, does not resist, or is too large to be solved here"
                .to_string(),
            changed => format!("displacements differ {} (root mean square, small deformation)", changed.join(", ")),
        };
        let sentence = format!(
            "the volume springs of {cells} are written as {} of tetrahedra, which resist changes of their shapes as well: {known}",
            10 * count
        );
        Ok(Some((divided, sentence)))
    }
}

/// The model of the network before it was divided; `None` if it has springs that are not divided and that no program holds.
fn undivided(network: &NetworkRecord, division: &Division) -> Option<Network> {
    let is_kept = |place: &usize| division.hexahedra.binary_search(place).is_err();
    let springs = (0..network.springs.len()).filter(is_kept).map(|place| network.springs[place].clone()).collect();
    let mut whole = Parts::of(&NetworkRecord { springs, ..network.clone() }).ok()?.network(3);
    whole.others.extend(division.hexahedra.iter().filter_map(|&place| {
        let spring = &network.springs[place];
        Some(MeasureSpring {
            kind: SpringKind::Volume,
            points: spring.points.iter().copied().collect(),
            constant: spring.constant,
            rest: spring.rest,
            measure: division.measures[spring.measure].clone()?,
            law: None,
        })
    }));
    Some(whole)
}

/// By how much the displacements of two networks differ under gravity and each load beside it, in words; none where one of them is not solved.
fn changes(
    network: &NetworkRecord,
    gravity: Option<&[f64]>,
    models: [&Network; 2],
    points: &[f64],
    support: &Support,
    parts: &Parts,
) -> Result<Vec<String>> {
    let weight = network.masses.iter().flatten().flat_map(|m| spatial(gravity, network).map(|g| m * g)).collect();
    let mut cases = cases(3, weight, &network.loads);
    cases.truncate(affordable(points, 3, parts));
    if cases.is_empty() || network.held.is_empty() {
        return Ok(Vec::new());
    }
    let mut answers = Vec::new();
    for model in models {
        let system = System::new(&model.stiffness(points), support)?.placed(points, 3);
        let Some(factor) = system.cholesky()? else { return Ok(Vec::new()) };
        let forces: Vec<Vec<f64>> = cases.iter().map(|case| case.forces.clone()).collect();
        answers.push(system.solve_all(&factor, &forces));
    }
    let square = |v: &mut dyn Iterator<Item = f64>| v.map(|v| v * v).sum::<f64>();
    let pairs = cases.iter().zip(answers[0].iter().zip(&answers[1]));
    let words = pairs.filter_map(|(case, (whole, divided))| {
        let apart = square(&mut whole.iter().zip(divided).map(|(a, b)| a - b));
        let share = 100.0 * (apart / square(&mut whole.iter().copied())).sqrt();
        share.is_finite().then(|| format!("by {share:.1} % {}", case.words))
    });
    Ok(words.collect())
}
