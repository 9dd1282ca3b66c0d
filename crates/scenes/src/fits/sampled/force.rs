//! The force law of a sampled fit.

use crate::element::{Element, SpringGroup};
use crate::error::{Error, Result};
use crate::named::unknown;
use crate::springs::{Force, Law, Springs};
use std::sync::Arc;

/// The force law of a sampled fit.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum ForceRecipe {
    /// Linear springs with the rest measure of the mesh.
    #[default]
    Linear,
    /// Linear springs with rest measures of their own.
    FreeRest,
    /// One law for all groups.
    Law(Law),
    /// A law for each group, by name.
    Groups(Vec<(String, Law)>),
}

impl ForceRecipe {
    /// Parses `linear`, `free-rest` or a law.
    ///
    /// # Errors
    /// The text is not a law.
    pub fn parse(text: &str) -> Result<ForceRecipe> {
        match text {
            "linear" => Ok(ForceRecipe::Linear),
            "free-rest" => Ok(ForceRecipe::FreeRest),
            _ => Law::parse(text).map(ForceRecipe::Law).map_err(|e| e.placed(|e| Error::at("force", e.problem()))),
        }
    }

    /// The force with a law for each group of `springs`.
    ///
    /// # Errors
    /// A group has no law.
    pub(super) fn resolve(&self, element: &Element, springs: &Springs) -> Result<Force> {
        match self {
            ForceRecipe::Linear => Ok(Force::Linear),
            ForceRecipe::FreeRest => Ok(Force::FreeRest),
            ForceRecipe::Law(law) => Ok(Force::of_all(law.clone(), springs.names().len())),
            ForceRecipe::Groups(laws) => {
                let law = |group: &String| match laws.iter().find(|(named, _)| named == group) {
                    Some((_, law)) => Ok(Arc::new(law.clone())),
                    None => {
                        let expected = format!("a law for the group \"{group}\" of {}", element.name);
                        Err(Error::expected("force", expected, "none"))
                    }
                };
                springs.names().iter().map(law).collect::<Result<_>>().map(Force::Laws)
            }
        }
    }

    /// The number of unknowns of a fit of all springs of the element.
    pub fn unknowns(&self, element: &Element) -> usize {
        let columns = |group: &SpringGroup| match self {
            ForceRecipe::Linear => 1,
            ForceRecipe::FreeRest => 2,
            ForceRecipe::Law(law) => law.parameters.len(),
            ForceRecipe::Groups(laws) => {
                laws.iter().find(|(named, _)| *named == group.name).map_or(0, |(_, law)| law.parameters.len())
            }
        };
        element.springs.iter().map(|group| columns(group) * group.nodes.len().max(1)).sum()
    }

    /// Whether the force is linear in its parameters.
    pub fn is_linear(&self) -> bool {
        match self {
            ForceRecipe::Linear | ForceRecipe::FreeRest => true,
            ForceRecipe::Law(law) => law.is_linear(),
            ForceRecipe::Groups(laws) => laws.iter().all(|(_, law)| law.is_linear()),
        }
    }

    /// Checks that every law belongs to a group among `known`, those of all elements of a mesh.
    ///
    /// # Errors
    /// A law does not.
    pub fn check_groups(&self, known: &[&str]) -> Result<()> {
        let ForceRecipe::Groups(laws) = self else { return Ok(()) };
        match laws.iter().find(|(group, _)| !known.contains(&group.as_str())) {
            Some((group, _)) => {
                let expected = format!("groups of the fit's springs, {}", known.join(", "));
                Err(unknown(expected, known.iter().copied(), group).at_key("force"))
            }
            None => Ok(()),
        }
    }

    /// The name in reports.
    pub fn name(&self) -> String {
        match self {
            ForceRecipe::Linear => String::new(),
            ForceRecipe::FreeRest => " free rest".into(),
            ForceRecipe::Law(law) => format!(" {}", law.text),
            ForceRecipe::Groups(laws) => {
                let texts: Vec<String> = laws.iter().map(|(group, law)| format!("{group}: {}", law.text)).collect();
                format!(" {}", texts.join("; "))
            }
        }
    }
}
