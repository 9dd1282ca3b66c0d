//! Measures of numbers whose squares leave the range, and what is said where there is none.

use super::samples::{EXPLICIT, LINEAR, MOTION};
use super::verdict::{Verdict, of_scene};
use super::{folder, problem};
use springfit_fit::fit::Spread;
use springfit_foundation::scalar::{distance, norm};
use springfit_mesh::mesh::Field;
use springfit_report::report;
use springfit_studies::study::{MotionEnding, SampledOutcome, Scene, displacement_error, run};
use std::path::Path;

/// Powers of two scale exactly.
#[test]
fn errors_do_not_depend_on_the_unit() {
    let fem = [0.0, 0.0, 0.3, -0.4, 1.0, 0.5];
    let lem = [0.0, 0.0, 0.2, -0.4, 1.1, 0.7];
    let expected = displacement_error(&fem, &lem, 2).unwrap();
    for exponent in [-1000, -600, -500, -10, 10, 500, 600, 1000] {
        let unit = 2f64.powi(exponent);
        let scaled = |u: &[f64]| u.iter().map(|u| u * unit).collect::<Vec<f64>>();
        let found = displacement_error(&scaled(&fem), &scaled(&lem), 2).unwrap();
        assert!((found.rms / expected.rms - 1.0).abs() < 1e-14, "2^{exponent}: {found:?}, expected {expected:?}");
        assert!((found.max / expected.max - 1.0).abs() < 1e-14, "2^{exponent}: {found:?}, expected {expected:?}");
        let length = norm(&scaled(&fem)) / unit;
        assert!((length / norm(&fem) - 1.0).abs() < 1e-14, "2^{exponent}: {length}");
        let apart = distance(&scaled(&fem), &scaled(&lem)) / unit;
        assert!((apart / distance(&fem, &lem) - 1.0).abs() < 1e-14, "2^{exponent}: {apart}");
    }
}

/// A model that is 1e5 times away is so whatever the squares are.
#[test]
fn a_large_distance_is_no_perfect_result() {
    let error = displacement_error(&[0.0, 1e155], &[0.0, 1e160], 1).unwrap();
    assert!((error.max / 1e7 - 1.0).abs() < 1e-4, "{error:?}");
    for odd in [f64::NAN, f64::INFINITY] {
        assert_eq!(displacement_error(&[0.0, odd], &[0.0, 1.0], 1), None);
        assert_eq!(displacement_error(&[0.0, 1.0], &[0.0, odd], 1), None);
    }
    assert_eq!(displacement_error(&[0.0, 5e-324], &[0.0, 1e300], 1), None);
}

/// Of points that a symmetry of the body makes equal, rounding would select one.
#[test]
fn the_tip_does_not_depend_on_the_numbers_of_points() {
    let fem = [0.1, 0.2, 1.0, 0.0, 0.0, -1.0 + 1e-13, 0.8, 0.6];
    let lem = [0.1, 0.2, 1.1, 0.0, 0.0, -1.3, 0.8, 0.7];
    for first in 0..4 {
        let turned = |u: &[f64]| u.iter().cycle().skip(2 * first).take(8).copied().collect::<Vec<f64>>();
        let found = displacement_error(&turned(&fem), &turned(&lem), 2).unwrap();
        assert!((found.tip - 30.0).abs() < 1e-9, "{found:?}");
    }
}

#[test]
fn the_norm_of_what_is_not_finite_is_not() {
    assert_eq!(norm(&[]), 0.0);
    assert_eq!(norm(&[0.0, 0.0]), 0.0);
    assert!(norm(&[f64::NAN, 1e300]).is_nan() && norm(&[1e300, f64::NAN]).is_nan());
    assert_eq!(norm(&[f64::INFINITY, 1.0]), f64::INFINITY);
}

/// The key of the error about a scene; the mesh is read and the scene run.
fn refused_key(text: &str) -> Option<String> {
    let folder = folder();
    let error = Scene::parse(text, &folder.path().join("scene.toml")).and_then(|scene| run(&scene, &mut |_| ()));
    error.err()?.key().map(String::from)
}

#[test]
fn loads_and_displacements_have_the_range_of_other_inputs() {
    for (from, to, key) in [
        ("traction = [0, 0, 1.0]", "traction = [0, 0, 1e160]", "load[0].traction"),
        ("traction = [0, 0, 1.0]", "traction = [0, 0, 1e-160]", "load[0].traction"),
        ("\"2.0*x\"", "\"1e160*x\"", "load[1]"),
        ("\"2.0*x\"", "\"1e-160*x\"", "load[1]"),
        ("force = [0, 0, 1.0]", "force = [0, 0, -1e31]", "load[2].force"),
        ("body = [0, 0, 1.0]", "body = [0, 0, 1e-31]", "load[3].body"),
        ("\"free\", 0.01]", "\"free\", 1e160]", "load[4].displacement"),
        ("measured.csv\", scale = 1.0", "measured.csv\", scale = 1e160", "load[4].measured.scale"),
        ("density = 1000.0", "density = 1e308", "material.density"),
        ("density = 1000.0", "density = 5e-324", "material.density"),
    ] {
        assert_eq!(LINEAR.matches(from).count(), 1, "{from}");
        assert_eq!(refused_key(&LINEAR.replace(from, to)).as_deref(), Some(key), "{to}");
    }
    for (from, to, key) in [
        ("\"0.001*t\"", "\"1e155*t\"", "motion.pull[0].displacement[0]"),
        ("\"0.1*t\"", "\"1e155*t\"", "motion.force[0].force[0]"),
    ] {
        assert_eq!(MOTION.matches(from).count(), 1, "{from}");
        assert_eq!(refused_key(&MOTION.replace(from, to)).as_deref(), Some(key), "{to}");
    }
    assert_eq!(problem(LINEAR), None);
}

/// Small components beside large ones are the rounding of whoever wrote them.
#[test]
fn a_small_component_beside_a_large_one_is_no_fault() {
    let folder = folder();
    let scene = LINEAR.replace("traction = [0, 0, 1.0]", "traction = [1e-200, 0, 1.0]");
    assert!(matches!(of_scene(&scene, &folder.path().join("scene.toml")), Ok(Verdict::Right(_))));
}

#[test]
fn measured_displacements_have_a_range() {
    let folder = folder();
    let scene = Scene::parse(LINEAR, &folder.path().join("scene.toml")).unwrap();
    let mesh = scene.build_mesh().unwrap();
    let path = folder.path().join("measured.csv");
    for (number, is_known) in [("1e-2", true), ("0", true), ("1e155", false), ("1e-155", false), ("inf", false)] {
        std::fs::write(&path, format!("point,ux\n4,{number}\n")).unwrap();
        assert_eq!(Field::read(&path, &mesh, 1.0).is_ok(), is_known, "{number}");
    }
}

/// Gravity that takes a body away leaves no figures that look like rest.
#[test]
fn what_runs_away_is_not_reported_at_rest() {
    let scene = EXPLICIT.replace("-9.81", "-1e30");
    let outcome = run(&Scene::parse(&scene, Path::new("scene.toml")).unwrap(), &mut |_| ()).unwrap();
    let moved = &outcome.motion.as_ref().unwrap().models;
    for model in moved {
        assert_ne!(model.ending, MotionEnding::Complete, "{}", model.name);
        assert!(model.records.iter().all(|record| record.is_finite()));
    }
    let notes = report::notes(&outcome);
    assert_eq!(
        notes.iter().filter(|note| note.contains("its motion is known up to 0.0 s")).count(),
        moved.len(),
        "{notes:?}"
    );
    let table = report::tables(&outcome);
    let rows: Vec<&str> = table.lines().filter(|line| line.contains("after")).collect();
    assert_eq!(rows.len(), moved.len(), "{table}");
    assert!(rows.iter().all(|row| !row.contains("0.000e0")), "{table}");
}

/// One law for all groups, which volumes and lengths cannot share.
#[test]
fn a_sampled_fit_that_misses_the_forces_says_so() {
    let scene = |force: &str| {
        let scene = format!(
            "mesh = {{ box = {{ element = \"tri3\", size = [1, 1], cells = [1, 1] }} }}\n\
             material = {{ young = 1e4, poisson = 0.3333, law = \"neo-hookean\" }}\n\
             fit = [{{ objective = \"sampled\", force = \"{force}\", shapes = {{ families = [\"uniaxial\"], count = 20, \
             held_out = 5, stretch = 0.02 }} }}]\n"
        );
        run(&Scene::parse(&scene, Path::new("scene.toml")).unwrap(), &mut |_| ()).unwrap()
    };
    let unexplained = |notes: &[String]| notes.iter().any(|note| note.contains("of the sampled forces unexplained"));
    let outcome = scene("k*(c - c0)^3");
    let sampled = outcome.fits[0].kind.sampled().unwrap();
    assert!(sampled.trained.max > 0.1, "{sampled:?}");
    assert!(unexplained(&report::notes(&outcome)) && unexplained(&report::Report::of(&outcome).notes));
    for (share, expected) in [(0.05, false), (0.1, false), (0.11, true)] {
        let of = |max: f64| Spread { mean: max, max };
        let [trained, held_out] = [(share, 0.0), (0.0, share)].map(|(trained, held_out)| SampledOutcome {
            trained: of(trained),
            held_out: Some(of(held_out)),
            ..sampled.clone()
        });
        assert_eq!(unexplained(&trained.notes()), expected, "{share}");
        assert_eq!(unexplained(&held_out.notes()), expected, "{share}");
    }
}
