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
/// The largest number of halvings of one way. A kink of the law takes one for each binary digit of its place. Rounding errors of a force
/// that is a small difference of large terms would take all that there are, and come no nearer.
const HALVINGS: usize = 64;

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
                let [first, last] = halves([one.rest, c]);
                let ways = [[one.rest, c], first, last];
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
            let work = |[from, to]: [f64; 2], own: &[f64]| -> f64 {
                // The rule is that of [−1, 1], which is two long.
                rule().iter().zip(own).map(|((_, w), t)| w * (to - from) / 2.0 * t).sum()
            };
            let whole = [one.rest, *c];
            let [first, last] = halves(whole);
            let (of_whole, of_halves) = ways.split_at(POINTS);
            let works = [work(first, &of_halves[..POINTS]), work(last, &of_halves[POINTS..])];
            let by_one = work(whole, of_whole);
            let way = Halved::known(whole, works, by_one);
            let energy = match (c - one.rest).abs() <= SMOOTH * one.rest.abs() {
                true => by_one,
                false if way.is_known(way.size()) => way.sum(),
                false => self.energy(*c, one.rest, &one.parameters),
            };
            [energy, own[0], function.slope_of(around, *c, one.rest)]
        };
        springs.iter().zip(forces.chunks_exact(count)).map(pull).collect()
    }

    /// The energy `∫ T dc` from rest, by a quadrature that is refined until it agrees with that of its halves: of all parts of the way, the one
    /// whose halves disagree most with it is halved next.
    pub fn energy(&self, c: f64, rest: f64, parameters: &[f64]) -> f64 {
        let whole = self.work([rest, c], rest, parameters);
        if (c - rest).abs() <= SMOOTH * rest.abs() {
            return whole;
        }
        let halved = |way, work| Halved::of(way, work, |half| self.work(half, rest, parameters));
        let first = halved([rest, c], whole);
        if first.is_known(first.size()) {
            return first.sum();
        }
        let mut parts = vec![first];
        for _ in 0..HALVINGS {
            let size = parts.iter().map(Halved::size).sum();
            // There is always a part: one is taken and two are given back.
            let worst = (0..parts.len()).max_by(|a, b| parts[*a].doubt.total_cmp(&parts[*b].doubt)).unwrap_or(0);
            if parts[worst].is_known(size) {
                break;
            }
            let Halved { halves, works, .. } = parts.swap_remove(worst);
            parts.extend(halves.into_iter().zip(works).map(|(half, work)| halved(half, work)));
        }
        parts.iter().map(Halved::sum).sum()
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

/// A part of the way of a spring, in two halves.
struct Halved {
    halves: [[f64; 2]; 2],
    /// The work on each half, by one rule.
    works: [f64; 2],
    /// How far their sum is from the work on the part by one rule.
    doubt: f64,
}

impl Halved {
    fn of(way: [f64; 2], whole: f64, work: impl Fn([f64; 2]) -> f64) -> Halved {
        Halved::known(way, halves(way).map(work), whole)
    }

    fn known(way: [f64; 2], works: [f64; 2], whole: f64) -> Halved {
        Halved { halves: halves(way), works, doubt: (works[0] + works[1] - whole).abs() }
    }

    fn sum(&self) -> f64 {
        self.works[0] + self.works[1]
    }

    fn size(&self) -> f64 {
        self.works[0].abs() + self.works[1].abs()
    }

    /// Whether the doubt is rounding beside the size of the work on the whole way: what is small beside that is not refined, however far the
    /// measure is from rest. What is not finite is not refined either.
    fn is_known(&self, size: f64) -> bool {
        // Halves of a work without a finite value do not give one, so that such a part is not halved any more.
        self.doubt <= KNOWN * size || !self.sum().is_finite()
    }
}

fn halves([from, to]: [f64; 2]) -> [[f64; 2]; 2] {
    // The sum of two large ends may overflow, their difference need not.
    let middle = from + (to - from) / 2.0;
    [[from, middle], [middle, to]]
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
