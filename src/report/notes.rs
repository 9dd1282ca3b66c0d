//! What a reader must know before trusting a result.

use super::agreement::{Agreement, agreements};
use super::frequencies::frequency_notes;
use super::linear_theory::{bending_note, distrust, linear_notes};
use super::materials::material_note;
use super::motion::motion_notes;
use super::quality::quality_lines;
use super::sheets::sheet_notes;
use crate::mesh::{CellBlock, Filled};
use crate::model::Lumping;
use crate::solve::{Ending, Standing};
use crate::study::{FitOutcome, Followed, GaugeResult, Outcome, extent, spurious_modes};

/// What points notes at the table beside them, for those who have none.
pub const IN_TABLE: &str = " (* in the table)";

/// What a reader must know before trusting a row, one sentence per line.
pub fn notes(outcome: &Outcome) -> Vec<String> {
    let quality = quality_lines(&outcome.mesh.quality);
    let annotations = outcome.mesh.annotations.notes();
    quality.into_iter().chain(annotations).chain(notes_beside_summary(outcome)).collect()
}

/// Says what a reader must know before trusting a row, one sentence per line, without the lines that `summary` has.
pub fn notes_beside_summary(outcome: &Outcome) -> Vec<String> {
    let finite = outcome.loads.iter().filter_map(|load| trouble(&load.name, load.followed.as_ref()?));
    let finite = finite.map(|trouble| format!("finite elements: {trouble}"));
    let measured = outcome.loads.iter().filter_map(|load| {
        let measured = load.measured.filter(|measured| measured.points > 0)?;
        let error = measured.error.map_or("-".into(), |e| format!("e_rms / e_max {:.2} / {:.2} %", e.rms, e.max));
        let own = measured
            .uncertainty
            .map_or(String::new(), |e| format!(", which themselves are right to about {:.2} / {:.2} %", e.rms, e.max));
        Some(format!(
            "errors under {} are relative to the displacements {} at {} points{own}; finite elements: {error}",
            load.name,
            measured.standard.words(),
            measured.points
        ))
    });
    let own = outcome.fits.iter().flat_map(|fit| note(outcome, fit));
    let starts = agreements(outcome);
    let silent = outcome.loads.iter().filter(|load| load.gauge == Some(GaugeResult::NoReading)).map(|load| {
        let why = "it requires a force along its axis that acts on one side of it only";
        format!("the gauge has no reading under {}: {why}", load.name)
    });
    let notes = distrust(outcome)
        .into_iter()
        .chain(outcome.assumed.iter().cloned())
        .chain(spurious(outcome))
        .chain(fibres(outcome))
        .chain(outcome.mesh.quality.filled.as_ref().and_then(Filled::far_off))
        .chain(outcome.material.remarks().iter().cloned())
        .chain(outcome.of_loads.iter().cloned())
        .chain(lumping(outcome))
        .chain(finite)
        .chain(bending_note(outcome))
        .chain(sheet_notes(outcome))
        .chain(linear_notes(outcome))
        .chain(silent)
        .chain(measured)
        .chain(own)
        .chain(starts.iter().map(agreed));
    notes.chain(frequency_notes(outcome)).chain(motion_notes(outcome)).collect()
}

/// That the rule of an element leaves motions without stiffness.
fn spurious(outcome: &Outcome) -> Vec<String> {
    let note = |block: &CellBlock| {
        let (name, modes) = (&block.element.name, spurious_modes(&block.element).filter(|modes| *modes > 0)?);
        let count = if modes == 1 { "1 motion that deforms".into() } else { format!("{modes} motions that deform") };
        Some(format!(
            "the rule of {name} gives {count} a cell no stiffness (spurious modes): finite elements and fits do not see them, and errors relative to \
             R have no meaning there"
        ))
    };
    outcome.mesh.blocks.iter().filter_map(note).collect()
}

/// That what is linear does not know the fibres of the law.
fn fibres(outcome: &Outcome) -> Option<String> {
    let (law, share) = (outcome.law.as_ref()?, 100.0 * outcome.fibres?);
    Some(format!(
        "{law}: with its fibres the elasticity tensor at rest differs by {share:.1} % from that of E and nu. Errors of matrices, the networks \
         as materials and fits of linear springs are for E and nu, without fibres"
    ))
}

/// That masses are not the row sums that most expect. A motion says itself how it lumps them.
fn lumping(outcome: &Outcome) -> Option<String> {
    let is_hrz = outcome.motion.is_none() && outcome.lumping == Some(Lumping::Hrz);
    is_hrz.then(|| "some row sums of the mass matrix are not positive: the masses are those of the HRZ method".into())
}

/// What is wrong with an equilibrium.
fn trouble(load: &str, followed: &Followed) -> Option<String> {
    match (followed.ending, followed.inverted) {
        (Ending::Stalled, _) if followed.residual.is_nan() => {
            Some(format!("the response is not finite at {:.3} of the load {load}", followed.load))
        }
        (Ending::Stalled, _) => Some(format!(
            "no equilibrium was found beyond {:.3} of the load {load} (residual {:.1e} there)",
            followed.load, followed.residual
        )),
        (Ending::Converged, 0) if followed.is_rounded => Some(format!(
            "under {load} rounding limits the equilibrium: the residual is {:.1e} of the forces",
            followed.residual
        )),
        (_, 0) => None,
        (_, count) => Some(format!("{count} elements are inverted under {load}")),
    }
}

fn note(outcome: &Outcome, fit: &FitOutcome) -> Vec<String> {
    let name = &fit.fit.name;
    let mut notes = Vec::new();
    if fit.deficient > 0 {
        notes.push(format!(
            "{name}: in {} elements the objective has more than one optimum; the one with the smallest constants is used",
            fit.deficient
        ));
    }
    if fit.reused > 0 {
        let cells = outcome.mesh.cell_count();
        let fitted = cells.saturating_sub(fit.reused).max(1);
        notes.push(format!(
            "{name}: {fitted} of {cells} elements {} fitted, in {:.3} us each. Each of the others has the shape of one of them and takes its \
             constants{IN_TABLE}",
            if fitted == 1 { "was" } else { "were" },
            1e6 * fit.seconds_per_element(cells)
        ));
    }
    if fit.unreached > 0 {
        let elements = if fit.unreached == 1 { "element" } else { "elements" };
        notes
            .push(format!("{name}: in {} {elements} the iteration ended before it reached the optimum", fit.unreached));
    }
    let own = fit.kind.notes(outcome.mesh.cell_count(), &outcome.material);
    notes.extend(own.into_iter().map(|note| format!("{name}: {note}")));
    if let Some(engine) = &fit.engine {
        let of_engine = engine.notes(extent(&outcome.mesh).into_iter().fold(0.0, f64::max));
        notes.extend(of_engine.into_iter().map(|note| format!("{name}: {note}")));
        if outcome.motion.is_some() {
            notes.push(format!(
                "{name}: the motion is that of equations which are solved to the end, not that in the engine"
            ));
        }
    }
    notes.extend(material_note(outcome, fit));
    if let Some(m) = &fit.moduli {
        let (of, unit) = match outcome.material.thicknesses().uniform() {
            Some(thickness) => (m.young / thickness, "Pa"),
            None => (m.young, "N/m"),
        };
        let material = outcome.material.uniform().map_or(String::new(), |material| {
            format!("; the material has {:e} Pa, {}, 1", material.young(), material.poisson())
        });
        notes.push(format!(
            "{name}: the whole network has E = {of:.4e} {unit}, nu = {:.3}, Zener ratio {:.3}{material}",
            m.poisson, m.zener,
        ));
    }
    for load in &fit.loads {
        if let Some(trouble) = load.followed.and_then(|followed| trouble(&load.name, &followed)) {
            notes.push(format!("{name}: {trouble}"));
        }
    }
    let Some(stability) = &fit.stability else { return notes };
    let points = points(outcome, &fit.loose_points);
    let [least, _] = stability.energy_ratio;
    let remedy = if fit.network.negative() > 0 && fit.kind.published().is_some() {
        format!("; {} spring constants are negative", fit.network.negative())
    } else if fit.network.negative() > 0 {
        format!("; {} spring constants are negative, which \"nonnegative = true\" prevents", fit.network.negative())
    } else {
        String::new()
    };
    let reason = fit.loads.iter().find_map(|load| load.unsolved.as_ref());
    let reason = reason.map_or(String::new(), |reason| format!(" ({reason})"));
    let unsolved = match fit.loads.iter().all(|load| load.displacement.is_none()) {
        true => format!(", and no displacements are given{reason}"),
        false => String::new(),
    };
    if !stability.is_found && [Standing::Stable, Standing::Soft].contains(&stability.standing) {
        notes.push(format!(
            "{name}: the search for the softest motion has not converged; the least energy ratio may be lower than {least:.1e}"
        ));
    }
    match stability.standing {
        Standing::Stable => {}
        Standing::Soft => notes.push(format!(
            "{name}: near-mechanism, a motion has only {least:.1e} of the body's stiffness; the displacements are unreliable. \
             Loosest: {points}{remedy}"
        )),
        Standing::Indefinite => notes.push(format!(
            "{name}: indefinite, a motion releases energy ({least:.1e} of the energy that it stores in the body): the \
             equilibrium is unstable{unsolved}. Moving most: {points}{remedy}"
        )),
        Standing::Singular => notes.push(format!(
            "{name}: mechanism, a motion has no stiffness, so no displacements are given. Moving freely: {points}{remedy}"
        )),
    }
    notes
}

fn agreed(agreement: &Agreement) -> String {
    let percent = 100.0 * agreement.difference;
    let verdict = match agreement.agree {
        true => format!("agree within {percent:.0} %"),
        false if percent.is_finite() => format!("do not agree: they differ by up to {percent:.0} %"),
        false => "cannot be compared: one of them is not known".into(),
    };
    format!("{}: held-out errors {verdict} ({})", agreement.fits.join(", "), agreement.load)
}

fn points(outcome: &Outcome, points: &[usize]) -> String {
    let place = |&p: &usize| {
        let x: Vec<String> = outcome.mesh.point(p).iter().map(|x| format!("{x:.4}")).collect();
        format!("{} ({})", outcome.mesh.point_number(p), x.join(", "))
    };
    let named: Vec<_> = points.iter().take(3).map(place).collect();
    let rest = if points.len() > 3 { format!(" and {} more", points.len() - 3) } else { String::new() };
    let (word, many) = (outcome.mesh.point_word(), if points.len() == 1 { "" } else { "s" });
    format!("{word}{many} {}{rest}", named.join(", "))
}
