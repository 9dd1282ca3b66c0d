//! The tables of the reference: each key of a schema with its type, its default and its meaning, in Markdown.

use super::key_types::{KeyTypes, alternatives, has_keys, resolved};
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, VecDeque};
use std::fmt::Write;

/// The keys of one table of a kind of file.
#[derive(Debug, Clone, PartialEq)]
pub struct KeyTable {
    /// The path of the table, which is a heading of the reference.
    pub title: String,
    /// The titles of the columns, and the rows below them.
    pub rows: Vec<Vec<String>>,
}

/// A table of keys before it is written, with those that others of its kind have as well.
struct Found<'a> {
    title: String,
    schema: &'a Value,
    /// The keys that all alternatives of the table have.
    common: Map<String, Value>,
}

/// The tables of a schema, by their titles. A file that the program writes has all its keys, and values of them may be null; a file that
/// it reads has defaults.
pub fn key_tables(schema: &Value, name: &str, is_written: bool) -> Vec<KeyTable> {
    let (found, titles) = found(schema, if is_written { "." } else { " " });
    let types = KeyTypes { root: schema, titles: &titles, is_written };
    let mut tables: Vec<KeyTable> = found.iter().filter_map(|found| table(found, &types)).collect();
    tables.sort_by(|a, b| a.title.cmp(&b.title));
    tables.iter_mut().filter(|table| table.title.is_empty()).for_each(|table| table.title = name.into());
    tables
}

impl KeyTable {
    /// The table in Markdown, without its title.
    pub fn markdown(&self) -> String {
        let rule = format!("|{}\n", "---|".repeat(self.rows.first().map_or(0, Vec::len)));
        let line = |cells: &Vec<String>| format!("| {} |\n", cells.join(" | "));
        let (head, rows) = self.rows.split_at(1.min(self.rows.len()));
        head.iter().map(line).chain([rule]).chain(rows.iter().map(line)).collect()
    }
}

/// All tables in Markdown, each below its title.
pub fn key_tables_text(tables: &[KeyTable]) -> String {
    let mut text = String::new();
    for table in tables {
        writeln!(text, "## {}\n\n{}", table.title, table.markdown()).expect("a String grows");
    }
    text
}

/// The tables from the root on, those with short paths first, and the titles of the definitions.
fn found<'a>(root: &'a Value, separator: &str) -> (Vec<Found<'a>>, BTreeMap<&'a str, String>) {
    let (mut found, mut titles) = (Vec::new(), BTreeMap::new());
    let mut ahead = VecDeque::from([(root, String::new(), Map::new())]);
    while let Some((schema, title, taken)) = ahead.pop_front() {
        let others = alternatives(schema, root);
        let common = common(&others);
        for (reference, alternative) in others.iter().rev() {
            let title = format!("{title} {}", name_of(alternative).unwrap_or_default());
            titles.extend(reference.map(|reference| (reference, title.clone())));
            ahead.push_front((alternative, title, common.clone()));
        }
        for (key, property) in properties(schema) {
            for reference in references(property, root) {
                let definition = resolved(reference, root);
                let own = name_of(definition).unwrap_or(key);
                // What all alternatives have belongs to the table above them.
                let above = match title.rsplit_once(' ') {
                    Some((above, _)) if taken.contains_key(key) => above,
                    _ => &title,
                };
                let path = if above.is_empty() { own.to_string() } else { format!("{above}{separator}{own}") };
                if let std::collections::btree_map::Entry::Vacant(entry) = titles.entry(reference) {
                    ahead.push_back((definition, entry.insert(path).clone(), Map::new()));
                }
            }
        }
        // A key of all alternatives is in the table above them.
        let common = if taken.is_empty() { common } else { taken };
        found.push(Found { title, schema, common });
    }
    (found, titles)
}

/// The name of an alternative: its title, or the value of its tag.
fn name_of(schema: &Value) -> Option<&str> {
    let tag = || properties(schema).find_map(|(_, property)| property.get("const")?.as_str());
    schema.get("title").and_then(Value::as_str).or_else(tag)
}

fn properties(schema: &Value) -> impl Iterator<Item = (&str, &Value)> {
    let all = schema.get("properties").and_then(Value::as_object);
    all.into_iter().flatten().map(|(key, property)| (key.as_str(), property))
}

/// The definitions with keys to which a property leads.
fn references<'a>(property: &'a Value, root: &'a Value) -> Vec<&'a str> {
    match property {
        Value::Object(members) => match members.get("$ref").and_then(Value::as_str) {
            Some(reference) if has_keys(resolved(reference, root), root) => vec![reference],
            Some(reference) => references(resolved(reference, root), root),
            None => members.values().flat_map(|value| references(value, root)).collect(),
        },
        Value::Array(list) => list.iter().flat_map(|value| references(value, root)).collect(),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => Vec::new(),
    }
}

/// The keys that all alternatives have with the same meaning; each may have names of its own.
fn common(alternatives: &[(Option<&str>, &Value)]) -> Map<String, Value> {
    let Some((_, first)) = alternatives.first() else { return Map::new() };
    let mut all = Map::new();
    for (key, property) in properties(first) {
        let each: Vec<&Value> = alternatives.iter().filter_map(|(_, other)| other["properties"].get(key)).collect();
        if each.len() < alternatives.len() || each.iter().any(|other| other["description"] != property["description"]) {
            continue;
        }
        let mut merged = property.clone();
        let names = |other: &&Value| match (&other["enum"], &other["const"]) {
            (Value::Array(names), _) => names.clone(),
            (_, Value::Null) => Vec::new(),
            (_, name) => vec![name.clone()],
        };
        let names: Vec<Value> = each.iter().flat_map(names).collect();
        if !names.is_empty() {
            merged["enum"] = json!(names);
        }
        all.insert(key.into(), merged);
    }
    all
}

/// The table of the keys, those that are required first; none if there is no key.
fn table(found: &Found, types: &KeyTypes) -> Option<KeyTable> {
    let Found { title, schema, common } = found;
    let has_alternatives = !alternatives(schema, types.root).is_empty();
    let own = properties(schema).filter(|(key, property)| {
        // A key of another alternative is in the table of that one.
        property.get("x-of").is_none() && (has_alternatives || !common.contains_key(*key))
    });
    let shared = common.iter().filter(|_| has_alternatives).map(|(key, property)| (key.as_str(), property));
    let required = |key: &str| {
        let of = |schema: &Value| schema["required"].as_array().is_some_and(|keys| keys.iter().any(|own| own == key));
        of(schema) || alternatives(schema, types.root).iter().any(|(_, alternative)| of(alternative))
    };
    let mut keys: Vec<(&str, &Value)> = own.chain(shared).collect();
    keys.sort_by_key(|(key, _)| (!types.is_written && !required(key), *key));
    let row = |(key, property): (&str, &Value)| {
        let meaning = property["description"].as_str().unwrap_or_default().replace('\n', " ");
        let mut row = vec![format!("`{key}`"), types.words(property)];
        let default = || if required(key) { "required".into() } else { default_words(property) };
        row.extend((!types.is_written).then(default));
        row.push(meaning);
        row.iter().map(|cell| cell.replace('|', "\\|")).collect()
    };
    let head = ["key", "type", "default", "meaning"].into_iter().filter(|head| !types.is_written || *head != "default");
    let rows: Vec<Vec<String>> =
        [head.map(String::from).collect()].into_iter().chain(keys.into_iter().map(row)).collect();
    (rows.len() > 1).then(|| KeyTable { title: title.clone(), rows })
}

/// What a key has that is not given, from its schema: `none`, a value in code, or words.
pub fn default_words(property: &Value) -> String {
    let unit = property["x-unit"].as_str().map_or(String::new(), |unit| format!(" {unit}"));
    match (property["x-default"].as_str(), &property["default"]) {
        (Some(words), _) => words.into(),
        (.., Value::Null) => "none".into(),
        (.., Value::Array(list)) if list.is_empty() => "none".into(),
        (.., Value::Object(table)) if table.is_empty() => "none".into(),
        (.., Value::String(_) | Value::Array(_)) => format!("`{}`", property["default"]),
        (.., value @ (Value::Number(_) | Value::Bool(_) | Value::Object(_))) => {
            format!("{}{unit}", value.to_string().trim_end_matches(".0"))
        }
    }
}
