//! What displacements say of few moduli: their deviations, and where they would put them without ρ.

use crate::error::Result;
use crate::whole::{
    Best, DescentMethod, Determination, Displacements, GaussNewton, Object, Snapshot, Validation, Wanted, WholeFit,
    WholeSettings, fit_whole,
};

/// The step to the optimum without ρ from which on linearisation is not enough to know that optimum. A linearisation
/// errs by about the square of the step, which is then below the intervals that are told.
const NEAR: f64 = 0.02;
/// Steps of the search for that optimum.
const STEPS: usize = 100;

/// What displacements say of the moduli that a fit has found.
#[derive(Debug, Clone)]
pub(super) struct Evidence {
    /// At the optimum without ρ, or where the fit has ended if that is near. Too many unknowns are not tried, and fewer displacements than
    /// unknowns determine none of them.
    pub known: Option<Determination>,
    /// The way of each unknown from where the fit has ended to the optimum without ρ.
    pub shifts: Vec<f64>,
    /// How many times as large as the stated noise the residuals are, where it is stated.
    pub misfit: Option<f64>,
    /// Whether that optimum had to be searched for, and was found.
    pub searched: Option<bool>,
}

impl Evidence {
    /// Where the fit has ended.
    pub fn at(known: Option<Determination>, noise: Option<f64>) -> Evidence {
        let misfit = known.as_ref().zip(noise).map(|(known, noise)| known.residual / noise);
        let shifts = known.as_ref().map_or_else(Vec::new, |known| known.shifts.clone());
        Evidence { known, shifts, misfit, searched: None }
    }

    /// Whether the optimum without ρ is so near that linearisation reaches it.
    pub fn is_near(&self) -> bool {
        is_near(&self.shifts)
    }

    /// With what is known at the optimum without ρ, if it was found; `own` is where the fit has ended.
    pub fn free(self, own: &[f64], found: Option<(Option<Determination>, Vec<f64>)>) -> Evidence {
        let Some((known, theta)) = found else { return Evidence { searched: Some(false), ..self } };
        // The last part of the way is linear.
        let rest = known.as_ref().map_or_else(|| vec![f64::INFINITY; own.len()], |known| known.shifts.clone());
        let is_optimal = is_near(&rest);
        let shifts = theta.iter().zip(own).zip(&rest).map(|((free, own), rest)| free + rest - own).collect();
        Evidence { known, shifts, searched: Some(is_optimal), ..self }
    }

    /// What the loads of a fit say of the moduli of its network.
    pub fn of_network(object: &Object, wanted: &Wanted, found: &WholeFit) -> Result<Evidence> {
        let problem = Displacements::new(object, wanted.trained.iter().collect(), wanted.frequencies.as_ref())?;
        let sees = |theta: &[f64]| Determination::of(&problem, theta, wanted.noise).ok();
        let evidence = Evidence::at(sees(&found.theta), wanted.noise);
        if found.cancelled || evidence.is_near() {
            return Ok(evidence);
        }
        // Not by the method and limit of the fit, which may have ended early because of them.
        let free = Wanted { validation: Validation::None, ..wanted.clone() };
        let method = DescentMethod::GaussNewton(GaussNewton::PRECISE);
        let settings =
            WholeSettings { regularizations: vec![0.0], iterations: STEPS, method, ..WholeSettings::default() };
        let best = Best { error: None, theta: found.theta.clone(), stage: None };
        let (theta, curve, left_out) = (found.theta.clone(), Vec::new(), Vec::new());
        let from = Snapshot { stage: 0, theta, best, curve, left_out };
        let free = fit_whole(object, &free, &settings, Some(from), &mut |_| true)?;
        Ok(evidence.free(&found.theta, Some((sees(&free.theta), free.theta))))
    }
}

fn is_near(shifts: &[f64]) -> bool {
    shifts.iter().all(|shift| shift.abs() < NEAR)
}
