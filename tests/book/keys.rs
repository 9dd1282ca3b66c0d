//! What a key means is a sentence beside its field: the schemas have these sentences, and the reference has the tables that are made of them.

use super::markdown::{Page, page};
use serde_json::Value;
use springfit_element::{element, material};
use springfit_report::report;
use springfit_studies::study;
use std::path::Path;
use std::process::Command;

/// The kinds of files, and the pages that have the tables of their keys.
const PAGES: [(&str, &str); 6] = [
    ("scene", "scene.md"),
    ("compare", "comparison.md"),
    ("element", "elements.md"),
    ("material", "materials.md"),
    ("network", "outputs.md"),
    ("report", "report.md"),
];

fn schema(kind: &str) -> Value {
    match kind {
        "scene" => study::scene_schema(),
        "compare" => study::compare_schema(),
        "element" => element::schema(),
        "material" => material::schema(),
        "network" => report::network_schema(),
        "report" => report::schema(),
        other => panic!("{other}"),
    }
}

/// Visits each table of keys below a value of a schema.
fn visit(value: &Value, see: &mut impl FnMut(&Value)) {
    if value["properties"].is_object() {
        see(value);
    }
    match value {
        Value::Object(members) => members.values().for_each(|member| visit(member, see)),
        Value::Array(list) => list.iter().for_each(|member| visit(member, see)),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

#[test]
fn every_key_has_a_sentence() {
    for (kind, least) in
        [("scene", 200), ("compare", 15), ("element", 30), ("material", 7), ("network", 90), ("report", 290)]
    {
        let (mut keys, mut wrong) = (0, Vec::new());
        visit(&schema(kind), &mut |table| {
            for (key, property) in table["properties"].as_object().unwrap() {
                let words = property["description"].as_str().unwrap_or_default();
                let begins = words.starts_with(|c: char| c.is_uppercase() || c == '`');
                let is_part = ["Of ", "As ", "The same"].iter().any(|begin| words.starts_with(begin));
                keys += 1;
                if !begins || is_part || !words.ends_with('.') {
                    wrong.push(format!("{key}: \"{words}\""));
                }
            }
        });
        assert!(wrong.is_empty() && keys >= least, "{kind}: {keys} keys, {wrong:#?}");
    }
}

/// A schema and a reader are made of one structure; a structure that refuses unknown keys has them all in its schema.
#[test]
fn files_that_are_read_have_no_other_keys() {
    for kind in ["scene", "compare", "element", "material"] {
        visit(&schema(kind), &mut |table| {
            assert_eq!(table["additionalProperties"], false, "{kind}: {:?}", table["properties"]);
        });
    }
}

/// The keys of fits and of ranges are read by hand: an unknown one is refused with the list of those that are known.
#[test]
fn keys_that_are_read_by_hand_are_those_of_the_schema() {
    let schema = schema("scene");
    let own = |table: &Value| -> Vec<String> {
        let keys = table["properties"].as_object().unwrap().iter();
        keys.filter(|(_, key)| key.get("x-of").is_none()).map(|(key, _)| key.clone()).collect()
    };
    let kinds = schema["$defs"]["FitEntry"]["oneOf"].as_array().unwrap().iter();
    let fit = |kind: &Value| {
        let objective = kind["properties"]["objective"]["enum"][0].as_str().unwrap();
        (format!("[[fit]]\nobjective = \"{objective}\"\nzzz = 1\n"), own(kind))
    };
    let range = "[[fit]]\nobjective = \"exact\"\n[sweep.over]\nmaterial.young = { from = 1, to = 2, zzz = 1 }\n";
    let all: Vec<(String, Vec<String>)> =
        kinds.map(fit).chain([(range.to_string(), own(&schema["$defs"]["RangeEntry"]))]).collect();
    assert_eq!(all.len(), 6);
    let head = "[mesh]\nbox = { element = \"hex8\", size = [1, 1, 1], cells = [1, 1, 1] }\n[material]\nyoung = 1\npoisson = 0.3\n";
    for (text, known) in all {
        let error = study::Scene::parse(&format!("{head}{text}"), Path::new("scene.toml")).unwrap_err().to_string();
        let list = error.split_once("expected one of ").unwrap_or_else(|| panic!("{text}: {error}")).1;
        let list = list.split("; did").next().unwrap();
        let mut listed: Vec<&str> = list.split('"').skip(1).step_by(2).collect();
        listed.sort_unstable();
        assert_eq!(listed, known, "{text}");
    }
}

/// The tables that the program prints, by their titles.
fn printed(kind: &str) -> Vec<(String, String)> {
    let program = env!("CARGO_BIN_EXE_springfit");
    let output = Command::new(program).args(["schema", kind, "--markdown"]).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let tables = text.strip_prefix("## ").unwrap().split("\n## ");
    tables
        .map(|table| table.split_once("\n\n").unwrap())
        .map(|(title, rows)| (title.into(), rows.trim().into()))
        .collect()
}

/// `SPRINGFIT_WRITE_GOLDEN=1` writes them anew, as it writes golden files.
#[test]
fn the_reference_has_the_tables_of_keys_that_the_program_prints() {
    let is_written = std::env::var_os("SPRINGFIT_WRITE_GOLDEN").is_some_and(|value| !value.is_empty());
    for (kind, name) in PAGES {
        let mut page: Page = page(&format!("docs/src/reference/{name}"));
        let tables = printed(kind);
        assert!(!tables.is_empty(), "{kind}");
        for (title, table) in &tables {
            let head = format!("<!-- keys: {title} -->\n");
            let (before, rest) = page.text.split_once(&head).unwrap_or_else(|| panic!("{name} has no table {title}"));
            let heading = before.trim_end().lines().rev().find(|line| line.starts_with('#')).unwrap();
            assert!(
                kind == "material" || heading.trim_start_matches('#').trim() == title,
                "{name}: {title} is below {heading}"
            );
            let (found, after) =
                rest.split_once("\n<!-- /keys -->").unwrap_or_else(|| panic!("{name}: {title} has no end"));
            if is_written && found != table {
                page.text = format!("{before}{head}{table}\n<!-- /keys -->{after}");
                std::fs::write(&page.path, &page.text).unwrap();
                continue;
            }
            assert_eq!(found, table, "{name}: {title}; SPRINGFIT_WRITE_GOLDEN=1 writes it anew");
        }
        let marks: Vec<&str> = page.text.lines().filter(|line| line.starts_with("<!-- keys: ")).collect();
        assert_eq!(marks.len(), tables.len(), "{name}: {marks:?}");
    }
}
