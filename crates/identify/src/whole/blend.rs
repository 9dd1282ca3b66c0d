//! The mass matrix between the consistent one and lumped masses that gives a network the frequencies of a body.
//!
//! `min_s Σ_i (½ ln ω_i²/ω̄_i²)²` for `M = (1 − s) M_c + s diag(m)`, `0 ≤ s ≤ 1`. With modes of unit mass
//! `d ln ω_i²/ds = φ_iᵀ (M_c − diag(m)) φ_i`.
//!
//! Theory: page *Whole-object fits* of the book.

use super::masses::Vibrations;
use crate::error::Result;
use crate::model::ConsistentMasses;

/// Steps at most.
// Newton's steps in one unknown double the digits. Each takes the modes under every support.
const STEPS: usize = 12;
/// A shorter step is the last one.
// The frequency of a mode that the mesh resolves changes with the share by less than itself: this step changes it by
// less than 1e-4.
const SHORT: f64 = 1e-4;

/// The share s of lumped masses, `[points]`, kg, by Gauss–Newton steps from the consistent matrix.
///
/// # Errors
/// Frequencies are not found, or there is not one mass for each point.
pub fn fit_mass_share(
    consistent: &ConsistentMasses,
    lumped: &[f64],
    dimension: usize,
    wanted: &[Vibrations],
) -> Result<f64> {
    let mut share = 0.0_f64;
    for _ in 0..STEPS {
        let blend = consistent.blended(lumped, share)?;
        let (mut slope, mut curvature) = (0.0, 0.0);
        for vibrations in wanted {
            let modes = vibrations.equations.lowest_modes(&blend, dimension, vibrations.squares.len())?;
            for ((square, shape), wanted) in modes.squares.iter().zip(&modes.shapes).zip(&vibrations.squares) {
                let even: f64 = consistent.product(shape, dimension)?.iter().zip(shape).map(|(f, u)| f * u).sum();
                let own: f64 = shape.iter().enumerate().map(|(dof, u)| lumped[dof / dimension] * u * u).sum();
                // With `φᵀ M φ = 1` the logarithm of ω changes by `−½ φᵀ (∂M/∂s) φ` with the share s.
                let rate = 0.5 * (even - own);
                slope += rate * 0.5 * (square / wanted).ln();
                curvature += rate * rate;
            }
        }
        // Beyond these ends masses between points would be negative, or more than all of them lumped. Without a
        // curvature both matrices have the same frequencies, and any share will do.
        let next = if curvature > 0.0 { (share - slope / curvature).clamp(0.0, 1.0) } else { share };
        let is_short = (next - share).abs() <= SHORT;
        share = next;
        if is_short {
            break;
        }
    }
    Ok(share)
}
