//! `report.json`: every key is that of a documented record, whatever the kinds of fits.

use serde_json::Value;
use springfit_report::report::parts::{Note, Weight, grouped, ordered};
use springfit_report::report::{Report, VERSION, report};
use springfit_studies::study::{KindRecord, Scene, run};
use std::path::Path;

/// Everything that a linear scene may have: fits to the stiffness, published and to the whole object, a gauge, a motion.
pub const LINEAR: &str = r#"
[mesh]
box = { element = "quad4", size = [3, 1], cells = [6, 2] }
[material]
young = 2e4
poisson = 0.3
density = 1000
[[fit]]
objective = "spectral"
[[fit]]
objective = "offdiag"
nonnegative = true
springs = ["edge", "diagonal"]
[[fit]]
objective = "baudet"
[[fit]]
objective = "exact"
energy = "stable-mooney-rivlin"
share = 0.5
[[fit]]
name = "whole"
objective = "whole"
start = ["offdiag", "equal"]
regularization = 1e-2
frequencies = 2
[[fix]]
group = "xmin"
[[load]]
name = "pull"
group = "xmax"
traction = [500, 0]
[[load]]
name = "shear"
group = "xmax"
traction = [0, 50]
[gauge]
where = "x > 0.9 && x < 2.1"
axis = "x"
area = 1
[motion]
duration = 0.02
step = 0.005
linear = true
watch = { group = "xmax" }
[[motion.force]]
group = "xmax"
force = [10, 0]
[output]
frequencies = 2
moduli = true
"#;

/// Large deformation, with a fit to forces.
pub const LARGE: &str = r#"
[mesh]
box = { element = "tet4", size = [1, 1, 1], cells = [1, 1, 1] }
[material]
young = 1
poisson = 0.3
law = "neo-hookean"
[[fit]]
objective = "sampled"
force = "free-rest"
shapes = { count = 20, held_out = 10 }
[[fit]]
objective = "sampled"
force = { edge = "k*c", bulk = "a*s" }
springs = ["edge", "bulk"]
bounds = { k = [0, 10] }
shapes = { count = 20, held_out = 10 }
[[fit]]
objective = "sampled"
norm = "huber"
shapes = { count = 20, held_out = 10 }
[[fit]]
objective = "whole"
start = "sampled"
shapes = { count = 20, held_out = 10 }
loads = ["pull"]
regularization = 1e-2
[[fix]]
group = "zmin"
[[load]]
name = "pull"
group = "zmax"
traction = [0, 0, 0.1]
"#;

/// The report as it is written, and read back.
pub fn reports(text: &str) -> (Value, Report) {
    let scene = Scene::parse(text, Path::new("scene.toml")).unwrap();
    let text = report(&run(&scene, &mut |_| {}).unwrap());
    (serde_json::from_str(&text).unwrap(), serde_json::from_str(&text).unwrap())
}

/// A key that is left out where it has no value, or that no record has, would make the two differ.
#[test]
fn a_report_is_its_records() {
    for text in [LINEAR, LARGE] {
        let (value, report) = reports(text);
        assert_eq!(serde_json::to_value(&report).unwrap(), value);
        assert_eq!(report.version, VERSION);
    }
}

#[test]
fn fits_have_the_records_of_their_kinds() {
    let kind = |record: &KindRecord| match record {
        KindRecord::Stiffness(_) => "stiffness",
        KindRecord::Sampled(_) => "sampled",
        KindRecord::Whole(_) => "whole",
        KindRecord::Published(_) => "published",
        KindRecord::Exact(_) => "exact",
    };
    let kinds = |report: &Report| report.fits.iter().map(|fit| kind(&fit.kind)).collect::<Vec<_>>();
    let linear = reports(LINEAR).1;
    assert_eq!(kinds(&linear), ["stiffness", "stiffness", "published", "exact", "whole", "whole"]);
    for fit in &linear.fits {
        assert_eq!(fit.whole.is_some(), matches!(fit.kind, KindRecord::Whole(_)), "{}", fit.name);
        assert_eq!(fit.unmet.is_some(), matches!(fit.kind, KindRecord::Published(_)), "{}", fit.name);
        assert!(fit.sampled.is_none() && fit.loads.len() == 2);
    }
    assert!(linear.fits[0].certificate_gap.is_some() && linear.fits[1].certificate_gap.is_none());
    assert_eq!((linear.gauge.len(), linear.frequencies.len(), linear.motion.len()), (2, 7, 7));
    let large = reports(LARGE).1;
    assert_eq!(kinds(&large), ["sampled", "sampled", "sampled", "whole"]);
    assert!(large.fits[0].sampled.is_some() && large.fits[3].sampled.is_none());
    assert_eq!(large.loads_followed.len(), 1);
}

/// The keys that programs rely on.
#[test]
fn the_stable_keys_are_there() {
    let value = reports(LINEAR).0;
    let has = |value: &Value, keys: &[&str]| {
        let object = value.as_object().unwrap();
        keys.iter().for_each(|key| assert!(object.contains_key(*key), "{key}"));
    };
    has(&value, &["version", "scene", "nodes", "elements", "springs", "left_out", "fits"]);
    for fit in value["fits"].as_array().unwrap() {
        let kind = match fit["objective"].as_str().unwrap() {
            "baudet" => "source",
            "exact" => "volume",
            _ => "solver",
        };
        has(fit, &["objective", kind, "status", "seconds_per_element", "seconds", "negative_springs"]);
        has(fit, &["relative_frobenius", "relative_spectral", "certificate_gap", "loads"]);
        has(&fit["relative_frobenius"], &["mean", "max"]);
        for load in fit["loads"].as_array().unwrap() {
            has(load, &["name", "e_rms", "e_max", "e_tip", "e_energy", "seconds_fem", "seconds_lem"]);
        }
    }
}

/// A key of another kind of fit is refused by its name; one of no kind, or with a value of a wrong type, with its line as well.
#[test]
fn keys_belong_to_their_objectives() {
    let scene = |keys: &str| {
        let text = format!(
            "[mesh]\nbox = {{ element = \"quad4\", size = [1, 1], cells = [1, 1] }}\n[material]\nyoung = 1\npoisson = 0.3\n\
             [[fit]]\n{keys}\n[[fix]]\ngroup = \"xmin\"\n"
        );
        Scene::parse(&text, Path::new("scene.toml")).unwrap_err().to_string()
    };
    for (keys, start) in [
        (
            "objective = \"modal\"\nforce = \"linear\"",
            "scene.toml:8: fit[0].force: belongs to the objective \"sampled\"",
        ),
        (
            "objective = \"sampled\"\nvalidate = [\"a\"]",
            "scene.toml:8: fit[0].validate: belongs to the objective \"whole\"",
        ),
        ("objective = \"whole\"\nnorm = \"1\"", "scene.toml:8: fit[0].norm: belongs to the objective \"sampled\""),
        ("objective = \"whole\"\nstart = \"sampled\"\ntied = true", "scene.toml:9: fit[0].tied: does not go with"),
        ("objective = \"lloyd\"\nhigher = 0.5", "scene.toml:8: fit[0].higher: does not go with"),
        ("objective = \"sampled\"\nbalance = 0.5", "scene.toml:8: fit[0].balance: does not go with"),
        (
            "objective = \"lloyd\"\nweigth = \"none\"",
            "scene.toml:8: fit[0].weigth: unknown field \"weigth\", expected one of",
        ),
        ("objective = \"modal\"\n\nhigher = \"a\"", "scene.toml:9: fit[0].higher: invalid type"),
        ("objective = \"sampled\"\nshapes = { count = \"a\" }", "scene.toml:8: fit[0].shapes.count: invalid type"),
        ("name = 3\nobjective = \"modal\"", "scene.toml:7: fit[0].name: invalid type"),
        ("higher = 1", "scene.toml:6: fit[0]: missing field \"objective\""),
    ] {
        let error = scene(keys);
        assert!(error.starts_with(start), "{keys}: {error}");
    }
}

#[test]
fn notes_that_differ_in_subjects_and_figures_are_one_and_the_dearest_is_first() {
    let far = |name: &str, percent: &str| {
        Note::of_model(Weight::Model, name, "the network is not the material").figures(percent).advice(". Take exact")
    };
    let notes = vec![
        Note::of_body(Weight::Detail, "some detail"),
        far("a", ": 16 %"),
        far("b", ": 28 %"),
        Note::of_model(Weight::Broken, "b", "mechanism"),
        Note::of_load(Weight::Reference, "errors under ", "push", " are relative to quadratic elements")
            .figures(": 1 %"),
        Note::of_load(Weight::Reference, "errors under ", "pull", " are relative to quadratic elements")
            .figures(": 1 %"),
    ];
    let sentences: Vec<String> = grouped(notes.clone()).iter().map(Note::sentence).collect();
    assert_eq!(
        sentences,
        [
            "b: mechanism",
            "errors under push, pull are relative to quadratic elements: 1 %",
            "a, b: the network is not the material. Take exact",
            "some detail"
        ]
    );
    assert_eq!(ordered(notes).len(), 6);
}
