//! What a file is that was given in the place of a scene, and which command takes it.

use serde_json::Value;
use springfit_foundation::error::Error;
use springfit_mesh::mesh::MESH_FORMATS;
use springfit_studies::study::is_comparison;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// What is read of a file to tell what it is; a scene is rarely longer, and the first keys of a network and of a report are nearer.
const BEGINNING: u64 = 1 << 20;

/// The error of a scene, or where the file is of another kind that the program knows, what it is and which command takes it.
pub fn explained(path: &Path, error: Error) -> Error {
    if error.file() != Some(path) {
        return error;
    }
    match kind(path) {
        Some((found, advice)) => {
            let problem = format!("expected a scene, found {found}: {advice}");
            Error::new(problem).of_kind(error.kind()).in_file(path)
        }
        None => error,
    }
}

/// What the file is and what takes it, if it is not a scene but another file of the program.
fn kind(path: &Path) -> Option<(&'static str, String)> {
    let name = path.display();
    if path.is_dir() {
        let is_run = path.join("report.json").is_file();
        let of_run = format!("springfit plot {name} draws figures of it, and the scene is the file that ends in .toml");
        return is_run.then_some(("the folder of a run", of_run));
    }
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    if ending != "json" && MESH_FORMATS.iter().any(|format| format.endings.contains(&&*ending)) {
        return Some(("a mesh", format!("springfit new {name} -o scene.toml writes a scene for it")));
    }
    let mut beginning = Vec::new();
    File::open(path).ok()?.take(BEGINNING).read_to_end(&mut beginning).ok()?;
    let text = String::from_utf8_lossy(&beginning);
    if text.trim_start().starts_with('{') {
        return Some(of_json(path, &text));
    }
    if is_comparison(&text) {
        return Some(("a comparison", format!("springfit compare {name}")));
    }
    let keys = text.parse::<toml::Table>().ok()?;
    let has = |key: &str| keys.contains_key(key);
    if has("mesh") || has("fit") {
        return None;
    }
    if has("nodes") && has("cell") {
        return Some(("an element", format!("springfit check {name}, or springfit compare {name}")));
    }
    has("energy").then(|| ("an energy", format!("a scene names it as law = \"{name}\" in [material]")))
}

/// What a JSON document is.
fn of_json(path: &Path, text: &str) -> (&'static str, String) {
    let name = path.display();
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let is_network = text.contains("\"springfit network\"");
    if is_network {
        return ("a network", format!("springfit measure {name} measures it, and springfit export {name} hands it on"));
    }
    // A report is cut at the length that is read, which is no JSON.
    let has_key = |key: &str| text.contains(&format!("\"{key}\":"));
    let is_scene = serde_json::from_str::<Value>(text)
        .is_ok_and(|value| value.get("mesh").is_some() && value.get("material").is_some());
    if is_scene {
        return ("the keys of one in JSON", "a scene is a file in TOML".into());
    }
    match has_key("scene") && (has_key("fits") || has_key("regions")) {
        true => ("a report", format!("springfit plot {} draws figures of its run", folder.display())),
        false => ("JSON", "a scene is a file in TOML".into()),
    }
}
