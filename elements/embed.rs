//! Build script: puts every element file of this folder into the library, with the cell types it serves.

use std::fmt::Write;
use std::path::Path;
use std::{env, fs};

fn main() {
    println!("cargo::rerun-if-changed=elements");
    let folder = Path::new(&env::var("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("elements");
    let mut files: Vec<_> = fs::read_dir(&folder)
        .expect("the folder elements can be read")
        .map(|entry| entry.expect("an entry can be read").path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    files.sort();

    let mut code = String::from("&[\n");
    for path in files {
        let text = fs::read_to_string(&path).expect("an element file can be read");
        let table: toml::Table = text.parse().unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let name = path.file_stem().expect("it ends in .toml").to_string_lossy();
        let cell_type = |format: &str| table.get("formats").and_then(|f| f.get(format)?.get("type")?.as_integer());
        let (gmsh, vtk) = (cell_type("gmsh"), cell_type("vtk"));
        writeln!(code, "Shipped {{ name: {name:?}, gmsh: {gmsh:?}, vtk: {vtk:?}, text: include_str!({path:?}) }},")
            .expect("a String grows");
    }
    code += "]\n";
    let out = Path::new(&env::var("OUT_DIR").expect("cargo sets it")).join("shipped.rs");
    fs::write(out, code).expect("the build folder can be written");
}
