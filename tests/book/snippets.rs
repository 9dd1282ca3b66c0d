//! TOML blocks of the pages are read by the program.

use super::markdown::{Block, Page, pages};
use springfit_element::element::Element;
use springfit_element::material::{Energy, Material, State};
use springfit_studies::study::{Comparing, Scene};
use std::path::Path;

/// What a scene has around a part of one.
const MESH: &str = "[mesh]\nbox = { element = \"hex8\", size = [1, 1, 1], cells = [1, 1, 1] }\n";
const MATERIAL: &str = "[material]\nyoung = 10e3\npoisson = 0.3\ndensity = 1000\n";
const LAW: &str = "law = \"neo-hookean\"\n";
const FIT: &str = "[[fit]]\nobjective = \"exact\"\n";
const LOADS: &str = "[[load]]\nname = \"tension\"\ngroup = \"zmax\"\nforce = [0, 0, 1]\n[[load]]\nname = \"shear\"\ngroup = \"zmax\"\nforce = [1, 0, 0]\n[[load]]\nname = \"gravity\"\nbody = [0, 0, -1]\n";

/// The block with what it lacks of a scene.
fn scene_around(block: &str, law: bool) -> String {
    let has = |table: &str| block.lines().any(|line| line.trim_end() == table);
    let mut text = String::new();
    let parts = [("[mesh]", MESH.to_string()), ("[material]", MATERIAL.to_string() + if law { LAW } else { "" })];
    for (table, part) in parts.into_iter().chain([("[[fit]]", FIT.into()), ("[[load]]", LOADS.into())]) {
        if !has(table) && !has(&format!("[{table}]")) {
            text += &part;
        }
    }
    text + block
}

fn check(page: &Page, block: &Block) -> bool {
    let place = |problem: String| panic!("{}:{}: {problem}", page.name(), block.line);
    let Some(mark) = block.mark.as_deref() else { return false };
    match mark {
        "scene" | "scene with a law" => {
            let text = scene_around(&block.text, mark.ends_with("law"));
            let scene = Scene::parse(&text, Path::new("scene.toml"));
            scene.map(|_| ()).unwrap_or_else(|e| place(e.to_string()));
        }
        "comparison" => {
            let found = Comparing::parse(&block.text, Path::new("comparison.toml"));
            found.map(|_| ()).unwrap_or_else(|e| place(e.to_string()));
        }
        "element" => Element::parse(&block.text).map(|_| ()).unwrap_or_else(|e| place(e.to_string())),
        "material" => {
            let material = Material::new(10e3, 0.3, State::Solid).unwrap();
            Energy::parse(&block.text, material).map(|_| ()).unwrap_or_else(|e| place(e.to_string()));
        }
        // Read by the commands of the tutorial that it belongs to.
        other if other.starts_with("file: ") => {}
        other => place(format!("no mark is called \"{other}\"")),
    }
    true
}

#[test]
fn every_toml_block_is_read() {
    let mut read = 0;
    for page in pages() {
        for block in page.blocks().iter().filter(|block| block.language == "toml") {
            assert!(check(&page, block), "{}:{}: a TOML block without a mark", page.name(), block.line);
            read += 1;
        }
    }
    assert!(read > 12, "{read}");
}
