//! The masses of a whole-object fit, and the natural frequencies that they give.

use super::body::WholeBody;
use super::held::Held;
use super::outcome::{FittedMasses, ModelFrequencies, SupportFrequencies, SupportPart};
use super::recipe::WholeRecipe;
use crate::error::{Error, Result};
use crate::model::{ConsistentMasses, Lumping, Moments, Network, lumped_masses};
use crate::progress::{Event, Progress};
use crate::solve::{Equations, Masses};
use crate::whole::{Frequencies, Vibrations, fit_mass_share, fit_masses};

impl WholeBody<'_> {
    /// The `count` lowest frequencies of the body, as ω².
    pub(super) fn squares(&self, key: &str, held: &Held, count: usize) -> Result<Vec<f64>> {
        let found = match (self.fine, &held.fine) {
            (Some(fine), Some(support)) => fine.vibrations(support, count),
            _ => {
                let masses = self.masses.unwrap_or_default();
                let equations = self.equations(key, &held.support)?;
                equations.lowest_modes(masses, self.mesh.dimension, count).map(|modes| modes.squares)
            }
        };
        found.map_err(|e| Error::at(key, e.problem()).of_kind(e.kind()))
    }

    pub(super) fn frequencies(&self, count: usize) -> Result<Option<Frequencies>> {
        let Some(masses) = self.masses.filter(|_| count > 0) else { return Ok(None) };
        let held = self.supports("supports", &[])?.remove(0);
        let squares = self.squares("frequencies", &held, count)?;
        // All frequencies together have the weight of one load.
        let weight = 1.0 / count as f64;
        let (support, masses) = (self.support.clone(), masses.to_vec());
        Ok(Some(Frequencies { support, masses, squares, weight }))
    }

    /// Fits the masses of a network to as many frequencies as the recipe says under each support of the fit; those of the validation
    /// choose ρ. As many frequencies more are compared.
    ///
    /// # Errors
    /// A model has fewer frequencies, or no masses at the points are those of the body.
    pub(super) fn fit_masses(
        &self,
        recipe: &WholeRecipe,
        network: &Network,
        progress: &mut Progress,
    ) -> Result<FittedMasses> {
        let (mesh, count) = (self.mesh, recipe.masses);
        let (density, d) = (self.material.densities(), mesh.dimension);
        let thickness = self.material.thicknesses();
        let lumped = lumped_masses(mesh, density.clone(), thickness.clone(), Lumping::Hrz);
        let at = |e: Error| Error::at("masses", e.problem()).of_kind(e.kind());
        let consistent = ConsistentMasses::of_mesh(mesh, density.clone(), thickness.clone()).map_err(at)?;
        let moments = match self.fine {
            Some(fine) => fine.moments(),
            None => Moments::of_body(mesh, density, thickness),
        };
        let supports = self.all_supports(recipe)?;
        for (held, _) in &supports {
            let free = held.support.prescribed.iter().filter(|held| held.is_none()).count();
            if 2 * count > free {
                let expected = format!(
                    "at most {}, half of the {free} free degrees of freedom held at {}, because as many frequencies more are compared",
                    free / 2,
                    held.words()
                );
                return Err(Error::expected("masses", expected, count));
            }
        }
        let (mut of_supports, mut wanted, mut others) = (Vec::new(), Vec::new(), Vec::new());
        for (done, (held, part)) in supports.iter().enumerate() {
            progress(Event::stage("frequencies of the body", done, supports.len()));
            let squares = self.squares("masses", held, 2 * count)?;
            let equations = self.equations_of(network, &held.support)?;
            let equations =
                equations.ok_or_else(|| Error::expected("masses", "a network that is stable", "another"))?;
            let vibrations =
                Vibrations { support: held.support.clone(), equations, squares: squares[..count].to_vec() };
            match part {
                SupportPart::Fitted => wanted.push(vibrations.clone()),
                SupportPart::Consulted => others.push(vibrations.clone()),
                SupportPart::Unseen => {}
            }
            of_supports.push((held, *part, squares, vibrations.equations));
        }
        let found = fit_masses(&mesh.points, d, &lumped, &moments, (&wanted, &others)).map_err(at)?;
        // The mesh of a curved body has another mass.
        let scale = moments.mass / consistent.total();
        let (consistent, scaled) =
            (consistent.scaled(scale).map_err(at)?, lumped.iter().map(|m| scale * m).collect::<Vec<_>>());
        let share = fit_mass_share(&consistent, &scaled, d, &wanted).map_err(at)?;
        let matrix = consistent.blended(&scaled, share).map_err(at)?;
        let frequencies = |(held, part, squares, equations): &(_, SupportPart, Vec<f64>, Equations)| {
            let held: &&Held = held;
            let body = self.equations("masses", &held.support)?;
            let models = [
                ("finite elements", &body, Masses::from(&lumped)),
                ("fitted", equations, Masses::from(&lumped)),
                ("fitted masses", equations, Masses::from(&found.masses)),
                ("mass matrix", equations, Masses::from(&matrix)),
            ];
            let model = |(model, equations, masses): (&str, &Equations, Masses)| {
                let modes = equations.lowest_modes(masses, d, squares.len()).map_err(at)?;
                let errors: Vec<f64> = modes.squares.iter().zip(squares).map(|(a, b)| (a / b).sqrt() - 1.0).collect();
                let rms = |errors: &[f64]| (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
                Ok(ModelFrequencies { model: model.into(), first: rms(&errors[..count]), next: rms(&errors[count..]) })
            };
            let models = models.into_iter().map(model).collect::<Result<_>>()?;
            Ok(SupportFrequencies { support: held.words(), part: *part, models })
        };
        let own = Moments::of_masses(&mesh.points, d, &found.masses);
        // A flat body has no second moment across itself: the quotient is not finite, and left out below.
        let off = |k: usize| (own.second[k * d + k] / moments.second[k * d + k] - 1.0).abs();
        let second_error = (0..d).map(off).filter(|off| off.is_finite()).fold(0.0, f64::max);
        Ok(FittedMasses {
            count,
            regularization: found.regularization,
            second_error,
            change: found.change,
            share,
            total: moments.mass,
            curve: found.curve,
            supports: of_supports.iter().map(frequencies).collect::<Result<_>>()?,
            masses: found.masses,
        })
    }
}
