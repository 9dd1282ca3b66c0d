//! Whether a network is stable: its energy in all motions, relative to that of the finite elements.
//!
//! Theory: page *Precision* of the book.

use super::linear::{Factor, System};
use crate::springs::dot;
use nalgebra::{DMatrix, DVector};

/// The number of steps of the Lanczos method. The ends of the spectrum, which are needed, converge first.
const STEPS: usize = 40;
/// An energy ratio below this is zero up to rounding: the network does not resist the motion.
pub(super) const NOTHING: f64 = 1e-9;
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

/// The extreme ratios of the energies of `network` and `body`, both with the same support.
///
/// With a factor of the network the Lanczos method is applied to `K⁻¹R`, which finds the ratios next to zero, of either
/// sign, accurately. Without a factor `R⁻¹K` finds the least ratio. If everything is held the ratios are 1.
pub fn compare_energies(network: &System, factor: Option<&Factor>, body: &System, body_factor: &Factor) -> Stability {
    let positive = factor.is_some_and(Factor::is_positive_definite);
    let spectrum = match factor {
        Some(factor) => lanczos(body, |_, r| {
            let mut x = r.to_vec();
            factor.solve(&mut x);
            x
        }),
        None => lanczos(body, |v, _| {
            let mut x = network.apply(v);
            body_factor.solve(&mut x);
            x
        }),
    };
    let (ratios, softest) = match (factor, spectrum) {
        // Everything is held: no motion distinguishes the two models.
        _ if body.size() == 0 => ([1.0; 2], Vec::new()),
        (_, None) => ([0.0; 2], vec![0.0; body.size()]),
        (Some(_), Some([low, high])) if positive => ([1.0 / high.value, 1.0 / low.value], high.vector),
        // One end of the spectrum of K⁻¹R is the negative ratio nearest to zero, the other one the positive ratio
        // nearest to zero.
        (Some(_), Some([low, high])) if low.value < 0.0 => ([1.0 / low.value, 1.0 / high.value], low.vector),
        (Some(_), Some([low, high])) => ([1.0 / high.value, 1.0 / low.value], high.vector),
        (None, Some([low, high])) => ([low.value, high.value], low.vector),
    };
    let standing = match ratios[0].abs() {
        least if !(least >= NOTHING) => Standing::Singular,
        _ if !positive && body.size() > 0 => Standing::Indefinite,
        least if least < SOFT => Standing::Soft,
        _ => Standing::Stable,
    };
    Stability { standing, energy_ratio: ratios, softest }
}

/// An approximate eigenvalue, and its vector on the free degrees of freedom.
struct Ritz {
    value: f64,
    vector: Vec<f64>,
}

/// The lower and upper end of the spectrum of an operator that is symmetric in the inner product `xᵀ R y` of `body`.
/// `operator` receives `v` and `R v`. `None` if no step could be made.
fn lanczos(body: &System, operator: impl Fn(&[f64], &[f64]) -> Vec<f64>) -> Option<[Ritz; 2]> {
    let n = body.size();
    let steps = STEPS.min(n);
    // The start must not be orthogonal to a mode by a symmetry of the body; this one is the same on every machine.
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    let mut v: Vec<f64> = (0..n).map(|_| random()).collect();
    let mut basis: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
    let mut projected = DMatrix::zeros(steps, steps);
    for step in 0..steps {
        let mut rv = body.apply(&v);
        let size = dot(&v, &rv).sqrt();
        if !(size > 0.0 && size.is_finite()) {
            break;
        }
        v.iter_mut().for_each(|x| *x /= size);
        rv.iter_mut().for_each(|x| *x /= size);
        let mut next = operator(&v, &rv);
        let before = dot(&next, &body.apply(&next)).sqrt();
        basis.push((v, rv));
        for _ in 0..2 {
            for (i, (q, rq)) in basis.iter().enumerate() {
                let along = dot(rq, &next);
                projected[(i, step)] += along;
                next.iter_mut().zip(q).for_each(|(x, q)| *x -= along * q);
            }
        }
        let left = dot(&next, &body.apply(&next)).max(0.0).sqrt();
        v = next;
        if left.is_nan() || left <= 1e-13 * before {
            break;
        }
    }
    let m = basis.len();
    let projected = projected.view((0, 0), (m, m)).into_owned();
    if m == 0 || projected.iter().any(|x: &f64| !x.is_finite()) {
        return None;
    }
    let eigen = ((&projected + projected.transpose()) * 0.5).symmetric_eigen();
    let ritz = |index: usize| {
        let mut vector = DVector::zeros(n);
        for ((q, _), w) in basis.iter().zip(eigen.eigenvectors.column(index).iter()) {
            vector.axpy(*w, &DVector::from_column_slice(q), 1.0);
        }
        Ritz { value: eigen.eigenvalues[index], vector: vector.as_slice().to_vec() }
    };
    Some([ritz(eigen.eigenvalues.imin()), ritz(eigen.eigenvalues.imax())])
}
