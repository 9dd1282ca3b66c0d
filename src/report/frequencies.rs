//! Natural frequencies side by side.

use super::table::Digits::{Signed, Significant};
use super::table::{Cell, Column, Table};
use crate::study::{FrequencyOutcome, Outcome, Standard};

/// One row per model, a network's frequencies with their distance from those of the finite elements.
pub(super) fn frequencies(models: &[FrequencyOutcome]) -> Table {
    let known = |model: &FrequencyOutcome| model.frequencies.clone().unwrap_or_default();
    let most = models.iter().map(|model| known(model).len()).max().unwrap_or(0);
    let finite = models.first().map(known).unwrap_or_default();
    let pair = |i: usize| {
        let column = |title, unit| Column::numbers(title).unit(unit).group(i.to_string());
        [column("f", "Hz"), column("off", "%")]
    };
    let columns = std::iter::once(Column::words("model")).chain((1..=most).flat_map(pair)).collect();
    let row = |(place, model): (usize, &FrequencyOutcome)| {
        let values = known(model);
        let cells = |i: usize| {
            let value = values.get(i).copied();
            let body = finite.get(i).filter(|_| place > 0);
            let off = value.zip(body).map(|(value, body)| value / body - 1.0);
            [Cell::number(value, Significant(4)), Cell::percent(off, Signed(1))]
        };
        std::iter::once(Cell::from(&*model.name)).chain((0..most).flat_map(cells)).collect::<Vec<_>>()
    };
    let rows: Vec<_> = if most > 0 { models.iter().enumerate().map(row).collect() } else { Vec::new() };
    Table::new("frequencies", format!("Natural frequencies{}", rigid(models)), columns, rows)
}

fn rigid(models: &[FrequencyOutcome]) -> String {
    match models.first().map_or(0, |model| model.rigid) {
        0 => String::new(),
        1 => ", without those of one rigid motion that no support prevents".into(),
        count => format!(", without those of {count} rigid motions that no support prevents"),
    }
}

pub(super) fn frequency_notes(outcome: &Outcome) -> Vec<String> {
    let note = |model: &FrequencyOutcome| {
        model.reason.as_ref().map(|why| format!("{}: no natural frequencies: {why}", model.name))
    };
    let has_finer =
        outcome.loads.iter().any(|load| load.measured.is_some_and(|measured| measured.standard == Standard::FinerBody));
    let words = "natural frequencies are compared with those of the finite elements of the mesh, not with those of the finer body";
    let compared = (has_finer && outcome.frequencies.len() > 1).then(|| words.to_string());
    outcome.frequencies.iter().filter_map(note).chain(compared).collect()
}
