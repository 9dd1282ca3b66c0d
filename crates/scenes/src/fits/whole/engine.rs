//! The body in an engine: what its networks reach there, and factors on constants that make them answer like the body.
//!
//! Theory: page *Networks in engines* of the book.

use super::body::WholeBody;
use super::entry::FEW;
use super::recipe::{ValidationRecipe, WholeRecipe};
use crate::engine::{Ceiling, Setting, Sweep, Truncated, TruncatedModel, least_substeps};
use crate::error::{Error, ErrorKind, Result};
use crate::fit::CellFits;
use crate::fits::engine::{EngineErrors, EngineLimit, EngineOutcome};
use crate::fits::fitted::{Fitted, FittedKind};
use crate::model::Network;
use crate::progress::{Event, Progress};
use crate::whole::{DescentMethod, GaussNewton, Object, Target, Unknowns, Wanted, fit_whole};

impl WholeBody<'_> {
    /// The masses that an engine needs.
    ///
    /// # Errors
    /// The material has a law, or no density.
    pub(super) fn engine_masses(&self) -> Result<&[f64]> {
        if self.newton.is_some() {
            let expected = "a material without a \"law\": constants for an engine are fitted at small deformation";
            return Err(Error::expected("engine", expected, "one with a law"));
        }
        self.masses.ok_or_else(|| {
            let expected = "a density in [material] or --density: what an engine reaches depends on the masses";
            Error::expected("engine", expected, "none")
        })
    }

    /// Checks that a whole-object fit goes with an engine, and that the body is below its ceiling.
    ///
    /// # Errors
    /// Frequencies or masses are fitted as well, or those of [`WholeBody::check_ceiling`].
    pub(super) fn check_engine(
        &self,
        recipe: &WholeRecipe,
        setting: &Setting,
        network: &Network,
        wanted: &Wanted,
    ) -> Result<()> {
        for (key, count) in [("frequencies", recipe.frequencies), ("masses", recipe.masses)] {
            if count > 0 {
                let expected = "none with an \"engine\": frequencies are those of equations that are solved to the end";
                return Err(Error::expected(key, expected, count));
            }
        }
        self.check_ceiling(setting, network, &wanted.trained).map(|_| ())
    }

    /// How stiff a body the engine can hold.
    ///
    /// # Errors
    /// The body is above the ceiling, or the engine does not hold its springs.
    fn check_ceiling(&self, setting: &Setting, network: &Network, targets: &[Target]) -> Result<EngineLimit> {
        let limit = self.limit(setting, network, targets)?;
        let Some(factor) = limit.ceiling.filter(|factor| *factor < 1.0) else { return Ok(limit) };
        let least = limit.least_substeps;
        let words = least.map_or("thousands of substeps".into(), |least| format!("at least {least} substeps"));
        let expected = format!("{words} for a body of this stiffness, mass and size");
        let found =
            format!("{}, with which springs without compliance reach {factor:.3} of its modulus", setting.substeps);
        Err(Error::expected("engine.substeps", expected, found).of_kind(ErrorKind::Infeasible))
    }

    /// The limit of the engine for a network of these springs, under the loads that are made for a fit.
    ///
    /// # Errors
    /// The engine does not hold the springs.
    pub fn engine_limit(&self, setting: Setting, network: &Network, progress: &mut Progress) -> Result<EngineLimit> {
        let wanted = self.wanted(&few(setting), &mut None, progress)?;
        self.limit(&setting, network, &wanted.trained)
    }

    fn limit(&self, setting: &Setting, network: &Network, targets: &[Target]) -> Result<EngineLimit> {
        let model = TruncatedModel { network, points: &self.mesh.points, masses: self.engine_masses()? };
        let loads: Vec<_> =
            targets.iter().map(|target| (&target.support, &target.forces[..], &target.displacement[..])).collect();
        let ceiling = Ceiling::of(model, &loads, setting)?.map(|ceiling| ceiling.factor);
        let least_substeps = match ceiling {
            Some(_) => least_substeps(model, &loads, setting)?,
            None => None,
        };
        // A body of several moduli has none that stands for it.
        let modulus = ceiling.zip(self.material.uniform()).map(|(factor, material)| factor * material.young());
        Ok(EngineLimit { setting: *setting, ceiling, modulus, least_substeps })
    }

    /// Measures what a network answers in an engine. The constants of a fit that does not know of the engine are multiplied by one factor for
    /// springs on lengths and one for those on contents.
    ///
    /// # Errors
    /// The engine does not hold the network, or the body is above its ceiling.
    pub(crate) fn in_engine(
        &self,
        (name, setting): (&str, Setting),
        fitted: &mut Fitted,
        progress: &mut Progress,
    ) -> Result<EngineOutcome> {
        progress(Event::stage(&format!("{name}: engine"), 0, 1));
        let masses = self.engine_masses()?;
        let recipe = few(setting);
        let wanted = self.wanted(&recipe, &mut None, progress)?;
        let limit = self.check_ceiling(&setting, &fitted.network, &wanted.trained)?;
        let (before, after, factors) = match &fitted.kind {
            FittedKind::Whole(outcome) => {
                let before = outcome.fitted.iter().map(|load| load.before).collect();
                (before, outcome.fitted.iter().map(|load| load.after).collect(), None)
            }
            _ => {
                let unknowns = Unknowns::per_kind(&fitted.network);
                let object = Object::new(&fitted.network, &self.mesh.points, unknowns, None)?;
                let object = object.in_engine(Some((setting, masses)));
                let found =
                    fit_whole(&object, &wanted, &self.settings(&recipe), None, &mut |_| !self.controls.cancelled())?;
                let factors: Vec<f64> = found.theta.iter().map(|theta| theta.exp()).collect();
                scale(&mut fitted.cells, &factors);
                fitted.network = found.network;
                let [before, after] = found.trained.map(|errors| errors.loads);
                (before, after, Some(factors))
            }
        };
        let unknown = || {
            let problem = "the network is not stable in the engine under each of the loads that are made for the fit";
            Error::at("engine", problem).of_kind(ErrorKind::Infeasible)
        };
        let model = TruncatedModel { network: &fitted.network, points: &self.mesh.points, masses };
        let truncated = Truncated::new(model, self.support, &setting)?.ok_or_else(unknown)?;
        // Sweeps that take springs one after the other, and do not correct more than they find, damp all motions.
        let may_grow = setting.sweep == Sweep::Jacobi || setting.relaxation > 1.0;
        if let Some(growth) = may_grow.then(|| truncated.growth()).flatten() {
            let expected = "sweeps with which a body that is let go comes to rest";
            let found = format!("{}, with which each substep multiplies its motion by {growth:.2}", setting.words());
            let advice = "; more substeps, less relaxation, or \"gauss-seidel\" without relaxation damp it";
            return Err(Error::expected("engine", expected, found).followed_by(advice).of_kind(ErrorKind::Unsupported));
        }
        let vibration = match truncated.lowest_vibration() {
            // The fit is not lost where its first vibration is not found.
            Err(error) if error.kind() == ErrorKind::Limit => None,
            found => found?.map(Into::into),
        };
        let modes = self.equations("engine", self.support)?.lowest_modes(masses, self.mesh.dimension, 1)?;
        Ok(EngineOutcome {
            limit,
            factors,
            before: EngineErrors::of(&before).ok_or_else(unknown)?,
            after: EngineErrors::of(&after).ok_or_else(unknown)?,
            vibration,
            frequency: modes.squares.first().map_or(f64::NAN, |square| square.sqrt() / std::f64::consts::TAU),
        })
    }
}

/// A fit with few unknowns under loads that are made from the mesh.
fn few(setting: Setting) -> WholeRecipe {
    let (engine, validation) = (Some(setting), ValidationRecipe::None);
    let mut recipe = WholeRecipe { engine, validation, ..WholeRecipe::default() };
    recipe.settings.regularizations = vec![FEW];
    recipe.settings.method = DescentMethod::GaussNewton(GaussNewton::PRECISE);
    recipe
}

/// Multiplies the constants of the cells by the factors for springs on lengths and on contents.
fn scale(cells: &mut [CellFits], factors: &[f64]) {
    for fit in cells {
        let (pairs, count) = (fit.springs.pairs().len(), fit.springs.len().max(1));
        for (place, constant) in fit.constants.iter_mut().enumerate() {
            let kind = usize::from(place % count >= pairs);
            *constant *= factors.get(kind).copied().unwrap_or(1.0);
        }
    }
}
