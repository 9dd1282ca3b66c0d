//! A fit of a scene with its name.

use super::recipe::Recipe;
use crate::engine::Setting;
use crate::fit::Fit;
use crate::model::BendingSprings;

/// A fit, its name in reports, and its spring groups.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedFit {
    /// The name in reports.
    pub name: String,
    /// How the springs are found.
    pub recipe: Recipe,
    /// The spring groups; all that are not optional, if absent.
    pub springs: Option<Vec<String>>,
    /// The settings of the engine that the constants are for; `None` where equations are solved to the end.
    pub engine: Option<Setting>,
    /// Which springs resist the bending of a sheet; those of directors if absent.
    pub bending: Option<BendingSprings>,
    /// The number of its `[[fit]]` in the scene file.
    entry: Option<usize>,
}

impl NamedFit {
    /// A fit to the stiffness at rest, under a name that states its settings, such as `modal 0.1 +bulk`.
    pub fn new(fit: Fit, springs: Option<Vec<String>>) -> NamedFit {
        NamedFit::of(Recipe::Stiffness(fit), springs)
    }

    /// A fit by this recipe, under a name that states its settings.
    pub fn of(recipe: Recipe, springs: Option<Vec<String>>) -> NamedFit {
        NamedFit::named(recipe.name(springs.as_deref()), recipe, springs)
    }

    /// A fit by this recipe, under the given name.
    pub fn named(name: impl Into<String>, recipe: Recipe, springs: Option<Vec<String>>) -> NamedFit {
        NamedFit { name: name.into(), recipe, springs, engine: None, bending: None, entry: None }
    }

    /// The fit for the settings of an engine.
    #[must_use]
    pub fn in_engine(mut self, engine: Option<Setting>) -> NamedFit {
        if let Recipe::Whole(recipe) = &mut self.recipe {
            recipe.engine = engine;
        }
        NamedFit { engine, ..self }
    }

    /// The fit with these springs that resist bending.
    #[must_use]
    pub fn bending_by(self, bending: Option<BendingSprings>) -> NamedFit {
        NamedFit { bending, ..self }
    }

    /// Marks the fit as that of the `[[fit]]` with this number, from 0.
    pub fn of_entry(self, entry: usize) -> NamedFit {
        NamedFit { entry: Some(entry), ..self }
    }

    /// The number of its `[[fit]]` in the scene file, from 0; `None` if it is from no file.
    pub fn entry(&self) -> Option<usize> {
        self.entry
    }

    /// The key of errors about the fit: `fit[2]`, or `fit "modal"` if it is from no file.
    pub fn place(&self) -> String {
        self.entry.map_or_else(|| format!("fit \"{}\"", self.name), |entry| format!("fit[{entry}]"))
    }
}
