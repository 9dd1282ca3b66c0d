//! Pictures: the errors in them are those of a fresh run.

use super::markdown::root;
use super::printed::compare;
use springfit::report::deformed;
use springfit::study::{Scene, run};
use std::process::Command;

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
    assert!(known.contains("e_rms"), "{known}");
    compare(&known, &words(&picture), 0.0).unwrap();
}

#[test]
fn the_figures_for_a_paper_are_those_of_a_fresh_run() {
    let folder = tempfile::tempdir().unwrap();
    let scene = |name: &str| root().join("scenes").join(name).display().to_string();
    let springfit = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_springfit"));
        let output = command.args(arguments).current_dir(folder.path()).output().unwrap();
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    };
    springfit(&["run", &scene("cube_tet.toml"), "--set", "output.vtu=true", "--out", "run"]);
    springfit(&["converge", &scene("square_quad.toml"), "--out", "converge"]);
    let figure = |name: &str, run: &str, more: &[&str]| {
        let file = format!("plot-{name}.svg");
        springfit(&[&["plot", run, "--figure", name, "-o", &file][..], more].concat());
        let (known, made) = (root().join("docs/src/figures").join(&file), folder.path().join(&file));
        if std::env::var_os("SPRINGFIT_WRITE_BOOK").is_some() {
            std::fs::copy(made, known).unwrap();
            return;
        }
        let text = |path| words(&std::fs::read_to_string(path).unwrap());
        compare(&text(known), &text(made), 0.01).unwrap();
    };
    figure("deformation", "run", &["--of", "offdiag k>=0", "--load", "shear", "--columns", "two"]);
    figure("moduli", "run", &["--columns", "two"]);
    figure("convergence", "converge", &[]);
    springfit(&["compare", &root().join("benches/norms.toml").display().to_string(), "--out", "compare"]);
    let compared = |name: &str, figure: &str, more: &[&str]| {
        let file = format!("compare-{name}.svg");
        springfit(&[&["plot", "compare", "--figure", figure, "-o", &file][..], more].concat());
        let (known, made) = (root().join("docs/src/figures").join(&file), folder.path().join(&file));
        if std::env::var_os("SPRINGFIT_WRITE_BOOK").is_some() {
            std::fs::copy(made, known).unwrap();
            return;
        }
        // Numbers at the axis of times differ from machine to machine.
        let named = |path| {
            words(&std::fs::read_to_string(path).unwrap())
                .lines()
                .filter(|l| l.parse::<f64>().is_err())
                .collect::<Vec<_>>()
                .join("\n")
        };
        assert_eq!(named(known), named(made), "{name}");
    };
    compared("precision", "work-precision", &["--columns", "two"]);
    compared("poisson", "poisson", &["--of", "tet4"]);
}

/// Of the study of the paper, whose command draws them.
#[test]
#[ignore = "takes minutes; .ci/long has it"]
fn the_pictures_of_the_paper_are_those_of_a_fresh_run() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["paper", "--only", "1", "--only", "3", "--only", "figure 9", "--out", "paper"];
    let mut command = Command::new(env!("CARGO_BIN_EXE_springfit"));
    assert!(command.args(arguments).current_dir(folder.path()).output().unwrap().status.success());
    for name in ["cube_tet-tension", "cube_hex_large-tension", "figure-9"] {
        let known = root().join(format!("docs/src/figures/{name}.svg"));
        let made = std::fs::read_to_string(folder.path().join(format!("paper/{name}.svg"))).unwrap();
        if std::env::var_os("SPRINGFIT_WRITE_BOOK").is_some() {
            std::fs::write(known, made).unwrap();
        } else {
            compare(&words(&std::fs::read_to_string(known).unwrap()), &words(&made), 0.2).unwrap();
        }
    }
}
