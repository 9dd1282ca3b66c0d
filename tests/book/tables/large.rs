//! Large deformation: fits at rest and fits to forces.

use super::{markdown, outcome, scene};

fn of(name: &str) -> String {
    let outcome = outcome(&scene(name));
    let row = |fit: &springfit_studies::study::FitOutcome| {
        let errors = fit.loads.iter().map(|load| format!("{:.2}", load.error.unwrap().rms));
        let name = fit.fit.name.split(" +").next().unwrap().to_string();
        std::iter::once(format!("`{name}`")).chain(errors).collect()
    };
    let rows: Vec<Vec<String>> = outcome.fits.iter().map(row).collect();
    markdown(&["fit", "tension", "shear", "both"], &rows)
}

pub fn tetrahedra() -> String {
    of("cube_tet_large")
}

pub fn hexahedra() -> String {
    of("cube_hex_large")
}
