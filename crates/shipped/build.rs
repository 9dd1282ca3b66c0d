//! Embeds every file of `elements`, with the cell types it serves, every file of `materials`, and the experiments of
//! `scenes/paper` with the meshes they name.

use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    let code: Vec<String> =
        files("elements", "toml").iter().map(|(name, path, text)| element(name, path, text)).collect();
    write("elements.rs", &code);
    let code = files("materials", "toml").into_iter().map(|(name, path, _)| included(&name, &path));
    write("materials.rs", &code.collect::<Vec<_>>());
    let scenes = files("scenes/paper", "toml");
    let named = |(name, _, _): &(String, PathBuf, String)| {
        let path = format!("meshes/{name}.msh");
        scenes.iter().any(|(_, _, text)| text.contains(&path))
    };
    let meshes = files("scenes/meshes", "msh").into_iter().filter(named);
    let code = scenes.iter().map(|(name, path, _)| included(&format!("paper/{name}.toml"), path));
    let code = code.chain(meshes.map(|(name, path, _)| included(&format!("meshes/{name}.msh"), &path)));
    write("experiments.rs", &code.collect::<Vec<_>>());
}

/// Name, path and text of the files of a folder with that ending, by name.
fn files(folder: &str, ending: &str) -> Vec<(String, PathBuf, String)> {
    let package = PathBuf::from(env::var("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    // The package links to the folders of the repository; where a checkout has no links they are found from here.
    let linked = package.join(folder);
    let folder = if linked.is_dir() { linked } else { package.join("../..").join(folder) };
    println!("cargo::rerun-if-changed={}", folder.display());
    let mut paths: Vec<PathBuf> = fs::read_dir(&folder)
        .expect("the folder can be read")
        .map(|entry| entry.expect("an entry can be read").path())
        .filter(|path| path.extension().is_some_and(|e| e == ending))
        .collect();
    paths.sort();
    let read = |path: PathBuf| {
        let text = fs::read_to_string(&path).expect("a file can be read");
        let name = path.file_stem().expect("it has an ending").to_string_lossy().into_owned();
        (name, path, text)
    };
    paths.into_iter().map(read).collect()
}

fn included(name: &str, path: &Path) -> String {
    format!("({name:?}, include_str!({path:?})),")
}

fn element(name: &str, path: &Path, text: &str) -> String {
    let cell_type = |format: &str| {
        let found = cell_type(text, format);
        found.unwrap_or_else(|line| panic!("{}: expected `{format} = {{ type = NUMBER`, found {line}", path.display()))
    };
    let (gmsh, vtk) = (cell_type("gmsh"), cell_type("vtk"));
    format!("ElementFile {{ name: {name:?}, gmsh: {gmsh:?}, vtk: {vtk:?}, text: include_str!({path:?}) }},")
}

/// The number after `type =` in the line of a format, if the table `[formats]` has one; the line if it has no such form. A parser of TOML
/// would be compiled for this alone; the tests compare with what the program's reads.
fn cell_type<'t>(text: &'t str, format: &str) -> Result<Option<i64>, &'t str> {
    let Some((_, formats)) = text.split_once("\n[formats]") else { return Ok(None) };
    let lines = formats.lines().skip(1).take_while(|line| !line.starts_with('['));
    let value = |line: &'t str| Some((line, line.strip_prefix(format)?.trim_start().strip_prefix('=')?));
    let Some((line, value)) = lines.filter_map(value).next() else { return Ok(None) };
    let number = value.trim_start().strip_prefix('{').and_then(|rest| rest.trim_start().strip_prefix("type"));
    let number = number.and_then(|rest| rest.trim_start().strip_prefix('=')).map(|rest| rest.trim_start());
    let digits = number.map(|rest| rest.split(|c: char| !c.is_ascii_digit()).next().unwrap_or_default());
    digits.and_then(|digits| digits.parse().ok()).map(Some).ok_or(line)
}

fn write(file: &str, entries: &[String]) {
    let out = Path::new(&env::var("OUT_DIR").expect("cargo sets it")).join(file);
    fs::write(out, format!("&[\n{}\n]\n", entries.join("\n"))).expect("the build folder can be written");
}
