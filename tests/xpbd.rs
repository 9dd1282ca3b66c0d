//! The loops that are exported for a user's own engine: they come to rest where the theory of early ended sweeps says, and take no other file.

use crate::kit::{json, outcome};
use springfit::export::{TARGETS, target_named, write_files};
use springfit_bodies::engine::{Engine, Order, Setting, Sweep, Truncated, TruncatedModel};
use springfit_bodies::model::Support;
use springfit_foundation::error::ErrorKind;
use springfit_report::report::{NetworkFile, NetworkRecord};
use springfit_studies::study::Outcome;
use std::fs;
use std::process::Command;
use tempfile::TempDir;

/// A cube under so small a load that its answer is linear.
const SCENE: &str = "
[mesh]
box = { element = \"tet4\", size = [1, 1, 1], cells = [2, 2, 2] }
[material]
young = 1e4
poisson = 0.3
density = 1000
[[fit]]
objective = \"offdiag\"
springs = [\"edge\", \"bulk\"]
nonnegative = true
[[fix]]
group = \"zmin\"
[[load]]
name = \"pöke \\\"it\\\"\"
group = \"zmax\"
traction = [0.01, 0.02, -0.03]
[[load]]
name = \"turn\"
group = \"zmax\"
displacement = [\"-0.1*y\", \"0.1*x\", \"free\"]
";
const LOAD: &str = "pöke \"it\"";

fn plane() -> String {
    let text = SCENE.replace("tet4", "tri3").replace("[1, 1, 1]", "[1, 1]").replace("[2, 2, 2]", "[4, 4]");
    let text = text.replace("zm", "ym").replace("[0.01, 0.02, -0.03]", "[0.01, 0.02]").replace(", \"free\"]", "]");
    text.replace("density", "plane = \"strain\"\ndensity")
}

fn record(outcome: &Outcome, engine: Option<Setting>) -> NetworkRecord {
    NetworkRecord { engine, ..NetworkFile::of(outcome, &outcome.fits[0]).record() }
}

/// The files of a network without gravity, and the program.
fn written(network: &NetworkRecord) -> TempDir {
    written_under(network, &vec![0.0; network.dimension])
}

/// The files of a network under gravity, and the program.
fn written_under(network: &NetworkRecord, gravity: &[f64]) -> TempDir {
    let folder = TempDir::new().unwrap();
    let files = target_named("xpbd").unwrap().files(network, Some(gravity)).unwrap();
    write_files(&files, folder.path(), &[]).unwrap();
    let strict = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O1", "-o", "run", "run.c", "-lm"];
    let output = Command::new("cc").args(strict).current_dir(&folder).output().expect("the tests need a C compiler");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder
}

/// The exit code, and what is printed.
fn ran(folder: &TempDir, words: &[&str]) -> (Option<i32>, String) {
    let output = Command::new(folder.path().join("run")).args(words).current_dir(folder).output().unwrap();
    (output.status.code(), String::from_utf8([output.stdout, output.stderr].concat()).unwrap())
}

/// The displacements at rest under the load, three for each point.
fn at_rest(folder: &TempDir, network: &NetworkRecord, words: &[&str]) -> Vec<f64> {
    let (code, text) = ran(folder, &[&["--rest", "rest.txt", "--load", LOAD], words].concat());
    assert_eq!(code, Some(0), "{text}");
    let rest = fs::read_to_string(folder.path().join("rest.txt")).unwrap();
    let places: Vec<f64> = rest.split_whitespace().map(|word| word.parse().unwrap()).collect();
    assert_eq!(places.len(), 3 * network.points.len());
    let start = network.points.iter().flat_map(|x| (0..3).map(|k| x.get(k).copied().unwrap_or(0.0)));
    places.iter().zip(start).map(|(x, start)| x - start).collect()
}

/// Where the network rests at the setting by the linear theory.
fn expected(outcome: &Outcome, network: &NetworkRecord, setting: &Setting) -> Vec<f64> {
    let d = network.dimension;
    let mut support = Support { prescribed: vec![None; network.points.len() * d] };
    for held in &network.held {
        support.prescribed[held.point * d..][..d].copy_from_slice(&held.displacement);
    }
    let mut forces = vec![0.0; network.points.len() * d];
    for force in &network.loads[0].forces {
        forces[force.point * d..][..d].copy_from_slice(&force.force);
    }
    let masses = network.masses.as_deref().unwrap();
    let model = TruncatedModel { network: &outcome.fits[0].network, points: &outcome.mesh.points, masses };
    let truncated = Truncated::new(model, &support, setting).unwrap().unwrap();
    let found = truncated.answers(&[forces]).unwrap().remove(0);
    found.chunks(d).flat_map(|u| (0..3).map(move |k| u.get(k).copied().unwrap_or(0.0))).collect()
}

/// The distance of two displacements, of the largest entry.
fn distance(found: &[f64], expected: &[f64]) -> f64 {
    let largest = expected.iter().fold(0.0_f64, |largest, u| largest.max(u.abs()));
    found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest
}

fn settings() -> Vec<Setting> {
    let usual = Setting::usual(Engine::Xpbd);
    vec![
        usual,
        Setting { substeps: 3, iterations: 4, relaxation: 1.3, ..usual },
        Setting { order: Order::Given, iterations: 2, ..usual },
        Setting { order: Order::Jolt, step: 0.01, substeps: 2, ..usual },
        Setting { sweep: Sweep::Jacobi, relaxation: 0.1, iterations: 3, ..usual },
    ]
}

#[test]
fn the_loop_in_c_rests_where_the_theory_says() {
    // A corner that is held along some axes.
    let corner = SCENE.split("[[load]]\nname = \"turn\"").next().unwrap();
    let corner = corner.replace("\"zmin\"", "\"zmin\"\naxes = [\"z\"]\n[[fix]]\ngroup = \"xmin\"");
    for text in [SCENE.to_string(), plane(), corner] {
        let outcome = outcome(&text);
        for setting in settings() {
            let network = record(&outcome, Some(setting));
            let folder = written(&network);
            let found = at_rest(&folder, &network, &[]);
            let apart = distance(&found, &expected(&outcome, &network, &setting));
            assert!(apart < 1e-3, "{} {}: {apart}", network.dimension, setting.words());
        }
    }
}

/// Other numbers than those of the setting move another body, which is said where the constants were fitted for them.
#[test]
fn other_settings_are_told_where_constants_were_fitted() {
    let outcome = outcome(SCENE);
    let usual = Setting::usual(Engine::Xpbd);
    let changes: [(&[&str], Setting); 3] = [
        (&["--substeps", "20"], usual.with_substeps(20)),
        (&["--iterations", "3"], Setting { iterations: 3, ..usual }),
        (&["--step", "0.01"], Setting { step: 0.01, ..usual }),
    ];
    for engine in [Some(usual), None] {
        let network = record(&outcome, engine);
        let folder = written(&network);
        assert!(!ran(&folder, &["0.1"]).1.contains("Beware"));
        for (words, setting) in &changes {
            let apart = distance(&at_rest(&folder, &network, words), &expected(&outcome, &network, setting));
            assert!(apart < 1e-3, "{words:?}: {apart}");
            let said = ran(&folder, &[&["0.1"], *words].concat()).1;
            assert_eq!(said.contains("Beware: the constants were fitted for"), engine.is_some(), "{said}");
        }
        let said = target_named("xpbd").unwrap().at_rest(&network, Some(&[0.0; 3])).unwrap().join("\n");
        assert_eq!(said.contains("the constants are those of equations that are solved"), engine.is_none(), "{said}");
    }
}

/// Files that are not ours end the program by themselves, wherever they end or differ.
#[test]
fn the_loop_in_c_refuses_other_files_and_words() {
    let folder = written(&record(&outcome(SCENE), None));
    let path = folder.path().join("network.json");
    let own = fs::read_to_string(&path).unwrap();
    let refused = |text: &[u8], expected: &str| {
        fs::write(&path, text).unwrap();
        let (code, said) = ran(&folder, &["0.02"]);
        assert!(code == Some(2) && said.contains(expected) && said.lines().count() == 1, "{code:?}: {said}");
    };
    for length in (0..own.len()).step_by(own.len() / 100) {
        let cut = (length..).find(|&length| own.is_char_boundary(length)).unwrap();
        refused(&own.as_bytes()[..cut], "network.json: expected ");
    }
    for (from, to, expected) in [
        ("springfit xpbd", "springfit network", "expected \"springfit xpbd\", found \"springfit network\""),
        ("\"version\":1", "\"version\":2", "expected a whole number from 1 to 1, found 2"),
        ("\"substeps\":10", "\"substeps\":0", "expected a whole number from 1 to 100000"),
        ("\"held\":[[0,", "\"held\":[[27,", "expected a whole number from 0 to 26"),
        ("\"masses\":[", "\"masses\":[-1,", "expected masses above zero"),
        ("\"compliance\":", "\"compliance\":-", "expected compliances above zero"),
        ("\"kind\":\"length\"", "\"kind\":\"angle\"", "expected \"length\", found \"angle\""),
        ("\"points\":[[", "\"points\":[[1e999,", "expected a number, found 1e999"),
    ] {
        assert!(own.contains(from), "{from}");
        refused(own.replacen(from, to, 1).as_bytes(), expected);
    }
    refused(&[0, 255, 10, 7], "network.json: expected {, found its end");
    fs::remove_file(&path).unwrap();
    assert_eq!(ran(&folder, &[]).0, Some(2));
    // A file whose white space is another is ours.
    let value: serde_json::Value = serde_json::from_str(&own).unwrap();
    fs::write(&path, own.replace(':', " : ").replace(',', "\n, ")).unwrap();
    assert!(value["constraints"].is_array() && ran(&folder, &["0.02"]).0 == Some(0));
    for (words, expected) in [
        (&["--load", "none"][..], format!("--load: expected one of \"{LOAD}\" \"turn\", found \"none\"")),
        (&["--load", "turn"], "--load: expected a load of forces, found \"one that moves points".into()),
        (&["--substeps", "1.5"], "--substeps: expected a whole number from 1 to 100000, found \"1.5\"".into()),
        (&["--step", "-1"], "--step: expected a time above 0 s".into()),
        (&["--rest"], "--rest: expected a word after it".into()),
        (&["soon"], "SECONDS: expected a time above 0 s, found \"soon\"".into()),
        (&["--fast"], "--fast: expected --rest".into()),
    ] {
        let (code, said) = ran(&folder, words);
        assert!(code == Some(2) && said.contains(&expected), "{words:?}: {said}");
    }
}

/// Constraints of a colour share no point, and follow each other where the order is that of colours.
#[test]
fn constraints_are_in_the_order_of_a_sweep() {
    let outcome = outcome(SCENE);
    for setting in settings() {
        let folder = written(&record(&outcome, Some(setting)));
        let body = json(&folder.path().join("network.json"));
        let all = body["constraints"].as_array().unwrap();
        assert_eq!(all.len(), outcome.fits[0].network.len());
        let mut of_colour = std::collections::BTreeSet::new();
        for constraint in all {
            for p in constraint["points"].as_array().unwrap() {
                assert!(of_colour.insert((constraint["colour"].as_u64(), p.as_u64())), "{constraint}");
            }
        }
        let colours: Vec<u64> = all.iter().map(|constraint| constraint["colour"].as_u64().unwrap()).collect();
        let is_content: Vec<bool> = all.iter().map(|constraint| constraint["kind"] == "content").collect();
        match setting.order {
            Order::Colours => assert!(colours.is_sorted()),
            Order::Given => assert!(is_content.is_sorted()),
            Order::Jolt => assert!(is_content.iter().rev().is_sorted()),
        }
    }
}

/// Constants that belong to an engine go to this engine alone, and to files that only show or pass on numbers.
#[test]
fn constants_of_an_engine_go_nowhere_else() {
    let outcome = outcome(SCENE);
    for engine in Engine::all() {
        let network = record(&outcome, Some(Setting::usual(engine)));
        for target in &TARGETS {
            let is_own = match target.name {
                "npz" | "vtu" => true,
                "xpbd" => engine == Engine::Xpbd,
                "jolt" => engine == Engine::Jolt,
                "newton" => matches!(engine, Engine::NewtonXpbd | Engine::NewtonVbd),
                _ => false,
            };
            let refused = target.files(&network, None).err().filter(|e| e.key() == Some("engine"));
            assert_eq!(refused.is_none(), is_own, "{} {}", target.name, engine.name());
            let Some(error) = refused else { continue };
            assert_eq!(error.kind(), ErrorKind::Unsupported);
            let text = error.to_string();
            assert!(
                text.contains("equations that are solved, found constants for ") && text.contains("; --to npz"),
                "{text}"
            );
        }
    }
    let wrong = record(&outcome, Some(Setting::usual(Engine::Xpbd).with_substeps(0)));
    let error = target_named("xpbd").unwrap().files(&wrong, None).err().unwrap();
    assert_eq!(error.key(), Some("engine.substeps"));
}

/// Stress relaxes in the loop as in the motion of the network by implicit Euler, whose equations a substep solves by many sweeps; at rest the share is left that
/// no term has.
#[test]
fn the_loop_in_c_creeps_as_the_motion() {
    let relaxing = SCENE.replace(
        "density = 1000\n",
        "density = 1000\nrelaxation = { terms = [{ shear = 0.5, bulk = 0.5, time = \"20 ms\" }, { shear = 0.2, bulk = 0.2, time = \"0.2 s\" }] }\n",
    );
    let size = "size = [1, 1, 1], cells = [2, 2, 2]";
    let motion = "[motion]\nlinear = true\nduration = 0.1\nstep = 1e-3\nintegrator = \"implicit-euler\"\ngravity = [3e-4, 0, -9.81e-4]\n";
    let text = relaxing.replace(size, "size = [0.1, 0.1, 0.2], cells = [2, 2, 4]").replace("[[load]]\n", "#\n");
    let head = text.split('#').next().unwrap().to_string();
    let outcome = outcome(&format!("{head}{motion}"));
    let network = record(&outcome, None);
    let gravity = [3e-4, 0.0, -9.81e-4];
    let folder = written_under(&network, &gravity);
    let moved = |folder: &TempDir| -> f64 {
        let (code, printed) = ran(folder, &["0.1", "--step", "1e-3", "--substeps", "1", "--iterations", "200"]);
        assert_eq!(code, Some(0), "{printed}");
        printed.split("displacement is ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap()
    };
    let found = moved(&folder);
    let model = outcome.motion.as_ref().unwrap().models.iter().find(|model| model.fit.is_some()).unwrap();
    // The body has not swung back before the end.
    let largest = model.largest;
    // Four digits are printed.
    assert!((found / largest - 1.0).abs() < 2e-4, "{found} {largest}");
    // The elastic body moves otherwise by far.
    let mut elastic = network;
    elastic.motion.as_mut().unwrap().relaxation.clear();
    let elastic = moved(&written_under(&elastic, &gravity));
    assert!((elastic / largest - 1.0).abs() > 0.1, "{elastic} {largest}");
}
