//! The network that a whole-object fit begins with, and its unknowns.

use super::body::WholeBody;
use super::made_loads::MadeLoads;
use super::recipe::{Sharing, Start, WholeRecipe};
use crate::error::{Error, ErrorKind, Result};
use crate::fit::{CellFits, ExactEnergy, ExactFit, ShearSprings, VolumeSprings};
use crate::fits::exact::ExactRecipe;
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

    /// The exact network of the body with these springs, with the energy of its law.
    ///
    /// # Errors
    /// The law is not one of springs.
    pub(super) fn exact(&self, shear: ShearSprings, volume: VolumeSprings) -> Result<ExactFit> {
        let recipe = ExactRecipe { shear, volume, ..ExactRecipe::default() };
        let fit = recipe.resolve_all(self.laws).and_then(|fit| fit.energy.has_contents().map(|()| fit));
        fit.map_err(|e| {
            let names = ExactEnergy::of_contents().join("\" or \"");
            let expected = format!("a law that is \"{names}\" in all cells, where the start is \"exact\"");
            let found = self.laws.map_or_else(|| e.problem().to_string(), |laws| laws.title());
            Error::expected("start", expected, found).of_kind(ErrorKind::Unsupported)
        })
    }

    /// Leaves out the made loads under which the network has no stable equilibrium at the start: one alone would end the fit.
    pub(super) fn keep_reached(
        &self,
        object: &Object,
        wanted: &mut Wanted,
        followed: &mut Option<MadeLoads>,
    ) -> Result<()> {
        let Some(followed) = followed.as_mut() else { return Ok(()) };
        let mut others = match &mut wanted.validation {
            Validation::Loads(loads) => Some(loads),
            Validation::None | Validation::LeaveOneOut | Validation::Discrepancy => None,
        };
        for targets in std::iter::once(&mut wanted.trained).chain(others.iter_mut().map(|loads| &mut **loads)) {
            let none = vec![0.0; object.unknowns().count()];
            let reached = Displacements::new(object, targets.iter().collect(), None)?.reached(&none)?;
            let mut reached = reached.into_iter();
            targets.retain(|target| {
                let is_kept = reached.next().unwrap_or(true) || !target.is_made;
                if !is_kept {
                    followed.not_followed.push(target.name.clone());
                }
                is_kept
            });
        }
        Ok(())
    }

    /// The moduli of the exact network. Those of cells or regions start from those of the body that fit best.
    pub(super) fn moduli(
        &self,
        recipe: &WholeRecipe,
        held: &[bool],
        wanted: &mut Wanted,
        followed: &mut Option<MadeLoads>,
    ) -> Result<Object<'_>> {
        let (shear, volume) = match recipe.start {
            Start::Exact(shear, volume) => (shear, volume),
            Start::Fit(_) | Start::Sampled(_) | Start::Equal => (ShearSprings::default(), VolumeSprings::default()),
        };
        if let Some(law) = self.laws.and_then(|laws| laws.laws().find(|law| law.has_fibres())) {
            let expected = "a law without fibres, where moduli are unknown";
            return Err(
                Error::expected("start", expected, format!("\"{}\"", law.name())).of_kind(ErrorKind::Unsupported)
            );
        }
        let parts = ModuliParts::new(self.mesh, self.material.clone(), &self.exact(shear, volume)?, held)?;
        let object = |parts, unknowns| Ok(Object::of_moduli(parts, unknowns, self.newton)?.iterated(self.iterations()));
        let body = object(parts.clone(), parts.unknowns(ModuliSharing::Body))?;
        self.keep_reached(&body, wanted, followed)?;
        let of_body = parts.unknowns(ModuliSharing::Body);
        let sharing = recipe.unknowns.moduli().unwrap_or(ModuliSharing::Element);
        if sharing == ModuliSharing::Body {
            return Ok(body);
        }
        // Poisson's ratio is that of the material.
        if sharing == ModuliSharing::RegionYoung {
            let unknowns = parts.unknowns(sharing);
            return object(parts, unknowns);
        }
        let wanted = Wanted { validation: Validation::None, ..wanted.clone() };
        let settings = WholeSettings { regularizations: vec![0.0], ..self.settings(recipe) };
        let mut last = vec![0.0; of_body.count()];
        let found = fit_whole(&body, &wanted, &settings, None, &mut |snapshot| {
            last = snapshot.map_or(last.clone(), |snapshot| snapshot.theta.clone());
            true
        })?;
        let parts = if found.stands { parts.scaled(&of_body.factors(&last)) } else { parts };
        let unknowns = parts.unknowns(sharing);
        object(parts, unknowns)
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
