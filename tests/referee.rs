//! The referee of simulators: what it prints, and programs that are missing, end early or answer nonsense. Real engines run in `.ci/long`.

use serde_json::Value;
use springfit::referee::ENGINES;
use springfit_report::report::{
    Factor, FoundRow, RefereeRecord, RefereeRow, RepairRecord, Telling, referee_svg, referee_text,
};
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

fn row(load: &str, told: Option<[f64; 2]>, found: Option<(f64, bool)>, moving: Option<f64>) -> RefereeRow {
    RefereeRow {
        engine: "newton".into(),
        solver: "VBD 1 ms".into(),
        model: if told.is_some() { "own elements".into() } else { "exact springs".into() },
        telling: Telling::Given,
        load: load.into(),
        poisson: 0.3,
        told,
        truth: 2.0,
        truth_uncertainty_percent: 0.1,
        tip_of_finite_elements: 1e-3,
        energy_of_finite_elements: 1.9,
        found: found.map(|(percent, is_still)| FoundRow {
            is_still,
            tip: 1e-3,
            energy: 1.9,
            of_model_percent: percent,
            tip_percent: percent,
            energy_percent: percent,
            truth_percent: percent,
        }),
        moving_percent: moving,
        seconds: 1.0,
        warnings: Vec::new(),
    }
}

fn record() -> RefereeRecord {
    let repair = |factor: Factor| RepairRecord {
        engine: "newton".into(),
        solver: "VBD 1 ms".into(),
        model: "own elements".into(),
        poisson: 0.3,
        factor,
        derived: None,
    };
    let told = Some([1e4, 0.3]);
    RefereeRecord {
        repairs: vec![repair(Factor::Number(1.25)), repair(Factor::TooSoft), repair(Factor::NotAtRest)],
        rows: vec![
            row("tension", told, Some((-0.01, true)), Some(0.01)),
            row("shear", told, Some((7.46, false)), Some(0.42)),
            row("torsion", told, None, Some(12.0)),
            row("bending", told, None, None),
            row("tension", None, Some((400.0, true)), Some(0.01)),
        ],
        ..RefereeRecord::default()
    }
}

#[test]
fn tables_say_what_is_at_rest_and_what_is_not() {
    let text = referee_text(&record());
    let own = text.lines().find(|line| line.contains("own elements  VBD 1 ms")).unwrap();
    let cells: Vec<&str> = own.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).collect();
    assert_eq!(cells[3..], ["0.3", "0.0", "+7.5*", "not at rest", "diverged"], "{own}");
    assert!(text.contains("* still moving, by at most 0.42 % of the largest displacement\n"), "{text}");
    for word in ["+400.0", "-5.0"] {
        assert!(text.contains(word), "{word}: {text}");
    }
    let factors = text.split_once("What to tell the engine").unwrap().1;
    for factor in ["1.250", "too soft", "not at rest"] {
        assert!(factors.contains(factor), "{factor}: {text}");
    }
}

/// The factor of a repair: a number, or the word that says why there is no factor.
#[test]
fn factors_in_json_are_numbers_or_words() {
    let json = serde_json::to_value(record()).unwrap();
    let factors: Vec<Value> = json["repairs"].as_array().unwrap().iter().map(|r| r["factor"].clone()).collect();
    assert_eq!(Value::from(factors), serde_json::json!([1.25, "too-soft", "not-at-rest"]));
}

/// Bars beyond the axis are cut, and have their number beside them.
#[test]
fn the_chart_has_a_bar_for_each_body_at_rest() {
    let svg = referee_svg(&record());
    for words in ["+400 %", "not at rest", "diverged", "newton VBD 1 ms, exact springs, ν = 0.3"] {
        assert!(svg.contains(words), "{words}: {svg}");
    }
    // The names of four loads and three bars have a colour, and the axis five lines.
    assert_eq!(svg.matches("<rect").count(), 4 + 3 + 5, "{svg}");
}

#[test]
fn engines_and_solvers_have_names_of_their_own() {
    for engine in &ENGINES {
        for (i, solver) in engine.solvers.iter().enumerate() {
            assert!(engine.solvers[..i].iter().all(|other| other.name != solver.name));
            assert!(solver.elements.is_some() || !solver.networks.is_empty());
        }
        // The versions of the book are those of the proofs of exports.
        let requirements = include_str!("../exports/requirements.txt");
        for word in engine.install.split(' ').filter(|word| word.contains("==")) {
            assert!(requirements.lines().any(|line| line == word), "{word}");
        }
    }
}

/// The moduli that the law of SemiImplicit has are those of the material, where E and nu are changed as derived: its moduli at rest are
/// `3/4 mu` and `lambda - 5/8 mu` of what is told.
#[test]
fn the_derived_moduli_are_those_of_the_material_in_the_law() {
    let lame = |[e, nu]: [f64; 2]| [e / (2.0 + 2.0 * nu), e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))];
    let newton = ENGINES.iter().find(|engine| engine.name == "newton").unwrap();
    let law = newton.solvers.iter().find(|solver| solver.name == "SemiImplicit").unwrap().elements.unwrap();
    for nu in [0.0, 0.3, 0.45] {
        let [mu, lambda] = lame(law([1e4, nu]).unwrap());
        let [expected_mu, expected_lambda] = lame([1e4, nu]);
        assert!((0.75 * mu / expected_mu - 1.0).abs() < 1e-12);
        assert!((lambda - 0.625 * mu - expected_lambda).abs() < 1e-8 * mu);
    }
}

fn referee(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_springfit"));
    command.arg("referee").args(arguments).current_dir(folder).output().unwrap()
}

fn message(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn wrong_options_are_refused_before_anything_is_written() {
    let folder = TempDir::new().unwrap();
    for (arguments, expected) in [
        (
            &["--engine", "mujocco"][..],
            "--engine: expected one of mujoco, newton, lammps, jolt, xpbd, found \"mujocco\"; did you mean \"mujoco\"?",
        ),
        (
            &["--engine", "mujoco", "--solver", "VBD 1 ms"],
            "--solver: expected one of \"discrete\", \"tendons 0.1 ms\", found \"VBD 1 ms\"",
        ),
        (&["--engine", "xpbd", "--poisson", "0.5"], "--poisson: expected numbers from 0 to below 0.5, found 0.5"),
    ] {
        let output = referee(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(2));
        assert!(message(&output).contains(expected), "{}", message(&output));
        assert!(!folder.path().join("out").exists());
    }
    let missing = referee(folder.path(), &["--engine", "xpbd", "--python", "no-such-python"]);
    assert_eq!(missing.status.code(), Some(2));
    assert!(message(&missing).contains("--python: the program no-such-python cannot be started, which runs xpbd"));
}

/// A program that prints these lines in place of Python.
#[cfg(unix)]
fn program(folder: &Path, script: &str) -> String {
    use std::os::unix::fs::PermissionsExt;
    let path = folder.join("python");
    fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    path.to_str().unwrap().to_string()
}

#[cfg(unix)]
#[test]
fn an_engine_that_is_missing_is_one_line_with_its_installation() {
    let folder = TempDir::new().unwrap();
    let python = program(folder.path(), "echo '{\"missing\": \"No module named mujoco\"}'");
    let output = referee(folder.path(), &["--engine", "mujoco", "--python", &python]);
    assert_eq!(output.status.code(), Some(2));
    let errors: Vec<String> =
        message(&output).lines().filter(|line| line.starts_with("error:")).map(String::from).collect();
    assert_eq!(errors.len(), 1);
    for words in ["mujoco is not there for", "(No module named mujoco)", "pip install mujoco==4.0.0 numpy", "--python"]
    {
        assert!(errors[0].contains(words), "{words}: {}", errors[0]);
    }
    // Where no engine is named, those that are missing are notes.
    let all = referee(folder.path(), &["--python", &python, "--node", &python]);
    assert_eq!(all.status.code(), Some(2));
    assert!(message(&all).contains("no engine is there"), "{}", message(&all));
}

#[cfg(unix)]
#[test]
fn bodies_of_programs_that_end_early_or_diverge_are_told() {
    let folder = TempDir::new().unwrap();
    let only = ["--engine", "xpbd", "--solver", "0.2 ms, 1 pass", "--poisson", "0.3"];
    let run = |script: &str, out: &str| {
        let python = program(folder.path(), script);
        let output = referee(folder.path(), &[&only[..], &["--python", &python, "--out", out]].concat());
        let text = fs::read_to_string(folder.path().join(out).join("referee.json")).unwrap();
        (output.status.code(), serde_json::from_str::<Value>(&text).unwrap())
    };
    let (code, record) = run("echo '{\"version\": \"1\"}'; echo 'out of memory' >&2", "ended");
    assert_eq!((code, record["rows"].as_array().unwrap().len()), (Some(1), 0));
    let failed: Vec<&str> = record["failed"].as_array().unwrap().iter().map(|line| line.as_str().unwrap()).collect();
    assert!(failed.iter().all(|line| line.contains("ended early: out of memory")), "{failed:?}");
    let answers = "echo '{\"version\": \"1\"}'\nwhile read line; do case \"$line\" in\n\
                   *open*) echo '{\"step\": 0.001}';;\n*load*) echo '{}';;\n\
                   *) echo '{\"positions\": null, \"warnings\": [\"unstable\"]}';;\nesac; done";
    let (code, record) = run(answers, "diverged");
    let rows = record["rows"].as_array().unwrap();
    // Elements and one network, under four loads.
    assert_eq!((code, rows.len()), (Some(0), 8));
    for row in rows {
        assert!(row["found"].is_null() && row["moving_percent"].is_null());
        assert_eq!(row["warnings"], serde_json::json!(["unstable"]));
    }
}
