//! What the root mean square hides: the error where the body moves most, and that of the compliance under each load.

use super::columns::{Heading, aligned};
use crate::study::{BodyLoad, FitOutcome, LoadOutcome, Outcome, extent};

/// One row per fit and one column per load; empty without loads.
pub(super) fn load_error_table(outcome: &Outcome) -> String {
    if outcome.loads.is_empty() || outcome.fits.is_empty() {
        return String::new();
    }
    let mut header = vec![Heading::words("fit")];
    let column = |load: &BodyLoad| Heading::numbers(format!("{}\n%e_tip / %e_energy", load.name));
    header.extend(outcome.loads.iter().map(column));
    let entry = |load: &LoadOutcome| {
        let tip = load.error.map_or("-".into(), |error| format!("{:.2}", error.tip));
        // Without the sign of a zero.
        let rounded = |error: f64| (100.0 * error).round() / 100.0 + 0.0;
        let work = load.work_error.map_or("-".into(), |error| format!("{:+.2}", rounded(error)));
        format!("{tip} / {work:>6}")
    };
    let row =
        |fit: &FitOutcome| std::iter::once(fit.fit.name.clone()).chain(fit.loads.iter().map(entry)).collect::<Vec<_>>();
    let rows: Vec<_> = outcome.fits.iter().map(row).collect();
    format!("\n{}{}", aligned(&header, &rows), largest(outcome))
}

/// How far the finite elements move under the loads that they reach, which percentages hide.
fn largest(outcome: &Outcome) -> String {
    let d = outcome.mesh.dimension;
    let size = extent(&outcome.mesh).into_iter().fold(0.0, f64::max);
    let moved = |load: &BodyLoad| {
        let length = |u: &[f64]| u.iter().map(|u| u * u).sum::<f64>().sqrt();
        let most = load.fem.chunks_exact(d).map(length).fold(0.0, f64::max);
        format!("{} {most:.3e} m ({:.2} % of the body)", load.name, 100.0 * most / size)
    };
    let loads: Vec<String> = outcome.loads.iter().filter(|load| load.is_reached()).map(moved).collect();
    if loads.is_empty() {
        return String::new();
    }
    format!("Largest displacement of the finite elements: {}.\n", loads.join(", "))
}
