//! The tables of the reference list what the program knows, no more and no less.

use super::markdown::{Page, page};
use crate::report::{LARGE, LINEAR, reports};
use serde_json::Value;
use springfit::element::{Element, SHIPPED, SpringKind};
use springfit::report::{open_scene_outputs, write_outputs};
use springfit::study::{Scene, run};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

type Names = BTreeSet<String>;

/// The names in the first column of the tables below each heading, by the heading's words.
fn columns(page: &Page) -> BTreeMap<String, Names> {
    let mut found: BTreeMap<String, Names> = BTreeMap::new();
    let mut heading = String::new();
    for line in page.text.lines() {
        if line.starts_with('#') {
            heading = line.trim_start_matches('#').trim().to_string();
        }
        let Some(first) = line.strip_prefix("| `").and_then(|rest| rest.split(" | ").next()) else { continue };
        let names = first.split('`').step_by(2).filter(|name| !name.is_empty()).map(String::from);
        found.entry(heading.clone()).or_default().extend(names);
    }
    found
}

/// The words between quotes after "expected".
fn expected(error: &str) -> Names {
    let list = error.split_once("expected").unwrap_or_else(|| panic!("{error}")).1.split("; did").next().unwrap();
    list.split('"').skip(1).step_by(2).map(String::from).collect()
}

fn compare(what: &str, page: &Names, program: &Names) {
    let missing: Vec<_> = program.difference(page).collect();
    let stale: Vec<_> = page.difference(program).collect();
    assert!(
        missing.is_empty() && stale.is_empty(),
        "{what}: not on the page {missing:?}, not in the program {stale:?}"
    );
}

/// A scene in which only the table with the key `zzz` is wrong.
fn scene_with(table: &str) -> String {
    let box_of = |more: &str| format!("box = {{ element = \"hex8\", size = [1, 1, 1], cells = [1, 1, 1]{more} }}");
    let fit = |objective: &str, more: &str| format!("[[fit]]\nobjective = \"{objective}\"\n{more}\n");
    let [mut head, mut mesh, mut young, mut fits, mut rest] =
        [String::new(), box_of(""), "young = 1\npoisson = 0.3\n".into(), fit("exact", ""), String::new()];
    let zzz = "zzz = 1\n";
    match table {
        "scene" => head = zzz.into(),
        "mesh" => mesh = mesh + "\n" + zzz,
        "mesh box" => mesh = box_of(", zzz = 1"),
        "mesh fill" => mesh = "fill = { zzz = 1 }\n".into(),
        "mesh disc" => mesh = "disc = { zzz = 1 }\n".into(),
        "mesh quality" => mesh = "file = \"a.msh\"\nquality = { zzz = 1 }\n".into(),
        "material" => young += zzz,
        "material data" => young = "young = { zzz = 1 }\npoisson = 0.3\n".into(),
        "material orthotropic" | "material transversely-isotropic" | "material cubic" => {
            young = format!("{} = {{ zzz = 1 }}\n", &table[9..]);
        }
        "fit frobenius" => fits = fit("frobenius", zzz),
        "fit exact" => fits = fit("exact", zzz),
        "fit sampled" => fits = fit("sampled", zzz),
        "fit sampled shapes" => fits = fit("sampled", "shapes = { zzz = 1 }"),
        "fit whole" => fits = fit("whole", zzz),
        "load measured" => rest = "[[load]]\nmeasured = { zzz = 1 }\n".into(),
        "motion" => rest = "[motion]\nduration = 1\nstep = 1\nzzz = 1\n".into(),
        "motion damping" | "motion watch" => {
            rest = format!("[motion]\nduration = 1\nstep = 1\n{} = {{ zzz = 1 }}\n", &table[7..]);
        }
        "motion pull" | "motion force" => {
            rest = format!("[motion]\nduration = 1\nstep = 1\n[[motion.{}]]\nzzz = 1\n", &table[7..]);
        }
        "reference" => rest = "[reference]\nrefine = 1\nzzz = 1\n".into(),
        "fix" | "load" => rest = format!("[[{table}]]\n{zzz}"),
        "sweep" => rest = format!("[sweep]\nover = {{}}\n{zzz}"),
        "sweep range" => rest = "[sweep.over]\nmaterial.young = { from = 1, to = 2, zzz = 1 }\n".into(),
        "newton" | "solver" | "gauge" | "output" => rest = format!("[{table}]\n{zzz}"),
        other => panic!("{other}"),
    }
    format!("{head}[mesh]\n{mesh}\n[material]\n{young}{fits}{rest}")
}

#[test]
fn the_page_of_scenes_has_every_key() {
    let tables = columns(&page("docs/src/reference/scene.md"));
    let common = tables["fit"].clone();
    for (table, names) in tables.iter().filter(|(table, _)| *table != "fit") {
        let error = Scene::parse(&scene_with(table), Path::new("scene.toml")).unwrap_err().to_string();
        assert!(error.contains("\"zzz\""), "{table}: {error}");
        let mut known = expected(&error);
        if table.starts_with("fit") && !table.ends_with("shapes") {
            assert!(common.is_subset(&known), "{error}");
            known = known.difference(&common).cloned().collect();
        }
        compare(table, names, &known);
    }
    assert_eq!(tables.len(), 32);
}

#[test]
fn the_page_of_elements_has_every_key() {
    let tables = columns(&page("docs/src/reference/elements.md"));
    let quad4 = std::fs::read_to_string(super::markdown::root().join("elements/quad4.toml")).unwrap();
    let wrong = [
        ("element", format!("zzz = 1\n{quad4}")),
        ("nodes", quad4.replacen("at = [-1, -1]", "zzz = 1, at = [-1, -1]", 1)),
        ("springs", quad4.replacen("[[springs]]", "[[springs]]\nzzz = 1", 1)),
    ];
    for (table, text) in wrong {
        let error = Element::parse(&text).unwrap_err().to_string();
        assert!(error.contains("\"zzz\""), "{table}: {error}");
        compare(table, &tables[table], &expected(&error));
    }
    let text = page("docs/src/reference/elements.md").text;
    for file in SHIPPED {
        let name = file.name;
        assert!(text.contains(&format!("`{name}`")), "{name}");
    }
}

#[test]
fn the_page_of_springs_has_every_kind() {
    let text = page("docs/src/reference/springs.md").text;
    let names = columns(&page("docs/src/reference/springs.md"))["Kinds of springs"].clone();
    compare("kinds", &names, &SpringKind::all().map(|kind| kind.name().to_string()).collect());
    for kind in SpringKind::all().filter(|kind| kind.properties().in_element_files) {
        let row = text.lines().find(|line| line.starts_with(&format!("| `{}` |", kind.name()))).unwrap();
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let own = kind.properties();
        let nodes = if own.nodes.start() == own.nodes.end() {
            own.nodes.start().to_string()
        } else {
            format!("{} to {}", own.nodes.start(), own.nodes.end())
        };
        let nodes = nodes + if own.content.is_some() { ", or none" } else { "" };
        assert_eq!([cells[1], cells[2], cells[4]], [&nodes, &own.least_dimension.to_string(), own.unit], "{row}");
    }
}

/// The names that an error lists after "one of", as words.
fn listed(error: &str) -> Names {
    let list =
        error.split_once("one of ").unwrap().1.split(", found").next().unwrap().split(", or a path").next().unwrap();
    list.split(", ").map(String::from).collect()
}

#[test]
fn the_pages_of_objectives_and_materials_have_every_name() {
    let refusal = |material: &str, objective: &str| {
        let text = format!(
            "[mesh]\nbox = {{ element = \"hex8\", size = [1, 1, 1], cells = [1, 1, 1] }}\n[material]\nyoung = 1\npoisson = 0.3\n{material}[[fit]]\nobjective = \"{objective}\"\n"
        );
        let scene = Scene::parse(&text, Path::new("scene.toml"));
        scene.and_then(|scene| run(&scene, &mut |_| ())).unwrap_err().to_string()
    };
    let objectives = columns(&page("docs/src/reference/objectives.md"));
    let known = listed(&refusal("", "zzz"));
    let names = objectives["Objectives"].union(&objectives["Published formulas"]).cloned().collect();
    compare("objectives", &names, &known);
    let laws = columns(&page("docs/src/reference/materials.md"))["Shipped laws"].clone();
    compare("laws", &laws, &listed(&refusal("law = \"zzz\"\n", "exact")));
}

/// Keys by the path of the table that has them; tables in lists count once.
fn keys(value: &Value, path: &str, found: &mut BTreeMap<String, Names>) {
    match value {
        Value::Object(table) => {
            for (key, value) in table {
                found.entry(path.into()).or_default().insert(key.clone());
                // Names of parameters and of groups are those of the user.
                if !["bounds", "force"].contains(&key.as_str()) {
                    keys(value, &format!("{path}.{key}"), found);
                }
            }
        }
        Value::Array(list) => list.iter().for_each(|value| keys(value, path, found)),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

/// A distorted box, some of whose springs push.
const POSITIVE: &str = "[mesh]\nfile = \"scenes/meshes/cube_tet.msh\"\nscale = 0.01\n[material]\nyoung = 1\npoisson = 0.3\n[[fit]]\nobjective = \
                        \"exact\"\nnonnegative = true\n[[fit]]\nobjective = \"frobenius\"\nrest = \"free\"\n[[fix]]\ngroup = \"fixed\"\n";

/// With errors of a whole-object fit under other loads, moduli, and masses.
const COARSE: &str = "[mesh]\nbox = { element = \"hex8\", size = [2, 1, 1], cells = [2, 1, 1] }\n[material]\nyoung = 1\npoisson = 0.3\ndensity = 1\n\
                      [reference]\nrefine = 1\n[[fit]]\nobjective = \"whole\"\nstart = \"exact\"\nunknowns = \"body-moduli\"\nmasses = 2\n[[fix]]\n\
                      group = \"xmin\"\n";

#[test]
fn the_page_of_the_report_has_every_key() {
    let mut found = BTreeMap::new();
    for text in [LINEAR, LARGE] {
        keys(&reports(text).0, "report", &mut found);
    }
    let scene = Scene::parse(POSITIVE, &super::markdown::root().join("scene.toml")).unwrap();
    // The file, which also has the names of the files of its run.
    let folder = TempDir::new().unwrap();
    write_outputs(
        &run(&scene, &mut |_| {}).unwrap(),
        scene.output(),
        open_scene_outputs(&scene, folder.path()).unwrap(),
    )
    .unwrap();
    let text = std::fs::read_to_string(folder.path().join("report.json")).unwrap();
    keys(&serde_json::from_str(&text).unwrap(), "report", &mut found);
    let scene = Scene::parse(COARSE, &super::markdown::root().join("scene.toml")).unwrap();
    let outcome = springfit::study::run(&scene, &mut |_| {}).unwrap();
    keys(&serde_json::from_str(&springfit::report::report(&outcome)).unwrap(), "report", &mut found);
    let tables = columns(&page("docs/src/reference/report.md"));
    // Tables of the same keys are on the page once; a sampled start has the settings of a sampled fit.
    let same = [
        ("fits.relative_spectral", "fits.relative_frobenius"),
        ("fits.sampled.trained", "fits.relative_frobenius"),
        ("fits.sampled.held_out", "fits.relative_frobenius"),
        ("fits.tension.rest_lengths", "fits.relative_frobenius"),
        ("fits.whole.relative_errors_validated", "fits.whole.relative_errors_fitted"),
        ("fits.loads.followed", "loads_followed"),
        ("fits.loads.gauge", "gauge"),
        ("fits.loads.solver_lem", "fits.loads.solver_fem"),
        ("fits.start", "fits"),
    ];
    let mut seen = BTreeSet::new();
    for (path, names) in found {
        let path = path.strip_prefix("report").unwrap().trim_start_matches('.');
        let path = if path.is_empty() { "report" } else { path };
        let heading = same.iter().find(|(own, _)| *own == path).map_or(path, |(_, other)| *other);
        let known = tables.get(heading).unwrap_or_else(|| panic!("no table for {path}: {names:?}"));
        let missing: Vec<_> = names.difference(known).collect();
        assert!(missing.is_empty(), "{path}: {missing:?}");
        if path == heading {
            // What a scene has not measured is null, and its keys are not seen.
            assert!(known.iter().all(|key| names.contains(key)), "{path}: {:?}", known.difference(&names));
        }
        seen.insert(heading.to_string());
    }
    let unseen: Vec<_> = tables.keys().filter(|table| !seen.contains(*table)).collect();
    assert!(unseen.iter().all(|table| ["measured"].contains(&table.as_str())), "{unseen:?}");
}

#[test]
fn the_page_of_the_command_line_has_every_command_and_option() {
    let help = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_springfit")).args(arguments).arg("--help").output().unwrap();
        String::from_utf8(output.stdout).unwrap()
    };
    let page = page("docs/src/reference/command-line.md");
    let general = help(&[]);
    let listed = general.split_once("Commands:\n").unwrap().1.split("\n\n").next().unwrap();
    // Long descriptions go on in lines that are indented further.
    let names = listed.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let commands: Vec<&str> =
        names.filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help").collect();
    let sections: BTreeMap<&str, &str> =
        page.text.split("\n## ").skip(1).filter_map(|section| section.split_once('\n')).collect();
    let options = |text: &str| -> Names {
        let words = text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-'));
        words.filter(|word| word.starts_with("--") && word.len() > 3).map(String::from).collect()
    };
    let rows = |section: &str| -> Names {
        let rows = section.lines().filter(|line| line.starts_with("| `-"));
        rows.flat_map(|line| options(line.split(" | ").next().unwrap())).collect()
    };
    let common = rows(sections["Options of many commands"]);
    assert!(common.iter().all(|option| help(&["run"]).contains(option.as_str())), "{common:?}");
    for command in &commands {
        let section = sections.get(command).unwrap_or_else(|| panic!("no section for {command}"));
        let mut known: Names = help(&[command])
            .lines()
            .filter(|line| line.trim_start().starts_with('-'))
            .flat_map(|line| options(line.split("  ").find(|part| part.contains("--")).unwrap_or("")))
            .collect();
        known.retain(|option| option != "--help" && !common.contains(option));
        compare(command, &rows(section), &known);
    }
}

#[test]
fn the_page_of_meshes_has_the_units_that_are_read() {
    use springfit::quantity::Quantity;
    let text = page("docs/src/reference/meshes.md").text;
    let quantities = [
        ("length, mesh unit", Quantity::Length),
        ("area", Quantity::Area),
        ("pressure", Quantity::Pressure),
        ("density", Quantity::Density),
        ("time", Quantity::Time),
    ];
    for (name, quantity) in quantities {
        let row = text.lines().find(|line| line.starts_with(&format!("| {name} |"))).unwrap();
        let units: Vec<&str> =
            row.split('`').skip(1).step_by(2).filter(|unit| unit.chars().count() > 1 || unit.is_ascii()).collect();
        assert!(units.len() > 1);
        units.iter().for_each(|unit| assert!(quantity.parse(&format!("2 {unit}")).is_ok(), "{unit}"));
    }
}

#[test]
fn the_page_of_outputs_has_every_key_of_a_network() {
    let schema = springfit::report::network_schema();
    let tables = columns(&page("docs/src/reference/outputs.md"));
    let keys = |table: &Value| -> Names { table["properties"].as_object().unwrap().keys().cloned().collect() };
    compare("network", &tables["network"], &keys(&schema));
    let records = [
        ("springs", "SpringRecord"),
        ("measures", "MeasureRecord"),
        ("cells", "CellBlockRecord"),
        ("groups", "OriginRecord"),
        ("held", "HeldRecord"),
        ("loads", "NodalLoadRecord"),
        ("damping", "NetworkDampingRecord"),
        ("motion", "DriveRecord"),
        ("provenance", "ProvenanceRecord"),
    ];
    for (heading, record) in records {
        compare(heading, &tables[heading], &keys(&schema["$defs"][record]));
    }
    let kinds: Names = SpringKind::all().map(|kind| kind.name().to_string()).collect();
    compare("kinds", &tables["What a spring does"], &kinds);
}

#[test]
fn the_page_of_exports_has_every_program() {
    let tables = columns(&page("docs/src/reference/exports.md"));
    let known = springfit::export::TARGETS.iter().map(|target| target.name.to_string()).collect();
    compare("programs", &tables["Networks in other programs"], &known);
}
