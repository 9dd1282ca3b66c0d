//! A fit of a scene with its name.

use super::recipe::Recipe;
use crate::fit::Fit;

/// A fit, what a report calls it, and the spring groups it uses.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedFit {
    pub name: String,
    pub recipe: Recipe,
    /// All groups that are not optional, if absent.
    pub springs: Option<Vec<String>>,
    /// The number of its `[[fit]]` in the scene file.
    entry: Option<usize>,
}

impl NamedFit {
    /// The recipe under the name that says what it does, such as `modal 0.1 +bulk`.
    pub fn new(fit: Fit, springs: Option<Vec<String>>) -> NamedFit {
        NamedFit::of(Recipe::Stiffness(fit), springs)
    }

    pub fn of(recipe: Recipe, springs: Option<Vec<String>>) -> NamedFit {
        NamedFit::named(recipe.name(springs.as_deref()), recipe, springs)
    }

    /// The recipe under a name of one's own.
    pub fn named(name: impl Into<String>, recipe: Recipe, springs: Option<Vec<String>>) -> NamedFit {
        NamedFit { name: name.into(), recipe, springs, entry: None }
    }

    /// The fit as that of the `[[fit]]` of this number.
    pub(in crate::study) fn of_entry(self, entry: usize) -> NamedFit {
        NamedFit { entry: Some(entry), ..self }
    }

    /// The number of its `[[fit]]` in the scene file, from 0; `None` if it is from no file.
    pub fn entry(&self) -> Option<usize> {
        self.entry
    }

    /// The key of errors about it: `fit[2]`, or `fit "modal"` if it is from no file.
    pub(in crate::study) fn place(&self) -> String {
        self.entry.map_or_else(|| format!("fit \"{}\"", self.name), |entry| format!("fit[{entry}]"))
    }
}
