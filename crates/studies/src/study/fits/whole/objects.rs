//! The network that a whole-object fit begins with, and its unknowns.

use super::body::WholeBody;
use super::recipe::{Sharing, Start, WholeRecipe};
use crate::error::Result;
use crate::fit::{CellFits, ShearSprings, VolumeSprings};
use crate::model::Network;
use crate::whole::{
    BodyRegions, Displacements, ModuliParts, ModuliSharing, Object, Unknowns, Validation, Wanted, WholeSettings,
    fit_whole,
};

impl WholeBody<'_> {
    /// The springs of `network`, which was assembled from `fits`.
    pub(super) fn springs(&self, recipe: &WholeRecipe, fits: &[CellFits], network: &Network) -> Result<Object<'_>> {
        let unknowns = match recipe.unknowns {
            Sharing::Group => Unknowns::per_group(self.mesh, fits, network)?,
            Sharing::Region => {
                let regions = BodyRegions::of(self.mesh, &self.material);
                Unknowns::per_region(self.mesh, &regions, fits, network)?
            }
            Sharing::Element => Unknowns::per_element(self.mesh, fits, network)?,
            Sharing::Spring | Sharing::Moduli | Sharing::RegionModuli | Sharing::RegionYoung | Sharing::BodyModuli => {
                Unknowns::per_spring(network)
            }
        };
        Ok(Object::new(network, &self.mesh.points, unknowns, self.newton)?.iterated(self.iterations()))
    }

    /// The moduli of the exact network. Those of cells or regions start from those of the body that fit best.
    pub(super) fn moduli(&self, recipe: &WholeRecipe, held: &[bool], wanted: &Wanted) -> Result<Object<'_>> {
        let springs = match recipe.start {
            Start::Exact(shear, volume) => (shear, volume),
            Start::Fit(_) | Start::Sampled(_) | Start::Equal => (ShearSprings::default(), VolumeSprings::default()),
        };
        let parts = ModuliParts::new(self.mesh, self.material.clone(), springs, held)?;
        let of_body = parts.unknowns(ModuliSharing::Body);
        let sharing = recipe.unknowns.moduli().unwrap_or(ModuliSharing::Element);
        if sharing == ModuliSharing::Body {
            return Ok(Object::of_moduli(parts, of_body)?.iterated(self.iterations()));
        }
        // Poisson's ratio is that of the material.
        if sharing == ModuliSharing::RegionYoung {
            let unknowns = parts.unknowns(sharing);
            return Ok(Object::of_moduli(parts, unknowns)?.iterated(self.iterations()));
        }
        let body = Object::of_moduli(parts.clone(), of_body.clone())?.iterated(self.iterations());
        let wanted = Wanted { validation: Validation::None, ..wanted.clone() };
        let settings = WholeSettings { regularizations: vec![0.0], ..self.settings(recipe) };
        let mut last = vec![0.0; of_body.count()];
        let found = fit_whole(&body, &wanted, &settings, None, &mut |snapshot| {
            last = snapshot.map_or(last.clone(), |snapshot| snapshot.theta.clone());
            true
        })?;
        let parts = if found.stands { parts.scaled(&of_body.factors(&last)) } else { parts };
        let unknowns = parts.unknowns(sharing);
        Ok(Object::of_moduli(parts, unknowns)?.iterated(self.iterations()))
    }

    /// Gives the springs of an object equal constants, with which they are as stiff as the body is.
    pub(super) fn equal<'a>(&self, object: Object<'a>, wanted: &Wanted) -> Result<Object<'a>> {
        let object = object.alike();
        if self.newton.is_some() {
            return Ok(object);
        }
        let theta = vec![0.0; object.unknowns().count()];
        let problem = Displacements::new(&object, wanted.trained.iter().collect(), None)?;
        let factor = problem.best_factor(&theta)?.unwrap_or(1.0);
        drop(problem);
        Ok(object.scaled(factor))
    }
}
