//! What the sweep finds, by family.

use super::markdown;
use springfit_studies::study::{Family, StabilityRow, Verdict, stability};

/// Three groups of objectives, of free constants.
fn group(method: &str) -> Option<usize> {
    let is_free = !method.contains("k >= 0") && !method.contains("tied");
    let first = method.split_whitespace().next().filter(|_| is_free)?;
    match first {
        "spectral" => Some(1),
        "divergence" => Some(2),
        "frobenius" if method.contains("relative") => Some(2),
        "frobenius" | "offdiag" | "modal" => Some(0),
        _ => None,
    }
}

const FAMILIES: [Family; 11] = [
    Family::Poisson,
    Family::Young,
    Family::Size,
    Family::Place,
    Family::Needle,
    Family::Cap,
    Family::Sliver,
    Family::Near,
    Family::Bent,
    Family::Corner,
    Family::Reversed,
];

/// How many cases have an answer, of how many, and the largest error.
fn cell(rows: &[&StabilityRow]) -> String {
    let has_answer =
        |row: &&&StabilityRow| matches!(row.verdict, Verdict::Accurate | Verdict::InputLimited | Verdict::Dependent);
    let answered: Vec<_> = rows.iter().filter(has_answer).collect();
    let worst = answered.iter().filter_map(|row| row.error).fold(0.0, f64::max);
    let error = if worst > 0.0 { format!(", {worst:.0e}") } else { String::new() };
    format!("{} of {}{error}", answered.len(), rows.len())
}

pub fn table() -> String {
    let outcome = stability(None, &mut |_| {}).unwrap();
    assert_eq!(outcome.lost().count(), 0);
    let row = |family: &Family| {
        let of = |own: usize| -> Vec<&StabilityRow> {
            outcome.rows.iter().filter(|row| row.family == *family && group(&row.method) == Some(own)).collect()
        };
        let mut cells = vec![family.name().to_string()];
        cells.extend([0, 1, 2].map(|own| cell(&of(own))));
        cells
    };
    let rows: Vec<Vec<String>> = FAMILIES.iter().map(row).collect();
    markdown(&["varied", "`frobenius`, `offdiag`, `modal`", "`spectral`", "`relative`, `divergence`"], &rows)
}
