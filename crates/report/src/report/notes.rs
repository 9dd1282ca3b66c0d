//! What a reader must know before trusting a result.

use super::agreement::{Agreement, agreements};
use super::frequencies::frequency_notes;
use super::linear_theory::{bending_note, distrust, linear_note};
use super::materials::material_note;
use super::motion::{motion_distrust, motion_notes};
use super::note::{Note, Weight, grouped, ordered};
use super::quality::quality_lines;
use super::sheets::sheet_notes;
use crate::mesh::{CellBlock, Filled};
use crate::model::{Lumping, is_balanced};
use crate::solve::{Ending, Standing};
use crate::study::{BODY, BodyLoad, FitOutcome, Followed, GaugeResult, Outcome, Standard, spurious_modes};

/// What a reader must know before trusting a row, one sentence for each model or load, the dearest first.
pub fn notes(outcome: &Outcome) -> Vec<String> {
    of_summary(outcome).chain(notes_beside_summary(outcome)).collect()
}

/// Says what [`notes`] does, without the lines that `summary` has.
pub fn notes_beside_summary(outcome: &Outcome) -> Vec<String> {
    ordered(all(outcome)).iter().map(Note::sentence).collect()
}

/// Says what [`notes`] does with one sentence for all models and loads that it concerns.
pub(super) fn groups(outcome: &Outcome) -> Vec<String> {
    of_summary(outcome).chain(groups_beside_summary(outcome)).collect()
}

/// Says what [`notes_beside_summary`] does with one sentence for all models and loads that it concerns.
pub fn groups_beside_summary(outcome: &Outcome) -> Vec<String> {
    grouped(all(outcome)).iter().map(Note::sentence).collect()
}

/// What `summary` says as well.
fn of_summary(outcome: &Outcome) -> impl Iterator<Item = String> {
    let quality = quality_lines(&outcome.mesh.quality);
    distrust(outcome).into_iter().chain(motion_distrust(outcome)).chain(quality).chain(outcome.mesh.annotations.notes())
}

/// The sentences of a record of the network `name` which say that its cells lock, so that it is too stiff with them.
pub fn of_locking<'n>(name: &'n str, notes: &'n [String]) -> impl Iterator<Item = &'n str> {
    let sentence = move |note: &'n String| note.strip_prefix(name)?.strip_prefix(": ");
    notes.iter().filter_map(sentence).filter(|words| words.contains("cells lock"))
}

fn all(outcome: &Outcome) -> Vec<Note> {
    let of_body = |weight: Weight| move |words: String| Note::of_body(weight, words);
    let mut notes: Vec<Note> = spurious(outcome).into_iter().map(of_body(Weight::Broken)).collect();
    let unsolved = outcome.loads.iter().filter_map(|load| trouble(&load.name, load.followed.as_ref()?));
    notes.extend(unsolved.map(|words| Note::of_model(Weight::Broken, BODY, words)));
    notes.extend(outcome.of_loads.iter().cloned().map(of_body(Weight::Reference)));
    notes.extend(bending_note(outcome).into_iter().chain(linear_note(outcome)).chain(measured(outcome)));
    let model = outcome.assumed.iter().cloned().chain(fibres(outcome)).chain(odd_density(outcome));
    let model = model.chain(outcome.mesh.quality.filled.as_ref().and_then(Filled::far_off));
    notes.extend(model.chain(outcome.material.remarks().iter().cloned()).map(of_body(Weight::Model)));
    notes.extend(sheet_notes(outcome));
    notes.extend(outcome.fits.iter().flat_map(|fit| of_fit(outcome, fit)));
    notes.extend(agreements(outcome).iter().map(agreed));
    notes.extend(frequency_notes(outcome).into_iter().chain(motion_notes(outcome)));
    notes.extend(lumping(outcome).into_iter().map(of_body(Weight::Detail)).chain(silent(outcome)));
    notes
}

/// What errors are relative to, where that is not the finite elements of the mesh.
fn measured(outcome: &Outcome) -> Vec<Note> {
    let note = |load: &BodyLoad| {
        let measured = load.measured.as_ref().filter(|measured| measured.points > 0)?;
        let error = measured.fem_e_rms.zip(measured.fem_e_max);
        let error = error.map_or("-".into(), |(rms, max)| format!("e_rms / e_max {rms:.2} / {max:.2} %"));
        let own = measured.uncertainty_rms.zip(measured.uncertainty_max);
        let is_alone = own.is_none() && measured.standard == Standard::Quadratic;
        let own = match own {
            Some((rms, max)) => format!(", which themselves are right to about {rms:.2} / {max:.2} %"),
            None if is_alone => ", whose own error is not known without halved cells".into(),
            None => String::new(),
        };
        let words =
            format!(" are relative to the displacements {} at {} points", measured.standard.words(), measured.points);
        let note = Note::of_load(Weight::Reference, "errors under ", &load.name, words);
        Some(note.figures(format!("{own}; finite elements: {error}")))
    };
    outcome.loads.iter().filter_map(note).collect()
}

/// Under which loads the gauge has no reading.
fn silent(outcome: &Outcome) -> Vec<Note> {
    let silent = outcome.loads.iter().filter(|load| load.gauge == Some(GaugeResult::NoReading));
    let why = ": it requires a force along its axis that acts on one side of it only";
    silent.map(|load| Note::of_load(Weight::Detail, "the gauge has no reading under ", &load.name, why)).collect()
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

/// Densities of solids, kg/m³: from aerogels to osmium, with room for models that are lighter or heavier.
const DENSITIES: std::ops::RangeInclusive<f64> = 0.1..=5e4;

/// That no solid has such a density: one of a deck in millimetres and tonnes, or in the unit of another, is 10³ or 10¹² times as large as it should be.
fn odd_density(outcome: &Outcome) -> Option<String> {
    let ends = outcome.material.density()?.range();
    let odd = ends.into_iter().find(|density| !DENSITIES.contains(density))?;
    Some(format!(
        "the density {odd:.3e} kg/m³ is that of no solid (0.1 to 5e4 kg/m³): its unit or that of the mesh is another one"
    ))
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

fn of_fit(outcome: &Outcome, fit: &FitOutcome) -> Vec<Note> {
    let note = |weight, words: String| Note::of_model(weight, &fit.fit.name, words);
    let mut notes = Vec::new();
    if fit.deficient > 0 {
        notes.push(note(
            Weight::Detail,
            format!(
                "in {} elements the objective has more than one optimum; the one with the smallest constants is used",
                fit.deficient
            ),
        ));
    }
    if fit.reused > 0 {
        let cells = outcome.mesh.cell_count();
        let fitted = cells.saturating_sub(fit.reused).max(1);
        let were = if fitted == 1 { "was" } else { "were" };
        let words = format!("{fitted} of {cells} elements {were} fitted");
        let time = format!(", in {:.3} us each", 1e6 * fit.seconds_per_element(cells));
        let others = ". Each of the others has the shape of one of them and takes its constants";
        notes.push(note(Weight::Detail, words).figures(time).advice(others));
    }
    if fit.unreached > 0 {
        let elements = if fit.unreached == 1 { "element" } else { "elements" };
        let words = format!("in {} {elements} the iteration ended before it reached the optimum", fit.unreached);
        notes.push(note(Weight::Model, words));
    }
    let own = fit.kind.notes(outcome.mesh.cell_count(), &outcome.material);
    notes.extend(own.into_iter().map(|words| note(Weight::Fit, words)));
    if let Some(engine) = &fit.engine {
        let of_engine = engine.notes(outcome.mesh.longest_side());
        notes.extend(of_engine.into_iter().map(|words| note(Weight::Fit, words)));
        if outcome.motion.is_some() {
            let words = "the motion is that of equations which are solved to the end, not that in the engine";
            notes.push(note(Weight::Reference, words.into()));
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
        let words = format!(
            "the whole network has E = {of:.4e} {unit}, nu = {:.3}, Zener ratio {:.3}{material}",
            m.poisson, m.zener,
        );
        notes.push(note(Weight::Fit, words));
    }
    notes.extend(unrest(outcome, fit));
    let troubles = fit.loads.iter().filter_map(|load| trouble(&load.name, &load.followed?));
    notes.extend(troubles.map(|words| note(Weight::Broken, words)));
    notes.extend(standing(outcome, fit).into_iter().map(|words| note(Weight::Broken, words)));
    notes
}

/// Forces at rest below this share of the largest pull are no fault of the network.
// A spring pulls by its constant times the length of an edge at most where it has no rest length. What is left of the pulls then moves a
// point by 2 % of an edge at most, as other springs hold it too.
const SMALL: f64 = 0.02;

/// A note on a network that moves without a load. Only sampled laws of force and fitted rest measures can make such a network.
fn unrest(outcome: &Outcome, fit: &FitOutcome) -> Option<Note> {
    let left = fit.unbalanced(&outcome.mesh);
    let words = "the network is not at rest in the mesh: its springs pull there, and their forces do not balance, so that it moves without a load. \
                 Displacements and errors of loads at small deformation are those of its stiffness alone";
    let figures = format!(": {:.1} % of the largest pull is left at some point", 100.0 * left);
    // A small rest of forces moves a body by less than most errors are.
    let weight = if left <= SMALL { Weight::Model } else { Weight::Broken };
    (!is_balanced(left)).then(|| Note::of_model(weight, &fit.fit.name, words).figures(figures))
}

/// Why a network does not stand, or is not known to.
fn standing(outcome: &Outcome, fit: &FitOutcome) -> Vec<String> {
    let Some(stability) = &fit.stability else { return Vec::new() };
    let points = points(outcome, &fit.loose_points);
    let [least, _] = stability.energy_ratio;
    let negative = fit.network.negative();
    let remedy = match (negative, fit.kind.published()) {
        (0, _) => String::new(),
        (_, Some(_)) => format!("; {negative} spring constants are negative"),
        (_, None) => format!("; {negative} spring constants are negative, which \"nonnegative = true\" prevents"),
    };
    let reason = fit.loads.iter().find_map(|load| load.unsolved.as_ref());
    let reason = reason.map_or(String::new(), |reason| format!(" ({reason})"));
    let unsolved = match fit.loads.iter().all(|load| load.displacement.is_none()) {
        true => format!(", and no displacements are given{reason}"),
        false => String::new(),
    };
    let is_sought = !stability.is_found && [Standing::Stable, Standing::Soft].contains(&stability.standing);
    let sought = is_sought.then(|| {
        format!(
            "the search for the softest motion has not converged; the least energy ratio may be lower than {least:.1e}"
        )
    });
    let words = match stability.standing {
        Standing::Stable => None,
        Standing::Soft => Some(format!(
            "near-mechanism, a motion has only {least:.1e} of the body's stiffness; the displacements are unreliable. Loosest: {points}{remedy}"
        )),
        Standing::Indefinite => Some(format!(
            "indefinite, a motion releases energy ({least:.1e} of the energy that it stores in the body): the equilibrium is unstable{unsolved}. \
             Moving most: {points}{remedy}"
        )),
        Standing::Singular => Some(format!(
            "mechanism, a motion has no stiffness, so no displacements are given. Moving freely: {points}{remedy}"
        )),
    };
    sought.into_iter().chain(words).collect()
}

fn agreed(agreement: &Agreement) -> Note {
    let percent = 100.0 * agreement.difference;
    let verdict = match agreement.agree {
        true => format!("agree within {percent:.0} %"),
        false if percent.is_finite() => format!("do not agree: they differ by up to {percent:.0} %"),
        false => "cannot be compared: one of them is not known".into(),
    };
    let words = format!("held-out errors {verdict} ({})", agreement.load);
    Note::of_model(Weight::Fit, &agreement.fits.join(", "), words)
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
