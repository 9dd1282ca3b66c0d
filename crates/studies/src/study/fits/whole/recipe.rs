//! A whole-object fit before the mesh is known.

use crate::error::{Error, Result};
use crate::fit::Fit;
use crate::study::fits::facts::SceneFacts;
use crate::study::fits::sampled::SampledRecipe;
use crate::whole::WholeSettings;

/// A whole-object fit before the mesh is known.
#[derive(Debug, Clone, PartialEq)]
pub struct WholeRecipe {
    pub start: Start,
    pub unknowns: Sharing,
    /// Loads of the scene that are fitted, and whether those made from the mesh are.
    pub loads: LoadSelection,
    pub validation: ValidationRecipe,
    pub settings: WholeSettings,
    /// How many natural frequencies of the finite elements are fitted as well.
    pub frequencies: usize,
    /// Of the random loads.
    pub seed: u64,
}

/// The constants it starts from; none is below zero.
#[derive(Debug, Clone, PartialEq)]
pub enum Start {
    Fit(Fit),
    /// Large deformation.
    Sampled(Box<SampledRecipe>),
    /// One constant for all springs of a kind.
    Equal,
}

/// What has a factor of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sharing {
    #[default]
    Spring,
    Group,
    Region,
    Element,
}

/// Loads of the scene by name, and whether a set that is made from the mesh is used as well.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LoadSelection {
    pub names: Vec<String>,
    pub made: bool,
}

/// What chooses the regularization.
#[derive(Debug, Clone, PartialEq)]
pub enum ValidationRecipe {
    Loads(LoadSelection),
    LeaveOneOut,
    /// Nothing: the last regularization is taken.
    None,
}

/// The name of the loads that are made from the mesh.
pub const MADE: &str = "made";
pub const LEAVE_ONE_OUT: &str = "leave-one-out";
/// Names that no load of a scene may have.
pub const RESERVED: [&str; 2] = [MADE, LEAVE_ONE_OUT];

impl Start {
    pub fn title(&self) -> String {
        match self {
            Start::Fit(fit) => fit.objective.title(),
            Start::Sampled(recipe) => format!("sampled{}", recipe.force.name()),
            Start::Equal => "equal".into(),
        }
    }
}

crate::named!(Sharing { "spring" => Spring, "group" => Group, "region" => Region, "element" => Element });

impl WholeRecipe {
    /// What of it goes with the material.
    ///
    /// # Errors
    /// Loads are made where displacements are large, or frequencies wanted without a density.
    pub fn check(&self, law: bool, density: bool) -> Result<()> {
        let judged = matches!(&self.validation, ValidationRecipe::Loads(loads) if loads.made);
        for (key, made) in [("loads", self.loads.made), ("validate", judged)] {
            if law && made {
                let expected = "loads of the scene, where the material has a law";
                return Err(Error::expected(key, expected, "\"made\""));
            }
        }
        if self.frequencies > 0 && !density {
            return Err(Error::expected("frequencies", "a density in [material]", "none"));
        }
        Ok(())
    }

    /// That the loads of the recipe are in the scene, and [`WholeRecipe::check`].
    ///
    /// # Errors
    /// A load is unknown, or a choice does not go with the material.
    pub fn check_in(&self, scene: &SceneFacts) -> Result<()> {
        scene.expect_loads("loads", &self.loads.names)?;
        if let ValidationRecipe::Loads(loads) = &self.validation {
            scene.expect_loads("validate", &loads.names)?;
        }
        self.check(scene.law, scene.density)
    }
}

impl LoadSelection {
    pub fn new(names: Vec<String>) -> LoadSelection {
        let made = names.iter().any(|name| name == MADE);
        LoadSelection { names: names.into_iter().filter(|name| name != MADE).collect(), made }
    }

    /// In words, for notes and reports.
    pub fn words(&self) -> Vec<String> {
        let made = self.made.then(|| "loads made from the mesh".to_string());
        self.names.iter().cloned().chain(made).collect()
    }
}

impl ValidationRecipe {
    /// In words, for notes and reports.
    pub fn words(&self) -> Vec<String> {
        match self {
            ValidationRecipe::Loads(loads) if loads.made && loads.names.is_empty() => {
                vec!["random loads made from the mesh".into()]
            }
            ValidationRecipe::Loads(loads) => loads.words(),
            ValidationRecipe::LeaveOneOut => vec!["each of them left out in turn".into()],
            ValidationRecipe::None => Vec::new(),
        }
    }
}
