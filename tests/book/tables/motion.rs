//! Frequencies and errors over time.

use super::{markdown, outcome, scene, signed};

pub fn frequencies() -> String {
    let outcome = outcome(&scene("cube_hex_motion"));
    let motion = outcome.motion.unwrap();
    let body = outcome.frequencies[0].consistent.clone().unwrap();
    let row = |(own, moved): (&springfit_studies::study::FrequencyOutcome, &springfit_studies::study::ModelMotion)| {
        let error = moved.error().map_or("reference".into(), |[mean, max]| format!("{mean:.2} / {max:.2}"));
        let of_kind = |(masses, found, error): (&str, &Option<Vec<f64>>, String)| {
            let off = found.as_ref().unwrap().iter().zip(&body).map(|(own, body)| match own == body {
                true => format!("{own:.2} Hz"),
                false => format!("{} %", signed(100.0 * (own / body - 1.0), 1)),
            });
            [format!("`{}`", own.name), masses.into()].into_iter().chain(off).chain([error]).collect()
        };
        [("consistent", &own.consistent, String::new()), ("lumped", &own.frequencies, error)].map(of_kind)
    };
    let rows: Vec<Vec<String>> = outcome.frequencies.iter().zip(&motion.models).flat_map(row).collect();
    markdown(&["model", "masses", "1", "2", "3", "4", "5", "6", "e_rms in %, mean / largest"], &rows)
}

/// The error of the springs of the membrane, as they turn and with both models linear.
pub fn membrane() -> String {
    let motion = outcome(&scene("membrane")).motion.unwrap();
    let springs = &motion.models[1];
    let [mean, max] = springs.error().unwrap();
    let [own_mean, own_max] = springs.linear_error.unwrap();
    let rows = [("springs that turn", mean, max), ("both models linear", own_mean, own_max)];
    let rows = rows.map(|(name, mean, max)| vec![name.to_string(), format!("{mean:.2}"), format!("{max:.2}")]);
    markdown(&["compared", "e_rms in %, mean", "largest"], &rows)
}
