//! A `[[fit]]` of a scene file.

use super::engine::{EngineEntry, EngineOrName};
use super::exact::{ExactEntry, without_groups};
use super::named::NamedFit;
use super::published::PublishedEntry;
use super::recipe::Recipe;
use super::sampled::{FitFunctions, SampledEntry};
use super::stiffness::StiffnessEntry;
use super::whole::{Start, WholeEntry, starts};
use crate::error::{Error, ErrorKind, Result};
use crate::file;
use crate::fit::Objective;
use crate::fit::published::Method;
use crate::keys::keys;
use crate::model::BendingSprings;
use crate::named::{suggestion, unknown};
use serde::de::{DeserializeOwned, Error as _, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::fmt;
use std::path::Path;
use toml::{Table, Value};

/// A `[[fit]]`: the keys that all fits have, and those of its kind, which its objective determines.
#[derive(Debug, Clone, PartialEq)]
pub struct FitEntry {
    /// The name in reports; derived from the settings if absent.
    pub name: Option<String>,
    /// The objective.
    pub objective: String,
    /// The spring groups; all that are not optional, if absent.
    pub springs: Option<Vec<String>>,
    /// The settings of the engine that the constants are for.
    pub engine: Option<EngineEntry>,
    /// Which springs resist the bending of a sheet; those of directors if absent.
    pub bending: Option<BendingSprings>,
    keys: Table,
}

/// The keys that all fits have.
pub(super) const COMMON: [&str; 5] = ["name", "objective", "springs", "engine", "bending"];

fn json_text(value: &Value) -> String {
    serde_json::to_string(value).expect("keys are text")
}

/// The kind of a fit, by its objective.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Stiffness,
    Sampled,
    Whole,
    Published,
    Exact,
}

crate::named!(Kind {
    "stiffness" => Stiffness,
    "sampled" => Sampled,
    "whole" => Whole,
    "published" => Published,
    "exact" => Exact,
});

impl Kind {
    /// The kind of this objective.
    ///
    /// # Errors
    /// There is no such objective.
    fn of(objective: &str) -> Result<Kind> {
        let no_kind = || {
            let expected = Kind::all().flat_map(Kind::objectives).collect::<Vec<_>>().join(", ");
            let names = Kind::all().flat_map(Kind::objectives);
            unknown(format!("one of {expected}"), names, objective).at_key("objective")
        };
        Kind::all().find(|kind| kind.objectives().contains(&objective)).ok_or_else(no_kind)
    }

    pub(super) fn objectives(self) -> Vec<&'static str> {
        match self {
            Kind::Stiffness => Objective::NAMES.to_vec(),
            Kind::Sampled => vec!["sampled"],
            Kind::Whole => vec!["whole"],
            Kind::Published => Method::NAMES.to_vec(),
            Kind::Exact => vec!["exact"],
        }
    }

    /// The names of its keys.
    fn keys(self) -> &'static [&'static str] {
        match self {
            Kind::Stiffness => keys::<StiffnessEntry>(),
            Kind::Sampled => keys::<SampledEntry>(),
            Kind::Whole => keys::<WholeEntry>(),
            Kind::Published => keys::<PublishedEntry>(),
            Kind::Exact => keys::<ExactEntry>(),
        }
    }

    fn unknown(self, key: &str) -> Error {
        let known: Vec<String> = COMMON.iter().chain(self.keys()).map(|known| format!("\"{known}\"")).collect();
        let hint = suggestion(COMMON.iter().chain(self.keys()).copied(), key);
        Error::at(key, format!("unknown field \"{key}\", expected one of {}{hint}", known.join(", ")))
    }
}

impl FitEntry {
    /// An entry with this objective and no other keys.
    pub fn new(objective: impl Into<String>) -> FitEntry {
        let (name, springs, engine, bending, keys) = Default::default();
        FitEntry { name, objective: objective.into(), springs, engine, bending, keys }
    }

    /// What is set, as `key = value` with values in JSON, sorted by the keys: what tells one fit from another on disk.
    pub fn identity(&self) -> Vec<String> {
        let springs = self.springs.as_ref().map(|names| Value::from(names.clone()));
        let bending = self.bending.map(|springs| Value::from(springs.name()));
        let common =
            [("objective", Some(Value::from(self.objective.clone()))), ("springs", springs), ("bending", bending)];
        let common = common.into_iter().filter_map(|(key, value)| Some((key.to_string(), value?)));
        let engine = self.engine.as_ref().map(EngineEntry::identity);
        let mut set: Vec<String> =
            common.chain(self.keys.clone()).map(|(key, value)| format!("{key} = {}", json_text(&value))).collect();
        set.extend(engine);
        set.sort();
        set
    }

    /// Sets a key of the entry to this value, if there is one.
    pub fn with(mut self, key: &str, value: Option<impl Into<Value>>) -> FitEntry {
        if let Some(value) = value {
            self.keys.insert(key.into(), value.into());
        }
        self
    }

    /// Sets the spring groups of the entry.
    pub fn with_springs(self, springs: Option<Vec<String>>) -> FitEntry {
        FitEntry { springs, ..self }
    }

    /// Checks that each key is known and has a value of the right type.
    ///
    /// # Errors
    /// A key is wrong; the error names it.
    pub fn check(&self) -> Result<()> {
        // An unknown objective is reported when its kind is needed.
        let Ok(kind) = Kind::of(&self.objective) else { return Ok(()) };
        // Fits of elements have these keys from elsewhere, or not at all.
        if let Some(key) = COMMON.iter().find(|key| self.keys.contains_key(**key)) {
            let problem = "belongs to a fit of a scene, which has the body, its masses and how it is held; found in a fit of elements alone";
            return Err(Error::at(*key, problem).of_kind(ErrorKind::Unsupported));
        }
        let known = match self.keys.keys().find(|key| owners(key).next().is_none()) {
            Some(key) => Err(kind.unknown(key)),
            None => Ok(()),
        };
        known.and_then(|()| match kind {
            Kind::Stiffness => self.typed::<StiffnessEntry>().map(|_| ()),
            Kind::Sampled => self.typed::<SampledEntry>().map(|_| ()),
            Kind::Whole => self.whole().map(|_| ()),
            Kind::Published => Ok(()),
            Kind::Exact => self.typed::<ExactEntry>().map(|_| ()),
        })
    }

    /// The fits that the entry describes, one for each start of a whole-object fit; files are relative to `folder`.
    ///
    /// # Errors
    /// A key has a wrong value, or belongs to another objective.
    pub fn fits(&self, folder: &Path) -> Result<Vec<NamedFit>> {
        self.fits_with(folder, &FitFunctions::default())
    }

    /// Returns the fits that the entry describes, as [`FitEntry::fits`] does, with functions of the program in place of keys.
    ///
    /// # Errors
    /// Those of [`FitEntry::fits`]; or a function stands for a key that is there as well, or that the objective does not have.
    pub fn fits_with(&self, folder: &Path, functions: &FitFunctions) -> Result<Vec<NamedFit>> {
        let engine = self.engine.as_ref().map(|entry| entry.setting().map_err(|e| e.under("engine"))).transpose()?;
        let fits = self.fits_of_kind(folder, functions)?;
        Ok(fits.into_iter().map(|fit| fit.in_engine(engine)).collect())
    }

    fn fits_of_kind(&self, folder: &Path, functions: &FitFunctions) -> Result<Vec<NamedFit>> {
        let kind = Kind::of(&self.objective)?;
        self.check_owners(kind)?;
        if let Some(springs) = &self.springs {
            let again = (1..springs.len()).find(|&i| springs[..i].contains(&springs[i]));
            let found = match again {
                Some(again) => Some(format!("\"{}\" again", springs[again])),
                None => springs.is_empty().then(|| "none".into()),
            };
            if let Some(found) = found {
                return Err(Error::expected("springs", "groups of the element, each once", found));
            }
        }
        if let (Some(key), false) = (functions.key(), kind == Kind::Sampled) {
            let found = format!("one with \"{}\"", self.objective);
            return Err(Error::expected(key, "a function with the objective \"sampled\" alone", found));
        }
        let recipe = match kind {
            Kind::Stiffness => Recipe::Stiffness(self.typed::<StiffnessEntry>()?.fit(&self.objective)?),
            Kind::Sampled => Recipe::Sampled(Box::new(self.typed::<SampledEntry>()?.check(folder, functions)?)),
            Kind::Published => Recipe::Published(Method::named(&self.objective).map_err(|e| e.at_key("method"))?),
            Kind::Exact => Recipe::Exact(self.typed::<ExactEntry>()?.recipe(self.springs.as_deref())?),
            Kind::Whole => {
                let (entry, sampled) = self.whole()?;
                let recipes = entry.recipes(|| sampled.clone().check(folder, functions))?;
                let is_exact = recipes.iter().any(|(_, recipe)| matches!(recipe.start, Start::Exact(..)));
                if let Some(springs) = self.springs.as_ref().filter(|_| is_exact) {
                    return Err(without_groups(springs));
                }
                let several = recipes.len() > 1;
                let fit = |(start, recipe): (String, _)| {
                    let own = |name: &String| if several { format!("{name} from {start}") } else { name.clone() };
                    self.fit(self.name.as_ref().map(own), Recipe::Whole(Box::new(recipe)))
                };
                return Ok(recipes.into_iter().map(fit).collect());
            }
        };
        Ok(vec![self.fit(self.name.clone(), recipe)])
    }

    fn fit(&self, name: Option<String>, recipe: Recipe) -> NamedFit {
        let of_hinges = if self.bending == Some(BendingSprings::Hinges) { " hinges" } else { "" };
        let name = name.unwrap_or_else(|| recipe.name(self.springs.as_deref()) + of_hinges);
        NamedFit::named(name, recipe, self.springs.clone()).bending_by(self.bending)
    }

    /// The keys of the entry as a `T`.
    fn typed<T: DeserializeOwned>(&self) -> Result<T> {
        let own = self.keys.iter().filter(|(key, _)| keys::<T>().contains(&key.as_str()));
        file::parse_table(own.map(|(key, value)| (key.clone(), value.clone())).collect())
    }

    /// The keys of a whole-object fit, and those of the sampled fit from which it may start.
    fn whole(&self) -> Result<(WholeEntry, SampledEntry)> {
        let sampled = if self.starts_from_sampled() { self.typed()? } else { SampledEntry::default() };
        Ok((self.typed()?, sampled))
    }

    fn starts_from_sampled(&self) -> bool {
        starts(self.keys.get("start")).is_ok_and(|starts| starts.contains(&"sampled".into()))
    }

    /// Checks that no key belongs to another objective.
    fn check_owners(&self, kind: Kind) -> Result<()> {
        let objective = &self.objective;
        let own = |key: &str| {
            let from_sampled = kind == Kind::Whole && self.starts_from_sampled();
            // Whole-object fits share constants by "unknowns".
            kind.keys().contains(&key)
                || from_sampled && !["tied", "data"].contains(&key) && Kind::Sampled.keys().contains(&key)
        };
        let Some(key) = self.keys.keys().find(|key| !own(key)) else { return Ok(()) };
        let objectives: Vec<&str> = owners(key).flat_map(Kind::objectives).collect();
        Err(match objectives[..] {
            [] => kind.unknown(key),
            [owner] => Error::at(key, format!("belongs to the objective \"{owner}\", found with \"{objective}\"")),
            [..] => Error::at(key, format!("does not go with the objective \"{objective}\"")),
        })
    }
}

/// The kinds of fits that have the key.
fn owners(key: &str) -> impl Iterator<Item = Kind> {
    Kind::all().filter(move |kind| kind.keys().contains(&key))
}

impl<'de> Deserialize<'de> for FitEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<FitEntry, D::Error> {
        deserializer.deserialize_map(EntryVisitor)
    }
}

/// The names of groups, or one word for several groups.
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a list of groups of the element, or \"default\", \"all\" or \"all + volume\"")]
enum Groups {
    One(String),
    Many(Vec<String>),
}

struct EntryVisitor;

impl<'de> Visitor<'de> for EntryVisitor {
    type Value = FitEntry;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a table of keys")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> std::result::Result<FitEntry, A::Error> {
        let mut entry = FitEntry::new("");
        let mut objective = None;
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "name" => entry.name = Some(map.next_value()?),
                "objective" => objective = Some(map.next_value()?),
                "springs" => {
                    entry.springs = Some(match map.next_value()? {
                        Groups::One(name) => vec![name],
                        Groups::Many(names) => names,
                    });
                }
                "engine" => entry.engine = Some(map.next_value::<EngineOrName>()?.0),
                "bending" => {
                    let name: String = map.next_value()?;
                    entry.bending = Some(BendingSprings::named(&name).map_err(|e| A::Error::custom(e.problem()))?);
                }
                _ => {
                    let value = map.next_value()?;
                    entry.keys.insert(key, value);
                }
            }
        }
        entry.objective = objective.ok_or_else(|| A::Error::missing_field("objective"))?;
        Ok(entry)
    }
}
