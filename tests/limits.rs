//! What is too large is refused before it is tried, and outputs that cannot be written before the work.

use crate::kit::{holding, place};
use springfit_bodies::model::Network;
use springfit_foundation::error::ErrorKind;
use springfit_report::report::{NetworkFile, network_csv, network_json, open_scene_outputs};
use springfit_studies::study::{Scene, run};
use std::fs;
use std::io::{self, Write};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

const BODY: &str = r#"
mesh = { box = { element = "hex8", size = [0.02, 0.02, 0.02], cells = [CELLS, CELLS, CELLS] } }
material = { young = 10e3, poisson = 0.3, density = 1000LAW }
fix = [{ group = "zmin" }]
load = [{ name = "tension", group = "zmax", traction = [0, 0, 10] }]
MORE
"#;

fn scene(cells: usize, law: &str, more: &str) -> String {
    let more =
        if more.contains("fit") { more.into() } else { format!("fit = [{{ objective = \"frobenius\" }}]\n{more}") };
    BODY.replace("CELLS", &cells.to_string()).replace("LAW", law).replace("MORE", &more)
}

/// Runs the program in a folder where a shell's script comes first.
fn program(folder: &Path, script: &str, arguments: &[&str]) -> Output {
    let mut command = Command::new("sh");
    command.args(["-c", &format!("{script}; exec \"$@\""), "sh", env!("CARGO_BIN_EXE_springfit")]).args(arguments);
    command.current_dir(folder).stdin(Stdio::null()).output().unwrap()
}

/// One error that begins with its place, exit code 2, and no table.
fn assert_refused(output: &Output, place: &str, words: &[&str]) {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    let errors: Vec<&str> = text.lines().filter(|line| !line.starts_with("note: ")).collect();
    assert!(errors.len() == 1 && errors[0].starts_with(&format!("error: {place}")), "{place}: {text}");
    assert!(words.iter().all(|word| text.contains(word)), "{words:?}: {text}");
    assert!(output.status.code() == Some(2) && output.stdout.is_empty(), "{output:?}");
}

/// Of a body that stands, and of a network: neither is called indefinite. The limits lie between what the program itself takes and
/// what the step takes that is refused.
#[cfg(target_os = "linux")]
#[test]
fn what_does_not_fit_into_memory_is_refused_with_its_figures() {
    let folder = TempDir::new().unwrap();
    let run = |method: &str, limit: u64| {
        let text = scene(30, "", &format!("[solver]\nmethod = \"{method}\""));
        fs::write(folder.path().join("scene.toml"), text).unwrap();
        let limit = format!("export RAYON_NUM_THREADS=1; ulimit -v {}", limit * 1000);
        program(folder.path(), &limit, &["run", "scene.toml", "--out", "out"])
    };
    let figures = [" GB of memory", " GB is left", "fewer points"];
    assert_refused(&run("cholesky", 600), "scene.toml:2: mesh: the stiffness", &figures);
    assert_refused(&run("cholesky", 1200), "scene.toml:2: mesh: the factor", &figures);
    assert_refused(&run("multigrid", 280), "scene.toml:2: mesh: the stiffness", &figures);
}

/// Neither way fits: the figure is that of the levels, which is the lesser one here.
#[cfg(target_os = "linux")]
#[test]
fn the_figure_of_a_refusal_is_the_least_that_would_do() {
    let folder = holding("scene.toml", scene(30, "", ""));
    let limit = "export RAYON_NUM_THREADS=1; ulimit -v 280000";
    let found = program(folder.path(), limit, &["run", "scene.toml", "--out", "out"]);
    let words = ["the stiffness with the levels of its multigrid takes 0.", "a factor does not fit either"];
    assert_refused(&found, "scene.toml:2: mesh: the stiffness with the levels", &words);
    assert!(!String::from_utf8_lossy(&found.stderr).contains("factorised instead"));
}

/// The factor with pivots of a network that is not positive definite takes as much as a Cholesky factor; L and U do not fit here.
#[cfg(target_os = "linux")]
#[test]
fn the_factor_of_an_indefinite_network_fits_where_that_of_the_body_does() {
    let folder = TempDir::new().unwrap();
    let text = scene(16, "", "[solver]\nmethod = \"cholesky\"")
        .replace("size = [0.02, 0.02, 0.02]", "size = [0.02, 0.02, 0.002]");
    fs::write(folder.path().join("scene.toml"), text).unwrap();
    let limit = "export RAYON_NUM_THREADS=1; ulimit -v 700000";
    let found = program(folder.path(), limit, &["run", "scene.toml", "--out", "out"]);
    let text = String::from_utf8_lossy(&found.stderr).into_owned() + &String::from_utf8_lossy(&found.stdout);
    assert!(found.status.success(), "{text}");
    assert!(text.contains("indefinite, a motion releases energy"), "{text}");
    assert!(!text.contains("no displacements are given"), "{text}");
    let report = fs::read_to_string(folder.path().join("out/report.json")).unwrap();
    assert!(report.contains("\"ldl\""), "{text}");
}

/// Where no estimate saw it coming, the program ends as with every other error.
#[cfg(target_os = "linux")]
#[test]
fn memory_that_is_refused_ends_the_program_with_one_line() {
    let folder = TempDir::new().unwrap();
    let more = "[output]\nreport = false";
    fs::write(folder.path().join("scene.toml"), scene(60, "", more).replace("load = ", "#")).unwrap();
    let script = "export RAYON_NUM_THREADS=1; unset RUST_BACKTRACE; ulimit -v 120000";
    let found = program(folder.path(), script, &["run", "scene.toml", "--out", "out"]);
    let text = String::from_utf8_lossy(&found.stderr).into_owned();
    assert!(
        found.status.code() == Some(2) && text.contains("error: the program cannot go on"),
        "{text} {}",
        found.status
    );
}

#[test]
fn counts_have_bounds() {
    let law = ", law = \"neo-hookean\"";
    for (law, more, key) in [
        (law, "newton = { iterations = 100001 }", "newton.iterations"),
        (law, "newton = { steps = 100001 }", "newton.steps"),
        ("", "output = { frequencies = 1001 }", "output.frequencies"),
        ("", "motion = { duration = 1, step = 0.1, iterations = 100001 }", "motion.iterations"),
        ("", "motion = { duration = 1e9, step = 1e-3 }", "motion.step"),
        ("", "fit = [{ objective = \"whole\", iterations = 100001 }]", "fit[0].iterations"),
        ("", "fit = [{ objective = \"whole\", frequencies = 1001 }]", "fit[0].frequencies"),
    ] {
        let error = Scene::parse(&scene(1, law, more), Path::new("scene.toml")).unwrap_err();
        assert_eq!((error.key(), error.kind()), (Some(key), ErrorKind::Limit), "{error}");
    }
    let starts = "fit = [{ objective = \"sampled\", force = \"k*(exp(a*s) - 1)\", starts = 10001 }]";
    let scene = Scene::parse(&scene(1, law, starts), Path::new("scene.toml")).unwrap();
    let error = run(&scene, &mut |_| {}).unwrap_err();
    assert_eq!((error.key(), error.kind()), (Some("fit[0].starts"), ErrorKind::Limit), "{error}");
}

/// Keeps all, and the size of the largest piece.
#[derive(Default)]
struct Pieces(Vec<u8>, usize);

impl Write for Pieces {
    fn write(&mut self, piece: &[u8]) -> io::Result<usize> {
        self.0.extend(piece);
        self.1 = self.1.max(piece.len());
        Ok(piece.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// No text of the whole network is made: what is written at once does not grow with the network.
#[test]
fn networks_are_written_record_by_record() {
    let (mut largest, mut sizes) = (Vec::new(), Vec::new());
    for cells in [2, 12] {
        let scene = Scene::parse(&scene(cells, "", "fit = [{ objective = \"exact\" }]"), Path::new("s.toml")).unwrap();
        let outcome = run(&scene, &mut |_| {}).unwrap();
        let network: &Network = &outcome.fits[0].network;
        let (mut json, mut csv) = (Pieces::default(), Pieces::default());
        network_json(&NetworkFile::of(&outcome, &outcome.fits[0]), &mut json).unwrap();
        network_csv(&outcome.mesh, network, &mut csv).unwrap();
        let file: serde_json::Value = serde_json::from_slice(&json.0).unwrap();
        assert_eq!(file["springs"].as_array().unwrap().len(), network.len());
        assert_eq!(csv.0.iter().filter(|byte| **byte == b'\n').count(), network.len() + 1);
        // The table has a buffer of its own.
        assert!(csv.1 <= 1 << 16, "{}", csv.1);
        largest.push(json.1);
        sizes.push(csv.0.len());
    }
    // The table has more than one piece.
    assert!(sizes[1] > 2 << 16, "{sizes:?}");
    assert!(largest[1] < 2 * largest[0], "{largest:?}");
}

/// By its name, by a symbolic link and by a hard one.
#[cfg(unix)]
#[test]
fn no_output_replaces_an_input() {
    let mesh = place("tests/meshes/tet10.vtu");
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::copy(mesh, at("mesh.vtu")).unwrap();
    fs::create_dir(at("out")).unwrap();
    std::os::unix::fs::symlink(at("mesh.vtu"), at("soft.vtu")).unwrap();
    fs::hard_link(at("mesh.vtu"), at("hard.vtu")).unwrap();
    let before = fs::read(at("mesh.vtu")).unwrap();
    for output in ["mesh.vtu", "./out/../mesh.vtu", "soft.vtu", "hard.vtu"] {
        let arguments = ["fit", "mesh.vtu", "--young", "10kPa", "--poisson", "0.3", "-o", output];
        assert_refused(&program(folder.path(), ":", &arguments), output, &["an input"]);
        let scene = scene(1, "", "output = { vtu = true }").replace("mesh = {", "mesh = { file = \"FILE\" } #");
        fs::write(at("scene.toml"), scene.replace("FILE", output)).unwrap();
        let arguments = ["run", "scene.toml", "--out", "."];
        assert_refused(&program(folder.path(), ":", &arguments), "./mesh.vtu", &["an input"]);
    }
    assert_eq!(fs::read(at("mesh.vtu")).unwrap(), before);
}

/// A folder or a file that is read-only in the place of any of them.
#[test]
fn outputs_that_cannot_be_written_are_found_before_the_work() {
    let more = "output = { vtu = true, csv = true }\nmotion = { duration = 1e-3, step = 1e-3 }";
    let scene = Scene::parse(&scene(1, "", more), Path::new("scene.toml")).unwrap();
    let made = TempDir::new().unwrap();
    let outcome = run(&scene, &mut |_| {}).unwrap();
    let written = springfit_report::report::write_outputs(
        &outcome,
        scene.output(),
        open_scene_outputs(&scene, made.path()).unwrap(),
    )
    .unwrap();
    assert_eq!(written.len(), 10, "{written:?}");
    for path in written {
        let folder = TempDir::new().unwrap();
        let place = folder.path().join(path.file_name().unwrap());
        open_scene_outputs(&scene, folder.path()).unwrap();
        fs::create_dir(&place).unwrap();
        let error = open_scene_outputs(&scene, folder.path()).unwrap_err();
        assert_eq!((error.kind(), error.file()), (ErrorKind::Io, Some(&*place)));
    }
}
