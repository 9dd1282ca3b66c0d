//! Whether a network is stable: its energy in all motions, relative to that of the finite elements.
//!
//! Theory: page *Precision* of the book.

use super::lanczos::{Ritz, ends, noise};
use super::linear::{Factor, System};
use crate::error::Result;
use crate::model::{Entries, Support};
use crate::springs::dot;
use faer::sparse::Triplet;

/// Steps of a search at most. 20 to 80 are usual; ratios that differ by many orders may take more.
const STEPS: usize = 200;
/// Steps of the search near zero in a matrix that is not positive definite: what is nearest is found first, or is zero with rounding.
const NEAR_STEPS: usize = 40;
/// An energy ratio below this is zero up to rounding: the network does not resist the motion. The ratio of a motion
/// without energy is the rounding of both stiffnesses times the condition of that of the body.
pub(super) const NOTHING: f64 = 1e-9;
/// The energy of a motion by its displacements is rounded by up to this share of the body's, where the body is slender.
// The rounding is the condition of the body's stiffness times 1.1e-16, which is 1e-6 where the condition is 1e10.
const ROUNDED: f64 = 1e-6;
/// A ratio below zero by this share of the largest is found without a factor of the network.
// The search knows a ratio to 2e-3 of itself (`FOUND` of `lanczos.rs`). That is 2e-6 of the largest here, about what is let pass as
// rounding, so that a ratio nearer to zero is looked for by its reciprocal.
const CLEAR: f64 = 1e-3;
/// An energy ratio below this indicates that the network is close to a mechanism: it is a hundred times softer than the
/// body.
pub(super) const SOFT: f64 = 0.01;

/// How a network resists the motions that a body resists.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Stability {
    /// The verdict.
    pub standing: Standing,
    /// The least and the largest ratio `uᵀ K u/uᵀ R u` that was found, of the energy of the network to that of the
    /// finite elements.
    pub energy_ratio: [f64; 2],
    /// The motion with the least ratio, on the free degrees of freedom.
    pub softest: Vec<f64>,
    /// Whether the search for the least ratio has converged; if not, some motion may have a lesser one.
    pub is_found: bool,
}

/// Whether the stiffness of a network is positive definite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// Positive definite, and no motion is much softer than in the body.
    Stable,
    /// Positive definite, but some motion has less than a hundredth of the body's resistance.
    Soft,
    /// Indefinite: some motion releases energy, so that the network is unstable.
    Indefinite,
    /// Singular: some motion meets no resistance; the network is a mechanism.
    Singular,
}

/// Whether a stiffness is positive definite where it is free, once this share of its largest diagonal entry is added to its diagonal. With a share
/// beyond rounding motions without resistance pass, and only those that release energy do not.
///
/// # Errors
/// The matrix does not fit into memory.
pub fn is_definite(stiffness: &Entries, support: &Support, share: f64) -> Result<bool> {
    let largest = stiffness.iter().filter(|e| e.row == e.col).map(|e| e.val.abs()).fold(0.0, f64::max);
    let mut entries = stiffness.clone();
    entries.extend((0..support.prescribed.len()).map(|dof| Triplet::new(dof, dof, share * largest)));
    Ok(System::new(&entries, support)?.cholesky()?.is_some())
}

/// The extreme ratios of the energies of `network` and `body`, both with the same support, each that of a motion.
///
/// Lanczos' method on `R⁻¹K` finds both ends of the ratios, of either sign. A least ratio near zero is then found by its reciprocal
/// in `K⁻¹R` with the factor of the network; without it, or if the matrix is not positive definite and the ratio is far enough below zero,
/// it is left as it is. If everything is held the ratios are 1.
pub fn compare_energies(network: &System, factor: Option<&Factor>, body: &System, body_factor: &Factor) -> Stability {
    if body.size() == 0 {
        return Stability { standing: Standing::Stable, energy_ratio: [1.0; 2], softest: Vec::new(), is_found: true };
    }
    let is_positive = factor.is_some_and(Factor::is_positive_definite);
    // `v` is rough, `R⁻¹ v` is smooth: together they meet every motion.
    let rough = noise(body.size());
    let mut smooth = rough.clone();
    body_factor.solve(&mut smooth);
    let direct = |v: &[f64], _: &[f64]| {
        let mut image = network.apply(v);
        body_factor.solve(&mut image);
        image
    };
    // The smooth vector begins among motions of which the rough one has next to nothing, the lowest of the body.
    let starts = [rough, smooth];
    let Some([low, high]) = ends(|x| body.apply(x), direct, &starts, [!is_positive, true], STEPS) else {
        let softest = vec![0.0; body.size()];
        return Stability { standing: Standing::Singular, energy_ratio: [0.0; 2], softest, is_found: false };
    };
    let is_clear = low.is_found && (is_positive || low.value < -CLEAR * high.value.abs());
    let [rough, smooth] = starts;
    let near = factor.filter(|_| !is_clear).and_then(|factor| {
        let inverse = |_: &[f64], rv: &[f64]| {
            let mut image = rv.to_vec();
            factor.solve(&mut image);
            image
        };
        // The largest reciprocal is that of the least ratio; where some are negative, the least is that of the ratio next below zero.
        let (wanted, steps) = if is_positive { ([false, true], STEPS) } else { ([true, false], NEAR_STEPS) };
        ends(|x| body.apply(x), inverse, &[low.vector.clone(), rough, smooth], wanted, steps)
    });
    let quotient = |x: &[f64]| dot(x, &network.apply(x)) / dot(x, &body.apply(x));
    // The quotient of a vector errs with the square of the error of the vector, and is a ratio that a motion has.
    let largest = quotient(&high.vector);
    // What is near zero in the ratios themselves is rounding; its reciprocal has all digits, or is rounding beside one that is infinite.
    let is_sure = near.is_none() || low.is_found || quotient(&low.vector) < -ROUNDED;
    let near = near.into_iter().flatten().map(|Ritz { value, vector, is_found }| {
        let ratio = match (quotient(&vector), 1.0 / value) {
            // Beyond its rounding the quotient is taken; a quotient that is NaN goes on and is left out below.
            (ratio, _) if !(ratio.abs() <= ROUNDED) => ratio,
            (_, ratio) if ratio.abs() <= ROUNDED => ratio,
            // The quotient is rounding, and the reciprocal contradicts it: the motion has no energy that can be told
            // from none.
            _ => 0.0,
        };
        (ratio, vector, is_found)
    });
    let low = Some(low).filter(|_| is_sure).map(|low| (quotient(&low.vector), low.vector, low.is_found));
    let candidates = near.chain(low).filter(|(ratio, ..)| ratio.is_finite());
    let least = candidates.reduce(|a, b| if b.0 < a.0 { b } else { a });
    let Some((least, softest, is_found)) = least else {
        let softest = vec![0.0; body.size()];
        return Stability { standing: Standing::Singular, energy_ratio: [0.0; 2], softest, is_found: false };
    };
    Stability { standing: standing(least, is_positive), energy_ratio: [least, largest.max(least)], softest, is_found }
}

/// The verdict on a network whose least ratio was found to be `least`, and which was shown to be positive definite or not. A matrix that is
/// not has a motion without energy above zero, up to rounding: if the search shows none that releases energy, it is one without resistance.
pub(super) fn standing(least: f64, is_positive: bool) -> Standing {
    match least {
        least if least <= -NOTHING => Standing::Indefinite,
        // NaN is no resistance.
        least if !is_positive || !(least >= NOTHING) => Standing::Singular,
        least if least < SOFT => Standing::Soft,
        _ => Standing::Stable,
    }
}
