//! Imports point one way, files have no circles, elements are data, and files stay small.

mod graph;
mod module;
mod tokens;

use crate::kit::files;
use graph::{Graph, PROGRAM, Source};
use springfit_element::element::SHIPPED;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A layer may import those before it; a folder counts as one.
const LAYERS: [&str; 43] = [
    "shipped",
    "numerics",
    "multigrid",
    "text",
    "page",
    "clock",
    "error",
    "bound",
    "range",
    "named",
    "order",
    "number",
    "random",
    "quantity",
    "file",
    "memory",
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
    "positive",
    "dynamics",
    "engine",
    "whole",
    "calibration",
    "network",
    "analysis",
    "scene",
    "study",
    "generate",
    "prelude",
    "report",
    "export",
    "referee",
    "terminal",
    "commands",
    "program",
];

/// Every source of the packages that are here: a published package holds its own alone.
fn sources() -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |package: &str| -> Vec<Source> {
        let folder = if package.is_empty() { root.join("src") } else { root.join("crates").join(package).join("src") };
        let read = |path: PathBuf| {
            let within: Vec<_> = path.strip_prefix(&folder).unwrap().iter().map(|p| p.to_str().unwrap()).collect();
            Source::new(package, &within.join("/"), &std::fs::read_to_string(&path).unwrap())
        };
        // A published package has no other packages in its folder.
        if folder.is_dir() { files(&folder).into_iter().map(read).collect() } else { Vec::new() }
    };
    [
        "shipped",
        "numerics",
        "multigrid",
        "page",
        "foundation",
        "element",
        "fit",
        "mesh",
        "bodies",
        "identify",
        "networks",
        "analysis",
        "generate",
        "scenes",
        "studies",
        "report",
        "",
    ]
    .into_iter()
    .flat_map(read)
    .collect()
}

/// The layer of a source; `None` for the roots of libraries, which only declare and pass on.
fn layer<'a>(source: &'a Source, in_crate: &'a str) -> Option<&'a str> {
    match (in_crate, source.path.as_str()) {
        ("springfit_shipped", _) => Some("shipped"),
        ("springfit_page", _) => Some("page"),
        ("springfit_scenes", path) if path != "lib.rs" => Some("scene"),
        ("springfit_multigrid" | "springfit_numerics", "lib.rs") => None,
        ("springfit_numerics", _) => Some("numerics"),
        ("springfit_multigrid", _) => Some("multigrid"),
        (PROGRAM, _) => Some("program"),
        (_, "lib.rs") => None,
        (_, path) => path.split(['/', '.']).next(),
    }
}

#[test]
fn imports_point_up_the_list_of_layers() {
    let sources = sources();
    let graph = Graph::of(&sources);
    for (file, source) in sources.iter().enumerate() {
        assert!(graph.crates.contains_key(&file), "{} is declared by no module", source.name());
    }
    let rank = |file: usize| {
        let source = &sources[file];
        let layer = layer(source, &graph.crates[&file])?;
        let rank = LAYERS.iter().position(|l| *l == layer);
        Some(rank.unwrap_or_else(|| panic!("{} is in no layer", source.name())))
    };
    for ((file, imported), path) in &graph.imports {
        if let (Some(own), Some(other)) = (rank(*file), rank(*imported)) {
            assert!(other <= own, "{} imports {path} of {}", sources[*file].name(), sources[*imported].name());
        }
    }
    let whole = sources.iter().any(|source| source.package == "element");
    assert!(graph.imports.len() > if whole { 800 } else { 20 }, "the imports were not found");
}

/// The circles, each as the names of its files, with the imports that lead from one of them back to itself.
fn circles(sources: &[Source]) -> Vec<(BTreeSet<String>, String)> {
    let graph = Graph::of(sources);
    let describe = |circle: BTreeSet<usize>| {
        let files: BTreeSet<String> = circle.iter().map(|&file| sources[file].name()).collect();
        let way = circle.iter().map(|&file| graph.way_back(file)).min_by_key(Vec::len).expect("a circle has files");
        let import = |edge: &(usize, usize)| {
            format!("    {} imports {} of {}\n", sources[edge.0].name(), graph.imports[edge], sources[edge.1].name())
        };
        let text = format!("{files:?}\n{}", way.iter().rev().map(import).collect::<String>());
        (files, text)
    };
    graph.circles().into_iter().map(describe).collect()
}

#[test]
fn files_do_not_import_each_other_in_a_circle() {
    let sources = sources();
    let found = circles(&sources);
    let circles: String = found.iter().map(|(_, text)| format!("{text}\n")).collect();
    assert!(circles.is_empty(), "files import each other in a circle:\n{circles}");
}

fn circle_of(sources: &[(&str, &str, &str)]) -> Vec<Vec<String>> {
    let sources: Vec<Source> = sources.iter().map(|(package, path, text)| Source::new(package, path, text)).collect();
    circles(&sources).into_iter().map(|(files, _)| files.into_iter().collect()).collect()
}

const ROOT: (&str, &str, &str) = ("a", "lib.rs", "pub mod m; pub mod n;");

#[test]
fn a_circle_is_found_through_a_re_export() {
    let m = ("a", "m/mod.rs", "mod p; mod q; pub use p::Wide as P; pub(crate) use self::q::*;");
    let p = ("a", "m/p.rs", "use crate::m::Q; pub struct Wide(Q);");
    let q = ("a", "m/q.rs", "pub struct Q; fn f() { let s = \"// }\"; super::P::new('}'); }");
    let n = ("a", "n.rs", "use crate::{error::Error, m::{self, P}}; fn f(q: m::Q) {}");
    assert_eq!(circle_of(&[ROOT, m, p, q, n]), [["a/m/p.rs", "a/m/q.rs"]]);
    // The other way is only in a comment, a text, a test, or the crate of another.
    let q = "pub struct Q; /* super::P /* */ */ const T: &str = r#\"super::P\"#; #[cfg(test)] mod tests { use super::super::P; }";
    assert!(circle_of(&[ROOT, m, p, ("a", "m/q.rs", q), n]).is_empty());
}

#[test]
fn a_circle_is_found_through_super_and_inline_modules() {
    let m = ("a", "m.rs", "mod deep; pub fn f() { deep::g() }");
    let deep = ("a", "m/deep.rs", "pub fn g() {} mod inner { fn h<'a>(x: &'a u8) { super::super::f() } }");
    let n = ("a", "n.rs", "pub use super::m::f;");
    assert_eq!(circle_of(&[ROOT, m, deep, n]), [["a/m.rs", "a/m/deep.rs"]]);
    // A parent that only declares and passes on is transparent.
    let m = ("a", "m.rs", "mod deep; pub use deep::f;");
    let deep = ("a", "m/deep.rs", "pub fn f() { super::f() }");
    assert!(circle_of(&[ROOT, m, deep, n]).is_empty());
}

#[test]
fn a_circle_is_found_through_a_layer_that_a_crate_imports_again() {
    let below = ("b", "lib.rs", "pub mod base;");
    let base = ("b", "base.rs", "pub struct Base;");
    let root = ("a", "lib.rs", "pub mod m; pub mod n; use springfit_b::base;");
    let m = ("a", "m.rs", "use crate::base::Base; use crate::n::{N as Other};");
    let n = ("a", "n.rs", "use springfit_b::base; pub struct N(base::Base, crate::m::Missing);");
    assert_eq!(circle_of(&[below, base, root, m, n]), [["a/m.rs", "a/n.rs"]]);
}

#[test]
fn no_source_names_a_shipped_element() {
    for source in sources().into_iter().filter(|source| source.path != "lib.rs") {
        for element in SHIPPED {
            let word = |w: &str| w == element.name;
            // The examples of help texts are typed by people, who know elements by name.
            let examples = source.text.split_once("const EXAMPLES").and_then(|(_, rest)| rest.split_once("\";\n"));
            let text = examples.map_or(source.text.clone(), |(examples, _)| source.text.replace(examples, ""));
            // So are those of the documentation, and comments say of which elements something was measured.
            let text: String =
                text.lines().filter(|line| !line.trim().starts_with("//")).collect::<Vec<_>>().join("\n");
            let named = text.split(|c: char| !c.is_alphanumeric() && c != '_').any(word);
            assert!(!named, "{} names {}", source.name(), element.name);
        }
    }
}

/// The lines of code of a source: those that are not blank and no comment.
fn code(text: &str) -> usize {
    text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with("//")).count()
}

/// A package is a room: a reader can know what is in it.
#[test]
fn packages_stay_small() {
    let mut packages: BTreeMap<String, usize> = BTreeMap::new();
    for source in sources() {
        *packages.entry(source.package).or_default() += code(&source.text);
    }
    for (package, lines) in packages {
        assert!(lines <= 15_000, "crates/{package} has {lines} lines of code");
    }
}

/// What the library passes on, by module: each name is one that a user may need.
#[test]
fn the_library_has_few_names() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut names = BTreeSet::new();
    for path in files(&root) {
        let text = std::fs::read_to_string(&path).unwrap();
        for item in text.split("\npub use springfit_").skip(1).chain(text.split("    pub use springfit_").skip(1)) {
            let item = item.split(';').next().unwrap();
            let (room, list) = item.rsplit_once("::{").or_else(|| item.rsplit_once("::")).unwrap();
            names.extend(list.trim_end_matches('}').split(',').map(|name| format!("{room}::{}", name.trim())));
        }
    }
    names.retain(|name| !name.ends_with("::"));
    assert!((300..=350).contains(&names.len()), "{} names", names.len());
}

#[test]
fn files_stay_small() {
    for source in sources() {
        let lines = source.text.lines().count();
        assert!(lines <= 400, "{} has {lines} lines", source.name());
    }
}
