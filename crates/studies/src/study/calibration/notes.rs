//! What a calibration has to say to its reader.

use super::outcome::{CalibratedLoad, CalibrationOutcome};
use crate::text::rounded;

impl CalibrationOutcome {
    /// Whether moduli and intervals are those of the body, as far as residuals and the search tell.
    pub(super) fn stands(&self) -> bool {
        !self.is_unfinished
            && self.misfit.is_none_or(|misfit| misfit <= MANY)
            && !self.is_hardly_explained()
            && self.slipped().is_none()
    }

    /// Whether, without a stated noise, the body explains little of what was measured.
    fn is_hardly_explained(&self) -> bool {
        // The comparison is negated, so that NaN counts as hardly explained.
        self.misfit.is_none() && !(self.explained >= EXPLAINED)
    }

    /// A load under which what is held was measured to move far.
    fn slipped(&self) -> Option<&CalibratedLoad> {
        self.loads.iter().find(|load| load.held_residual.is_some_and(|residual| residual > SLIPPED * load.extent()))
    }

    /// Says that no modulus and no interval is to be trusted; the report begins with it.
    pub fn distrust(&self) -> Option<String> {
        // The comparison is negated: a misfit that is NaN is not trusted.
        if let Some(misfit) = self.misfit.filter(|misfit| !(*misfit <= MANY)) {
            let scaled = if self.regions.is_empty() { "" } else { "; deviations by noise are multiplied by it" };
            return Some(format!(
                "NOT TRUSTED: residuals are {} times the stated noise (reduced chi-square {}, expected is 1): the model does not explain these \
                 measurements, or their noise is larger than stated{scaled}",
                rounded(misfit, 3),
                rounded(misfit * misfit, 3)
            ));
        }
        if self.is_hardly_explained() {
            return Some(format!(
                "NOT TRUSTED: the body explains {} % of what was measured: do places, displacements and loads belong together?",
                rounded(100.0 * self.explained.max(0.0), 3)
            ));
        }
        if let Some(load) = self.slipped() {
            return Some(format!(
                "NOT TRUSTED: {}: does [[fix]] hold what the body was held at?",
                load.slip().unwrap_or_default()
            ));
        }
        (!self.is_trusted).then(|| "NOT TRUSTED: the search has ended before the optimum".into())
    }

    pub(super) fn sentences(&self) -> Vec<String> {
        let mut all = Vec::new();
        if self.by_noise_alone && self.unknowns != "cells" {
            all.push(
                "intervals are those by noise alone: a mesh that is not refined has an error that they do not have"
                    .into(),
            );
        }
        if self.unknowns == "cells" {
            // Morozov's rule takes the strongest prior that the noise allows.
            all.push(
                "deviations by cell are those by noise with this prior: they leave out its pull, by which fields are smoother than the body \
                 and inclusions softer"
                    .into(),
            );
        }
        if !self.hardly_seen.is_empty() {
            all.push(format!(
                "the measurements hardly see {}: intervals reach beyond the factor 2",
                self.hardly_seen.join("; or of ")
            ));
        }
        match (self.misfit, self.is_unexplained) {
            (Some(misfit), _) if misfit > MANY => {}
            (Some(misfit), true) => all.push(format!(
                "residuals are {misfit:.2} times the stated noise: the model does not explain these measurements, and deviations by noise are \
                 multiplied by it"
            )),
            (Some(misfit), false) => all.push(format!("residuals are {misfit:.2} times the stated noise")),
            (None, _) if self.is_hardly_explained() => {}
            (None, _) => all.push(format!("the body explains {} % of what was measured", rounded(100.0 * self.explained, 6))),
        }
        if let (Some(misfit), true) = (self.misfit, self.unknowns == "cells" && self.is_unfinished) {
            all.push(format!("no weight of the prior reaches the noise: residuals are {misfit:.2} times as large"));
        } else if self.is_unfinished {
            all.push("the search has ended before the optimum: neither moduli nor intervals are to be trusted".into());
        }
        let is_seen = |load: &&CalibratedLoad| {
            let most = load.sigma.map_or(SHARE * load.extent(), |sigma| OUTLIER * sigma);
            load.held_residual.is_some_and(|residual| residual > most && residual <= SLIPPED * load.extent())
        };
        all.extend(self.loads.iter().filter(is_seen).filter_map(CalibratedLoad::slip));
        if let Some(distrust) = self.distrust() {
            all.insert(0, distrust);
        }
        if let Some(ratio) = self.ratio.filter(|ratio| *ratio > SLOW) {
            all.push(format!(
                "answers change from mesh to mesh by {ratio:.2} of the change before: where that is not below 0.5, a finer mesh of the scene is \
                 needed"
            ));
        }
        all
    }
}

impl CalibratedLoad {
    /// The size of the displacements of the load, m; forces have no distance to compare a slip with.
    fn extent(&self) -> f64 {
        if self.quantity == "displacements" { self.size } else { f64::INFINITY }
    }

    /// What was measured of what is held.
    fn slip(&self) -> Option<String> {
        let (residual, load) = (rounded(self.held_residual?, 3), &self.load);
        Some(format!("what is held was measured to be up to {residual} m from where it is held under \"{load}\""))
    }
}

/// Without a stated noise, residuals of half the size of what was measured are those of another body.
// The share that is explained is one less the squares that are left, `1 − (1/2)²`.
const EXPLAINED: f64 = 0.75;
/// What is held has moved far if it has by this share of the displacements of the load.
// A support that gives way by a share of the displacements makes a body look softer by about this share: moduli are a tenth too low.
const SLIPPED: f64 = 0.1;
/// It has moved if it has by this many deviations of the noise, which no one of a million does by chance.
const OUTLIER: f64 = 5.0;
/// Where the noise is not known, it has moved if it has by this share of the displacements of the load.
// It was chosen: moduli are off by about as much, which is worth a note, and the noise of most measurements is smaller.
const SHARE: f64 = 0.02;
/// Residuals of this multiple of the stated noise are those of another model or another noise, whatever part of them is the error of the meshes.
// With one measurement more than unknowns noise alone leaves as much in 0.3 % of cases, and with two more in 0.01 %.
pub(super) const MANY: f64 = 3.0;
/// The ratio of the changes of successive meshes from which on they are too coarse to be extrapolated.
// The order at a clamped edge is 1.42 at Poisson's ratio 0.3, 1.24 at 0.45 and never below 1.19: its ratio is 0.37 to
// 0.44. A ratio of 0.5 is that of the first order, and a larger one of meshes without an order.
const SLOW: f64 = 0.55;
