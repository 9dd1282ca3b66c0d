//! Natural frequencies side by side.

use super::note::{Note, Weight};
use super::table::Digits::{Signed, Significant};
use super::table::Priority::Always;
use super::table::{Cell, Column, Table};
use crate::study::{BODY, FrequencyOutcome, Outcome, QUADRATIC, Standard};

/// The words for both kinds of masses.
const CONSISTENT: &str = "consistent";
const LUMPED: &str = "lumped";

/// Two rows per model, with consistent and with lumped masses, and how far they are off the finite elements with consistent masses, or off
/// quadratic elements where the cells lock: those with lumped masses err as much at higher frequencies as the networks that are compared with them.
pub(super) fn frequencies(models: &[FrequencyOutcome]) -> Table {
    let rows: Vec<(&str, &str, &[f64])> = models
        .iter()
        .flat_map(|model| {
            let kinds = [(CONSISTENT, &model.consistent), (LUMPED, &model.frequencies)];
            let has_none = model.consistent.is_none();
            let rows =
                kinds.into_iter().filter(move |(masses, found)| found.is_some() || (has_none && *masses == LUMPED));
            rows.map(|(masses, found)| (&*model.name, masses, found.as_deref().unwrap_or_default()))
        })
        .collect();
    let most = rows.iter().map(|(.., found)| found.len()).max().unwrap_or(0);
    let of = |model: &str| rows.iter().position(|(name, _, found)| *name == model && !found.is_empty());
    let reference = of(QUADRATIC).or_else(|| of(BODY));
    let pair = |i: usize| {
        let column = |title, unit| Column::numbers(title).unit(unit).group(i.to_string()).priority(Always);
        [column("f", "Hz"), column("off", "%")]
    };
    let columns = [Column::words("model"), Column::words("masses").priority(Always)]
        .into_iter()
        .chain((1..=most).flat_map(pair))
        .collect();
    let row = |(place, (name, masses, found)): (usize, &(&str, &str, &[f64]))| {
        let cells = |i: usize| {
            let value = found.get(i).copied();
            let right =
                reference.filter(|reference| *reference != place).and_then(|reference| rows[reference].2.get(i));
            let off = value.zip(right).map(|(value, right)| value / right - 1.0);
            [Cell::number(value, Significant(4)), Cell::percent(off, Signed(1))]
        };
        [Cell::from(*name), Cell::from(*masses)].into_iter().chain((0..most).flat_map(cells)).collect::<Vec<_>>()
    };
    let cells: Vec<_> = if most > 0 { rows.iter().enumerate().map(row).collect() } else { Vec::new() };
    let note = reference
        .filter(|_| most > 0)
        .map(|reference| format!("off is relative to the {} with {} masses", rows[reference].0, rows[reference].1));
    Table::new("frequencies", format!("Natural frequencies{}", rigid(models)), columns, cells).with_notes(note)
}

fn rigid(models: &[FrequencyOutcome]) -> String {
    match models.first().map_or(0, |model| model.rigid) {
        0 => String::new(),
        1 => ", without those of one rigid motion that no support prevents".into(),
        count => format!(", without those of {count} rigid motions that no support prevents"),
    }
}

/// Which frequencies are missing, and what those of the finite elements are not right for.
pub(super) fn frequency_notes(outcome: &Outcome) -> Vec<Note> {
    let note = |model: &FrequencyOutcome| {
        let kind = if model.frequencies.is_some() { " with consistent masses" } else { "" };
        let words = |why| format!("no natural frequencies{kind}: {why}");
        model.reason.as_ref().map(|why| Note::of_model(Weight::Broken, &model.name, words(why)))
    };
    let is_compared = !outcome.frequencies.is_empty();
    let has_quadratic = outcome.frequencies.iter().any(|model| model.name == QUADRATIC);
    let has_finer = outcome
        .loads
        .iter()
        .any(|load| load.measured.as_ref().is_some_and(|measured| measured.standard == Standard::FinerBody));
    let words = "natural frequencies are compared with those of the finite elements of the mesh, not with those of the finer body";
    let compared = (has_finer && !has_quadratic && outcome.frequencies.len() > 1).then(|| words.to_string());
    let locking = (is_compared && !has_quadratic).then(|| outcome.locks_at()).flatten().map(|poisson| {
        format!(
            "at nu = {poisson} linear cells lock: natural frequencies are compared with those of elements that are too stiff, whose \
             frequencies are too high"
        )
    });
    let of_reference = compared.into_iter().chain(locking).map(|words| Note::of_body(Weight::Reference, words));
    outcome.frequencies.iter().filter_map(note).chain(of_reference).collect()
}
