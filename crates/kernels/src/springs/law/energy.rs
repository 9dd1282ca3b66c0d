//! The energy of a spring: the integral of its law of force.
//!
//! Theory: page *Sampled fits* of the book.

use super::function::AROUND_COUNT;
use super::{AskedForces, Body, Law};
use gauss_quad::GaussLegendre;
use std::sync::OnceLock;

/// The number of points of the quadrature that integrates the force; it is exact for polynomials up to degree 31.
const POINTS: usize = 16;
/// A change of the measure by this share of its value at rest is integrated without subdivision. A law hardly bends
/// along so short a way, which one quadrature knows to rounding.
const SMOOTH: f64 = 0.1;
/// The agreement of a quadrature with that of its two halves at which it is accepted, relative to the energy; about 50
/// rounding errors.
const KNOWN: f64 = 1e-14;
/// The largest number of halvings of the interval. A law with a kink, which no quadrature knows, ends here: the part
/// with the kink is a thousandth of the way.
const HALVINGS: usize = 10;

impl Law {
    /// Energy, force and slope of several springs, each at one measure. A function is asked once, and again for springs whose energy
    /// a quadrature and that of its halves do not know alike.
    pub fn pulls_of_all(&self, asked: &[AskedForces]) -> Vec<[f64; 3]> {
        let Body::Function(function) = &self.body else {
            let pull = |(one, c): (&AskedForces, &f64)| {
                let (c, rest, parameters) = (*c, one.rest, &one.parameters[..]);
                [self.energy(c, rest, parameters), self.force(c, rest, parameters), self.slope(c, rest, parameters)]
            };
            return asked.iter().flat_map(|one| one.c.iter().map(move |c| (one, c))).map(pull).collect();
        };
        let springs: Vec<(&AskedForces, f64)> =
            asked.iter().flat_map(|one| one.c.iter().map(move |&c| (one, c))).collect();
        // c, the places of the slope, and those of the quadratures of the whole way and of its halves.
        let places: Vec<Vec<f64>> = springs
            .iter()
            .map(|&(one, c)| {
                let middle = one.rest + (c - one.rest) / 2.0;
                let ways = [[one.rest, c], [one.rest, middle], [middle, c]];
                let of_ways = ways.into_iter().flat_map(|way| rule().iter().map(move |(x, _)| place(way, *x)));
                std::iter::once(c).chain(function.around_measure(c, one.rest)).chain(of_ways).collect()
            })
            .collect();
        let all: Vec<AskedForces> = springs
            .iter()
            .zip(&places)
            .map(|((one, _), places)| AskedForces { c: places, rest: one.rest, parameters: one.parameters.clone() })
            .collect();
        let forces = function.forces_of_all(&all);
        let count = places.first().map_or(1, Vec::len);
        let pull = |((one, c), own): (&(&AskedForces, f64), &[f64])| {
            let (around, ways) = own[1..].split_at(AROUND_COUNT);
            let middle = one.rest + (c - one.rest) / 2.0;
            let work = |[from, to]: [f64; 2], own: &[f64]| -> f64 {
                rule().iter().zip(own).map(|((_, w), t)| w * (to - from) / 2.0 * t).sum()
            };
            let (whole, halves) = ways.split_at(POINTS);
            let whole = work([one.rest, *c], whole);
            let halves = [work([one.rest, middle], &halves[..POINTS]), work([middle, *c], &halves[POINTS..])];
            let sum = halves[0] + halves[1];
            let is_known = (sum - whole).abs() <= KNOWN * (halves[0].abs() + halves[1].abs()) || !sum.is_finite();
            let energy = match (c - one.rest).abs() <= SMOOTH * one.rest.abs() {
                true => whole,
                false if is_known => sum,
                false => self.energy(*c, one.rest, &one.parameters),
            };
            [energy, own[0], function.slope_of(around, *c, one.rest)]
        };
        springs.iter().zip(forces.chunks_exact(count)).map(pull).collect()
    }

    /// The energy `∫ T dc` from rest, by a quadrature that is refined until it agrees with that of its halves.
    pub fn energy(&self, c: f64, rest: f64, parameters: &[f64]) -> f64 {
        let whole = self.work([rest, c], rest, parameters);
        if (c - rest).abs() <= SMOOTH * rest.abs() {
            whole
        } else {
            self.refined([rest, c], whole, 0.0, rest, parameters, HALVINGS)
        }
    }

    /// The work on a part of the way, of which one rule knows `whole`. `known` is the size of the work on the ways that this one is a half of: what is small beside
    /// that is not refined, however far the measure is from rest.
    fn refined(
        &self,
        [from, to]: [f64; 2],
        whole: f64,
        known: f64,
        rest: f64,
        parameters: &[f64],
        halvings: usize,
    ) -> f64 {
        let middle = from + (to - from) / 2.0;
        let halves = [[from, middle], [middle, to]];
        let works = halves.map(|half| self.work(half, rest, parameters));
        let sum = works[0] + works[1];
        let known = known.max(works[0].abs() + works[1].abs());
        if halvings == 0 || !sum.is_finite() || (sum - whole).abs() <= KNOWN * known {
            return sum;
        }
        (0..2).map(|i| self.refined(halves[i], works[i], known, rest, parameters, halvings - 1)).sum()
    }

    /// `∫ T dc` by one rule without refinement.
    fn work(&self, way: [f64; 2], rest: f64, parameters: &[f64]) -> f64 {
        let half = (way[1] - way[0]) / 2.0;
        let places = rule().iter().map(|(x, _)| place(way, *x));
        match &self.body {
            Body::Formula(formula) => {
                rule().iter().zip(places).map(|((_, w), c)| w * half * formula.force(c, rest, parameters)).sum()
            }
            Body::Function(function) => {
                let forces = function.forces(&places.collect::<Vec<_>>(), rest, parameters);
                rule().iter().zip(forces).map(|((_, w), t)| w * half * t).sum()
            }
        }
    }
}

/// The points and weights of the quadrature that integrates the force.
fn rule() -> &'static [(f64, f64)] {
    static RULE: OnceLock<Vec<(f64, f64)>> = OnceLock::new();
    let points = POINTS.try_into().expect("there are points");
    RULE.get_or_init(|| GaussLegendre::new(points).iter().map(|(x, w)| (*x, *w)).collect())
}

/// The place of the point x, from −1 to 1, on the way.
fn place([from, to]: [f64; 2], x: f64) -> f64 {
    from + (to - from) / 2.0 * (1.0 + x)
}
