//! Whether a network stands: its stiffness mode by mode, measured by that of the finite elements.

use super::linear::{Factor, System};
use nalgebra::{DMatrix, DVector};

/// Steps of Lanczos' method; the ends of the spectrum, which are wanted, come first.
const STEPS: usize = 40;
/// An energy ratio below this is a zero with rounding: the network does not resist the motion.
const NOTHING: f64 = 1e-9;
/// An energy ratio below this marks a mechanism in the making: the network yields a hundred times more than the body.
const SOFT: f64 = 0.01;

/// How a network resists the motions that a body resists.
#[derive(Debug, Clone, PartialEq)]
pub struct Stability {
    pub standing: Standing,
    /// Least and largest ratio `uᵀ K u / uᵀ R u` found, of the network's energy to that of the finite elements.
    pub energy_ratio: [f64; 2],
    /// The motion of the least ratio, on the free degrees of freedom.
    pub softest: Vec<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// Positive definite, and no motion much softer than in the body.
    Sound,
    /// Positive definite, but some motion meets less than a hundredth of the body's resistance.
    Soft,
    /// Some motion releases energy: without its supports' help the network runs away.
    Indefinite,
    /// Some motion meets no resistance: a mechanism.
    Singular,
}

/// The extreme ratios of the energies of `network` and `body`, both with the same support.
///
/// With a Cholesky factor of the network the pencil is iterated as `K⁻¹R`, which finds the softest motion to full
/// precision; without one as `R⁻¹K`, which finds that there is one of no or negative energy.
pub fn compare_energies(network: &System, factor: Option<&Factor>, body: &System, body_factor: &Factor) -> Stability {
    let (ratios, softest) = match factor {
        Some(factor) if factor.is_positive_definite() => {
            let (values, vector) = lanczos(body, true, |r| {
                let mut x = r.to_vec();
                factor.solve(&mut x);
                x
            });
            ([1.0 / values[1], 1.0 / values[0]], vector)
        }
        _ => lanczos(body, false, |r| {
            let mut x = network.apply(r);
            body_factor.solve(&mut x);
            x
        }),
    };
    let standing = match ratios[0] {
        least if least < -NOTHING * ratios[1].abs() => Standing::Indefinite,
        least if least < NOTHING || !least.is_finite() => Standing::Singular,
        least if least < SOFT => Standing::Soft,
        _ => Standing::Sound,
    };
    Stability { standing, energy_ratio: ratios, softest }
}

/// The ends of the spectrum of an operator that is symmetric in the inner product `xᵀ R y` of `body`, and the vector
/// at the upper end if `largest`, else at the lower. With `largest`, `operator` is handed `R v` in place of `v`.
fn lanczos(body: &System, largest: bool, operator: impl Fn(&[f64]) -> Vec<f64>) -> ([f64; 2], Vec<f64>) {
    let n = body.size();
    let steps = STEPS.min(n);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // Any start that no symmetry of the body makes orthogonal to a mode will do; this one repeats on every machine.
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
        let mut next = operator(if largest { &rv } else { &v });
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
        if !(left > 1e-13 * before) {
            break;
        }
    }
    let m = basis.len();
    let projected = projected.view((0, 0), (m, m)).into_owned();
    let eigen = ((&projected + projected.transpose()) * 0.5).symmetric_eigen();
    let end = |sign: f64| (0..m).max_by(|&a, &b| (sign * eigen.eigenvalues[a]).total_cmp(&(sign * eigen.eigenvalues[b])));
    let (Some(low), Some(high)) = (end(-1.0), end(1.0)) else { return ([f64::NAN; 2], vec![0.0; n]) };
    let weights = eigen.eigenvectors.column(if largest { high } else { low });
    let mut vector = DVector::zeros(n);
    for ((q, _), w) in basis.iter().zip(weights.iter()) {
        vector.axpy(*w, &DVector::from_column_slice(q), 1.0);
    }
    ([eigen.eigenvalues[low], eigen.eigenvalues[high]], vector.as_slice().to_vec())
}
