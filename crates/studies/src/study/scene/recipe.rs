//! What a fit of a scene is made from.

use super::whole::{Start, WholeRecipe};
use crate::element::{Element, SpringGroup};
use crate::error::{Error, Result};
use crate::fit::published::Method;
use crate::fit::{Fit, Objective, SampledFit, Solver, Source, Weight};
use crate::springs::{Force, Law, Springs};
use std::sync::Arc;

/// How the springs of a fit are found.
#[derive(Debug, Clone, PartialEq)]
pub enum Recipe {
    /// From the stiffness at rest.
    Stiffness(Fit),
    /// From the forces at sampled shapes.
    Forces(Box<SampledRecipe>),
    /// From the displacements of the whole object.
    Whole(Box<WholeRecipe>),
    /// By a published formula.
    Published(Method),
}

/// A sampled fit before the mesh is known.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledRecipe {
    /// With the force and the source of the shapes left open where the others say them.
    pub fit: SampledFit,
    pub force: ForceRecipe,
    /// Loads of the scene: the shapes are those of the finite elements under them.
    pub loads: Vec<String>,
    /// The energy, where the material has none: a shipped one's name, or the path of a file.
    pub law: Option<String>,
}

/// The law of force of a sampled fit.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum ForceRecipe {
    #[default]
    Linear,
    FreeRest,
    /// For all groups.
    Law(Law),
    /// For each group by name.
    Groups(Vec<(String, Law)>),
}

impl ForceRecipe {
    /// `linear`, `free-rest` or a law.
    ///
    /// # Errors
    /// The text is no law.
    pub fn parse(text: &str) -> Result<ForceRecipe> {
        match text {
            "linear" => Ok(ForceRecipe::Linear),
            "free-rest" => Ok(ForceRecipe::FreeRest),
            _ => Law::parse(text).map(ForceRecipe::Law).map_err(|e| e.placed(|e| Error::at("force", e.problem()))),
        }
    }

    /// With a law for each group of `springs`.
    ///
    /// # Errors
    /// A group has no law.
    fn resolve(&self, element: &Element, springs: &Springs) -> Result<Force> {
        match self {
            ForceRecipe::Linear => Ok(Force::Linear),
            ForceRecipe::FreeRest => Ok(Force::FreeRest),
            ForceRecipe::Law(law) => Ok(Force::of_all(law.clone(), springs.names.len())),
            ForceRecipe::Groups(laws) => {
                let law = |group: &String| match laws.iter().find(|(named, _)| named == group) {
                    Some((_, law)) => Ok(Arc::new(law.clone())),
                    None => {
                        let expected = format!("a law for the group \"{group}\" of {}", element.name);
                        Err(Error::expected("force", expected, "none"))
                    }
                };
                springs.names.iter().map(law).collect::<Result<_>>().map(Force::Laws)
            }
        }
    }

    /// Unknowns of a fit of all springs of the element.
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

    pub fn is_linear(&self) -> bool {
        match self {
            ForceRecipe::Linear | ForceRecipe::FreeRest => true,
            ForceRecipe::Law(law) => law.is_linear(),
            ForceRecipe::Groups(laws) => laws.iter().all(|(_, law)| law.is_linear()),
        }
    }

    /// That every law has a group among `known`, those of all elements of a mesh.
    ///
    /// # Errors
    /// One has none.
    pub fn check_groups(&self, known: &[&str]) -> Result<()> {
        let ForceRecipe::Groups(laws) = self else { return Ok(()) };
        match laws.iter().find(|(group, _)| !known.contains(&group.as_str())) {
            Some((group, _)) => {
                let expected = format!("groups of the fit's springs, {}", known.join(", "));
                Err(Error::expected("force", expected, format!("\"{group}\"")))
            }
            None => Ok(()),
        }
    }

    pub(super) fn name(&self) -> String {
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

impl SampledRecipe {
    /// The fit of one element's springs; `states` are positions of the mesh where the recipe names loads.
    ///
    /// # Errors
    /// A group has no law.
    pub fn resolve(&self, element: &Element, springs: &Springs, states: &Arc<Vec<Vec<f64>>>) -> Result<SampledFit> {
        let mut fit = self.fit.clone();
        fit.force = self.force.resolve(element, springs)?;
        if !self.loads.is_empty() {
            fit.sampling.source = Source::States(states.clone());
        }
        Ok(fit)
    }
}

impl Recipe {
    /// The sampled fit that it is or starts from.
    pub fn sampled(&self) -> Option<&SampledRecipe> {
        match self {
            Recipe::Forces(recipe) => Some(recipe),
            Recipe::Whole(recipe) => match &recipe.start {
                Start::Sampled(recipe) => Some(recipe),
                Start::Fit(_) | Start::Equal => None,
            },
            Recipe::Stiffness(_) | Recipe::Published(_) => None,
        }
    }

    /// The fit to stiffness at rest that it is or starts from.
    pub fn at_rest(&self) -> Option<Fit> {
        match self {
            Recipe::Stiffness(fit) => Some(*fit),
            Recipe::Whole(recipe) => match &recipe.start {
                Start::Fit(fit) => Some(*fit),
                // Its springs are what matters, not their constants.
                Start::Equal => Some(Fit::new(Objective::Frobenius(Weight::None))),
                Start::Sampled(_) => None,
            },
            Recipe::Forces(_) | Recipe::Published(_) => None,
        }
    }

    /// What says how it is made, such as `modal 0.1 +bulk k>=0`.
    pub fn name(&self, springs: Option<&[String]>) -> String {
        let groups: String = springs.unwrap_or_default().iter().map(|group| format!(" +{group}")).collect();
        let (mut name, tied, nonnegative) = match self {
            Recipe::Stiffness(fit) => {
                let solver = match fit.solver {
                    Solver::Native => String::new(),
                    _ => format!(" by {}", fit.solver.title()),
                };
                (fit.objective.title() + &groups + &solver, fit.tied, fit.nonnegative)
            }
            Recipe::Whole(recipe) => (format!("whole from {}{groups}", recipe.start.title()), false, false),
            Recipe::Published(method) => (method.name().to_string() + &groups, false, false),
            Recipe::Forces(recipe) => {
                let name = format!("sampled{}{groups}", recipe.force.name());
                (name, recipe.fit.tied, recipe.fit.nonnegative)
            }
        };
        if tied {
            name += " tied";
        }
        if nonnegative {
            name += " k>=0";
        }
        name
    }
}
