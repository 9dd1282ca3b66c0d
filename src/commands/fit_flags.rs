//! The flags of `springfit fit` that are keys of a `[[fit]]`.

use clap::{Args, Command};
use serde_json::Value;
use springfit_report::report::default_words;
use springfit_studies::study::{FitEntry, fit_schema};
use std::sync::LazyLock;

/// The fits of the schema, by which flags are explained.
static FITS: LazyLock<Value> = LazyLock::new(fit_schema);

/// What a flag gives to its key.
trait Given {
    fn given(&self) -> Option<toml::Value>;
}

impl<T: Clone + Into<toml::Value>> Given for Option<T> {
    fn given(&self) -> Option<toml::Value> {
        self.clone().map(Into::into)
    }
}

impl Given for bool {
    fn given(&self) -> Option<toml::Value> {
        self.then_some(true.into())
    }
}

/// Defines the flags, each with its key in fits of one kind.
macro_rules! flags {
    ($($heading:literal of $kind:literal { $($(#[$more:meta])* $flag:ident: $type:ty = $key:literal,)+ })+) => {
        #[derive(Args)]
        pub struct FitFlags {
            $($(
                #[arg(long, help_heading = $heading)]
                $(#[$more])*
                pub $flag: $type,
            )+)+
        }

        impl FitFlags {
            /// The flags, the kind of fit that explains each, and their keys.
            const KEYS: &[(&str, &str, &str)] = &[$($((stringify!($flag), $kind, $key)),+),+];

            /// The values that are given, by key.
            fn given(&self) -> impl Iterator<Item = (&'static str, toml::Value)> {
                let all = [$($(($key, self.$flag.given())),+),+];
                all.into_iter().filter_map(|(key, value)| Some((key, value?)))
            }
        }
    };
}

flags! {
    "Fit" of "stiffness" {
        #[arg(value_delimiter = ',', value_name = "GROUP,…")]
        springs: Option<Vec<String>> = "springs",
        tied: bool = "tied",
        nonnegative: bool = "nonnegative",
    }
    "Exact networks" of "exact" {
        energy: Option<String> = "energy",
        shear: Option<String> = "shear",
        volume: Option<String> = "volume",
        across: bool = "across",
    }
    "Sampled fits" of "sampled" {
        law: Option<String> = "law",
        force: Option<String> = "force",
        #[arg(allow_hyphen_values = true)]
        stretch: Option<f64> = "shapes.stretch",
        shapes: Option<u32> = "shapes.count",
    }
    "Fits to the stiffness" of "stiffness" {
        weight: Option<String> = "weight",
        higher: Option<f64> = "higher",
        balance: Option<f64> = "balance",
        rest: Option<String> = "rest",
        #[arg(allow_hyphen_values = true)]
        gap: Option<f64> = "gap",
    }
}

/// The schema of a key of fits of this kind; a dot leads into a table.
fn key_of(kind: &str, key: &str) -> Option<&'static Value> {
    let fit = FITS["oneOf"].as_array()?.iter().find(|fit| fit["title"] == kind)?;
    let own = |table: &'static Value, key: &str| table["properties"].get(key).filter(|key| key.get("x-of").is_none());
    let Some((table, inner)) = key.split_once('.') else { return own(fit, key) };
    let table = own(fit, table)?["anyOf"].as_array()?.iter().find_map(|one| one["$ref"].as_str())?;
    own(FITS.pointer(table.trim_start_matches('#'))?, inner)
}

/// The meaning of a key with its names and defaults, and the kind of fit if no other has the key.
fn help(kind: &str, key: &str) -> String {
    let schema = key_of(kind, key).expect("a flag is a key of a fit: without it no help could be printed");
    let kinds = FITS["oneOf"].as_array().into_iter().flatten().filter_map(|fit| fit["title"].as_str());
    let others: Vec<_> = kinds.filter(|other| *other != kind).filter_map(|o| Some((o, key_of(o, key)?))).collect();
    let mut words = schema["description"].as_str().unwrap_or_default().trim_end_matches('.').to_string();
    let names: Vec<&str> = schema["enum"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    if names.iter().any(|name| !words.contains(name)) {
        words += &format!(": {}", names.join(", "));
    }
    if schema["type"] != "boolean" && default_words(schema) != "none" {
        words += &format!(" [default: {}", default_words(schema));
        let own =
            others.iter().filter(|(_, other)| !other["default"].is_null() && other["default"] != schema["default"]);
        own.for_each(|(kind, other)| words += &format!("; {} if {kind}", default_words(other)));
        words.push(']');
    }
    if others.is_empty() && kind != "stiffness" {
        words += &format!(" ({kind} only)");
    }
    words.replace('\n', " ").chars().filter(|c| *c != '`').collect()
}

impl FitFlags {
    /// Adds to the flags of a command the help that their keys have.
    ///
    /// It is apart from their definition because most starts of the program print no help, and the schema takes longer than all other
    /// arguments.
    pub fn explained(command: Command) -> Command {
        command.mut_args(|arg| match Self::KEYS.iter().find(|(flag, ..)| arg.get_id() == flag) {
            Some((_, kind, key)) => arg.help(help(kind, key)),
            None => arg,
        })
    }

    /// The entry of a fit with this objective and the values that are given.
    pub fn entry(&self, objective: String) -> FitEntry {
        // The groups are a field of the entry; the other values are keys of its kind.
        let mut entry = FitEntry::new(objective).with_springs(self.springs.clone());
        let mut inner = toml::Table::new();
        for (key, value) in self.given() {
            match key.split_once('.') {
                Some((_, key)) => _ = inner.insert(key.into(), value),
                None if key == "springs" => {}
                None => entry = entry.with(key, Some(value)),
            }
        }
        entry.with("shapes", Some(inner).filter(|shapes| !shapes.is_empty()))
    }

    /// The flag that stands for a key, as its path in a scene ends.
    pub fn flag(&self, key: &str) -> Option<&'static str> {
        let last = |path: &'static str| path.rsplit('.').next().unwrap_or(path);
        let named = match key {
            "shapes" if self.shapes.is_some() => "count",
            "shapes" => "stretch",
            key => key,
        };
        Self::KEYS.iter().find(|(_, _, path)| last(path) == named).map(|(flag, ..)| *flag)
    }
}
