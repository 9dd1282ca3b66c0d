//! The error of a network relative to the finite elements under a load.

use crate::model::Entries;
use crate::scalar::{Sum, scaled_norm};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};

/// The largest relative residual of a solution. A factor of a nearly singular matrix gives numbers that do not solve
/// the equations.
// Such numbers leave a large part of the forces. A refined solution leaves some roundings, and one by iterations ten times their
// tolerance, which is 1e-10 by default: the bound is far from both.
pub const SOLVED: f64 = 1e-6;

/// A point whose displacement is smaller than the largest by at most this share is at the tip as well.
// Rounding would decide between points that a symmetry of the body makes equal. Solutions by iterations err by less than this.
const TIED: f64 = 1e-6;

/// The distances of the points of the network from those of the finite elements, in percent of the largest
/// displacement.
///
/// `e_rms = 100 √(mean_i |u_i^FEM − u_i^LEM|²)/max_i |u_i^FEM|` over all points, `e_max = 100 max_i |u_i^FEM − u_i^LEM|/max_i |u_i^FEM|`, and
/// `e_tip = 100 |u_t^FEM − u_t^LEM|/|u_t^FEM|` at the point t with the largest displacement of the finite elements, or the largest error where
/// several points move equally far.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct DisplacementError {
    /// The root mean square error is in percent of the largest displacement.
    #[serde(rename = "e_rms")]
    #[schemars(with = "Option<f64>")]
    pub rms: f64,
    /// The largest error is in percent of the largest displacement.
    #[serde(rename = "e_max")]
    #[schemars(with = "Option<f64>")]
    pub max: f64,
    /// The error at the point that moves most in the finite elements, or the largest of equal ones, is in percent of the largest displacement.
    #[serde(rename = "e_tip")]
    #[schemars(with = "Option<f64>")]
    pub tip: f64,
}

impl DisplacementError {
    /// Writes the keys of an error into those of what has it; they are null where it is not known.
    ///
    /// # Errors
    /// The writer fails.
    pub fn or_null<S: Serializer>(error: &Option<DisplacementError>, to: S) -> Result<S::Ok, S::Error> {
        const UNKNOWN: DisplacementError = DisplacementError { rms: f64::NAN, max: f64::NAN, tip: f64::NAN };
        error.unwrap_or(UNKNOWN).serialize(to)
    }
}

/// The errors defined by Natsupakpong and Çavuşoğlu (2010), section 3. `fem` and `lem` are `[points × dimension]`, m.
/// `None` if the finite elements do not move, or a displacement or an error is not finite.
pub fn displacement_error(fem: &[f64], lem: &[f64], dimension: usize) -> Option<DisplacementError> {
    if !fem.iter().chain(lem).all(|u| u.is_finite()) {
        return None;
    }
    let square = |a: &[f64]| a.iter().map(|x| x * x).collect::<Sum>().value();
    let length = |a: &[f64]| scaled_norm(a, square);
    let largest = fem.chunks_exact(dimension).map(length).fold(0.0, f64::max);
    // Errors are shares of the largest displacement, and zero has no share.
    if largest == 0.0 {
        return None;
    }
    // Divided before any square, so that tiny and huge displacements lose no digits.
    let difference: Vec<f64> = fem.iter().zip(lem).map(|(a, b)| (a - b) / largest).collect();
    let points = (fem.len() / dimension) as f64;
    let both = fem.chunks_exact(dimension).zip(difference.chunks_exact(dimension));
    let at_tip = both.filter(|(u, _)| length(u) >= (1.0 - TIED) * largest);
    let tip = at_tip.map(|(_, difference)| length(difference)).fold(0.0, f64::max);
    let worst = difference.chunks_exact(dimension).map(length).fold(0.0, f64::max);
    let rms = scaled_norm(&difference, |a| square(a) / points);
    let error = DisplacementError { rms: 100.0 * rms, max: 100.0 * worst, tip: 100.0 * tip };
    Some(error).filter(|error| error.rms.is_finite() && error.max.is_finite())
}

/// The total of forces on points, `[points · dimension]`, along each axis, N.
pub fn resultant(forces: &[f64], dimension: usize) -> Vec<f64> {
    (0..dimension).map(|k| forces.iter().skip(k).step_by(dimension).sum()).collect()
}

/// `Σ f_i u_i`.
pub fn product(f: &[f64], u: &[f64]) -> f64 {
    f.iter().zip(u).map(|(f, u)| f * u).collect::<Sum>().value()
}

/// `uᵀ K u` of a symmetric matrix given by its lower triangle.
pub fn square(stiffness: &Entries, u: &[f64]) -> f64 {
    let term = |entry: &faer::sparse::Triplet<usize, usize, f64>| {
        let both = if entry.row == entry.col { 1.0 } else { 2.0 };
        both * entry.val * u[entry.row] * u[entry.col]
    };
    stiffness.iter().map(term).collect::<Sum>().value()
}
