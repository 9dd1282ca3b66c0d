//! `--set`: values of a scene's keys that are given on the command line.

use crate::kit::{holding, said, springfit};
use springfit_bodies::model::Network;
use springfit_foundation::error::{Error, Result};
use springfit_mesh::mesh::Mesh;
use springfit_report::report::network_csv;
use springfit_studies::study::{Scene, Setting, run};
use std::path::Path;

const SCENE: &str = r#"[mesh]
box = { element = "quad4", size = [1, 1], cells = [2, 2] }
[material]
young = 1000
poisson = 0.3
thickness = 0.01
[[fit]]
objective = "frobenius"
[[fix]]
group = "xmin"
[[load]]
name = "pull"
group = "xmax"
traction = [1, 0]
"#;

fn scene(text: &str, settings: &[&str]) -> Result<Scene> {
    let settings = settings.iter().map(|text| Setting::parse(text)).collect::<Result<Vec<_>>>()?;
    Scene::parse_with(text, Path::new("s.toml"), &settings)
}

/// The springs as a table, with all digits of their constants.
fn table(mesh: &Mesh, network: &Network) -> String {
    let mut text = Vec::new();
    network_csv(mesh, network, &mut text).unwrap();
    String::from_utf8(text).unwrap()
}

/// The scene with the settings gives the figures, to the bit, of the scene in whose text the same is written.
#[test]
fn a_setting_is_what_the_file_could_have_had() {
    for (settings, from, to) in [
        (&["material.poisson=0.45"][..], "poisson = 0.3", "poisson = 0.45"),
        (&["material.young = 2 kPa"], "young = 1000", "young = \"2 kPa\""),
        (&["material.plane=strain"], "poisson = 0.3", "poisson = 0.3\nplane = \"strain\""),
        (&["load[0].traction=[0, 2]"], "traction = [1, 0]", "traction = [0, 2]"),
        (&["load[0].traction[1]=3"], "traction = [1, 0]", "traction = [1, 3]"),
        (&["fit[0].objective=spectral"], "\"frobenius\"", "\"spectral\""),
        (
            &["fit[1].objective=offdiag", "fit[1].tied=true"],
            "[[fix]]",
            "[[fit]]\nobjective = \"offdiag\"\ntied = true\n[[fix]]",
        ),
        (&["mesh.box.cells=[3, 2]", "newton.steps=1", "material.law=neo-hookean"], "", "NEWTON"),
        (&["material.poisson=0.1", "material.poisson=0.2"], "poisson = 0.3", "poisson = 0.2"),
    ] {
        let written = match to {
            "NEWTON" => {
                let text = SCENE.replace("cells = [2, 2]", "cells = [3, 2]") + "[newton]\nsteps = 1\n";
                text.replace("young = 1000", "young = 1000\nlaw = \"neo-hookean\"")
            }
            to => {
                assert_eq!(SCENE.matches(from).count(), 1, "{from}");
                SCENE.replace(from, to)
            }
        };
        let found = run(&scene(SCENE, settings).unwrap(), &mut |_| ()).unwrap();
        let expected = run(&scene(&written, &[]).unwrap(), &mut |_| ()).unwrap();
        let (found_mesh, expected_mesh) = (found.mesh, expected.mesh);
        assert_eq!(found.fits.len(), expected.fits.len());
        for (found, expected) in found.fits.iter().zip(&expected.fits) {
            assert_eq!(table(&found_mesh, &found.network), table(&expected_mesh, &expected.network), "{settings:?}");
            assert_eq!(found.loads[0].error, expected.loads[0].error, "{settings:?}");
        }
        let typed: Vec<String> = settings.iter().map(|text| text.replace(" = ", "=")).collect();
        assert_eq!(found.settings, typed);
    }
}

fn fault(settings: &[&str]) -> Error {
    match scene(SCENE, settings).and_then(|scene| run(&scene, &mut |_| ())) {
        Ok(_) => panic!("{settings:?} is no fault"),
        Err(error) => error,
    }
}

/// The option and the key are named, and what was probably meant.
#[test]
fn a_wrong_setting_is_a_fault_of_the_option() {
    for (setting, key, words) in [
        ("material.posson=0.4", "--set material.posson", "did you mean \"material.poisson\"?"),
        ("materal.poisson=0.4", "--set materal.poisson", "did you mean \"material.poisson\"?"),
        ("fit[0].higer=0.4", "--set fit[0].higer", "did you mean \"fit[0].higher\"?"),
        ("fit[0].objective=frobenus", "--set fit[0].objective", "did you mean \"frobenius\"?"),
        ("mesh.box.element=quad5", "--set mesh.box.element", "did you mean \"quad4\"?"),
        ("fix[0].group=xmni", "--set fix[0].group", "did you mean \"xmin\"?"),
        ("material.law=neo-hokean", "--set material.law", "did you mean \"neo-hookean\"?"),
        ("material.poisson=much", "--set material.poisson", "expected a number"),
        ("material.poisson=0.6", "--set material.poisson", "0.5"),
        ("material.young=10 lbf", "--set material.young", "found \"10 lbf\""),
        ("load[0].traction[0]=1e*x", "--set load[0].traction[0]", "1e*x"),
        ("load[3].name=push", "--set load[3].name", "expected an entry from 0 to 1, which adds one, found [3]"),
        ("material[0]=1", "--set material[0]", "found a value of type table"),
        ("material.poisson.ratio=1", "--set material.poisson.ratio", "found a value of type float"),
        ("newton.steps=2", "--set newton.steps", "found one without"),
        ("fit=[]", "--set fit", "at least one [[fit]]"),
        ("material.poisson", "--set", "found \"material.poisson\""),
        ("=3", "--set", "found \"\""),
        ("load[x].name=a", "--set", "found \"load[x]"),
        ("load[0.name=a", "--set", "found \"load[0"),
        ("a..b=1", "--set", "found \"a..b\""),
        ("load[0].traction=[1, 0", "--set load[0].traction", "found [1, 0"),
        ("title=a\npoisson=3", "--set title", "a value of TOML"),
    ] {
        let error = fault(&[setting]);
        assert_eq!((error.key(), error.file(), error.line()), (Some(key), None, None), "{setting}: {error}");
        assert!(error.problem().contains(words), "{setting}: {error}");
    }
}

/// A fault elsewhere keeps its line and says what was set; a fault of the file alone is one of the file.
#[test]
fn a_fault_beside_a_setting_keeps_its_line() {
    let text = SCENE.replace("objective = \"frobenius\"", "objective = \"whole\"\nfrequencies = 3\nreal = 1");
    let error = scene(&text, &["material.poisson=0.4"]).unwrap_err();
    assert_eq!(error.line(), Some(10), "{error}");
    assert!(!error.problem().contains("--set"), "{error}");
    let law = SCENE.replace("young", "law = \"neo-hookean\"\nyoung") + "[newton]\nsteps = 1\n";
    let sampled = law.replace("\"frobenius\"", "\"sampled\"");
    assert!(scene(&sampled, &[]).is_ok());
    let motion = scene(&law, &["motion={ duration = 1, step = 0.1 }"]).unwrap_err();
    assert_eq!(motion.line(), Some(3), "{motion}");
    assert!(motion.problem().ends_with("(with --set motion={ duration = 1, step = 0.1 })"), "{motion}");
}

/// Each command that reads a scene takes the option; elements have no keys to set.
#[test]
fn every_command_that_reads_a_scene_takes_settings() {
    let folder = holding("s.toml", SCENE);
    for command in [
        &["run", "s.toml"][..],
        &["run", "s.toml", "--explain"],
        &["compare", "s.toml"],
        &["converge", "s.toml", "--levels", "2"],
        &["stability", "s.toml"],
    ] {
        let output = springfit(folder.path(), &[command, &["--set", "material.poisson=0.6"]].concat());
        let text = said(&output);
        assert!(text.starts_with("error: --set material.poisson: "), "{command:?}: {text}");
        assert_eq!(output.status.code(), Some(2));
    }
    let output = springfit(folder.path(), &["run", "s.toml", "--set", "material.poisson=0.2"]);
    assert!(String::from_utf8_lossy(&output.stdout).starts_with("s with material.poisson=0.2\n"), "{output:?}");
    for command in [&["compare", "tri3", "--shapes=1"][..], &["stability", "tri3"]] {
        let output = springfit(folder.path(), &[command, &["--set", "material.poisson=0.2"]].concat());
        let text = said(&output);
        assert!(text.starts_with("error: --set: belongs to a scene"), "{command:?}: {text}");
    }
}

/// A key that is not where it was written has a place in the scene, which the error names with its whole path.
#[test]
fn a_key_in_the_wrong_place_is_led_to_the_right_one() {
    for (setting, said) in [
        ("poisson=0.4", "did you mean \"material.poisson\"?"),
        ("young=1 kPa", "did you mean \"material.young\"?"),
        ("material.poison=0.4", "did you mean \"material.poisson\"?"),
        ("materials.poisson=0.4", "did you mean \"material.poisson\"?"),
        ("traction=[1, 0]", "did you mean \"load[0].traction\"?"),
        ("vtu=true", "did you mean \"output.vtu\"?"),
        ("load[0].tracton=[1, 0]", "did you mean \"load[0].traction\"?"),
        ("load.traction=[1, 0]", "such as load[0].traction"),
    ] {
        let error = scene(SCENE, &[setting]).unwrap_err().to_string();
        assert!(error.starts_with("--set ") && error.contains(said), "{setting}: {error}");
    }
    // In the file as well, with its line.
    let error = scene(&format!("poisson = 0.4\n{SCENE}"), &[]).unwrap_err().to_string();
    assert!(
        error.starts_with("s.toml:1: poisson: ") && error.contains("did you mean \"material.poisson\"?"),
        "{error}"
    );
    // What is nowhere has no suggestion.
    let error = scene(SCENE, &["quux=1"]).unwrap_err().to_string();
    assert!(error.contains("unknown field") && !error.contains("did you mean"), "{error}");
}

/// The name of an engine stands for the settings that it has by default.
#[test]
fn an_engine_is_named_or_set() {
    let of = |engine: &str| {
        let text = SCENE.replace("objective = \"frobenius\"", &format!("objective = \"frobenius\"\nengine = {engine}"));
        scene(&text, &["material.density=1000"]).map(|scene| scene.fits()[0].engine)
    };
    let named = of("\"jolt\"").unwrap();
    assert!(named.is_some());
    assert_eq!(named, of("{ method = \"jolt\" }").unwrap());
    assert_ne!(named, of("{ method = \"jolt\", substeps = 7 }").unwrap());
    let error = of("\"jollt\"").unwrap_err().to_string();
    assert!(error.contains("fit[0].engine.method") && error.contains("did you mean \"jolt\"?"), "{error}");
    // What an engine needs is asked for before the fits.
    for (settings, said) in [
        (&[][..], "expected a density in [material]"),
        (&["material.density=1", "material.law=neo-hookean"], "without a \"law\""),
    ] {
        let settings = [settings, &["fit[0].engine=jolt"]].concat();
        let error = scene(SCENE, &settings).unwrap_err().to_string();
        assert!(error.starts_with("--set fit[0].engine: ") && error.contains(said), "{error}");
    }
    let error = of("7").unwrap_err().to_string();
    assert!(error.contains("a name such as \"jolt\", or a table"), "{error}");
    let error = of("{ method = \"jolt\", substep = 7 }").unwrap_err().to_string();
    assert!(error.contains("substep") && error.contains("did you mean \"substeps\"?"), "{error}");
}
