//! Errors of displacement of all bodies at small deformation.

use super::{all_groups, fit, markdown, outcome, scene};
use springfit_bodies::solve::Standing;
use springfit_studies::study::{FitEntry, FitOutcome, NamedFit};

const SCENES: [&str; 12] = [
    "cube_hex",
    "cylinder_hex",
    "specimen_hex",
    "square_quad",
    "tissue_quad",
    "specimen_quad",
    "cube_tet",
    "cylinder_tet",
    "cylinder_hole_tet",
    "specimen_tet",
    "tissue_tri",
    "specimen_tri",
];

fn fits(groups: Option<Vec<String>>) -> Vec<NamedFit> {
    let bounded = |entry: FitEntry| entry.with("nonnegative", Some(true));
    let modal = || FitEntry::new("modal").with_springs(groups.clone());
    let divergence = FitEntry::new("divergence").with("balance", Some(0.5)).with_springs(groups.clone());
    let entries = [
        FitEntry::new("frobenius"),
        FitEntry::new("offdiag"),
        bounded(FitEntry::new("offdiag")),
        FitEntry::new("spectral"),
        modal(),
        bounded(modal()),
        divergence,
    ];
    entries.into_iter().map(fit).collect()
}

fn is_stable(fit: &FitOutcome) -> bool {
    fit.stability.as_ref().is_some_and(|stability| stability.standing == Standing::Stable)
}

pub fn table() -> String {
    let mut rows = Vec::new();
    for name in SCENES {
        let scene = scene(name);
        let groups = all_groups(&scene);
        let outcome = outcome(&scene.with_fits(fits(groups)));
        // All deformations of a simplex have constant strain: a modal weight is none.
        let is_simplex = !outcome.mesh.blocks[0].element.has_higher_modes();
        for (i, load) in outcome.loads.iter().enumerate() {
            let error = |fit: &FitOutcome| fit.loads[i].error.unwrap();
            let shown = |place: usize| !(is_simplex && (4..=5).contains(&place));
            let stable = outcome.fits.iter().enumerate().filter(|(place, fit)| shown(*place) && is_stable(fit));
            let best = stable.map(|(_, fit)| error(fit).rms).fold(f64::INFINITY, f64::min);
            let cell = |(place, fit): (usize, &FitOutcome)| {
                let error = error(fit);
                let text = format!("{:.2} / {:.2}", error.rms, error.max);
                match (shown(place), is_stable(fit)) {
                    (false, _) => "–".into(),
                    (true, false) => text + " †",
                    (true, true) if error.rms <= best + 0.005 => format!("**{text}**"),
                    (true, true) => text,
                }
            };
            let mut row = vec![name.to_string(), load.name.clone()];
            row.extend(outcome.fits.iter().enumerate().map(cell));
            rows.push(row);
        }
    }
    let header = [
        "scene",
        "load",
        "`frobenius`",
        "`offdiag`",
        "`offdiag`, k ≥ 0",
        "`spectral`",
        "`modal` + bulk",
        "`modal` + bulk, k ≥ 0",
        "`divergence` 0.5 + bulk",
    ];
    markdown(&header, &rows)
}
