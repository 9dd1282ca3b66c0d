//! Fits whose keys have lists of values: each combination is a fit of its own.

use crate::error::{Error, Result};
use crate::fit::Solver;
use springfit_scenes::{BODY, FitEntry, NamedFit, expect_own_name};
use std::collections::BTreeMap;
use std::path::Path;
use toml::{Table, Value};

/// Keys whose value is a list, as paths in a fit, and how deep its lists are: a list that is deeper has several values.
const LISTS: [(&str, usize); 13] = [
    ("springs", 1),
    ("loads", 1),
    ("validate", 1),
    ("supports", 1),
    ("validate_supports", 1),
    ("other_supports", 1),
    ("shapes", 1),
    ("shapes.families", 1),
    ("shapes.loads", 1),
    ("shapes.states", 1),
    ("shapes.stretch", 1),
    ("shapes.directions", 2),
    ("shapes.gradients", 2),
];
/// Tables whose keys may have lists as well.
const TABLES: [&str; 1] = ["shapes"];
/// Fits at most: a table of more is not read, and lists of a few keys multiply to more by mistake.
const MOST: usize = 1000;

/// A fit of a comparison, and the values of the keys that vary among the fits of its entry.
#[derive(Debug, Clone, PartialEq)]
pub struct VariedFit {
    pub named: NamedFit,
    /// By the paths of the keys.
    pub varied: Values,
}

impl From<NamedFit> for VariedFit {
    fn from(named: NamedFit) -> VariedFit {
        VariedFit { named, varied: BTreeMap::new() }
    }
}

/// A fit with its entry's place, and the keys that tell it from fits of the same name: those of its whole entry, or where that has a name those
/// with lists.
struct Candidate {
    fit: VariedFit,
    place: usize,
    has_name: bool,
    keys: Values,
}

impl Candidate {
    /// Whether keys are to tell the fits apart. Names that entries give themselves are for them to choose.
    fn is_like(&self, other: &Candidate) -> bool {
        let is_free = self.place == other.place || !(self.has_name || other.has_name);
        is_free && self.fit.named.name == other.fit.named.name
    }
}

/// The fits of all entries; files are relative to `folder`.
///
/// # Errors
/// A list is empty, a key is wrong, two fits have the same name, or there are too many. The key is `fit[i]` and that of the entry.
pub fn varied_fits(entries: &[Table], folder: &Path) -> Result<Vec<VariedFit>> {
    let mut all: Vec<Candidate> = Vec::new();
    for (place, entry) in entries.iter().enumerate() {
        let at = |e: Error| e.placed(|e| e.under(format!("fit[{place}]")));
        let has_name = entry.contains_key("name");
        for Combination { table, varied, keys } in combinations(entry).map_err(at)? {
            let entry: FitEntry = crate::file::parse_table(table).map_err(at)?;
            entry.check().map_err(at)?;
            for named in entry.fits(folder).map_err(at)? {
                let fit = VariedFit { named: named.of_entry(place), varied: varied.clone() };
                let keys = if has_name { varied.clone() } else { keys.clone() };
                all.push(Candidate { fit, place, has_name, keys });
            }
        }
        if all.len() > MOST {
            return Err(Error::expected("fit", format!("at most {MOST} fits"), "more"));
        }
    }
    let mut told: Vec<VariedFit> = Vec::new();
    for (place, fit) in told_apart(all) {
        let names = std::iter::once(BODY).chain(told.iter().map(|known| known.named.name.as_str()));
        expect_own_name(&format!("fit[{place}].name"), &fit.named.name, names)?;
        told.push(fit);
    }
    Ok(told)
}

/// The fits with the places of their entries. Those of the same name have the values in it by which they differ.
fn told_apart(all: Vec<Candidate>) -> Vec<(usize, VariedFit)> {
    let differences = |own: &Candidate| -> Values {
        let same: Vec<&Candidate> = all.iter().filter(|other| own.is_like(other)).collect();
        let differs = |(key, value): &(&String, &serde_json::Value)| {
            same.iter().any(|other| other.keys.get(*key) != Some(*value))
        };
        own.keys.iter().filter(differs).map(|(key, value)| (key.clone(), value.clone())).collect()
    };
    let told: Vec<Values> = all.iter().map(differences).collect();
    let named = |(Candidate { mut fit, place, .. }, told): (Candidate, Values)| {
        let words = told.iter().map(|(key, value)| words(key, value));
        fit.named.name = std::iter::once(fit.named.name).chain(words).collect::<Vec<_>>().join(", ");
        fit.varied.extend(told);
        (place, fit)
    };
    all.into_iter().zip(told).map(named).collect()
}

/// A key and its value in the name of a fit.
fn words(key: &str, value: &serde_json::Value) -> String {
    let key = key.strip_prefix("shapes.").unwrap_or(key);
    match value {
        serde_json::Value::Bool(true) => key.into(),
        serde_json::Value::Bool(false) => format!("not {key}"),
        serde_json::Value::String(text) => format!("{key} {text}"),
        // Of a table, such as that of an engine, the method speaks for itself.
        serde_json::Value::Object(table) => {
            let (of_method, others): (Vec<_>, Vec<_>) = table.iter().partition(|(name, _)| *name == "method");
            let method = of_method.iter().filter_map(|(_, value)| value.as_str()).map(String::from);
            let all = method.chain(others.into_iter().map(|(name, value)| words(name, value)));
            format!("{key} {}", all.collect::<Vec<_>>().join(" "))
        }
        serde_json::Value::Array(list) => {
            let all: Vec<String> = list.iter().map(|one| one.as_str().map_or(one.to_string(), String::from)).collect();
            format!("{key} {}", all.join(" + "))
        }
        value => format!("{key} {value}"),
    }
}

/// Values of keys by their paths.
type Values = BTreeMap<String, serde_json::Value>;

/// An entry in which each key has one value.
#[derive(Clone, Default)]
struct Combination {
    table: Table,
    /// The values of the keys that have lists.
    varied: Values,
    /// The values of all keys.
    keys: Values,
}

/// All combinations of the values, the last key fastest, with those of the keys that vary.
fn combinations(entry: &Table) -> Result<Vec<Combination>> {
    let mut all = vec![Combination::default()];
    let mut add = |path: [Option<&str>; 2], value: &Value| -> Result<()> {
        let key = path.iter().flatten().copied().collect::<Vec<_>>().join(".");
        let choices = choices(&key, value)?;
        let mut more = Vec::new();
        for known in &all {
            for choice in choices.as_deref().unwrap_or(std::slice::from_ref(value)) {
                let Combination { mut table, mut varied, mut keys } = known.clone();
                let of_json = serde_json::to_value(choice).unwrap_or_default();
                match path {
                    [Some(parent), Some(name)] => {
                        let inner = table.entry(parent).or_insert_with(|| Value::Table(Table::new()));
                        inner.as_table_mut().map(|inner| inner.insert(name.into(), choice.clone()));
                    }
                    [_, name] => drop(table.insert(name.unwrap_or_default().into(), choice.clone())),
                }
                if choices.is_some() {
                    varied.insert(key.clone(), of_json.clone());
                }
                keys.insert(key.clone(), of_json);
                more.push(Combination { table, varied, keys });
            }
        }
        all = more;
        // Checked after each key: the product of a few long lists would fill memory before the end.
        match all.len() > MOST {
            true => Err(Error::expected(key, format!("at most {MOST} combinations"), "more")),
            false => Ok(()),
        }
    };
    for (key, value) in entry {
        match value {
            Value::Table(inner) if TABLES.contains(&key.as_str()) => {
                inner.iter().try_for_each(|(name, value)| add([Some(key), Some(name)], value))?;
            }
            value => add([None, Some(key)], value)?,
        }
    }
    Ok(all)
}

/// The values that a key has in turn; `None` where it has one.
fn choices(key: &str, value: &Value) -> Result<Option<Vec<Value>>> {
    let Value::Array(list) = value else { return Ok(None) };
    if list.is_empty() {
        return Err(Error::expected(key, "at least one value", "an empty list"));
    }
    let own = LISTS.iter().find(|(known, _)| *known == key).map_or(0, |(_, depth)| *depth);
    let has_words = key == "springs" && list.iter().all(is_choice_of_groups);
    Ok((depth(value) > own || has_words).then(|| list.clone()))
}

/// How deep the lists of a value are: 0 for a number.
fn depth(value: &Value) -> usize {
    value.as_array().map_or(0, |list| 1 + list.iter().map(depth).max().unwrap_or(0))
}

/// Whether a text stands for several groups of any element, and not for one group.
fn is_choice_of_groups(value: &Value) -> bool {
    value.as_str().is_some_and(|text| crate::element::GROUP_CHOICES.contains(&text))
}

/// The solver of a fit, in a word.
pub fn solver_of(named: &NamedFit) -> &'static str {
    match (named.recipe.kind().cell_method(), named.recipe.stiffness()) {
        (Some(method), _) => method.solver(),
        (None, Some(fit)) if fit.solver != Solver::Native => fit.solver.name(),
        (None, _) => "native",
    }
}
