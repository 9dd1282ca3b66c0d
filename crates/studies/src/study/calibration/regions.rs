//! The moduli of regions with their intervals, from unknowns and their covariance.
//!
//! Theory: page *Calibration* of the book.

use super::outcome::{CalibratedRegion, Value};
use crate::calibration::{Estimate, Unknown, Unknowns, poisson_of, ratio_of};
use crate::material::{Material, MaterialMap};
use crate::whole::ninety_five;

/// A function of the unknowns: its derivatives by their places.
type Slopes = Vec<(usize, f64)>;

/// The step of t over which functions of Poisson's ratio are differentiated. Central differences err by its square, and
/// rounding over it is 1e-10: both are far below any interval.
const STEP: f64 = 1e-6;

/// The deviations of functions of the unknowns.
pub(super) struct Spread<'a> {
    pub estimate: &'a Estimate,
    /// By how much residuals exceed the noise, where they are more than noise; 1 otherwise.
    pub excess: f64,
}

impl Spread<'_> {
    /// The deviation by noise, and that by the meshes.
    fn of(&self, slopes: &Slopes) -> Option<(f64, Option<f64>)> {
        let mut variance = 0.0;
        for &(p, a) in slopes {
            for &(q, b) in slopes {
                variance += a * b * self.estimate.covariance[p][q]?;
            }
        }
        let mesh = self.estimate.mesh.as_ref().map(|mesh| {
            // The errors of the meshes move all unknowns together.
            slopes.iter().map(|&(p, a)| (a * mesh[p]).abs()).sum()
        });
        // Rounding can take the quadratic form of a nearly singular covariance below zero.
        Some((self.excess * variance.max(0.0).sqrt(), mesh))
    }

    /// A value whose logarithm (or itself) has this spread, between the ends that `ends` makes of the way to either side.
    fn value(&self, value: f64, slopes: &Slopes, ends: impl Fn(f64) -> [f64; 2]) -> Value {
        // A known region has no unknown: its moduli are those of the scene, without an interval.
        if slopes.is_empty() {
            return Value { value, interval: None, deviation: None, mesh_deviation: None };
        }
        let spread = self.of(slopes);
        // The errors of the meshes do not depend on the noise, so that the squares of both add up. They are no estimate
        // from a sample: their interval is that of the normal distribution, whatever the degrees of freedom of the
        // residuals.
        let way =
            spread.map(|(noise, mesh)| (self.estimate.reach * noise).hypot(ninety_five(None) * mesh.unwrap_or(0.0)));
        // The exponential of the way of an unknown that is hardly seen overflows: such a value has no interval.
        let interval = way.map(ends).filter(|[low, high]| low.is_finite() && high.is_finite());
        Value { value, interval, deviation: spread.map(|s| s.0), mesh_deviation: spread.and_then(|s| s.1) }
    }
}

/// The moduli of all regions.
pub(super) fn regions(
    base: &MaterialMap,
    (names, is_known): (&[String], &[bool]),
    unknowns: &Unknowns,
    spread: &Spread,
) -> Vec<CalibratedRegion> {
    let one = |(region, name): (usize, &String)| {
        let at = base.region().position(|own| *own == region).unwrap_or((0, 0));
        let guess = base.isotropic(at.0, at.1)?;
        let place = |unknown: Unknown| unknowns.all.iter().position(|own| *own == unknown);
        let (young, poisson) = (place(Unknown::Young(region)), place(Unknown::Poisson(region)));
        let theta = |place: Option<usize>| place.map_or(0.0, |place| spread.estimate.theta[place]);
        let factor = theta(young).exp();
        let t = ratio_of(guess.poisson()) + theta(poisson);
        Some(region_of(name, is_known[region], (guess, factor, t), (young, poisson), spread))
    };
    names.iter().enumerate().filter_map(one).collect()
}

fn region_of(
    name: &str,
    is_known: bool,
    (guess, factor, t): (Material, f64, f64),
    (young, poisson): (Option<usize>, Option<usize>),
    spread: &Spread,
) -> CalibratedRegion {
    let e = factor * guess.young();
    let slopes = |by_young: f64, by_poisson: f64| -> Slopes {
        young.map(|p| (p, by_young)).into_iter().chain(poisson.map(|p| (p, by_poisson))).collect()
    };
    let rate = |of: &dyn Fn(f64) -> f64| (of(poisson_of(t + STEP)) - of(poisson_of(t - STEP))) / (2.0 * STEP);
    // E and μ are positive. Intervals of their logarithms have no end below zero.
    let share = |value: f64| move |way: f64| [value * (-way).exp(), value * way.exp()];
    let nu = poisson_of(t);
    let shear = |nu: f64| e / (2.0 * (1.0 + nu));
    let lame = |nu: f64| e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
    let lambda = lame(nu);
    // λ may have either sign, so that its interval is in itself.
    // λ is proportional to E, so that its slope by ln E is λ.
    let of_lambda = spread.value(lambda, &slopes(lambda, rate(&lame)), |way| [lambda - way, lambda + way]);
    // The interval of Poisson's ratio is that of t, which every ratio of a material has.
    let of_t = poisson.map(|p| vec![(p, 1.0)]).unwrap_or_default();
    let slope = rate(&|nu| nu);
    let of_poisson = spread.value(nu, &of_t, |way| [poisson_of(t - way), poisson_of(t + way)]);
    let scaled = |value: Option<f64>| value.map(|value| slope * value);
    CalibratedRegion {
        region: name.into(),
        is_known,
        factor,
        // Slopes of the logarithm: the unknown is ln E, and μ is proportional to E.
        young: spread.value(e, &slopes(1.0, 0.0), share(e)),
        poisson: Value {
            deviation: scaled(of_poisson.deviation),
            mesh_deviation: scaled(of_poisson.mesh_deviation),
            ..of_poisson
        },
        shear_modulus: spread.value(shear(nu), &slopes(1.0, rate(&|nu| shear(nu).ln())), share(shear(nu))),
        lambda: of_lambda,
    }
}
