//! Pictures: the errors in them are those of a fresh run.

use super::markdown::root;
use super::printed::compare;
use crate::kit::outcome_of;
use springfit_report::report::deformed;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

/// The words of a picture, one text a line.
fn words(svg: &str) -> String {
    let texts = svg.split("<text").skip(1).map(|part| part.split_once('>').unwrap().1.split("</text>").next().unwrap());
    texts.map(|text| text.trim().to_string() + "\n").collect()
}

#[test]
fn the_picture_shows_the_errors_of_a_fresh_run() {
    let path = root().join("docs/src/figures/cube_tet-exact.svg");
    let picture = deformed(outcome_of("cube_tet"), "tension", &["frobenius", "offdiag k>=0", "exact"]).unwrap();
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

/// Pictures are compared by their words and sizes: places on them may differ by a rounding.
#[test]
fn the_page_of_elements_is_what_the_command_writes() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_springfit"));
    assert!(
        command.args(["elements", "--out", "elements"]).current_dir(folder.path()).output().unwrap().status.success()
    );
    let (made, known) = (folder.path().join("elements"), root().join("docs/src/elements"));
    let names = |folder: &Path| -> BTreeSet<String> {
        let all = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        all.filter(|name| !name.starts_with('.')).collect()
    };
    let text = |folder: &Path, name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    if std::env::var_os("SPRINGFIT_WRITE_BOOK").is_some() {
        names(&known).iter().for_each(|name| std::fs::remove_file(known.join(name)).unwrap());
        names(&made).iter().for_each(|name| std::fs::write(known.join(name), text(&made, name)).unwrap());
        return;
    }
    assert_eq!(names(&known), names(&made));
    for name in names(&made) {
        let (known, made) = (text(&known, &name), text(&made, &name));
        if name.ends_with(".md") {
            assert_eq!(known, made);
            continue;
        }
        assert_eq!(words(&known), words(&made), "{name}");
        assert!(made.len() < 10_000, "{name}: {} bytes", made.len());
        expect_apart(&name, &made);
    }
}

/// The numbers of nodes do not cover each other: they are ten pixels high, and the longest has two digits.
fn expect_apart(name: &str, svg: &str) {
    let number = |part: &str| {
        let (attributes, rest) = part.split_once('>').unwrap();
        let at = |key: &str| {
            attributes.split_once(&format!(" {key}=\"")).unwrap().1.split('"').next().unwrap().parse::<f64>()
        };
        let digits = rest.split("</text>").next().unwrap().trim();
        digits.parse::<usize>().ok().map(|_| [at("x").unwrap(), at("y").unwrap(), 3.0 * digits.len() as f64])
    };
    let numbers: Vec<[f64; 3]> = svg.split("<text").skip(1).filter_map(number).collect();
    assert!(numbers.len() > 1, "{name}");
    for (i, a) in numbers.iter().enumerate() {
        for b in &numbers[..i] {
            let clear = (a[0] - b[0]).abs() > a[2] + b[2] || (a[1] - b[1]).abs() > 8.0;
            assert!(clear, "{name}: {a:?} {b:?}");
        }
    }
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
