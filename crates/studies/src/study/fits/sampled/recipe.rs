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
    /// How many gradients of the file are to be fitted, if the scene says so.
    pub count: Option<usize>,
    /// How many of them are to be held out, if the scene says so.
    pub held_out: Option<usize>,
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
        SampledRecipe {
            fit,
            force: ForceRecipe::Linear,
            loads: Vec::new(),
            law: None,
            energy: None,
            gradients: None,
            count: None,
            held_out: None,
        }
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
    /// A group has no law, or more gradients are asked for than their file has.
    pub fn resolve(&self, element: &Element, springs: &Springs, states: &Arc<Vec<Vec<f64>>>) -> Result<SampledFit> {
        let mut fit = self.fit.clone();
        fit.force = self.force.resolve(element, springs)?;
        if let Some(listed) = fit.sampling.listed(element.dimension()) {
            let [own, others] = [("count", self.count, "fitted"), ("held_out", self.held_out, "held out")];
            for ((key, asked, part), listed) in [own, others].into_iter().zip(listed) {
                if let Some(asked) = asked.filter(|asked| *asked > listed) {
                    let expected = format!("at most {listed}, the shapes of the list that are {part}");
                    return Err(Error::expected(format!("shapes.{key}"), expected, asked));
                }
            }
        }
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
        match &self.gradients {
            Some(path) => format!(" to forces at the shapes of {}", path.display()),
            None => format!(" to forces at {} shapes with {} held out", sampling.shapes, sampling.held_out),
        }
    }
}
