//! What becomes of files: a run is a unit, and what is not of a run is never touched.
#![cfg(unix)]

mod faults;
mod foreign;
mod together;

use crate::kit::said;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

/// A plane body with tables, networks, pictures and a motion. A page would be a thousand times larger than all of them.
const SCENE: &str = r#"
title = "TITLE"
mesh = { box = { element = "quad4", size = [1, 1], cells = [1, 2] } }
material = { young = YOUNG, poisson = 0.3, density = 1000, thickness = 1 }
fit = [{ objective = "offdiag" }]
fix = [{ group = "ymin" }]
load = [{ name = "tension", group = "ymax", traction = [0, 10] }]
motion = { duration = 1e-3, step = 5e-4, every = 5e-4, integrator = "newmark", linear = true }
output = { csv = true, vtu = true }
"#;

/// The same without a motion, for a sweep and a study of convergence.
const SWEPT: &str = r#"
title = "TITLE"
mesh = { box = { element = "quad4", size = [1, 1], cells = [1, 2] } }
material = { young = YOUNG, poisson = 0.3, thickness = 1 }
fit = [{ objective = "offdiag" }]
fix = [{ group = "ymin" }]
load = [{ name = "tension", group = "ymax", traction = [0, 10] }]
sweep.over = { material.poisson = [0.1, 0.2, 0.3] }
"#;

/// A folder with the scenes `old` and `new`, which differ in their title and in all results.
fn scenes() -> tempfile::TempDir {
    // In memory, where there is such a folder: a run waits for the disk after each of its files.
    let memory = Path::new("/dev/shm");
    let place = if memory.is_dir() { memory.to_path_buf() } else { std::env::temp_dir() };
    let folder = tempfile::tempdir_in(place).unwrap();
    for (title, young) in [("old", "1e4"), ("new", "3e4")] {
        for (name, scene) in [("run", SCENE), ("swept", SWEPT)] {
            let text = scene.replace("TITLE", title).replace("YOUNG", young);
            fs::write(folder.path().join(format!("{name}-{title}.toml")), text).unwrap();
        }
    }
    folder
}

/// The program in this folder with these arguments.
fn springfit(folder: &Path, arguments: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_springfit"));
    command.args(arguments.split(' ')).current_dir(folder).stdin(Stdio::null());
    // Operations on files are in one order on one thread.
    command.env("RAYON_NUM_THREADS", "1");
    command
}

/// All files below a folder, by their paths.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let (name, path) = (entry.file_name().to_string_lossy().into_owned(), entry.path());
        let kind = entry.file_type().unwrap();
        if kind.is_dir() {
            found.extend(files(&path).into_iter().map(|(below, bytes)| (format!("{name}/{below}"), bytes)));
        } else if kind.is_symlink() {
            let target = fs::read_link(&path).unwrap();
            found.insert(name, [b"-> ", target.as_os_str().as_encoded_bytes()].concat());
        } else {
            found.insert(name, fs::read(path).unwrap_or_default());
        }
    }
    found
}

/// Those that users look for.
fn results(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    files(folder).into_iter().filter(|(name, _)| !name.starts_with(".springfit.")).collect()
}

fn copy(from: &BTreeMap<String, Vec<u8>>, to: &Path) {
    for (name, bytes) in from {
        let path = to.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
}
