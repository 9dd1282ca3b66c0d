//! The JSON Schemas: every shipped file satisfies that of its kind, and what a reader refuses, a schema refuses as well.

use crate::kit::{files_of, place};
use serde_json::{Value, json};
use springfit_element::{element, material};
use springfit_report::report;
use springfit_studies::study;
use std::fs;
use std::path::{Path, PathBuf};

/// What is wrong with a value, by the keywords that our schemas use; an unknown keyword is a fault of the test.
fn faults(schema: &Value, root: &Value, value: &Value, place: &str) -> Vec<String> {
    let Some(schema) = schema.as_object() else {
        return if schema == &json!(false) { vec![format!("{place}: not allowed")] } else { Vec::new() };
    };
    let mut found = Vec::new();
    let mut fault = |words: String| found.push(format!("{place}: {words}"));
    let alternatives = |list: &Value| {
        let all = list.as_array().unwrap();
        all.iter().map(|schema| faults(schema, root, value, place)).collect::<Vec<_>>()
    };
    let mut inner = Vec::new();
    for (keyword, rule) in schema {
        match keyword.as_str() {
            "$schema" | "x-type" | "x-unit" | "x-default" | "x-of" | "title" | "description" | "default" | "$defs"
            | "format" | "required" | "properties" => {}
            "$ref" => {
                let target =
                    root.pointer(rule.as_str().unwrap().trim_start_matches('#')).expect("the definition is there");
                inner.extend(faults(target, root, value, place));
            }
            "type" => {
                let names: Vec<&str> = rule.as_array().map_or_else(
                    || vec![rule.as_str().unwrap()],
                    |list| list.iter().map(|n| n.as_str().unwrap()).collect(),
                );
                if !names.iter().any(|name| is_of_type(value, name)) {
                    fault(format!("expected {names:?}, found {value}"));
                }
            }
            "enum" => {
                if !rule.as_array().unwrap().contains(value) {
                    fault(format!("expected {rule}, found {value}"))
                }
            }
            "const" => {
                if rule != value {
                    fault(format!("expected {rule}, found {value}"))
                }
            }
            "minimum" => {
                if value.as_f64().is_some_and(|v| v < rule.as_f64().unwrap()) {
                    fault(format!("{value} is below {rule}"))
                }
            }
            "maximum" => {
                if value.as_f64().is_some_and(|v| v > rule.as_f64().unwrap()) {
                    fault(format!("{value} is above {rule}"))
                }
            }
            "minItems" => {
                if value.as_array().is_some_and(|v| (v.len() as u64) < rule.as_u64().unwrap()) {
                    fault("too few items".into())
                }
            }
            "maxItems" => {
                if value.as_array().is_some_and(|v| v.len() as u64 > rule.as_u64().unwrap()) {
                    fault("too many items".into())
                }
            }
            "items" => {
                let items = value.as_array().into_iter().flatten().enumerate();
                inner.extend(items.flat_map(|(i, item)| faults(rule, root, item, &format!("{place}[{i}]"))));
            }
            "additionalProperties" => {
                let known = schema.get("properties").and_then(Value::as_object);
                let others = value
                    .as_object()
                    .into_iter()
                    .flatten()
                    .filter(|(key, _)| !known.is_some_and(|known| known.contains_key(*key)));
                inner.extend(others.flat_map(|(key, value)| faults(rule, root, value, &format!("{place}.{key}"))));
            }
            "anyOf" => {
                if !alternatives(rule).iter().any(Vec::is_empty) {
                    fault(format!("no alternative: {:?}", alternatives(rule)))
                }
            }
            "oneOf" => {
                if alternatives(rule).iter().filter(|faults| faults.is_empty()).count() != 1 {
                    fault(format!("not one alternative: {:?}", alternatives(rule)))
                }
            }
            other => panic!("the test does not know the keyword {other}"),
        }
    }
    if let Some(object) = value.as_object() {
        let required = schema.get("required").and_then(Value::as_array).into_iter().flatten();
        let missing: Vec<_> = required.filter(|key| !object.contains_key(key.as_str().unwrap())).collect();
        if !missing.is_empty() {
            fault(format!("{missing:?} are missing"));
        }
        let properties = schema.get("properties").and_then(Value::as_object).into_iter().flatten();
        for (key, rule) in properties {
            inner.extend(
                object.get(key).into_iter().flat_map(|value| faults(rule, root, value, &format!("{place}.{key}"))),
            );
        }
    }
    found.extend(inner);
    found
}

fn is_of_type(value: &Value, name: &str) -> bool {
    match name {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "object" => value.is_object(),
        "array" => value.is_array(),
        "number" => value.is_number(),
        "string" => value.is_string(),
        "integer" => value.as_f64().is_some_and(|v| v.fract() == 0.0),
        other => panic!("{other} is no type"),
    }
}

fn value(text: &str) -> Value {
    serde_json::to_value(text.parse::<toml::Table>().unwrap()).unwrap()
}

#[test]
fn every_shipped_file_satisfies_its_schema() {
    for (schema, folders, least) in [
        (study::scene_schema(), &["scenes"][..], 30),
        (element::schema(), &["elements", "examples/elements"], 20),
        (material::schema(), &["materials"], 10),
    ] {
        let mut all: Vec<PathBuf> = folders.iter().flat_map(|folder| files_of(&place(folder), "toml")).collect();
        // An index of experiments has a schema of its own.
        all.retain(|path| !path.ends_with("index.toml"));
        assert!(all.len() >= least, "{folders:?}");
        for path in all {
            let found = faults(&schema, &schema, &value(&fs::read_to_string(&path).unwrap()), "");
            assert!(found.is_empty(), "{}: {found:#?}", path.display());
        }
    }
}

/// A wrong key, type, name or a missing key is refused where the reader refuses it.
#[test]
fn a_schema_refuses_what_the_reader_refuses() {
    let schema = study::scene_schema();
    let scene = fs::read_to_string(place("scenes/cube_hex.toml")).unwrap();
    assert!(faults(&schema, &schema, &value(&scene), "").is_empty());
    for (from, to) in [
        ("poisson = 0.3", "posson = 0.3"),
        ("poisson = 0.3", "poisson = true"),
        ("element = \"hex8\", ", ""),
        ("\"frobenius\"", "\"frobenus\""),
        ("\"frobenius\"", "\"exact\"\nhigher = 0.3"),
        ("\"frobenius\"", "\"frobenius\"\nweight = \"moddal\""),
        ("higher    = 0.316", "higher = \"0.316\""),
        ("cells = [8, 8, 8]", "cells = 8"),
        ("group = \"zmin\"", "grup = \"zmin\""),
        ("traction = [1000, 0, 0]", "traction = [1000, 0, true]"),
    ] {
        assert!(scene.contains(from), "{from}");
        let scene = scene.replacen(from, to, 1);
        assert!(study::Scene::parse(&scene, Path::new("s.toml")).is_err(), "{to}");
        assert!(!faults(&schema, &schema, &value(&scene), "").is_empty(), "{to}");
    }
}

/// Keys have descriptions, which editors show.
#[test]
fn a_report_satisfies_its_schema() {
    let scene = study::Scene::load(&place("scenes/square_quad.toml")).unwrap();
    let outcome = study::run(&scene, &mut |_| ()).unwrap();
    let document = serde_json::from_str(&report::report(&outcome)).unwrap();
    let schema = report::schema();
    let found = faults(&schema, &schema, &document, "");
    assert!(found.is_empty(), "{found:#?}");
}

/// What is added to a table for a key that has a place in some of its kinds alone.
type Companions = &'static [(&'static str, &'static str)];

/// Tables whose keys have defaults in the schema, the beginning of a scene with each, and what single keys need besides.
const TABLES: [(&str, &str, Companions); 8] = [
    (
        "/$defs/FitEntry/oneOf/0",
        "[[fit]]",
        &[
            ("higher", "objective = \"modal\""),
            ("balance", "objective = \"divergence\""),
            ("gap", "objective = \"spectral\""),
            ("iterations", "objective = \"frobenius\"\nsolver = \"nelder-mead\""),
            ("sparsity", "objective = \"frobenius\"\nsolver = \"particle-swarm\"\ntopology = true"),
            ("", "objective = \"frobenius\""),
        ],
    ),
    (
        "/$defs/FitEntry/oneOf/1",
        "law = \"neo-hookean\"\n[[fit]]\nobjective = \"sampled\"",
        &[("huber", "norm = \"huber\""), ("starts", "force = \"k*(exp(a*s) - 1)\"")],
    ),
    ("/$defs/ShapesEntry", "law = \"neo-hookean\"\n[[fit]]\nobjective = \"sampled\"\n[fit.shapes]", &[]),
    (
        "/$defs/FitEntry/oneOf/2",
        "[[fix]]\nwhere = \"x < 1e-9\"\n[[fit]]\nobjective = \"whole\"",
        &[("shear", "start = \"exact\""), ("volume", "start = \"exact\"")],
    ),
    (
        "/$defs/FitEntry/oneOf/4",
        "[[fit]]\nobjective = \"exact\"",
        &[("share", "energy = \"stable-mooney-rivlin\""), ("across", "nonnegative = true")],
    ),
    ("/$defs/NewtonEntry", "law = \"neo-hookean\"\n[[fit]]\nobjective = \"exact\"\n[newton]", &[]),
    ("/$defs/SolverEntry", "[[fit]]\nobjective = \"exact\"\n[solver]", &[]),
    (
        "/$defs/MotionEntry",
        "density = 1\n[[fit]]\nobjective = \"exact\"\n[motion]\nduration = 1\nstep = 0.1",
        &[("remainder", "solver = \"conjugate-gradients\"")],
    ),
];

/// A default is written beside a key for the schema, and another time where the key is read: a scene that gives it is that which does not.
#[test]
fn a_default_of_the_schema_is_that_of_the_reader() {
    let schema = study::scene_schema();
    let mut tried = 0;
    for (table, head, companions) in TABLES {
        let read = |text: String| {
            let text = format!(
                "[mesh]\nbox = {{ element = \"hex8\", size = [1, 1, 1], cells = [1, 1, 1] }}\n[material]\nyoung = 1\npoisson = 0.3\n{text}"
            );
            let scene = study::Scene::parse(&text, Path::new("s.toml")).unwrap_or_else(|e| panic!("{e}\n{text}"));
            format!("{:?} {:?} {:?} {:?}", scene.fits(), scene.newton(), scene.solver(), scene.motion())
        };
        for (key, property) in schema.pointer(table).unwrap()["properties"].as_object().unwrap() {
            let default = &property["default"];
            let is_given = !default.is_null() && property.get("x-of").is_none();
            if !is_given || default.as_object().is_some() {
                continue;
            }
            let more = companions.iter().find(|(own, _)| own == key || own.is_empty()).map_or("", |(_, more)| more);
            let without = format!("{head}\n{more}\n");
            assert_eq!(read(format!("{without}{key} = {default}\n")), read(without), "{table}: {key}");
            tried += 1;
        }
    }
    assert!(tried >= 45, "{tried}");
}
