//! Closed lists of names that are both read and printed, and suggestions for misspelt names.

use crate::error::Error;
use std::fmt::Display;

/// The error for a name that is not in `names`: `expected …, found "…"`, with the most similar known name as a
/// suggestion.
pub fn unknown<'a>(expected: impl Display, names: impl IntoIterator<Item = &'a str>, found: &str) -> Error {
    Error::new(format!("expected {expected}, found \"{found}\"{}", suggestion(names, found)))
}

/// `; did you mean "…"?` with the name in `names` that is nearest to `found`; empty if no name is near.
///
/// The distance is that of Damerau and Levenshtein: the number of letters that are added, left out, changed or swapped.
/// A name is near if the distance is at most a third of the length of the longer name.
pub fn suggestion<'a>(names: impl IntoIterator<Item = &'a str>, found: &str) -> String {
    let plain = |name: &str| name.to_lowercase().replace(['_', ' '], "-");
    let wanted = plain(found);
    let near = |name: &'a str| {
        let distance = strsim::osa_distance(&plain(name), &wanted);
        let longer = name.chars().count().max(found.chars().count());
        (distance <= (longer / 3).max(1) && longer > 1).then_some((distance, name))
    };
    // Comparing long texts takes long, and a long text is not a misspelt name.
    let nearest = || names.into_iter().filter_map(near).min_by_key(|(distance, _)| *distance);
    match (found.len() <= LONGEST).then(nearest).flatten() {
        Some((_, name)) => format!("; did you mean \"{name}\"?"),
        None => String::new(),
    }
}

/// The largest number of letters of a name for which a suggestion is looked for; far above the length of all known
/// names.
const LONGEST: usize = 100;

/// Defines `NAMES`, `all()`, `name()` and `named(text)` of an enum from one list of names and values.
///
/// A variant with fields is listed with the values of its fields: these are the values that the name alone stands for.
/// A variant that is not in the list does not compile.
#[doc(hidden)]
#[macro_export]
macro_rules! named {
    ($type:ident { $($name:literal => $variant:ident $({ $($field:tt : $value:expr),+ })?),+ $(,)? }) => {
        // Not every list uses all four items.
        #[allow(dead_code)]
        impl $type {
            /// The names, as they appear in files, options and reports.
            pub const NAMES: &'static [&'static str] = &[$($name),+];

            /// The values, in the order of the names.
            pub fn all() -> impl Iterator<Item = $type> {
                [$($type::$variant { $($($field: $value),+)? }),+].into_iter()
            }

            /// The name of the value, as it appears in files, options and reports.
            pub fn name(&self) -> &'static str {
                match self {
                    $($type::$variant { .. } => $name),+
                }
            }

            /// The value with this name.
            ///
            /// # Errors
            /// No value has this name.
            pub fn named(name: &str) -> $crate::error::Result<$type> {
                match name {
                    $($name => Ok($type::$variant { $($($field: $value),+)? }),)+
                    other => {
                        let names = <$type>::NAMES;
                        Err($crate::named::unknown(format!("one of {}", names.join(", ")), names.iter().copied(), other))
                    }
                }
            }
        }
    };
}
