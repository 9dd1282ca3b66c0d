//! The type of a key in words, from its schema.

use serde_json::Value;
use std::collections::BTreeMap;

/// What the words for types depend on.
pub(super) struct KeyTypes<'a> {
    /// The whole schema.
    pub root: &'a Value,
    /// The titles of the tables, by the references to their definitions.
    pub titles: &'a BTreeMap<&'a str, String>,
    /// Whether null is worth a word.
    pub is_written: bool,
}

/// The definition to which a reference leads.
pub(super) fn resolved<'a>(reference: &str, root: &'a Value) -> &'a Value {
    root.pointer(reference.trim_start_matches('#')).unwrap_or(&Value::Null)
}

/// Whether the schema is that of a table with keys.
pub(super) fn has_keys(schema: &Value, root: &Value) -> bool {
    schema.get("properties").is_some() || schema["oneOf"].is_array() && !alternatives(schema, root).is_empty()
}

/// The tables of which a table is one, each with the reference that leads to it.
pub(super) fn alternatives<'a>(schema: &'a Value, root: &'a Value) -> Vec<(Option<&'a str>, &'a Value)> {
    let lists = ["oneOf", "anyOf"].into_iter().filter_map(|key| schema[key].as_array());
    let one = |schema: &'a Value| match schema["$ref"].as_str() {
        Some(reference) => (Some(reference), resolved(reference, root)),
        None => (None, schema),
    };
    lists.flatten().map(one).filter(|(_, schema)| schema.get("properties").is_some()).collect()
}

impl KeyTypes<'_> {
    /// The type in words, with links to the tables.
    pub fn words(&self, schema: &Value) -> String {
        let null = if self.is_written && self.is_nullable(schema) { ", or null" } else { "" };
        self.one(schema, false) + null
    }

    fn is_nullable(&self, schema: &Value) -> bool {
        let is_null = |kind: &Value| kind == "null";
        is_null(&schema["type"])
            || schema["type"].as_array().is_some_and(|kinds| kinds.iter().any(is_null))
            || schema["anyOf"].as_array().is_some_and(|kinds| kinds.iter().any(|kind| self.is_nullable(kind)))
    }

    fn one(&self, schema: &Value, many: bool) -> String {
        if let Some(words) = schema["x-type"].as_str() {
            return plural(words, many);
        }
        if let Some(reference) = schema["$ref"].as_str() {
            return match self.titles.get(reference) {
                Some(title) => format!("[{}](#{})", plural("table", many), anchor(title)),
                None => self.one(resolved(reference, self.root), many),
            };
        }
        let names = |list: &Value| list.as_array().map(|names| names.iter().map(name).collect::<Vec<_>>());
        if let Some(names) = names(&schema["enum"]) {
            return names.join(", ");
        }
        let kinds = schema["oneOf"].as_array().or(schema["anyOf"].as_array());
        if let Some(kinds) = kinds {
            let kinds = kinds.iter().filter(|kind| kind["type"] != "null");
            let is_named = kinds.clone().all(|kind| kind.get("const").is_some());
            let words: Vec<String> = kinds.map(|kind| self.one(kind, many)).collect();
            return words.join(if is_named { ", " } else { ", or " });
        }
        match schema.get("const") {
            Some(value) => name(value),
            None => self.plain(schema, many),
        }
    }

    /// The words for a schema with a type.
    fn plain(&self, schema: &Value, many: bool) -> String {
        let kind = match &schema["type"] {
            Value::Array(kinds) => kinds.iter().find_map(|kind| kind.as_str().filter(|kind| *kind != "null")),
            kind => kind.as_str(),
        };
        match kind {
            Some("boolean") => plural("flag", many),
            Some("integer") => plural("whole number", many),
            Some("string") => plural("text", many),
            Some("array") => {
                let items = self.one(&schema["items"], true);
                match (schema["minItems"].as_u64(), schema["maxItems"].as_u64()) {
                    (Some(2), Some(2)) => format!("{} of {items}", plural("pair", many)),
                    (Some(length), Some(most)) if length == most => {
                        format!("{} of {length} {items}", plural("list", many))
                    }
                    _ => format!("{} of {items}", plural("list", many)),
                }
            }
            Some("object") if schema["additionalProperties"].is_object() => {
                format!("{} of {}", plural("table", many), self.one(&schema["additionalProperties"], true))
            }
            Some("object") => plural("table", many),
            Some(other) => plural(other, many),
            None => plural("value", many),
        }
    }
}

/// Each word that stands for one thing, for many of it.
fn plural(words: &str, many: bool) -> String {
    let each = |word: &str| if word.ends_with('`') { word.to_string() } else { format!("{word}s") };
    if many { words.split(" or ").map(each).collect::<Vec<_>>().join(" or ") } else { words.into() }
}

fn name(value: &Value) -> String {
    format!("`{value}`")
}

/// The anchor of a heading, as mdBook makes it.
fn anchor(title: &str) -> String {
    let kept = title.to_lowercase().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c)).collect::<String>();
    kept.replace(' ', "-")
}
