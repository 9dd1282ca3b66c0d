//! How the springs of a fit are found, by the kind of the fit.

use super::exact::ExactRecipe;
use super::kind::FitKind;
use super::sampled::SampledRecipe;
use super::whole::WholeRecipe;
use crate::fit::Fit;
use crate::fit::published::Method;

/// How the springs of a fit are found.
#[derive(Debug, Clone, PartialEq)]
pub enum Recipe {
    /// From the stiffness at rest.
    Stiffness(Fit),
    /// From the forces at sampled shapes.
    Sampled(Box<SampledRecipe>),
    /// From the displacements of the whole object.
    Whole(Box<WholeRecipe>),
    /// By a published formula.
    Published(Method),
    /// The network that is equal to the finite element.
    Exact(ExactRecipe),
}

impl Recipe {
    /// The operations of its kind.
    pub fn kind(&self) -> &dyn FitKind {
        match self {
            Recipe::Stiffness(fit) => fit,
            Recipe::Sampled(recipe) => &**recipe,
            Recipe::Whole(recipe) => &**recipe,
            Recipe::Published(method) => method,
            Recipe::Exact(recipe) => recipe,
        }
    }

    /// The sampled fit that it is, or from which it starts.
    pub fn sampled(&self) -> Option<&SampledRecipe> {
        self.kind().sampled()
    }

    /// The fit to the stiffness at rest, if it is one.
    pub fn stiffness(&self) -> Option<Fit> {
        if let Recipe::Stiffness(fit) = self { Some(*fit) } else { None }
    }

    /// The whole-object fit, if it is one.
    pub fn whole(&self) -> Option<&WholeRecipe> {
        if let Recipe::Whole(recipe) = self { Some(recipe) } else { None }
    }

    /// Whether it is an exact network that may have negative constants: the springs of each part of the body are found by themselves.
    pub fn is_exact_without_bound(&self) -> bool {
        matches!(self, Recipe::Exact(recipe) if recipe.positive.is_none())
    }

    /// The published method, if it is one.
    pub fn published(&self) -> Option<Method> {
        if let Recipe::Published(method) = self { Some(*method) } else { None }
    }

    /// A name that states the settings, such as `modal 0.1 +bulk k>=0`.
    pub fn name(&self, springs: Option<&[String]>) -> String {
        let groups: String = match springs.unwrap_or_default() {
            // Words for groups of any element.
            [word] if word == "default" => String::new(),
            [word] if word.starts_with("all") => format!(" {word}"),
            groups => groups.iter().map(|group| format!(" +{group}")).collect(),
        };
        self.kind().title(&groups)
    }
}
