//! How good it is: errors of five kinds of models of two bodies against quadratic elements.

use super::{all_groups, fit, markdown, outcome, root};
use springfit_studies::study::{FitEntry, Outcome, Scene};

/// A scene of the folder `scenes` with another Poisson's ratio, whose errors are against quadratic elements.
fn judged(name: &str, poisson: &str) -> Scene {
    let path = root().join(format!("scenes/{name}.toml"));
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("poisson = 0.3"), "{name}");
    let text = text.replace("poisson = 0.3", &format!("poisson = {poisson}")) + "\n[reference]\nfrom = \"quadratic\"\n";
    Scene::parse(&text, &path).unwrap()
}

/// The largest error under any load of a fit, and that of the finite elements.
fn worst(outcome: &Outcome) -> (Vec<f64>, f64) {
    let fits = outcome.fits.iter().map(|fit| fit.loads.iter().map(|load| load.error.unwrap().max).fold(0.0, f64::max));
    let body = outcome.loads.iter().map(|load| load.measured.as_ref().unwrap().fem_e_max.unwrap()).fold(0.0, f64::max);
    (fits.collect(), body)
}

fn row(title: &str, name: &str, poisson: &str) -> Vec<String> {
    let scene = judged(name, poisson);
    let bounded = |objective: &str| FitEntry::new(objective).with("nonnegative", Some(true));
    let with_volume = |objective: &str| bounded(objective).with_springs(all_groups(&scene));
    let smoothed = FitEntry::new("exact").with("volume", Some("patches")).with("shear", Some("edges"));
    let cells = FitEntry::new("exact").with("volume", Some("cells"));
    let smoothed = if name.ends_with("tet") { smoothed } else { cells };
    let fits = [FitEntry::new("exact"), smoothed, with_volume("divergence"), with_volume("modal"), bounded("offdiag")]
        .map(fit);
    let (errors, body) = worst(&outcome(&scene.with_fits(fits.into())));
    assert!((errors[0] - body).abs() < 1e-6 * body, "{name}: {} and {body}", errors[0]);
    let cells = errors.iter().map(|error| format!("{error:.1} %"));
    [title.to_string(), poisson.into()].into_iter().chain(cells).collect()
}

pub fn table() -> String {
    let bodies = [("tetrahedra, with a hole", "cylinder_hole_tet"), ("hexahedra", "cylinder_hex")];
    let rows: Vec<Vec<String>> = bodies
        .iter()
        .flat_map(|(title, name)| ["0.3", "0.45", "0.49"].map(|poisson| row(title, name, poisson)))
        .collect();
    let header = [
        "cylinder of",
        "ν",
        "`exact` = finite elements",
        "smoothed",
        "`divergence` + volume, k ≥ 0",
        "`modal` + volume, k ≥ 0",
        "`offdiag`, k ≥ 0",
    ];
    markdown(&header, &rows)
}
