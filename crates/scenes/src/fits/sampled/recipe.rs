//! A sampled fit, before the mesh is known.

use super::force::ForceRecipe;
use super::origin::{SetStates, ShapeOrigin, States};
use crate::body::LargeBody;
use crate::element::Element;
use crate::error::{Error, Result};
use crate::fit::{DeformationFamily, SampledFit, Sampling, Source, Weights};
use crate::fits::facts::SceneFacts;
use crate::mesh::Mesh;
use crate::order::distinct;
use crate::springs::Springs;
use crate::stiffness::EnergyFunction;
use std::path::PathBuf;
use std::sync::Arc;

/// The settings of a sampled fit, before the mesh is known.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledRecipe {
    /// The settings of the fit; force and shapes are filled in from the other fields.
    pub fit: SampledFit,
    /// The force law of the springs.
    pub force: ForceRecipe,
    /// Where the shapes of each set are from.
    pub origins: Vec<ShapeOrigin>,
    /// The energy if the material has no law: the name of a shipped one, or the path of a file.
    pub law: Option<String>,
    /// The energy if it is a function of the program that uses the library.
    pub energy: Option<EnergyFunction>,
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
            origins: vec![ShapeOrigin::default()],
            law: None,
            energy: None,
        }
    }
}

impl SampledRecipe {
    /// The files that it names; the name of a shipped energy is not a file.
    pub fn files(&self) -> impl Iterator<Item = PathBuf> {
        let of_shapes = self.origins.iter().flat_map(ShapeOrigin::both).flat_map(ShapeOrigin::files);
        self.law.iter().map(PathBuf::from).chain(of_shapes)
    }

    /// The loads of the scene under which shapes of the fit are those of the finite elements.
    pub fn loads(&self) -> Vec<String> {
        let own = self.origins.iter().filter(|origin| origin.is_of_scene());
        distinct(own.flat_map(|origin| &origin.loads).cloned())
    }

    /// Whether shapes are states of the whole body.
    pub fn has_states(&self) -> bool {
        self.origins.iter().flat_map(ShapeOrigin::both).any(ShapeOrigin::has_states)
    }

    /// The key of a set of shapes.
    pub(super) fn key(&self, set: usize) -> String {
        if self.origins.len() > 1 { format!("shapes[{set}]") } else { "shapes".into() }
    }

    /// The states of all sets.
    ///
    /// # Errors
    /// Those of [`ShapeOrigin::read`].
    pub fn states(&self, mesh: &Mesh, large: Option<&LargeBody>) -> Result<Arc<SetStates>> {
        let read = |(set, origin): (usize, &ShapeOrigin)| {
            let named = |e: Error| e.placed(|e| e.under(self.key(set)));
            let own = origin.read(mesh, large).map_err(named)?;
            let others = origin.others.as_ref().map(|others| others.read(mesh, large)).transpose();
            Ok([own, others.map_err(|e| named(e.placed(|e| e.under("held_out"))))?.flatten()])
        };
        self.origins.iter().enumerate().map(read).collect::<Result<_>>().map(SetStates).map(Arc::new)
    }

    /// The fit of the springs of one element; `states` are positions of the mesh if shapes are states of the body.
    ///
    /// # Errors
    /// A group has no law, or more gradients are asked for than their file has.
    pub fn resolve(&self, element: &Element, springs: &Springs, states: &Arc<SetStates>) -> Result<SampledFit> {
        let mut fit = self.fit.clone();
        fit.force = self.force.resolve(element, springs)?;
        let d = element.dimension();
        for (set, origin) in self.origins.iter().enumerate() {
            let sampling = if set == 0 { &mut fit.sampling } else { &mut fit.beside[set - 1] };
            check_listed(sampling, origin, d).map_err(|e| e.under(self.key(set)))?;
            let [own, of_others] = states.0.get(set).cloned().unwrap_or_default();
            settle(sampling, origin, own, d);
            if let (Some(others), Some(origin)) = (&mut sampling.others, &origin.others) {
                let listed =
                    if let Source::Gradients(list) = &others.source { list.len() / d.pow(2) } else { usize::MAX };
                if let Some(asked) = origin.count.filter(|asked| *asked > listed) {
                    let key = self.key(set) + ".held_out.count";
                    return Err(Error::expected(key, format!("at most {listed}, the shapes of the list"), asked));
                }
                settle(others, origin, of_others, d);
            }
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
        for (set, origin) in self.origins.iter().enumerate() {
            for (place, origin) in [".loads", ".held_out.loads"].iter().zip(origin.both()) {
                let key = self.key(set) + place;
                if origin.is_of_scene() {
                    if !scene.law {
                        let problem = "belongs to a material with a \"law\": without one no load is followed";
                        return Err(Error::at(key, problem));
                    }
                    scene.expect_loads(&key, &origin.loads)?;
                }
            }
        }
        Ok(())
    }

    /// The shapes, in words, for a list of stages.
    pub fn shapes(&self) -> String {
        let words = |(sampling, origin): (&Sampling, &ShapeOrigin)| match &origin.gradients {
            Some(path) => format!("the shapes of {}", path.display()),
            None => {
                let held_out = sampling.others.as_ref().map_or(sampling.held_out, |others| others.shapes);
                format!("{} shapes with {held_out} held out", sampling.shapes)
            }
        };
        let sets: Vec<String> = self.fit.sets().zip(&self.origins).map(words).collect();
        format!(" to forces at {}", sets.join(" and "))
    }
}

/// Checks that a list has as many gradients as are asked for.
fn check_listed(sampling: &Sampling, origin: &ShapeOrigin, dimension: usize) -> Result<()> {
    let is_whole = |list: &[f64]| list.len().is_multiple_of(dimension * dimension);
    if matches!(&sampling.source, Source::Gradients(list) if !is_whole(list)) {
        // The fit says what its gradients have to be.
        return Ok(());
    }
    let Some([own, others]) = sampling.listed(dimension) else { return Ok(()) };
    let parts = [("count", origin.count, "fitted", own), ("held_out", origin.held_out, "held out", others)];
    for (key, asked, part, listed) in parts {
        if let Some(asked) = asked.filter(|asked| *asked > listed) {
            let expected = format!("at most {listed}, the shapes of the list that are {part}");
            return Err(Error::expected(key, expected, asked));
        }
    }
    Ok(())
}

/// Sets the source to states if there are some, and leaves out families that the dimension does not have, unless they are named.
fn settle(sampling: &mut Sampling, origin: &ShapeOrigin, states: Option<States>, dimension: usize) {
    match (states, &mut sampling.source) {
        (Some(states), source) => *source = Source::States(states),
        (None, Source::Families(families)) if !origin.are_named => {
            families.retain(|family| family.least_dimension() <= dimension);
        }
        (None, Source::Families(_) | Source::Gradients(_) | Source::States(_)) => {}
    }
}
