//! `[sweep]` and `springfit sweep`: which studies a design has, and that their table is the same however it was made.

use crate::kit::{self, holding, outcome};
use serde_json::{Value, json};
use springfit_studies::study::{InMemory, Scene, Sweep};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const SCENE: &str = r#"[mesh]
box = { element = "quad4", size = [1, 1], cells = [3, 3] }
[material]
young = 1000
poisson = 0.3
thickness = 0.01
[[fit]]
objective = "frobenius"
[[fit]]
objective = "spectral"
[[fix]]
group = "xmin"
[[load]]
name = "pull"
group = "xmax"
traction = [1, 0]
"#;

/// Seven studies, of which the last three fail: Poisson's ratio of plane stress is below 1.
const GRID: &str = "[sweep.over]\nmaterial.poisson = [0.0, 0.2, 0.4, 0.45, 1.0, 1.5, 2.0]\n";

fn sweep(table: &str) -> springfit_foundation::error::Result<Sweep> {
    Sweep::parse(&format!("{SCENE}{table}"), Path::new("s.toml"), &[], &InMemory::default())
}

/// The values of each study.
fn values(table: &str) -> Value {
    let sweep = sweep(table).unwrap();
    sweep.studies().iter().map(|study| serde_json::to_value(study.values()).unwrap()).collect()
}

fn folder_with(table: &str) -> TempDir {
    holding("s.toml", format!("{SCENE}{table}"))
}

fn done(folder: &Path, arguments: &str) -> String {
    kit::prints(folder, &arguments.split_whitespace().collect::<Vec<_>>())
}

fn refused(folder: &Path, arguments: &str) -> String {
    kit::refused(folder, &arguments.split_whitespace().collect::<Vec<_>>())
}

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap()
}

#[test]
fn a_grid_has_all_combinations_and_the_last_key_runs_fastest() {
    let found = values("[sweep.over]\nmaterial.poisson = [0, 0.4]\n\"fit[0].tied\" = [false, true]\n");
    let study = |poisson: Value, tied: bool| json!({ "material.poisson": poisson, "fit[0].tied": tied });
    let expected = [study(0.into(), false), study(0.into(), true), study(0.4.into(), false), study(0.4.into(), true)];
    assert_eq!(found, json!(expected));
}

#[test]
fn ranges_have_their_ends_units_and_spacings() {
    for (range, expected) in [
        ("{ from = 0.1, to = 0.4, count = 4 }", json!([0.1, 0.2, 0.3, 0.4])),
        ("{ from = 1, to = 10000, count = 3, spacing = \"log\" }", json!([1.0, 100.0, 10000.0])),
        ("{ from = \"1 kPa\", to = \"3kPa\", count = 3 }", json!(["1 kPa", "2 kPa", "3 kPa"])),
        ("{ from = 2, to = 9, step = 3 }", json!([2, 5, 8])),
        ("{ from = 0, to = 0.3, step = 0.1 }", json!([0.0, 0.1, 0.2, 0.30000000000000004])),
        ("{ from = 3, to = 1, step = -1 }", json!([3, 2, 1])),
        // Both ends are far from zero beside the step.
        ("{ from = 100, to = 100.3, step = 0.1 }", json!([100.0, 100.1, 100.2, 100.3])),
        ("{ from = 5, to = 7, count = 1 }", json!([5.0])),
    ] {
        let found = values(&format!("[sweep.over]\n\"material.young\" = {range}\n"));
        let found: Vec<&Value> = found.as_array().unwrap().iter().map(|study| &study["material.young"]).collect();
        assert_eq!(json!(found), expected, "{range}");
    }
}

/// `scipy.stats.qmc.Sobol(d, scramble=False).random(n)`, SciPy 1.17.
#[test]
fn sobol_points_are_those_of_scipy() {
    let found = values(
        "[sweep]\ndesign = \"sobol\"\nsamples = 8\n[sweep.over]\nmaterial.young = { from = 0, to = 1 }\nmaterial.poisson = { from = 0, to = 1 }\nmaterial.thickness = { from = 0, to = 1 }\n",
    );
    let expected = [
        [0.0, 0.0, 0.0],
        [0.5, 0.5, 0.5],
        [0.75, 0.25, 0.25],
        [0.25, 0.75, 0.75],
        [0.375, 0.375, 0.625],
        [0.875, 0.875, 0.125],
        [0.625, 0.125, 0.875],
        [0.125, 0.625, 0.375],
    ];
    for (study, [young, poisson, thickness]) in found.as_array().unwrap().iter().zip(expected) {
        let values = json!({ "material.young": young, "material.poisson": poisson, "material.thickness": thickness });
        assert_eq!(study, &values);
    }
}

/// Of 2ᵐ points of a sequence, moved by a seed or not, each of 2ᵐ equal parts of every range has one.
#[test]
fn a_sobol_design_fills_every_range_evenly() {
    for seed in ["", "seed = 1\n", "seed = 77\n"] {
        let keys = ["material.young", "material.poisson", "material.thickness", "material.density", "mesh.scale"];
        let over: String = keys.iter().map(|key| format!("{key} = {{ from = 0, to = 64 }}\n")).collect();
        let table = format!(
            "[sweep]\ndesign = \"sobol\"\nsamples = 64\n{seed}[sweep.over]\nmesh.box.cells = [[2, 2], [3, 3]]\n{over}"
        );
        // Poisson's ratio is refused in most studies, but not in all.
        let found = values(&table.replace("poisson = { from = 0, to = 64 }", "poisson = { from = 0, to = 0.5 }"));
        let studies = found.as_array().unwrap();
        for key in keys {
            let scale = if key.ends_with("poisson") { 128.0 } else { 1.0 };
            let parts: BTreeSet<u64> =
                studies.iter().map(|study| (study[key].as_f64().unwrap() * scale) as u64).collect();
            assert_eq!(parts.len(), 64, "{key}");
        }
        let fine = studies.iter().filter(|study| study["mesh.box.cells"] == json!([3, 3])).count();
        assert_eq!(fine, 32);
    }
}

#[test]
fn samples_depend_on_their_seed_alone() {
    let random = |seed: u32| {
        values(&format!(
            "[sweep]\ndesign = \"random\"\nsamples = 500\nseed = {seed}\n[sweep.over]\nmaterial.poisson = {{ from = 0.1, to = 0.4 }}\n"
        ))
    };
    assert_eq!(random(3), random(3));
    assert_ne!(random(3), random(4));
    let samples = random(5);
    let samples: Vec<f64> =
        samples.as_array().unwrap().iter().map(|study| study["material.poisson"].as_f64().unwrap()).collect();
    assert!(samples.iter().all(|x| (0.1..0.4).contains(x)));
    // The mean of 500 samples has the standard deviation 0.3/√(12·500) = 0.004.
    let mean = samples.iter().sum::<f64>() / 500.0;
    assert!((mean - 0.25).abs() < 0.016, "{mean}");
}

#[test]
fn a_list_of_studies_is_taken_as_it_is() {
    let found =
        values("[sweep]\nover = [{ \"material.poisson\" = 0.1 }, { material = { young = 5, poisson = 0.2 } }]\n");
    assert_eq!(found, json!([{ "material.poisson": 0.1 }, { "material.young": 5, "material.poisson": 0.2 }]));
}

#[test]
fn wrong_sweeps_are_refused() {
    let refuses = |table: &str, key: &str, words: &str| {
        let error = sweep(table).unwrap_err();
        assert!(error.key().unwrap_or_default().contains(key) && error.to_string().contains(words), "{table}: {error}");
    };
    for (values, key, words) in [
        ("poisson = 0.3", "poisson", "a list of values"),
        ("poisson = []", "poisson", "at least one value"),
        ("poisson = { from = 0 }", "poisson.to", "a number"),
        ("poisson = { from = 0, to = nan, count = 2 }", "poisson.to", "finite"),
        ("poisson = { from = 0, to = 0.4 }", "poisson.count", "the number of values"),
        ("poisson = { from = 0, to = 0.4, count = 0 }", "poisson.count", "from 1"),
        ("poisson = { from = 0, to = 0.4, numbers = 4 }", "poisson.numbers", "expected one of \"from\""),
        ("poisson = { from = 0, to = 0.4, step = -0.1 }", "poisson.step", "leads from"),
        ("poisson = { from = 0, to = 0.4, step = 0.1, count = 3 }", "poisson.count", "step"),
        ("young = { from = 0, to = 4, count = 3, spacing = \"log\" }", "young.spacing", "above 0"),
        ("young = { from = \"1 kPa\", to = \"3 MPa\", count = 3 }", "young.to", "the unit"),
    ] {
        refuses(&format!("[sweep.over]\nmaterial.{values}\n"), &format!("sweep.over.material.{key}"), words);
    }
    for (table, key, words) in [
        ("[sweep]\n", "sweep", "missing field \"over\""),
        ("[sweep.over]\n", "sweep.over", "at least one key"),
        ("[sweep]\nover = 3\n", "sweep.over", "a table of keys"),
        ("[sweep]\nover = []\n", "sweep.over", "from 1"),
        ("[sweep]\nover = [1]\n", "sweep.over[0]", "a table"),
        ("[sweep]\nover = [{ \"a b\" = 1 }]\n", "sweep.over[0].a b", "a key such as"),
        ("[sweep.over]\n\"fit[x].tied\" = [true]\n", "sweep.over.fit[x].tied", "a key such as"),
        ("[sweep.over]\nsweep.samples = [1, 2]\n", "sweep.over", "outside"),
        ("[sweep]\nsamples = 3\n[sweep.over]\nmaterial.poisson = [0]\n", "sweep.samples", "random"),
        ("[sweep]\ndesign = \"sobol\"\n[sweep.over]\nmaterial.poisson = [0]\n", "sweep.samples", "number of studies"),
        ("[sweep]\ndesign = \"latin\"\n[sweep.over]\nmaterial.poisson = [0]\n", "sweep.design", "grid"),
        (
            "[sweep]\ndesign = \"random\"\nsamples = 3\n[sweep.over]\nmaterial.poisson = { from = 0, to = 1, count = 2 }\n",
            "sweep.over.material.poisson.count",
            "grid",
        ),
        (
            "[sweep]\ndesign = \"random\"\nsamples = 2000000\n[sweep.over]\nmaterial.poisson = [0]\n",
            "sweep.samples",
            "1000000",
        ),
        ("[sweep.over]\nmaterial.poissn = [0.1, 0.2]\n", "material.poissn", "did you mean"),
    ] {
        refuses(table, key, words);
    }
    let error = sweep("").unwrap_err();
    assert!(error.key() == Some("sweep") && error.to_string().contains("[sweep]"), "{error}");
    // A scene with a wrong sweep is wrong for every command.
    assert!(Scene::parse(&format!("{SCENE}[sweep.over]\nmaterial.poisson = 3\n"), Path::new("s.toml")).is_err());
}

/// Each study has the figures of a run with the same `--set`, to the bit.
#[test]
fn a_study_is_a_run_with_its_settings() {
    let folder = folder_with("[sweep.over]\nmaterial.poisson = [0.05, 0.31]\n");
    done(folder.path(), "sweep s.toml --out o");
    for line in read(folder.path(), "o/studies.jsonl").lines() {
        let record: Value = serde_json::from_str(line).unwrap();
        done(
            folder.path(),
            &format!("run s.toml --set material.poisson={} --out r", record["settings"]["material.poisson"]),
        );
        let mut both = [record["report"].clone(), serde_json::from_str(&read(folder.path(), "r/report.json")).unwrap()];
        both.iter_mut().for_each(without_times);
        assert_eq!(both[0]["fits"], both[1]["fits"]);
    }
    let text = SCENE.replace("poisson = 0.3", "poisson = 0.31");
    let outcome = outcome(&text);
    let table = read(folder.path(), "o/table.csv");
    let rms = outcome.fits[0].loads[0].error.unwrap().rms;
    assert!(table.contains(&format!(",{rms:?},")), "{rms} is not in {table}");
}

fn without_times(value: &mut Value) {
    match value {
        Value::Object(object) => {
            object.retain(|key, _| !key.starts_with("seconds"));
            object.values_mut().for_each(without_times);
        }
        Value::Array(list) => list.iter_mut().for_each(without_times),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

#[test]
fn the_table_is_the_same_for_any_jobs_shards_and_interruptions() {
    let folder = folder_with(GRID);
    let folder = folder.path();
    done(folder, "sweep s.toml --out one");
    let table = read(folder, "one/table.csv");
    // Four studies of two fits, and three that failed.
    assert_eq!(table.lines().count(), 1 + 4 * 2 + 3, "{table}");
    assert!(table.starts_with("study,material.poisson,error,fit,load,"), "{table}");
    assert!(
        table.lines().any(|line| line.starts_with("7,2.0,\"") || line.starts_with("7,2.0,material.poisson: ")),
        "{table}"
    );
    done(folder, "sweep s.toml --jobs 3 --out three");
    assert_eq!(read(folder, "three/table.csv"), table);
    for shard in ["2/2", "1/2"] {
        done(folder, &format!("sweep s.toml --shard {shard} --out shards"));
    }
    assert_eq!(read(folder, "shards/studies-2-of-2.jsonl").lines().count(), 3);
    // Nothing is left to do but the table.
    done(folder, "sweep s.toml --resume --out shards");
    assert_eq!(read(folder, "shards/table.csv"), table);
    assert_eq!(read(folder, "shards/studies.jsonl"), "");
    // Killed in the middle of a line, after any number of studies.
    let lines = read(folder, "one/studies.jsonl");
    for kept in [0, 1, 100, lines.len() / 2, lines.len() - 1] {
        fs::write(folder.join("one/studies.jsonl"), &lines[..kept]).unwrap();
        done(folder, "sweep s.toml --resume --out one");
        assert_eq!(read(folder, "one/table.csv"), table, "{kept}");
        assert_eq!(read(folder, "one/studies.jsonl").lines().count(), 7);
    }
    // More values: those that are there are not run again.
    let more = read(folder, "s.toml").replace("[0.0, 0.2,", "[0.1, 0.0, 0.2,");
    fs::write(folder.join("s.toml"), more).unwrap();
    done(folder, "sweep s.toml --resume --out one");
    assert_eq!(read(folder, "one/studies.jsonl").lines().count(), 8);
    assert_eq!(read(folder, "one/table.csv").lines().count(), table.lines().count() + 2);
}

#[test]
fn what_would_mix_or_lose_studies_is_refused() {
    let folder = folder_with(GRID);
    let folder = folder.path();
    done(folder, "sweep s.toml --out o");
    let lines = read(folder, "o/studies.jsonl");
    assert!(refused(folder, "sweep s.toml --out o").contains("--resume"));
    fs::write(folder.join("s.toml"), read(folder, "s.toml").replace("young = 1000", "young = 1001")).unwrap();
    assert!(
        refused(folder, "sweep s.toml --out o --resume").contains("studies.jsonl:1: expected a study of this file")
    );
    assert!(refused(folder, "sweep s.toml --out o --resume --set material.young=1002").contains("studies.jsonl:1"));
    // Shards are of one scene, whether they go on or not.
    assert!(
        refused(folder, "sweep s.toml --out o --shard 3/3").contains("studies.jsonl:1: expected a study of this file")
    );
    assert_eq!(read(folder, "o/studies.jsonl"), lines);
    fs::write(folder.join("o/studies.jsonl"), "no study\n").unwrap();
    assert!(
        refused(folder, "sweep s.toml --out o --resume")
            .contains("studies.jsonl: expected a file of a sweep or of a comparison, or none")
    );
    fs::write(folder.join("o/studies.jsonl"), "{\"settings\":{}}\n").unwrap();
    assert!(
        refused(folder, "sweep s.toml --out o --resume").contains("studies.jsonl:1: expected a study of this kind")
    );
    for (arguments, words) in [
        ("sweep s.toml --shard 0/2", "--shard"),
        ("sweep s.toml --shard 3/2", "--shard"),
        ("sweep s.toml --shard -1/2", "--shard"),
        ("sweep s.toml --shard 2", "--shard"),
        ("sweep s.toml --jobs 0", "--jobs"),
        ("sweep missing.toml", "missing.toml"),
        ("sweep s.toml --set sweep.over.material.poisson=[]", "at least one value"),
    ] {
        assert!(refused(folder, arguments).contains(words), "{arguments}");
    }
    assert!(!folder.join("out").exists());
    fs::create_dir(folder.join("busy")).unwrap();
    let held = fs::File::create(folder.join("busy/studies.jsonl")).unwrap();
    held.lock().unwrap();
    assert!(refused(folder, "sweep s.toml --out busy").contains("another process"));
}

#[test]
fn the_studies_are_listed_without_running() {
    let folder = folder_with(GRID);
    let text = done(folder.path(), "sweep s.toml --explain");
    assert!(text.contains("7 studies") && text.contains("material.poisson") && text.contains("0.45"), "{text}");
    let listed: Value = serde_json::from_str(&done(folder.path(), "sweep s.toml --explain --json")).unwrap();
    assert_eq!(listed[2], json!({ "material.poisson": 0.4 }));
    assert!(!folder.path().join("out").exists());
    let rows: Value = serde_json::from_str(&done(folder.path(), "sweep s.toml --json")).unwrap();
    assert_eq!((rows[0]["study"].as_u64(), rows[0]["fit"].as_str()), (Some(1), Some("frobenius")));
    assert!(rows[10]["error"].as_str().unwrap().starts_with("material.poisson: "), "{}", rows[10]);
    // Other commands run the scene as it is.
    done(folder.path(), "run s.toml");
}

/// The figure of a sweep has a curve for each fit over the key that varies, whose points are those of the table.
#[test]
fn a_sweep_is_drawn_over_its_key() {
    let folder = folder_with("[sweep.over]\nmaterial.poisson = [0.0, 0.2, 0.4]\nmaterial.young = [10, 1000]\n");
    let folder = folder.path();
    done(folder, "sweep s.toml --out o");
    for of in ["material.poisson", "material.young"] {
        let svg = done(folder, &format!("plot o --figure sweep --of {of}"));
        assert!(svg.contains(of) && svg.contains("frobenius") && svg.contains("spectral"), "{of}");
    }
    assert!(done(folder, "plot o --figure sweep").contains("material.poisson"));
    let words = refused(folder, "plot o --figure sweep --of material.thickness");
    assert!(words.contains("--of: expected a key with several numbers: material.poisson, material.young"), "{words}");
    assert!(refused(folder, "plot . --figure sweep").contains("has no studies"));
    // A fit that is right to rounding is below the others, with its name.
    let scene = read(folder, "s.toml").replace("\"spectral\"", "\"exact\"");
    fs::write(folder.join("s.toml"), scene).unwrap();
    done(folder, "sweep s.toml --out exact");
    let svg = done(folder, "plot exact --figure sweep --of material.poisson");
    assert!(svg.contains("frobenius") && svg.contains("exact (at most "), "{svg}");
    // A sweep of fewer values tells of the studies that the folder has besides.
    let scene = read(folder, "s.toml").replace("[0.0, 0.2, 0.4]", "[0.0, 0.4]");
    fs::write(folder.join("s.toml"), scene).unwrap();
    let told = kit::said(&kit::springfit(folder, &["sweep", "s.toml", "--out", "exact", "--resume"]));
    assert!(told.contains("the folder has 2 studies of other values"), "{told}");
}

/// Errors relative to different solutions are of different curves, and a key of the name of a column does not replace it.
#[test]
fn what_is_not_to_be_compared_is_apart() {
    let fits = "fit = [[{ objective = \"frobenius\" }], [{ objective = \"exact\" }]]";
    let references = "reference = [{ refine = 1 }, { from = \"quadratic\" }]";
    let folder = folder_with(&format!("[sweep.over]\nmaterial.poisson = [0.1, 0.3]\n{references}\n{fits}\n"));
    let folder = folder.path();
    let told = done(folder, "sweep s.toml --out o");
    assert!(told.contains("relative to different solutions (finer-body, quadratic)"), "{told}");
    let rows: Value = serde_json::from_str(&done(folder, "sweep s.toml --json")).unwrap();
    let found = ["set.reference", "set.fit", "reference", "fit"].map(|column| rows[1][column].clone());
    assert_eq!(found, [json!({ "refine": 1 }), json!([{ "objective": "exact" }]), json!("finer-body"), json!("exact")]);
    let svg = done(folder, "plot o --figure sweep");
    for fit in ["frobenius", "exact"] {
        for reference in ["finer-body", "quadratic"] {
            assert!(svg.contains(&format!("{fit}, relative to {reference}")), "{svg}");
        }
    }
}

/// The page has the figure and the table, and one of others is not replaced.
#[test]
fn a_sweep_writes_its_page_where_it_is_asked_for() {
    let folder = folder_with("[sweep.over]\nmaterial.poisson = [0.1, 0.3]\n");
    let folder = folder.path();
    let told = done(folder, "sweep s.toml --report --out o");
    assert!(told.contains("sweep.html"), "{told}");
    let page = read(folder, "o/sweep.html");
    assert!(page.contains("<svg") && page.contains("material.poisson") && page.ends_with("</html>\n"), "{page}");
    // Its own page is replaced.
    done(folder, "sweep s.toml --report --resume --out o");
    fs::create_dir(folder.join("other")).unwrap();
    fs::write(folder.join("other/sweep.html"), "<!DOCTYPE html><p>mine").unwrap();
    let told = refused(folder, "sweep s.toml --report --out other");
    assert!(told.contains("sweep.html") && told.contains("not a page of this program"), "{told}");
    assert_eq!(read(folder, "other/sweep.html"), "<!DOCTYPE html><p>mine");
    done(folder, "sweep s.toml --out other");
}
