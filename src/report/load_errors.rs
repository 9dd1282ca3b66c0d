//! What the root mean square hides: the error where the body moves most, and that of the work of each load.

use super::columns::{Heading, aligned};
use crate::study::{BodyLoad, FitOutcome, LoadOutcome, Outcome};

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
    format!("\n{}", aligned(&header, &rows))
}
