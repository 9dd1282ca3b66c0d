//! Gauss–Newton steps of few moduli on the residuals of a finer body, whose derivatives are differences of its solutions.
//!
//! Theory: page *Whole-object fits* of the book.

use crate::body::FinerBody;
use crate::error::{Error, Result};
use crate::progress::Progress;
use crate::whole::{Determination, Object, Target};

/// The change of the logarithm of a modulus over which derivatives are taken. Displacements are smooth in it, and known to 1e-9.
const DIFFERENCE: f64 = 1e-3;
/// A step that counts as none. Displacements are known to 1e-9, and moduli follow them to a few digits less.
const SETTLED: f64 = 1e-6;
/// A step from which on the derivatives of the last point serve the next one. They have changed by about that share,
/// and derivatives cost as many solutions as there are unknowns.
const NEAR: f64 = 0.05;
/// Steps at most. From the result of the network two or three suffice.
const STEPS: usize = 20;
/// Halvings of a step at most. Where a thirty-second of a step does not help, rounding decides.
const HALVINGS: usize = 6;

/// The measured loads of a fit with a finer body.
pub(super) struct FinerSteps<'a> {
    pub fine: &'a FinerBody,
    pub object: &'a Object<'a>,
    /// The loads with the measured displacements.
    pub measured: &'a [Target],
    /// Their numbers among the loads of the scene.
    pub loads: &'a [usize],
}

/// Moduli, and what the finer body does there.
pub(super) struct FinerPoint {
    /// The logarithms of the factors on the moduli.
    pub theta: Vec<f64>,
    /// The displacements of each load at the points of the mesh, m.
    pub moved: Vec<Vec<f64>>,
    /// The derivative of the residuals in each unknown.
    pub columns: Vec<Vec<f64>>,
    /// The residuals of all loads, one after the other.
    pub residuals: Vec<f64>,
    /// The largest change of the last step, or of the next one, which is no more than rounding.
    pub step: f64,
}

impl FinerSteps<'_> {
    fn moved(&self, theta: &[f64], progress: &mut Progress) -> Result<Vec<Vec<f64>>> {
        self.fine.moved(self.loads, &self.object.region_factors(theta), progress)
    }

    /// `√w_l (u_l − ū_l)/‖ū_l‖` where it is known, of one load after the other.
    fn residuals(&self, moved: &[Vec<f64>]) -> Result<Vec<f64>> {
        let mut all = Vec::new();
        for (target, u) in self.measured.iter().zip(moved) {
            let nothing = || Error::expected("loads", "loads under which free points are known to move", &target.name);
            let scales = target.scale().ok_or_else(nothing)?;
            all.extend(u.iter().zip(&target.displacement).zip(scales).map(|((u, wanted), s)| s * (u - wanted)));
        }
        Ok(all)
    }

    fn columns(&self, theta: &[f64], residuals: &[f64], progress: &mut Progress) -> Result<Vec<Vec<f64>>> {
        let column = |p: usize| {
            let mut beside = theta.to_vec();
            beside[p] += DIFFERENCE;
            let beside = self.residuals(&self.moved(&beside, progress)?)?;
            Ok(beside.iter().zip(residuals).map(|(beside, at)| (beside - at) / DIFFERENCE).collect())
        };
        (0..theta.len()).map(column).collect()
    }

    /// The minimum of `Σ ‖r_l‖² + (ρ/m) ‖θ‖²` from θ on.
    ///
    /// # Errors
    /// The finer body has no solution, or the moduli do not settle.
    pub fn settle(&self, theta: &[f64], rho: f64, progress: &mut Progress) -> Result<FinerPoint> {
        let share = rho / theta.len().max(1) as f64;
        let value = |r: &[f64], theta: &[f64]| {
            r.iter().map(|r| r * r).sum::<f64>() + share * theta.iter().map(|t| t * t).sum::<f64>()
        };
        let moved = self.moved(theta, progress)?;
        let residuals = self.residuals(&moved)?;
        let columns = self.columns(theta, &residuals, progress)?;
        let mut at = FinerPoint { theta: theta.to_vec(), moved, columns, residuals, step: f64::INFINITY };
        for _ in 0..STEPS {
            let step = regularized_step(&at, share)?;
            let size = step.iter().fold(0.0, |a: f64, s| a.max(s.abs()));
            if size < SETTLED {
                return Ok(FinerPoint { step: size, ..at });
            }
            let now = value(&at.residuals, &at.theta);
            let mut length = 1.0;
            let mut found = None;
            for _ in 0..HALVINGS {
                let theta: Vec<f64> = at.theta.iter().zip(&step).map(|(t, s)| t + length * s).collect();
                let moved = self.moved(&theta, progress)?;
                let residuals = self.residuals(&moved)?;
                // A value that is not a number is no improvement either.
                if value(&residuals, &theta) < now {
                    found = Some((theta, moved, residuals));
                    break;
                }
                length /= 2.0;
            }
            let Some((theta, moved, residuals)) = found else {
                // Halvings that do not help say nothing of the distance of the minimum: the whole step does.
                at.step = size;
                break;
            };
            at.step = length * size;
            (at.theta, at.moved, at.residuals) = (theta, moved, residuals);
            if at.step > NEAR {
                at.columns = self.columns(&at.theta, &at.residuals, progress)?;
            }
        }
        if at.step < NEAR {
            return Ok(at);
        }
        let problem = format!(
            "the moduli do not settle on the finer mesh: the last step changes them by {:.1} %; displacements of more states or points, or \
             fewer moduli, are needed",
            100.0 * at.step
        );
        Err(Error::at("unknowns", problem))
    }
}

/// The step of the linearised problem, with ρ as residuals of its own.
fn regularized_step(at: &FinerPoint, share: f64) -> Result<Vec<f64>> {
    // Residuals √(ρ/m) θ_p of their own have the squares of the term ρ/m ‖θ‖², so that one routine serves both sums.
    let root = share.sqrt();
    let column = |(p, column): (usize, &Vec<f64>)| {
        let own = (0..at.theta.len()).map(|q| if p == q { root } else { 0.0 });
        column.iter().copied().chain(own).collect()
    };
    let columns: Vec<Vec<f64>> = at.columns.iter().enumerate().map(column).collect();
    let residuals: Vec<f64> = at.residuals.iter().copied().chain(at.theta.iter().map(|t| root * t)).collect();
    Ok(Determination::by(&columns, &residuals, residuals.len(), None)?.shifts)
}
