//! Natural frequencies side by side.

use super::table::aligned;
use crate::study::{FrequencyOutcome, Outcome};
use serde_json::{Value, json};

/// One row per model, a network's frequencies with their distance from those of the finite elements; empty where none were asked for.
pub(super) fn frequency_table(outcome: &Outcome) -> String {
    let known = || outcome.frequencies.iter().filter_map(|model| model.found.as_ref().ok());
    let Some(count) = known().map(Vec::len).max() else { return String::new() };
    let finite = outcome.frequencies[0].found.as_ref().ok();
    let mut header = vec!["frequencies".to_string()];
    header.extend((1..=count).map(|i| format!("{i}\nHz (%)")));
    let row = |(place, model): (usize, &FrequencyOutcome)| {
        let mut row = vec![model.name.clone()];
        match &model.found {
            Ok(found) => row.extend(found.iter().enumerate().map(|(i, own)| {
                let off = |body: &Vec<f64>| format!("({:+.1})", 100.0 * (own / body[i] - 1.0));
                let off = finite.filter(|_| place > 0).map_or(String::new(), off);
                format!("{own:.3} {off:>7}")
            })),
            Err(_) => row.extend(std::iter::repeat_n("-".to_string(), count)),
        }
        row
    };
    let rows: Vec<_> = outcome.frequencies.iter().enumerate().map(row).collect();
    format!("\nNatural frequencies{}\n{}", rigid(outcome), aligned(&header, &rows))
}

fn rigid(outcome: &Outcome) -> String {
    match outcome.frequencies[0].rigid {
        0 => String::new(),
        1 => ", but for one rigid motion that nothing holds".into(),
        count => format!(", but for {count} rigid motions that nothing holds"),
    }
}

pub(super) fn frequency_notes(outcome: &Outcome) -> Vec<String> {
    let note = |model: &FrequencyOutcome| {
        model.found.as_ref().err().map(|why| format!("{}: no natural frequencies: {why}", model.name))
    };
    outcome.frequencies.iter().filter_map(note).collect()
}

/// Hz; null where a model has none.
pub(super) fn frequency_json(model: &FrequencyOutcome) -> Value {
    json!({
        "name": model.name,
        "frequencies": model.found.as_ref().ok(),
        "rigid_motions": model.rigid,
        "reason": model.found.as_ref().err(),
    })
}
