//! A sampled fit, before the mesh is known.

use super::force::ForceRecipe;
use crate::element::Element;
use crate::error::{Error, Result};
use crate::fit::{DeformationFamily, SampledFit, Sampling, Source, Weights};
use crate::springs::Springs;
use crate::stiffness::EnergyFunction;
use crate::study::fits::facts::SceneFacts;
use std::path::PathBuf;
use std::sync::Arc;

/// The settings of a sampled fit, before the mesh is known.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledRecipe {
    /// The settings of the fit; force and shapes are filled in from the other fields.
    pub fit: SampledFit,
    /// The force law of the springs.
    pub force: ForceRecipe,
    /// The loads of the scene under which the shapes are those of the finite elements.
    pub loads: Vec<String>,
    /// The energy if the material has no law: the name of a shipped one, or the path of a file.
    pub law: Option<String>,
    /// The energy if it is a function of the program that uses the library.
    pub energy: Option<EnergyFunction>,
    /// The file from which deformation gradients were read.
    pub gradients: Option<PathBuf>,
}

impl Default for SampledRecipe {
    /// Shapes around rest and in all directions, each weighted by its relative error.
    fn default() -> SampledRecipe {
        let families = vec![
            DeformationFamily::Uniaxial,
            DeformationFamily::Equibiaxial,
            DeformationFamily::SimpleShear,
            DeformationFamily::Volumetric,
        ];
        let sampling = Sampling { source: Source::Families(families), perturbation: 0.02, ..Sampling::default() };
        let fit = SampledFit { sampling, weights: Weights::Relative, ..SampledFit::default() };
        SampledRecipe { fit, force: ForceRecipe::Linear, loads: Vec::new(), law: None, energy: None, gradients: None }
    }
}

impl SampledRecipe {
    /// The files that it names; the name of a shipped energy is not a file.
    pub fn files(&self) -> impl Iterator<Item = PathBuf> {
        self.law.iter().map(PathBuf::from).chain(self.gradients.clone())
    }

    /// The fit of the springs of one element; `states` are positions of the mesh if the recipe names loads.
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

    /// Checks that the material and the loads of the scene are those that the fit requires. Whether the fit has a law
    /// is not checked here.
    ///
    /// # Errors
    /// There are two laws, the loads have no law, or a load is unknown.
    pub fn check(&self, scene: &SceneFacts) -> Result<()> {
        if let (true, Some(law)) = (scene.law, &self.law) {
            return Err(Error::expected("law", "none, as the material has a law", format!("\"{law}\"")));
        }
        if !scene.law && !self.loads.is_empty() {
            let problem = "belongs to a material with a \"law\": without one no load is followed";
            return Err(Error::at("shapes.loads", problem));
        }
        scene.expect_loads("shapes.loads", &self.loads)
    }

    /// The shapes, in words, for a list of stages.
    pub fn shapes(&self) -> String {
        let sampling = &self.fit.sampling;
        format!(" to forces at {} shapes with {} held out", sampling.shapes, sampling.held_out)
    }
}
