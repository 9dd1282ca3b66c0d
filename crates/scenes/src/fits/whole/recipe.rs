//! A whole-object fit, before the mesh is known.

use crate::engine::Setting;
use crate::error::{Error, Result};
use crate::fit::{Fit, ShearSprings, VolumeSprings};
use crate::fits::exact::spring_words;
use crate::fits::facts::SceneFacts;
use crate::fits::sampled::SampledRecipe;
use crate::whole::{ModuliSharing, WholeSettings};

/// The settings of a whole-object fit, before the mesh is known.
#[derive(Debug, Clone, PartialEq)]
pub struct WholeRecipe {
    /// The constants from which it starts.
    pub start: Start,
    /// The engine in which the network is to answer like the body; `None` where equations are solved to the end.
    pub engine: Option<Setting>,
    /// Which springs share an unknown factor.
    pub unknowns: Sharing,
    /// The loads that are fitted: those of the scene by name, and whether those generated from the mesh are used.
    pub loads: LoadSelection,
    /// How the regularization is chosen.
    pub validation: ValidationRecipe,
    /// The settings of the optimisation.
    pub settings: WholeSettings,
    /// The number of natural frequencies of the finite elements that are fitted as well.
    pub frequencies: usize,
    /// The number of natural frequencies to which the masses are fitted after the springs.
    pub masses: usize,
    /// The seed of the random loads.
    pub seed: u64,
    /// The supports under which made loads are fitted, each by the names of the groups that are held or by conditions; that
    /// of the scene if empty.
    pub supports: Vec<Vec<String>>,
    /// The stretch that made loads cause at large deformation; `None` stands for 0.3.
    pub stretch: Option<f64>,
    /// The supports under which made loads of the validation act; those of the fit if empty.
    pub validation_supports: Vec<Vec<String>>,
    /// The supports under which loads neither are fitted nor choose ρ, and errors are reported.
    pub other_supports: Vec<Vec<String>>,
}

/// The constants from which a fit starts; none is negative.
#[derive(Debug, Clone, PartialEq)]
pub enum Start {
    /// Those of a fit to the stiffness at rest.
    Fit(Fit),
    /// Those of a sampled fit, at large deformation.
    Sampled(Box<SampledRecipe>),
    /// One constant for all springs of a kind.
    Equal,
    /// The exact network with these springs for μ and λ, whose moduli are the unknowns.
    Exact(ShearSprings, VolumeSprings),
}

/// The springs that share an unknown factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sharing {
    /// Each spring of the network has a factor.
    #[default]
    Spring,
    /// The springs of each group share a factor.
    Group,
    /// The springs of each group in each region of the mesh share a factor.
    Region,
    /// Each spring of each element has a factor.
    Element,
    /// The moduli of each cell of an exact network, or of the domain of each edge, have factors, and so has each patch.
    Moduli,
    /// The moduli of the cells of each region of the mesh have factors.
    RegionModuli,
    /// Young's modulus of the cells of each region of the mesh has a factor; Poisson's ratio stays.
    RegionYoung,
    /// The moduli of the body have factors.
    BodyModuli,
}

/// Loads of the scene by name, and whether a set generated from the mesh is used as well.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LoadSelection {
    /// The names of the loads.
    pub names: Vec<String>,
    /// Whether generated loads are used.
    pub made: bool,
}

/// How the regularization is chosen.
#[derive(Debug, Clone, PartialEq)]
pub enum ValidationRecipe {
    /// By the error on these loads.
    Loads(LoadSelection),
    /// By the error on each load of the fit when it is left out.
    LeaveOneOut,
    /// By the noise of the displacements.
    Discrepancy,
    /// Not at all: the last regularization is used.
    None,
}

/// The stretch of made loads at large deformation, where the scene names none: that of the paper's table 3.
pub const STRETCH: f64 = 0.3;
/// The name of the loads that are generated from the mesh.
pub const MADE: &str = "made";
/// The name of the validation that leaves out one load at a time.
pub const LEAVE_ONE_OUT: &str = "leave-one-out";
/// The name of the validation by the noise of measured displacements.
pub const DISCREPANCY: &str = "discrepancy";
/// Names that no load of a scene may have.
pub const RESERVED: [&str; 3] = [MADE, LEAVE_ONE_OUT, DISCREPANCY];

impl Start {
    /// The name in reports.
    pub fn title(&self) -> String {
        match self {
            Start::Fit(fit) => fit.objective.title(),
            Start::Sampled(recipe) => format!("sampled{}", recipe.force.name()),
            Start::Equal => "equal".into(),
            Start::Exact(shear, volume) => format!("exact{}", spring_words(*shear, *volume)),
        }
    }
}

crate::named!(Sharing {
    "spring" => Spring,
    "group" => Group,
    "region" => Region,
    "element" => Element,
    "moduli" => Moduli,
    "region-moduli" => RegionModuli,
    "region-young" => RegionYoung,
    "body-moduli" => BodyModuli,
});

impl Sharing {
    /// The cells that share moduli; `None` if the unknowns are no moduli.
    pub fn moduli(self) -> Option<ModuliSharing> {
        match self {
            Sharing::Moduli => Some(ModuliSharing::Element),
            Sharing::RegionModuli => Some(ModuliSharing::Region),
            Sharing::RegionYoung => Some(ModuliSharing::RegionYoung),
            Sharing::BodyModuli => Some(ModuliSharing::Body),
            Sharing::Spring | Sharing::Group | Sharing::Region | Sharing::Element => None,
        }
    }
}

impl WholeRecipe {
    /// Whether the unknowns are moduli of the body or of its regions.
    pub fn is_of_few_moduli(&self) -> bool {
        self.unknowns.moduli().is_some_and(|sharing| sharing != ModuliSharing::Element)
    }

    /// The groups and conditions of all lists of supports.
    pub fn held(&self) -> impl Iterator<Item = &String> {
        [&self.supports, &self.validation_supports, &self.other_supports].into_iter().flatten().flatten()
    }

    /// Whether loads are made from the mesh, for the fit or to choose ρ.
    pub fn has_made_loads(&self) -> bool {
        self.loads.made || matches!(&self.validation, ValidationRecipe::Loads(loads) if loads.made)
    }

    /// Checks the settings that depend on the material.
    ///
    /// # Errors
    /// Loads have a stretch and displacements are small, or frequencies are fitted without a density.
    pub fn check(&self, law: bool, density: bool) -> Result<()> {
        if self.stretch.is_some() && !law {
            let problem =
                "belongs to a material with a \"law\", found one without: at small deformation loads have no size";
            return Err(Error::at("stretch", problem));
        }
        if self.frequencies > 0 && !density {
            return Err(Error::expected("frequencies", "a density in [material]", "none"));
        }
        if self.masses > 0 && !density {
            return Err(Error::expected("masses", "a density in [material]", "none"));
        }
        if self.masses > 0 && law {
            return Err(Error::expected("masses", "a material without a law", "one with a law"));
        }
        Ok(())
    }

    /// Checks that the loads of the recipe are in the scene, and calls [`WholeRecipe::check`].
    ///
    /// # Errors
    /// A load is unknown, or a setting contradicts the material.
    pub fn check_in(&self, scene: &SceneFacts) -> Result<()> {
        scene.expect_loads("loads", &self.loads.names)?;
        if let ValidationRecipe::Loads(loads) = &self.validation {
            scene.expect_loads("validate", &loads.names)?;
        }
        self.check(scene.law, scene.density)
    }
}

impl LoadSelection {
    /// These names, among which `made` stands for the generated loads.
    pub fn new(names: Vec<String>) -> LoadSelection {
        let made = names.iter().any(|name| name == MADE);
        LoadSelection { names: names.into_iter().filter(|name| name != MADE).collect(), made }
    }

    /// The loads in words, for notes and reports.
    pub fn words(&self) -> Vec<String> {
        let made = self.made.then(|| "loads made from the mesh".to_string());
        self.names.iter().cloned().chain(made).collect()
    }
}

impl ValidationRecipe {
    /// The validation in words, for notes and reports.
    pub fn words(&self) -> Vec<String> {
        match self {
            ValidationRecipe::Loads(loads) if loads.made && loads.names.is_empty() => {
                vec!["random loads made from the mesh".into()]
            }
            ValidationRecipe::Loads(loads) => loads.words(),
            ValidationRecipe::LeaveOneOut => vec!["each of them left out in turn".into()],
            ValidationRecipe::Discrepancy => vec!["the noise of the displacements".into()],
            ValidationRecipe::None => Vec::new(),
        }
    }
}
