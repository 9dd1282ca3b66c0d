//! The keys of a `[[fit]]` whose objective is "whole".

use crate::error::{Error, Result};
use crate::fit::{Choices, Fit, Objective};
use crate::whole::WholeSettings;

/// A whole-object fit before the mesh is known.
#[derive(Debug, Clone, PartialEq)]
pub struct WholeRecipe {
    /// The constants it starts from; none is below zero.
    pub start: Fit,
    /// Loads of the scene that are fitted.
    pub loads: Vec<String>,
    /// Loads of the scene that choose the regularization.
    pub validated: Vec<String>,
    pub settings: WholeSettings,
}

/// What only a whole-object fit has.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WholeEntry {
    pub start: Option<String>,
    pub loads: Option<Vec<String>>,
    pub validate: Option<Vec<String>>,
}

impl WholeEntry {
    /// `choices` are those of the objective at the start.
    ///
    /// # Errors
    /// No loads are named, or one of them twice, or the start is no objective.
    pub fn check(self, choices: Choices, iterations: Option<u64>) -> Result<WholeRecipe> {
        let objective = Objective::named(self.start.as_deref().unwrap_or("offdiag"), choices)
            .map_err(|e| if e.key() == Some("objective") { Error::at("start", e.problem()) } else { e })?;
        let loads = self.loads.filter(|loads| !loads.is_empty());
        let loads = loads.ok_or_else(|| Error::expected("loads", "names of loads of the scene to fit", "none"))?;
        let validated = self.validate.unwrap_or_default();
        if let Some(name) = validated.iter().find(|name| loads.contains(name)) {
            return Err(Error::expected("validate", "loads that are not fitted", format!("\"{name}\"")));
        }
        let mut settings = WholeSettings::default();
        if validated.is_empty() {
            // Nothing tells when to stop: not too far from the start.
            settings.regularizations.retain(|rho| *rho >= 1e-4);
        }
        settings.iterations = iterations.unwrap_or(settings.iterations);
        if settings.iterations == 0 {
            return Err(Error::expected("iterations", "a number above 0", 0));
        }
        Ok(WholeRecipe { start: Fit { nonnegative: true, ..Fit::new(objective) }, loads, validated, settings })
    }
}
