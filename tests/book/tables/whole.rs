//! Fits of the whole object, before and after.

use super::{markdown, outcome, scene};
use springfit_studies::study::{FitOutcome, Outcome};

const SCENES: [&str; 4] = ["tissue_quad_whole", "cube_hex_whole", "cube_tet_whole", "cylinder_hole_tet_whole"];

fn error(fit: &FitOutcome, load: &str) -> Option<String> {
    let load = fit.loads.iter().find(|own| own.name == load)?;
    Some(format!("{:.2}", load.error?.rms))
}

/// One row for each fit: e_rms under loads that were fitted, that chose the regularisation, and that no fit has seen.
fn rows(name: &str, outcome: &Outcome) -> Vec<Vec<String>> {
    let shear = if outcome.load("shear x").is_some() { "shear x" } else { "shear" };
    let [bending, gravity] =
        if outcome.load("bending x").is_some() { ["bending x", "gravity x"] } else { ["bending", "side gravity"] };
    let row = |fit: &FitOutcome| {
        let mut row = vec![name.trim_end_matches("_whole").to_string(), format!("`{}`", fit.fit.name)];
        let loads = ["tension", shear, "torsion", bending, gravity];
        row.extend(loads.map(|load| error(fit, load).unwrap_or_else(|| "–".into())));
        row
    };
    outcome.fits.iter().map(row).collect()
}

pub fn table() -> String {
    let all: Vec<Vec<String>> = SCENES.iter().flat_map(|name| rows(name, &outcome(&scene(name)))).collect();
    markdown(&["body", "fit", "tension", "shear", "torsion", "bending", "gravity"], &all)
}
