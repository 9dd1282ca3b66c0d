//! The picture of README: what it says of errors is what a fresh run gives.

use super::markdown::root;
use super::printed::compare;
use springfit::report::deformed;
use springfit::study::{Scene, run};

/// The words of a picture, one text a line.
fn words(svg: &str) -> String {
    let texts = svg.split("<text").skip(1).map(|part| part.split_once('>').unwrap().1.split("</text>").next().unwrap());
    texts.map(|text| text.trim().to_string() + "\n").collect()
}

#[test]
fn the_picture_shows_the_errors_of_a_fresh_run() {
    let path = root().join("docs/src/figures/cube_tet-exact.svg");
    let outcome = run(&Scene::load(&root().join("scenes/cube_tet.toml")).unwrap(), &mut |_| {}).unwrap();
    let picture = deformed(&outcome, "tension", &["frobenius", "offdiag k>=0", "exact"]).unwrap();
    if std::env::var_os("SPRINGFIT_WRITE_BOOK").is_some() {
        std::fs::write(path, picture).unwrap();
        return;
    }
    let known = words(&std::fs::read_to_string(path).unwrap());
    assert!(known.contains("%e_rms"), "{known}");
    compare(&known, &words(&picture), 0.0).unwrap();
}
