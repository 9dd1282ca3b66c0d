//! Bodies whose stress relaxes or yields, beside closed forms and independent integration, and a kidney that is pressed and let go.

use super::markdown;
use crate::branches::yield_errors;
use crate::prony::creep_errors;
use springfit_studies::study::{Outcome, Scene, Setting, run};
use std::path::Path;

/// Errors of a bar that creeps, by what relaxes.
pub fn bar() -> String {
    let row = |(name, shares): (&str, [f64; 2])| {
        let errors = creep_errors(shares).into_iter().map(|error| format!("{error:.1e}"));
        std::iter::once(name.to_string()).chain(errors).collect()
    };
    let rows: Vec<Vec<String>> = [
        ("shear", [0.6, 0.0]),
        ("bulk", [0.0, 0.6]),
        ("shear and bulk", [0.6, 0.6]),
        ("shear more than bulk", [0.6, 0.3]),
    ]
    .map(row)
    .into();
    markdown(&["what relaxes by 0.6", "finite elements", "exact network", "smoothed network"], &rows)
}

/// Errors of branches that yield, by the step.
pub fn yielding() -> String {
    let steps = [5, 20, 80, 320];
    let row = |(steps, errors): (usize, [f64; 2])| {
        let errors = errors.map(|error| format!("{error:.1e}"));
        [vec![steps.to_string()], errors.to_vec()].concat()
    };
    let rows: Vec<Vec<String>> = steps.into_iter().zip(yield_errors(2.5, steps)).map(row).collect();
    markdown(&["steps in τ", "stretch", "shear"], &rows)
}

/// The kidney of the gallery, pressed for two seconds and let go, at twice the steps.
fn kidney(terms: &str) -> Outcome {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/kidney_creep.toml");
    let terms = format!("material.relaxation.terms=[{terms}]");
    let settings = [&terms, "motion.step=0.05", "motion.duration=6"].map(|setting| Setting::parse(setting).unwrap());
    run(&Scene::load_with(&path, &settings).unwrap(), &mut |_| {}).unwrap()
}

/// The way of the loaded points of the kidney, elastic, relaxing and yielding, and the difference of network and finite elements.
pub fn kidney_let_go() -> String {
    let all = ["{ shear = 0.6, time = 1e9 }", "{ shear = 0.6, time = 1 }", "{ shear = 0.6, time = 0.2, yield = 60 }"];
    let outcomes = all.map(kidney);
    let motions = outcomes.each_ref().map(|outcome| outcome.motion.as_ref().unwrap());
    let way = |motion: usize, model: usize, record: usize| motions[motion].models[model].records[record].watched[2];
    let rows: Vec<Vec<String>> = [1, 2, 3, 4, 5, 6, 8, 12]
        .map(|record| {
            let mut row = vec![format!("{}", 0.5 * record as f64)];
            row.extend((0..3).map(|motion| format!("{:.2}", 1e3 * way(motion, 1, record))));
            let apart =
                (0..3).map(|motion| (way(motion, 0, record) - way(motion, 1, record)).abs() / way(motion, 1, 4));
            row.push(if apart.fold(0.0, f64::max) < 1e-8 { "below 1e-8".into() } else { "more".into() });
            row
        })
        .into();
    markdown(&["time, s", "elastic, mm", "relaxes, mm", "yields, mm", "network to finite elements"], &rows)
}
