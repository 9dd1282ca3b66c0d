//! Whether the linear theory holds for what the finite elements do.

use super::note::{Note, Weight};
use crate::model::Deformation;
use crate::number::finite;
use crate::study::{BodyLoad, LACKING, ModelMotion, Outcome, TooStiff};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How far linear finite elements are deformed under a load or in a motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DeformationRecord {
    /// The load has this name; it is null for the motion.
    pub load: Option<String>,
    /// The largest principal strain by size is this.
    pub strain: Option<f64>,
    /// The largest rotation is in rad.
    pub rotation: Option<f64>,
    /// The deformation is beyond the linear theory: 10 % of strain or 0.1 rad.
    pub beyond_linear: bool,
    /// The finite elements lack about this share of the body's energy, because their cells are linear; it is null where the body does not bend, and where
    /// the share is not known.
    #[serde(default)]
    pub lacking_energy: Option<f64>,
}

impl DeformationRecord {
    fn new(load: Option<&str>, deformation: Deformation, lacking: Option<f64>) -> DeformationRecord {
        DeformationRecord {
            load: load.map(str::to_string),
            strain: finite(deformation.strain),
            rotation: finite(deformation.rotation),
            beyond_linear: deformation.exceeds(Deformation::LINEAR),
            lacking_energy: lacking.and_then(finite),
        }
    }

    /// Makes a record of the deformation under each load and in the motion, where they are linear.
    pub(super) fn all(outcome: &Outcome) -> Vec<DeformationRecord> {
        let loads = outcome.loads.iter().filter_map(of_load);
        let motion = moved(outcome).and_then(|body| body.deformation);
        loads
            .map(|(load, deformation)| DeformationRecord::new(Some(&load.name), deformation, load.lacking))
            .chain(motion.map(|deformation| DeformationRecord::new(None, deformation, None)))
            .collect()
    }
}

fn of_load(load: &BodyLoad) -> Option<(&BodyLoad, Deformation)> {
    Some((load, load.deformation?))
}

fn moved(outcome: &Outcome) -> Option<&ModelMotion> {
    outcome.motion.as_ref()?.models.first()
}

/// That no figure under a load is to be trusted: linear finite elements move by more than the body's own size.
pub(super) fn distrust(outcome: &Outcome) -> Option<String> {
    let size = outcome.mesh.longest_side();
    let linear = outcome.loads.iter().filter(|load| load.deformation.is_some());
    let beyond: Vec<String> = linear
        .map(|load| (load, load.largest_displacement(&outcome.mesh)))
        .filter(|(_, moved)| !(*moved <= size))
        .map(|(load, moved)| format!("{} ({:.0} % of the body)", load.name, 100.0 * moved / size))
        .collect();
    (!beyond.is_empty()).then(|| {
        format!(
            "NOT TRUSTED: the linear finite elements move by more than the body's own size under {}: the load or a unit is wrong, or \
             the body needs a law at large deformation",
            beyond.join(", ")
        )
    })
}

/// That a body bends whose linear cells resist it too much, and that errors are relative to these cells.
pub(super) fn bending_note(outcome: &Outcome) -> Option<Note> {
    let too_stiff = outcome.too_stiff?;
    let is_seen = |load: &&BodyLoad| match too_stiff {
        TooStiff::Coarse => load.lacking.is_some_and(|share| share >= LACKING),
        _ => load.bends,
    };
    let loads = outcome.loads.iter().filter(|load| load.measured.is_none()).filter(is_seen);
    // Of cells that are one across the jumps of strains see a part alone.
    let share =
        |load: &BodyLoad| load.lacking.map_or(String::new(), |share| format!(" (by about {:.0} %)", 100.0 * share));
    let mut under: Vec<String> = loads.map(|load| format!("{}{}", load.name, share(load))).collect();
    if outcome.loads.is_empty() {
        under.push("its vibrations".into());
    }
    let cells = match too_stiff {
        _ if under.is_empty() => return None,
        TooStiff::Locks(_) => return None,
        TooStiff::Bends => "the body is about one cell across and",
        TooStiff::Coarse => "the cells are large for the body, which",
    };
    // A finer body of a law has no quadratic elements.
    let way_out = match outcome.law {
        None => "[reference] with from = \"quadratic\" compares with quadratic elements",
        Some(_) => "more cells across, or elements of higher order, are not",
    };
    let words = format!(
        "{cells} bends under {}: linear cells are too stiff there, and errors are relative to them; {way_out}",
        under.join(", ")
    );
    Some(Note::of_body(Weight::Reference, words))
}

/// Under which loads, and whether in the motion, the linear theory is left: the largest strain and rotation of all.
pub(super) fn linear_note(outcome: &Outcome) -> Option<Note> {
    let loads = outcome.loads.iter().filter_map(of_load).map(|(load, deformation)| (load.name.as_str(), deformation));
    let motion = moved(outcome).and_then(|body| Some(("the motion", body.deformation?)));
    let beyond: Vec<(&str, Deformation)> =
        loads.chain(motion).filter(|(_, deformation)| deformation.exceeds(Deformation::LINEAR)).collect();
    let most = |of: fn(&Deformation) -> f64| {
        // What is not a number is the largest.
        beyond.iter().map(|(_, deformation)| of(deformation)).max_by(f64::total_cmp)
    };
    let largest = Deformation { strain: most(|of| of.strain)?, rotation: most(|of| of.rotation)? };
    // Surfaces and curves in space have no law.
    let is_bulk = outcome.mesh.cell_dimension() == outcome.mesh.dimension;
    let law = ". law = \"stable-neo-hookean\" in [material] solves at large deformation";
    let remedy = if is_bulk { law } else { "" };
    let names: Vec<&str> = beyond.iter().map(|(name, _)| *name).collect();
    let words =
        format!("finite elements: {} under {} are beyond the linear theory", large_words(largest), names.join(", "));
    Some(Note::of_body(Weight::Reference, words).advice(remedy))
}

/// The strains and rotations that exceed the bound of the linear theory, with the bound.
fn large_words(Deformation { strain, rotation }: Deformation) -> String {
    let bound = Deformation::LINEAR;
    let strains = format!("strains of up to {:.0} % (bound {:.0} %)", 100.0 * strain, 100.0 * bound);
    let rotations = format!("rotations of up to {rotation:.2} rad (bound {bound} rad)");
    let large: Vec<String> = [(strain, strains), (rotation, rotations)]
        .into_iter()
        .filter(|(size, _)| !(*size <= bound))
        .map(|(_, words)| words)
        .collect();
    large.join(" and ")
}

/// That small displacements of a network are beyond the linear theory; none if they are not.
pub fn beyond_linear(deformation: Deformation) -> Option<String> {
    let is_beyond = !(deformation.strain <= Deformation::LINEAR && deformation.rotation <= Deformation::LINEAR);
    is_beyond.then(|| format!("{} are beyond the linear theory", large_words(deformation)))
}

/// Says what part of a network's error is the fit's, where the springs turn beside linear finite elements. Bodies in space of surfaces and
/// curves have no law, `is_bulk` is false of them.
pub(super) fn turning_note(model: &ModelMotion, body: Option<Deformation>, is_bulk: bool) -> Option<Note> {
    let ([mean, max], [own_mean, own_max]) = (model.error()?, model.linear_error?);
    let rotation = body?.rotation;
    let law = if is_bulk { ", a law in [material] compares both at large deformation" } else { "" };
    let words =
        format!("the springs turn, and the finite elements, which rotate by up to {rotation:.2} rad, are linear");
    let figures = format!(
        ". Of the e_rms of {mean:.2} / {max:.2} % the fit's is {own_mean:.2} / {own_max:.2} %: that of two linear models"
    );
    let note = Note::of_model(Weight::Reference, &model.name, words).figures(figures);
    Some(note.advice(format!(". linear = true in [motion] compares linear models{law}")))
}
