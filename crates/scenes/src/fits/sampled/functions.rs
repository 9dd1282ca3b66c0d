//! Functions of the program that uses the library, in place of an energy and of laws of force.

use super::force::ForceRecipe;
use crate::error::{Error, Result};
use crate::fit::ResidualObjective;
use crate::springs::Law;
use crate::stiffness::EnergyFunction;

/// Functions in place of keys of a `[[fit]]` with the objective "sampled".
#[derive(Debug, Clone, Default)]
pub struct FitFunctions {
    /// The energy, in place of the key `law`.
    pub energy: Option<EnergyFunction>,
    /// The laws of force of spring groups, by name, beside the groups of the key `force`.
    pub groups: Vec<(String, Law)>,
    /// The law of force of all springs, in place of the key `force`.
    pub force: Option<Law>,
    /// What is minimised, in place of the key `norm`.
    pub norm: Option<ResidualObjective>,
}

impl FitFunctions {
    /// The key of the first function, if there is one.
    pub(crate) fn key(&self) -> Option<&'static str> {
        match (&self.energy, self.force.is_some() || !self.groups.is_empty()) {
            (Some(_), _) => Some("law"),
            (None, true) => Some("force"),
            (None, false) => self.norm.is_some().then_some("norm"),
        }
    }

    /// The force with these functions; `given` is that of the key, if it is there.
    ///
    /// # Errors
    /// Both are for all springs, or a group has two laws.
    pub(super) fn force(&self, given: Option<ForceRecipe>) -> Result<ForceRecipe> {
        let mut laws = match (given, &self.force) {
            (Some(_), Some(_)) => return Err(Error::expected("force", "one law for all springs", "two")),
            (None, Some(law)) => return Ok(ForceRecipe::Law(law.clone())),
            (given, None) if self.groups.is_empty() => return Ok(given.unwrap_or_default()),
            (None, None) => Vec::new(),
            (Some(ForceRecipe::Groups(laws)), None) => laws,
            (Some(ForceRecipe::Linear | ForceRecipe::FreeRest | ForceRecipe::Law(_)), None) => {
                return Err(Error::expected("force", "a table of laws beside the functions of groups", "one law"));
            }
        };
        for (group, law) in &self.groups {
            if laws.iter().any(|(known, _)| known == group) {
                return Err(Error::expected(format!("force.{group}"), "one law of the group", "two"));
            }
            laws.push((group.clone(), law.clone()));
        }
        Ok(ForceRecipe::Groups(laws))
    }
}
