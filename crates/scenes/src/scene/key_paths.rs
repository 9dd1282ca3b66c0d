//! Where keys of a scene are, for those that are written in the wrong place.

use super::entry::scene_schema;
use crate::error::Error;
use serde_json::Value;
use std::collections::VecDeque;
use std::sync::LazyLock;

/// Tables inside tables that are looked into; no key of a scene is deeper.
const DEEPEST: usize = 5;
/// Places that are named at most.
const MOST: usize = 3;

/// Says in the error of an unknown key which table of the scene has it: `; did you mean "material.poisson"?`. `key` is the whole path that was
/// written; a name that is misspelt has a suggestion already, which gets the path around it.
pub(super) fn led(error: Error, key: &str) -> Error {
    const MEANT: &str = "; did you mean \"";
    let problem = error.problem();
    if !problem.starts_with("unknown field") {
        return error;
    }
    let wrong = error.key().unwrap_or(key).to_string();
    if let Some((before, name)) = problem.split_once(MEANT) {
        let around = wrong.rsplit_once('.').map_or(String::new(), |(around, _)| format!("{around}."));
        let inside = key.strip_prefix(&*wrong).unwrap_or_default();
        let name = name.trim_end_matches("\"?");
        let whole = Error::new(format!("{before}{MEANT}{around}{name}{inside}\"?"));
        return whole.of_kind(error.kind()).at_key(wrong);
    }
    // The last name of the path is what is sought: `poisson` of `poisson`, and of `body.poisson`.
    let name = key.rsplit('.').next().unwrap_or(key);
    let name = name.split('[').next().unwrap_or(name);
    let places: Vec<String> = paths_of(name).into_iter().map(|path| format!("\"{path}\"")).collect();
    match &places[..] {
        [] => error,
        [one] => error.followed_by(format!("; did you mean {one}?")),
        several => error.followed_by(format!("; did you mean one of {}?", several.join(", "))),
    }
}

/// The paths of the keys of a scene with this name that are in the fewest tables; entries of lists have the number 0.
fn paths_of(name: &str) -> Vec<String> {
    // It is made once: programs read many scenes.
    static SCENE: LazyLock<Value> = LazyLock::new(scene_schema);
    let root: &Value = &SCENE;
    let mut found = Vec::new();
    let mut left = VecDeque::from([(String::new(), root, 0)]);
    while let Some((path, schema, depth)) = left.pop_front() {
        for table in tables(schema, root) {
            let Some(keys) = table["properties"].as_object() else { continue };
            for (key, inner) in keys {
                let own = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                if key == name && !found.contains(&own) {
                    found.push(own.clone());
                }
                if depth < DEEPEST {
                    let is_list = is_list(inner, root);
                    left.push_back((if is_list { format!("{own}[0]") } else { own }, inner, depth + 1));
                }
            }
        }
    }
    let depth = |path: &String| path.matches('.').count();
    let least = found.iter().map(depth).min();
    found.retain(|path| Some(depth(path)) == least);
    found.truncate(MOST);
    found
}

/// What a schema stands for, behind references.
fn resolved<'a>(schema: &'a Value, root: &'a Value) -> &'a Value {
    let reference = schema["$ref"].as_str().and_then(|reference| root.pointer(reference.trim_start_matches('#')));
    reference.unwrap_or(schema)
}

/// The alternatives of a schema, or it alone.
fn alternatives<'a>(schema: &'a Value, root: &'a Value) -> Vec<&'a Value> {
    let schema = resolved(schema, root);
    let lists = ["anyOf", "oneOf"].into_iter().filter_map(|key| schema[key].as_array());
    let all: Vec<&Value> = lists.flatten().map(|one| resolved(one, root)).collect();
    if all.is_empty() { vec![schema] } else { all }
}

/// The tables that a value of this schema may be, or may be a list of.
fn tables<'a>(schema: &'a Value, root: &'a Value) -> Vec<&'a Value> {
    let own = alternatives(schema, root).into_iter();
    own.flat_map(|one| match one.get("items") {
        Some(items) => alternatives(items, root),
        None => vec![one],
    })
    .collect()
}

/// Whether a value is a list of tables, and never one alone.
fn is_list(schema: &Value, root: &Value) -> bool {
    alternatives(schema, root).into_iter().filter(|one| one["type"] != "null").all(|one| one["type"] == "array")
}
