//! The tables of the reference list what the program knows, no more and no less.

use super::markdown::{Page, page};
use springfit_element::element::{SHIPPED, SpringKind};
use springfit_studies::study::{Scene, run};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

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

fn compare(what: &str, page: &Names, program: &Names) {
    let missing: Vec<_> = program.difference(page).collect();
    let stale: Vec<_> = page.difference(program).collect();
    assert!(
        missing.is_empty() && stale.is_empty(),
        "{what}: not on the page {missing:?}, not in the program {stale:?}"
    );
}

#[test]
fn the_page_of_elements_has_every_shipped_one() {
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
    use springfit_foundation::quantity::Quantity;
    let text = page("docs/src/reference/meshes.md").text;
    let quantities = [
        ("length, mesh unit", Quantity::Length),
        ("area", Quantity::Area),
        ("pressure", Quantity::Pressure),
        ("density", Quantity::Density),
        ("time", Quantity::Time),
        ("force", Quantity::Force),
        ("moment", Quantity::Moment),
        ("acceleration", Quantity::Acceleration),
        ("force density", Quantity::ForceDensity),
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
fn the_page_of_outputs_has_every_kind_of_spring() {
    let tables = columns(&page("docs/src/reference/outputs.md"));
    let kinds: Names = SpringKind::all().map(|kind| kind.name().to_string()).collect();
    compare("kinds", &tables["What a spring does"], &kinds);
}

#[test]
fn the_page_of_exports_has_every_program() {
    let tables = columns(&page("docs/src/reference/exports.md"));
    let known = springfit::export::TARGETS.iter().map(|target| target.name.to_string()).collect();
    compare("programs", &tables["Networks in other programs"], &known);
}
