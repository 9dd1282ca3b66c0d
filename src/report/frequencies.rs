//! Natural frequencies side by side.

use super::columns::{Heading, aligned};
use crate::study::{FrequencyOutcome, Outcome};

/// One row per model, a network's frequencies with their distance from those of the finite elements; empty where none were asked for.
pub(super) fn frequency_table(outcome: &Outcome) -> String {
    let known = || outcome.frequencies.iter().filter_map(|model| model.frequencies.as_ref());
    let Some(count) = known().map(Vec::len).max() else { return String::new() };
    let finite = outcome.frequencies[0].frequencies.as_ref();
    let mut header = vec![Heading::words("frequencies")];
    header.extend((1..=count).map(|i| Heading::numbers(format!("{i}\nHz (%)"))));
    let row = |(place, model): (usize, &FrequencyOutcome)| {
        let mut row = vec![model.name.clone()];
        match &model.frequencies {
            Some(found) => row.extend(found.iter().enumerate().map(|(i, own)| {
                let off = |body: &Vec<f64>| format!("({:+.1})", 100.0 * (own / body[i] - 1.0));
                let off = finite.filter(|_| place > 0).map_or(String::new(), off);
                format!("{own:.3} {off:>7}")
            })),
            None => row.extend(std::iter::repeat_n("-".to_string(), count)),
        }
        row
    };
    let rows: Vec<_> = outcome.frequencies.iter().enumerate().map(row).collect();
    format!("\nNatural frequencies{}\n{}", rigid(outcome), aligned(&header, &rows))
}

fn rigid(outcome: &Outcome) -> String {
    match outcome.frequencies[0].rigid {
        0 => String::new(),
        1 => ", without those of one rigid motion that no support prevents".into(),
        count => format!(", without those of {count} rigid motions that no support prevents"),
    }
}

pub(super) fn frequency_notes(outcome: &Outcome) -> Vec<String> {
    let note = |model: &FrequencyOutcome| {
        model.reason.as_ref().map(|why| format!("{}: no natural frequencies: {why}", model.name))
    };
    let has_finer = outcome.loads.iter().any(|load| load.measured.is_some_and(|measured| measured.is_of_finer));
    let words = "natural frequencies are compared with those of the finite elements of the mesh, not with those of the finer body";
    let compared = (has_finer && outcome.frequencies.len() > 1).then(|| words.to_string());
    outcome.frequencies.iter().filter_map(note).chain(compared).collect()
}
