//! Golden files: one for each output, in `data/AREA/CASE/`. A text is one as it is, all else is JSON whose numbers have twelve digits.

use super::case::root;
use super::form::Form;
use super::number::rounded;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The ending of trees, after the name of the output.
const TREE: &str = ".golden";

/// The folder of all golden files; `None` where it is missing, as in a package.
pub fn folder() -> Option<PathBuf> {
    let other = std::env::var_os("SPRINGFIT_GOLDEN_DATA").map(PathBuf::from);
    let folder = other.unwrap_or_else(|| root().join("tests/golden_files/data"));
    folder.is_dir().then_some(folder)
}

/// The golden files of a case by the names of the outputs.
pub fn read(folder: &Path) -> BTreeMap<String, Form> {
    let mut found = BTreeMap::new();
    if folder.is_dir() {
        gather(folder, "", &mut found);
    }
    found
}

fn gather(folder: &Path, within: &str, found: &mut BTreeMap<String, Form>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = format!("{within}{}", path.file_name().and_then(|name| name.to_str()).expect("names are text"));
        if path.is_dir() {
            gather(&path, &format!("{name}/"), found);
            continue;
        }
        let text = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let (name, form) = match name.strip_suffix(TREE) {
            Some(name) => {
                let tree = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
                (name.to_string(), Form::Tree(tree))
            }
            None => (name, Form::Text(text.lines().map(String::from).collect())),
        };
        found.insert(name, form);
    }
}

/// Writes a golden file.
pub fn write(folder: &Path, name: &str, form: &Form, is_whole: bool) {
    let (path, text) = match form {
        Form::Text(lines) => (folder.join(name), lines.iter().map(|line| format!("{line}\n")).collect()),
        Form::Tree(tree) => {
            let mut text = String::new();
            put(tree, is_whole, &mut text);
            (folder.join(format!("{name}{TREE}")), text + "\n")
        }
    };
    fs::create_dir_all(path.parent().expect("a file is in a folder")).unwrap();
    fs::write(path, text).unwrap();
}

/// Removes the golden file of an output that is no longer written.
pub fn remove(folder: &Path, name: &str) {
    for name in [name.to_string(), format!("{name}{TREE}")] {
        let path = folder.join(name);
        if path.is_file() {
            fs::remove_file(path).unwrap();
        }
    }
}

/// Appends JSON: what is short and has no lists is one line, and so are lists of numbers. Lines are not indented, which would be a
/// quarter of the files.
fn put(value: &Value, is_whole: bool, text: &mut String) {
    let is_short = |value: &Value| matches!(value, Value::Number(_) | Value::Null | Value::Bool(_));
    match value {
        Value::Object(entries) if entries.len() <= 8 && entries.values().all(is_short) => {
            text.push('{');
            for (i, (key, value)) in entries.iter().enumerate() {
                *text += &format!("{}{}:", if i > 0 { "," } else { "" }, Value::from(key.as_str()));
                put(value, is_whole, text);
            }
            text.push('}');
        }
        Value::Object(entries) => {
            text.push('{');
            for (i, (key, value)) in entries.iter().enumerate() {
                text.push_str(if i > 0 { "," } else { "" });
                text.push('\n');
                *text += &format!("{}:", Value::from(key.as_str()));
                put(value, is_whole, text);
            }
            text.push('\n');
            text.push('}');
        }
        Value::Array(items) => {
            let is_long = items.iter().any(|item| item.is_object() || item.is_string());
            text.push('[');
            for (i, item) in items.iter().enumerate() {
                text.push_str(if i > 0 { "," } else { "" });
                if is_long {
                    text.push('\n');
                }
                put(item, is_whole, text);
            }
            if is_long {
                text.push('\n');
            }
            text.push(']');
        }
        Value::Number(number) if number.is_f64() && !is_whole => {
            let x = number.as_f64().expect("a number with digits is one");
            *text += &Value::from(rounded(x)).to_string();
        }
        other => *text += &other.to_string(),
    }
}
