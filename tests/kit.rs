//! The program as users start it, and what it says; and scenes as the library runs them.

use springfit_foundation::error::Result;
use springfit_mesh::mesh::{Mesh, MeshSource};
use springfit_report::report::{open_scene_outputs, write_outputs};
use springfit_studies::study::{Outcome, Scene, run};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::{Mutex, OnceLock};
use tempfile::TempDir;

/// A folder of its own that has a file.
pub fn holding(name: &str, content: impl AsRef<[u8]>) -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join(name), content).unwrap();
    folder
}

/// What a file has in JSON.
pub fn json(path: &Path) -> serde_json::Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

/// A file or a folder of the repository.
pub fn place(path: impl AsRef<Path>) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Lists all files in a folder and in those below it, in the order of their paths.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let paths = entries.map(|entry| entry.unwrap().path());
    let mut found: Vec<PathBuf> =
        paths.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect();
    found.sort();
    found
}

/// Lists the files in a folder and in those below it that have this ending.
pub fn files_of(folder: &Path, ending: &str) -> Vec<PathBuf> {
    files(folder).into_iter().filter(|path| path.extension().is_some_and(|e| e == ending)).collect()
}

/// Runs `springfit ARGUMENTS…` in a folder.
pub fn springfit(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_springfit")).args(arguments).current_dir(folder).output().unwrap()
}

/// What it said on standard error.
pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// What it said on both of its streams.
pub fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &said(output)
}

/// Its exit code, and what it said on both of its streams.
pub fn ran(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let output = springfit(folder, arguments);
    (output.status.code(), told(&output))
}

/// What it prints where it succeeds.
pub fn prints(folder: &Path, arguments: &[&str]) -> String {
    let output = springfit(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", said(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// What it says where it refuses its input.
pub fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = springfit(folder, arguments);
    let said = said(&output);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
    said
}

/// What comes of the scene of this text, `scene.toml`, whose files are in a folder.
pub fn outcome_in(folder: &Path, text: &str) -> Result<Outcome> {
    run(&Scene::parse(text, &folder.join("scene.toml"))?, &mut |_| {})
}

/// What comes of the scene of this text.
pub fn outcome(text: &str) -> Outcome {
    outcome_in(Path::new(""), text).unwrap()
}

/// Why the scene of this text is refused.
pub fn refusal(text: &str) -> String {
    outcome_in(Path::new(""), text).unwrap_err().to_string()
}

/// A scene that is shipped.
pub fn shipped(name: &str) -> Scene {
    Scene::load(&place(format!("scenes/{name}.toml"))).unwrap()
}

/// What comes of it, which is computed once for all tests.
pub fn outcome_of(name: &str) -> &'static Outcome {
    static KNOWN: Mutex<BTreeMap<String, &'static OnceLock<Outcome>>> = Mutex::new(BTreeMap::new());
    let own = *KNOWN.lock().unwrap().entry(name.into()).or_insert_with(|| Box::leak(Box::default()));
    own.get_or_init(|| run(&shipped(name), &mut |_| {}).unwrap())
}

/// A mesh of the tests, as its file has it.
pub fn source(file: &str) -> MeshSource {
    MeshSource::read(&place("tests/meshes").join(file)).unwrap()
}

/// A mesh of the tests, whose cells have their elements.
pub fn mesh(file: &str) -> Mesh {
    Mesh::resolve(&source(file), &[], 1.0).unwrap()
}

/// The files of a run.
pub fn write_run(scene: &Scene, outcome: &Outcome, folder: &Path) {
    write_outputs(outcome, scene.output(), open_scene_outputs(scene, folder).unwrap()).unwrap();
}
