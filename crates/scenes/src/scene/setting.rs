//! Values of a scene's keys that are given beside its file.

use crate::error::{Error, ErrorKind, Result};
use std::fmt;
use toml::{Table, Value};

/// A value for one key of a scene, in place of what the file has there: `material.poisson=0.45`.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    key: String,
    steps: Vec<Step>,
    value: Value,
    /// The value as it was given.
    text: String,
}

/// A step from a value to one inside it.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Step {
    Name(String),
    Index(usize),
}

impl Setting {
    /// The setting that `KEY=VALUE` stands for. Steps of the key are separated by dots, and entries of lists are numbered from 0:
    /// `load[1].traction`. The value is TOML; a text that is no other value of TOML needs no quotes, such as `10 kPa`.
    ///
    /// # Errors
    /// There is no `=`, the key is no such path, or the value is a list, a table or a quoted text that does not end.
    pub fn parse(text: &str) -> Result<Setting> {
        let Some((key, value)) = text.split_once('=') else {
            return Err(Error::expected("--set", "KEY=VALUE such as material.poisson=0.45", format!("\"{text}\"")));
        };
        let (key, value) = (key.trim(), value.trim());
        let steps = steps(key).ok_or_else(|| {
            let expected = "a key such as material.poisson or load[0].traction before the \"=\"";
            Error::expected("--set", expected, format!("\"{key}\""))
        })?;
        let read = read_value(value).map_err(|e| e.at_key(format!("--set {key}")))?;
        Ok(Setting { key: key.into(), steps, value: read, text: value.into() })
    }

    /// The setting of a key to a value, as `KEY=VALUE` would have it.
    ///
    /// # Errors
    /// The key is no such path.
    pub fn of(key: &str, value: &Value) -> Result<Setting> {
        let Some(steps) = steps(key) else {
            return Err(Error::expected(
                key,
                "a key such as material.poisson or load[0].traction",
                format!("\"{key}\""),
            ));
        };
        let text = serde_json::to_value(value).map_or_else(|_| String::new(), |value| value.to_string());
        Ok(Setting { key: key.into(), steps, value: value.clone(), text })
    }

    /// The value; null where JSON has none.
    pub fn value(&self) -> serde_json::Value {
        serde_json::to_value(&self.value).unwrap_or_default()
    }

    /// The path of the key, as errors name it.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// The table or key at the top of the scene that it is in: `material` of `material.poisson`.
    pub fn first(&self) -> &str {
        self.key.split(['.', '[']).next().unwrap_or_default()
    }

    /// Puts the value into the table of a scene; tables on the way that are missing are made, and a list grows by one entry.
    ///
    /// # Errors
    /// A step leads into what is neither a table nor a list, or beyond the end of a list.
    pub(super) fn apply(&self, scene: &mut Table) -> Result<()> {
        let (Some((Step::Name(first), rest)), true) = (self.steps.split_first(), !self.steps.is_empty()) else {
            return Ok(());
        };
        let made = |rest: &[Step]| match rest.first() {
            Some(Step::Index(_)) => Value::Array(Vec::new()),
            Some(Step::Name(_)) | None => Value::Table(Table::new()),
        };
        let mut place = scene.entry(first.clone()).or_insert_with(|| made(rest));
        let mut reached = first.clone();
        for (i, step) in rest.iter().enumerate() {
            let following = &rest[i + 1..];
            let found = place.type_str();
            let fault = |expected: String, found: String| Err(Error::expected(&reached, expected, found));
            place = match (step, place) {
                (Step::Name(name), Value::Table(table)) => {
                    // A part has one of the two.
                    for (one, other) in [("where", "group"), ("group", "where")] {
                        if following.is_empty() && name == one {
                            table.remove(other);
                        }
                    }
                    reached = format!("{reached}.{name}");
                    table.entry(name.clone()).or_insert_with(|| made(following))
                }
                (Step::Index(index), Value::Array(list)) => {
                    let count = list.len();
                    if *index > count {
                        let expected = format!("an entry from 0 to {count}, which adds one");
                        return fault(expected, format!("[{index}]"));
                    }
                    if *index == count {
                        list.push(made(following));
                    }
                    reached = format!("{reached}[{index}]");
                    &mut list[*index]
                }
                (Step::Name(name), Value::Array(_)) => {
                    return fault(
                        format!("an entry of the list, such as {reached}[0].{name}"),
                        "the whole list".into(),
                    );
                }
                (Step::Name(name), _) => {
                    return fault(format!("a table with \"{name}\""), format!("a value of type {found}"));
                }
                (Step::Index(index), _) => {
                    return fault(format!("a list with an entry [{index}]"), format!("a value of type {found}"));
                }
            };
        }
        *place = self.value.clone();
        Ok(())
    }

    /// Whether the key of an error is that of the setting, or inside it.
    pub(super) fn holds(&self, key: &str) -> bool {
        is_inside(key, &self.key)
    }

    /// Whether the setting is inside what the key of an error names.
    pub(super) fn is_in(&self, key: &str) -> bool {
        is_inside(&self.key, key)
    }
}

/// A setting is displayed as it is typed, `key=text`.
impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}={}", self.key, self.text)
    }
}

fn is_inside(inner: &str, outer: &str) -> bool {
    inner.strip_prefix(outer).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

/// `load[1].traction` as its steps; `None` if it is no such path.
fn steps(key: &str) -> Option<Vec<Step>> {
    let is_name = |name: &str| !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '-');
    let mut found = Vec::new();
    for part in key.split('.') {
        let (name, mut rest) = part.split_at(part.find('[').unwrap_or(part.len()));
        if !is_name(name) {
            return None;
        }
        found.push(Step::Name(name.into()));
        while !rest.is_empty() {
            let (index, after) = rest.strip_prefix('[')?.split_once(']')?;
            found.push(Step::Index(index.parse().ok()?));
            rest = after;
        }
    }
    Some(found)
}

/// A value of TOML, or else the text itself.
fn read_value(text: &str) -> Result<Value> {
    let table = format!("value = {text}").parse::<Table>();
    // A text with line ends could hold further keys.
    let one = table.ok().filter(|table| table.len() == 1).and_then(|mut table| table.remove("value"));
    match one {
        Some(value) => Ok(value),
        None if text.starts_with(['[', '{', '"', '\'']) || text.contains('\n') => {
            let expected = "a value of TOML such as 0.45, \"10 kPa\", true or [0, 0, 100]";
            Err(Error::expected("--set", expected, text).of_kind(ErrorKind::Syntax))
        }
        None => Ok(Value::String(text.into())),
    }
}
