//! Imports point one way, elements are data, and files stay small.

use springfit::element::SHIPPED;
use std::path::{Path, PathBuf};

/// A module may import those before it; a folder counts as one.
const LAYERS: [&str; 17] = [
    "error",
    "named",
    "file",
    "scalar",
    "symbolic",
    "element",
    "material",
    "stiffness",
    "springs",
    "fit",
    "mesh",
    "model",
    "solve",
    "dynamics",
    "whole",
    "study",
    "report",
];

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(sources(&path));
        } else {
            files.push(path);
        }
    }
    files
}

/// Every source of the crates, by its path within its crate's `src`.
fn all() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let crates = ["foundation", "kernels", "bodies", "studies"].map(|name| root.join("crates").join(name).join("src"));
    let read = |folder: PathBuf| {
        let files = sources(&folder);
        let relative = move |path: PathBuf| {
            let text = std::fs::read_to_string(&path).unwrap();
            (path.strip_prefix(&folder).unwrap().to_path_buf(), text)
        };
        files.into_iter().map(relative)
    };
    crates.into_iter().chain([root.join("src")]).flat_map(read).collect()
}

#[test]
fn imports_point_up_the_list_of_layers() {
    let rank = |name: &str| LAYERS.iter().position(|l| *l == name);
    let mut imports = 0;
    for (path, text) in all() {
        let top = path.iter().next().unwrap().to_str().unwrap().trim_end_matches(".rs");
        if ["lib", "main", "arguments"].contains(&top) {
            continue;
        }
        let own = rank(top).unwrap_or_else(|| panic!("{} is in no layer", path.display()));
        for (place, _) in text.match_indices("crate::") {
            let name: String = text[place + 7..].chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            if let Some(imported) = rank(&name) {
                imports += 1;
                assert!(imported <= own, "{} imports {name}", path.display());
            }
        }
    }
    assert!(imports > 50, "the imports were not found");
}

#[test]
fn no_source_names_a_shipped_element() {
    for (path, text) in all().into_iter().filter(|(path, _)| path != Path::new("lib.rs")) {
        for element in SHIPPED {
            let word = |w: &str| w == element.name;
            let named = text.split(|c: char| !c.is_alphanumeric() && c != '_').any(word);
            assert!(!named, "{} names {}", path.display(), element.name);
        }
    }
}

#[test]
fn files_stay_small() {
    for (path, text) in all() {
        assert!(text.lines().count() <= 400, "{} has {} lines", path.display(), text.lines().count());
    }
}
