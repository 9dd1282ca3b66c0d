//! The program, run on faulty inputs.

use super::inputs::{FROM_FILES, TETRAHEDRON, edited, unit_mesh};
use super::message::{Message, Place};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::Path;
use std::process::Command;
use std::thread::sleep;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Far beyond what a refusal takes.
const LONGEST: Duration = Duration::from_secs(20);

/// A text of a scene or an element and what it is changed to; the place in its file that is named; words of the problem, or none.
pub type Edit<'a> = (&'a str, &'a str, &'a str, &'a str);

/// What a run left behind.
pub struct Seen {
    /// None if the program was stopped.
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
    pub changed: bool,
}

/// Runs the program in a folder with these files; one that ends in `/` is a folder.
pub fn run(files: &[(&str, &[u8])], arguments: &[&str]) -> Seen {
    let (folder, streams) = (TempDir::new().unwrap(), TempDir::new().unwrap());
    for (name, content) in files {
        let path = folder.path().join(name);
        if name.ends_with('/') {
            fs::create_dir(path).unwrap();
        } else {
            fs::write(path, content).unwrap();
        }
    }
    let before = contents(folder.path());
    let (out, err) = (streams.path().join("out"), streams.path().join("err"));
    let mut program = Command::new(env!("CARGO_BIN_EXE_springfit"))
        .args(arguments)
        .current_dir(folder.path())
        .stdout(File::create(&out).unwrap())
        .stderr(File::create(&err).unwrap())
        .spawn()
        .unwrap();
    let start = Instant::now();
    let mut code = None;
    loop {
        match program.try_wait().unwrap() {
            Some(status) => {
                code = status.code();
                break;
            }
            None if start.elapsed() > LONGEST => {
                program.kill().unwrap();
                program.wait().unwrap();
                break;
            }
            None => sleep(Duration::from_millis(2)),
        }
    }
    let text = |path| String::from_utf8_lossy(&fs::read(path).unwrap()).into_owned();
    Seen { code, stdout: text(out), stderr: text(err), changed: contents(folder.path()) != before }
}

/// All files below with their content, and all folders.
fn contents(folder: &Path) -> BTreeMap<String, Option<Vec<u8>>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let content = if path.is_dir() {
            found.extend(contents(&path));
            None
        } else {
            Some(fs::read(&path).unwrap())
        };
        found.insert(path.display().to_string(), content);
    }
    found
}

/// Collects what differs from an orderly refusal, so that one run shows all cases.
#[derive(Default)]
pub struct Refusals {
    cases: usize,
    wrong: Vec<String>,
}

impl Refusals {
    /// The run is refused; the line on standard error names `place`, and the problem has these `words`, if any.
    pub fn expect(&mut self, files: &[(&str, &[u8])], arguments: &[&str], place: &str, words: &str) {
        self.cases += 1;
        let seen = run(files, arguments);
        let names: Vec<&str> = files.iter().map(|(name, _)| name.trim_end_matches('/')).collect();
        let message = Message::parse(&seen.stderr, &names);
        let place_of = |name: &str| files.iter().find(|(file, _)| *file == name).map(|(_, text)| *text);
        let named = message
            .is_some_and(|message| message.place.is(&Place::parse(place, &names), place_of) && message.has(words));
        if seen.code != Some(2) || !seen.stdout.is_empty() || seen.changed || !named {
            let Seen { code, stdout, stderr, changed } = seen;
            let stderr: String = stderr.chars().take(500).collect();
            self.wrong.push(format!(
                "expected {place:?} with {words:?}\n found   {stderr:?}\n {arguments:?}: code {code:?}, files changed: \
                 {changed}, stdout {stdout:?}"
            ));
        }
    }

    /// The run of a scene beside other files.
    pub fn expect_with(&mut self, scene: &str, others: &[(&str, &str)], place: &str, words: &str) {
        let others = others.iter().map(|(name, text)| (*name, text.as_bytes()));
        let files: Vec<(&str, &[u8])> = [("scene.toml", scene.as_bytes())].into_iter().chain(others).collect();
        self.expect(&files, &["run", "scene.toml"], place, words);
    }

    /// The run of a scene alone, whose `place` is named.
    pub fn expect_of_scene(&mut self, scene: &str, place: &str, words: &str) {
        self.expect_with(scene, &[], &place_in("scene.toml", place), words);
    }

    /// The scene `FROM_FILES` with this element and this mesh.
    pub fn expect_of_files(&mut self, element: &str, mesh: &str, place: &str, words: &str) {
        self.expect_with(FROM_FILES, &[("own.toml", element), ("mesh.msh", mesh)], place, words);
    }

    pub fn expect_of_edits(&mut self, scene: &str, edits: &[Edit]) {
        for (from, to, place, words) in edits {
            self.expect_of_scene(&edited(scene, from, to), place, words);
        }
    }

    pub fn expect_of_elements(&mut self, edits: &[Edit]) {
        for (from, to, place, words) in edits {
            self.expect_of_files(&edited(TETRAHEDRON, from, to), &unit_mesh(), &place_in("own.toml", place), words);
        }
    }

    pub fn finish(self) {
        assert!(self.wrong.is_empty(), "{} of {} cases:\n{}", self.wrong.len(), self.cases, self.wrong.join("\n\n"));
    }
}

/// A place of a file: its key, its line, or both; the file alone without either.
fn place_in(file: &str, place: &str) -> String {
    if place.is_empty() {
        return file.into();
    }
    let blank = if place.starts_with(|c: char| c.is_ascii_digit()) { "" } else { " " };
    format!("{file}:{blank}{place}")
}

pub fn refuses_edits(scene: &str, edits: &[Edit]) {
    let mut refusals = Refusals::default();
    refusals.expect_of_edits(scene, edits);
    refusals.finish();
}

/// Texts that one part of a scene is changed to, each with the key that is named and words of the problem. `…` stands for the text and for the key in
/// `part`'s change and place.
pub fn refuses_values(scene: &str, part: &str, change: &str, place: &str, values: &[(&str, &str, &str)]) {
    let mut refusals = Refusals::default();
    for (value, key, words) in values {
        let scene = edited(scene, part, &change.replace('…', value));
        refusals.expect_of_scene(&scene, &place.replace('…', key), words);
    }
    refusals.finish();
}

pub fn refuses_elements(edits: &[Edit]) {
    let mut refusals = Refusals::default();
    refusals.expect_of_elements(edits);
    refusals.finish();
}
