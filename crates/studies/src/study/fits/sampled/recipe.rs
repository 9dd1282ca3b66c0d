//! A sampled fit before the mesh is known.

use super::force::ForceRecipe;
use crate::element::Element;
use crate::error::{Error, Result};
use crate::fit::{Family, SampledFit, Sampling, Source, Weights};
use crate::springs::Springs;
use crate::study::fits::facts::SceneFacts;
use std::path::PathBuf;
use std::sync::Arc;

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
    /// The file that the shapes were read from.
    pub gradients: Option<PathBuf>,
}

impl Default for SampledRecipe {
    /// Shapes around rest and in all directions, each counting for its relative error.
    fn default() -> SampledRecipe {
        let families = vec![Family::Uniaxial, Family::Equibiaxial, Family::SimpleShear, Family::Volumetric];
        let sampling = Sampling { source: Source::Families(families), perturbation: 0.02, ..Sampling::default() };
        let fit = SampledFit { sampling, weights: Weights::Relative, ..SampledFit::default() };
        SampledRecipe { fit, force: ForceRecipe::Linear, loads: Vec::new(), law: None, gradients: None }
    }
}

impl SampledRecipe {
    /// The files that it names; the name of a shipped energy leads to no file.
    pub fn files(&self) -> impl Iterator<Item = PathBuf> {
        self.law.iter().map(PathBuf::from).chain(self.gradients.clone())
    }

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

    /// That the material and the loads of the scene are those that the fit needs. A law for the fit is not asked for here.
    ///
    /// # Errors
    /// There are two laws, no law that loads are followed with, or an unknown load.
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

    /// The shapes, as a stage names them.
    pub fn shapes(&self) -> String {
        let sampling = &self.fit.sampling;
        format!(" to forces at {} shapes with {} held out", sampling.shapes, sampling.held_out)
    }
}
