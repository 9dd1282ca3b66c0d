//! A force law that is a function of the program that uses the library. Its derivatives are differences.
//!
//! Theory: page *Sampled fits* of the book.

use std::fmt::Debug;
use std::sync::Arc;

/// A force law as a function.
pub trait ForceFunction: Debug + Send + Sync {
    /// Writes the force `T` of one spring at each measure `c`, `[measures]`; `rest` is its measure at rest. The force is that of
    /// [`Law`](super::Law), NaN where it is undefined.
    fn forces(&self, c: &[f64], rest: f64, parameters: &[f64], forces: &mut [f64]);

    /// Writes the forces of several springs, one after the other, for functions that are quicker when they are asked for many at once.
    fn forces_of_all(&self, asked: &[AskedForces], forces: &mut [f64]) {
        let mut left = forces;
        for one in asked {
            let (own, others) = left.split_at_mut(one.c.len());
            self.forces(one.c, one.rest, &one.parameters, own);
            left = others;
        }
    }
}

/// The forces of one spring that a [`ForceFunction`] is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct AskedForces<'a> {
    /// What the spring measures, `[measures]`.
    pub c: &'a [f64],
    /// Its measure at rest.
    pub rest: f64,
    /// The parameters of its law.
    pub parameters: Vec<f64>,
}

/// What is asked of a law for one spring, see [`Law::respond_all`](super::Law::respond_all).
pub struct AskedResponse<'a> {
    /// What the spring measures, `[measures]`.
    pub c: &'a [f64],
    /// Its measure at rest.
    pub rest: f64,
    /// The parameters of its law.
    pub parameters: &'a [f64],
    /// Which values are wanted: T, its derivatives in the parameters, and the second derivatives row by row.
    pub wanted: Vec<bool>,
    /// `[values × measures]`; those that are not wanted are left as they are.
    pub results: &'a mut [f64],
}

/// A row of results as a sum of forces at several parameters.
struct Combination {
    /// Which of the forces that are asked for, and its weight.
    terms: Vec<(usize, f64)>,
    divisor: f64,
}

/// The step of a difference of the fourth order, relative to the variable: its error and that of rounding are some 1e-12 there.
const STEP: f64 = 1e-3;
/// Inner parameters below this count as of this size, so that their steps do not vanish.
const SMALLEST: f64 = 1e-2;
/// The strains, and the sizes of the parameters, at which a function is tried for being linear in some of them.
// Both signs and zero are among them: a law may have branches that meet at rest, or a force there.
pub(super) const STRAINS: [f64; 5] = [-0.5, -0.1, 0.0, 0.2, 0.9];
// What bends by 1e-14 at a parameter of one would pass for rounding; at 1e4 a quadratic term is ten thousand times as
// large beside the linear one.
const SIZES: [f64; 3] = [0.7, 1.9, 1e4];
/// The rounding of sums of three forces, relative to the largest.
const ROUNDING: f64 = 1e-12;
/// The weights of the values at −2h, −h, h and 2h in `12 h` times the slope, and in `12 h²` times the bend without its middle, −30.
const SLOPE: [f64; 4] = [1.0, -8.0, 8.0, -1.0];
// The weights of a second derivative sum up to 64/12, so that rounding leaves `64/12 · 1.1e-16/h² = 6e-10` of the
// values. Second derivatives in inner parameters steer the search alone, which needs no more.
const BEND: [f64; 4] = [-1.0, 16.0, 16.0, -1.0];
const AROUND: [f64; AROUND_COUNT] = [-2.0, -1.0, 1.0, 2.0];
/// How many values a difference has.
pub const AROUND_COUNT: usize = 4;

/// The function and the parameters in which it is linear.
#[derive(Debug, Clone)]
pub struct Function {
    function: Arc<dyn ForceFunction>,
    outer: Vec<bool>,
}

impl PartialEq for Function {
    fn eq(&self, other: &Function) -> bool {
        self.address() == other.address()
    }
}

impl Function {
    /// Tries in which parameters the function is linear.
    pub fn new(function: Arc<dyn ForceFunction>, parameters: usize) -> Function {
        let mut own = Function { function, outer: Vec::new() };
        let mut outer = vec![false; parameters];
        for i in 0..parameters {
            // Being linear in each of two parameters is not enough: in a product they must not be eliminated together.
            let others: Vec<usize> = (0..i).filter(|&j| outer[j]).collect();
            outer[i] = own.is_straight(i, parameters) && others.into_iter().all(|j| own.is_apart(i, j, parameters));
        }
        // Without its outer parameters the force vanishes.
        let inner: Vec<f64> = outer.iter().map(|outer| if *outer { 0.0 } else { 1.0 }).collect();
        // A force that is left without the outer parameters would be lost in a sum over them.
        if own.tried(&inner).iter().any(|t| *t != 0.0) {
            // The search then takes all parameters as inner ones, which is slower and right for every function.
            outer.fill(false);
        }
        own.outer = outer;
        own
    }

    /// For each parameter, whether it is an outer one; see [`Law::outer`](super::Law::outer).
    pub fn outer(&self) -> &[bool] {
        &self.outer
    }

    /// Where the function is, which tells it from others.
    pub fn address(&self) -> usize {
        Arc::as_ptr(&self.function).cast::<()>() as usize
    }

    /// T at each measure.
    pub fn forces(&self, c: &[f64], rest: f64, parameters: &[f64]) -> Vec<f64> {
        // What a function leaves unwritten is not finite and is refused.
        let mut forces = vec![f64::NAN; c.len()];
        self.function.forces(c, rest, parameters, &mut forces);
        forces
    }

    /// `dT/dc`, to some 1e-11.
    pub fn slope(&self, c: f64, rest: f64, parameters: &[f64]) -> f64 {
        let forces = self.forces(&self.around_measure(c, rest), rest, parameters);
        self.slope_of(&forces, c, rest)
    }

    /// The measures around c whose forces give the slope.
    pub fn around_measure(&self, c: f64, rest: f64) -> [f64; AROUND_COUNT] {
        AROUND.map(|share| c + share * measure_step(c, rest))
    }

    /// The slope by the forces at these measures.
    pub fn slope_of(&self, forces: &[f64], c: f64, rest: f64) -> f64 {
        forces.iter().zip(SLOPE).map(|(t, weight)| t * weight).sum::<f64>() / (12.0 * measure_step(c, rest))
    }

    /// Writes what is wanted of several springs. The function is asked once for all of them, and for all of its derivatives.
    pub fn respond_all(&self, responses: &mut [AskedResponse]) {
        let mut asked: Vec<AskedForces> = Vec::new();
        let mut rows: Vec<(usize, usize, Combination)> = Vec::new();
        for (place, response) in responses.iter().enumerate() {
            let count = response.parameters.len();
            let mut plan = Plan { function: self, asked: &mut asked, first: 0, c: response.c, rest: response.rest };
            plan.first = plan.asked.len();
            let mut wanted = response.wanted.iter().enumerate().filter(|(_, wanted)| **wanted).map(|(row, _)| row);
            let seconds: Vec<[usize; 2]> = (0..count).flat_map(|i| (0..=i).map(move |j| [i, j])).collect();
            rows.extend(wanted.by_ref().map(|row| {
                let combination = match row {
                    0 => Combination { terms: plan.force(response.parameters, 1.0), divisor: 1.0 },
                    row if row <= count => plan.first(response.parameters, row - 1),
                    row => plan.second(response.parameters, seconds[row - 1 - count]),
                };
                (place, row, combination)
            }));
        }
        let starts: Vec<usize> =
            asked.iter().scan(0, |next, one| Some(std::mem::replace(next, *next + one.c.len()))).collect();
        // A place that the function does not write has no force.
        let mut forces = vec![f64::NAN; asked.iter().map(|one| one.c.len()).sum()];
        self.function.forces_of_all(&asked, &mut forces);
        for (place, row, Combination { terms, divisor }) in rows {
            let response = &mut responses[place];
            let n = response.c.len();
            let row = &mut response.results[row * n..(row + 1) * n];
            row.fill(0.0);
            for (asked, weight) in terms {
                let own = &forces[starts[asked]..starts[asked] + n];
                row.iter_mut().zip(own).for_each(|(sum, t)| *sum += weight * t);
            }
            row.iter_mut().for_each(|sum| *sum /= divisor);
        }
    }

    /// The forces of several springs, one after the other.
    pub fn forces_of_all(&self, asked: &[AskedForces]) -> Vec<f64> {
        let mut forces = vec![f64::NAN; asked.iter().map(|one| one.c.len()).sum()];
        self.function.forces_of_all(asked, &mut forces);
        forces
    }

    /// `∂T/∂p_i`.
    pub fn first(&self, c: &[f64], rest: f64, parameters: &[f64], i: usize) -> Vec<f64> {
        // A linear parameter has the force at its unit as an exact derivative, without a difference.
        if self.outer[i] {
            return self.forces(c, rest, &self.unit(parameters, i));
        }
        let h = step(parameters[i]);
        self.around(c, rest, parameters, (i, h), SLOPE, 12.0 * h)
    }

    /// The sum of the forces around parameter i with these weights, over `divisor`.
    fn around(
        &self,
        c: &[f64],
        rest: f64,
        parameters: &[f64],
        (i, h): (usize, f64),
        weights: [f64; 4],
        divisor: f64,
    ) -> Vec<f64> {
        let mut sum = vec![0.0; c.len()];
        for (share, weight) in AROUND.iter().zip(weights) {
            let forces = self.forces(c, rest, &moved(parameters, i, share * h));
            sum.iter_mut().zip(forces).for_each(|(sum, t)| *sum += weight * t);
        }
        sum.iter_mut().for_each(|sum| *sum /= divisor);
        sum
    }

    /// The outer parameter i is one, the other outer ones are zero.
    fn unit(&self, parameters: &[f64], i: usize) -> Vec<f64> {
        let value = |(j, p): (usize, &f64)| if self.outer[j] { f64::from(u8::from(j == i)) } else { *p };
        parameters.iter().enumerate().map(value).collect()
    }

    /// The forces at [`STRAINS`] of a spring of length 1.
    fn tried(&self, parameters: &[f64]) -> Vec<f64> {
        self.forces(&STRAINS.map(|s| 1.0 + s), 1.0, parameters)
    }

    /// Whether `T(2p) − T(p) = T(p) − T(0)` in parameter i.
    fn is_straight(&self, i: usize, parameters: usize) -> bool {
        SIZES.iter().all(|size| {
            let at = |p: f64| {
                // The other parameters differ from each other, from zero and from one, where terms of a function may
                // vanish or cancel.
                let mut values: Vec<f64> = (0..parameters).map(|j| 0.9 + 0.3 * j as f64).collect();
                values[i] = p;
                self.tried(&values)
            };
            balanced([&at(2.0 * size), &at(0.0), &at(*size), &at(*size)])
        })
    }

    /// Whether the effects of parameters i and j add up.
    fn is_apart(&self, i: usize, j: usize, parameters: usize) -> bool {
        let at = |p: f64, q: f64| {
            let mut values: Vec<f64> = (0..parameters).map(|j| 0.9 + 0.3 * j as f64).collect();
            (values[i], values[j]) = (p, q);
            self.tried(&values)
        };
        // Three corners of a rectangle give the fourth of effects that add up. The sides differ, so that a product of
        // both parameters shows.
        balanced([&at(1.3, 0.6), &at(0.0, 0.0), &at(1.3, 0.0), &at(0.0, 0.6)])
    }
}

/// The forces of one spring that are asked for, each once.
struct Plan<'p, 'a> {
    function: &'p Function,
    asked: &'p mut Vec<AskedForces<'a>>,
    /// The first that is asked for this spring.
    first: usize,
    c: &'a [f64],
    rest: f64,
}

impl Plan<'_, '_> {
    fn ask(&mut self, parameters: Vec<f64>) -> usize {
        // Differences share many of their points, above all the middle.
        let own = &self.asked[self.first..];
        if let Some(known) = own.iter().position(|one| one.parameters == parameters) {
            return self.first + known;
        }
        self.asked.push(AskedForces { c: self.c, rest: self.rest, parameters });
        self.asked.len() - 1
    }

    /// T times a weight. In outer parameters it is linear, `T = Σ_i p_i T_i`, so that the forces `T_i` at units serve all of their values.
    fn force(&mut self, parameters: &[f64], weight: f64) -> Vec<(usize, f64)> {
        let outer = &self.function.outer;
        if !outer.contains(&true) {
            return vec![(self.ask(parameters.to_vec()), weight)];
        }
        let acting = (0..parameters.len()).filter(|&i| outer[i] && parameters[i] != 0.0);
        acting.map(|i| (self.ask(self.function.unit(parameters, i)), weight * parameters[i])).collect()
    }

    /// The sum of the forces around parameter i with these weights.
    fn around(&mut self, parameters: &[f64], (i, h): (usize, f64), weights: [f64; 4]) -> Vec<(usize, f64)> {
        let at = |(share, weight): (&f64, f64)| self.force(&moved(parameters, i, share * h), weight);
        AROUND.iter().zip(weights).flat_map(at).collect()
    }

    /// `∂T/∂p_i`.
    fn first(&mut self, parameters: &[f64], i: usize) -> Combination {
        if self.function.outer[i] {
            return Combination { terms: self.force(&self.function.unit(parameters, i), 1.0), divisor: 1.0 };
        }
        let h = step(parameters[i]);
        Combination { terms: self.around(parameters, (i, h), SLOPE), divisor: 12.0 * h }
    }

    /// `∂²T/∂p_i∂p_j`.
    fn second(&mut self, parameters: &[f64], [i, j]: [usize; 2]) -> Combination {
        let outer = &self.function.outer;
        match [outer[i], outer[j]] {
            // A force that is linear in two parameters whose effects add up has no mixed derivative.
            [true, true] => Combination { terms: Vec::new(), divisor: 1.0 },
            [true, false] => self.first(&self.function.unit(parameters, i), j),
            [false, true] => self.first(&self.function.unit(parameters, j), i),
            [false, false] if i == j => {
                let h = step(parameters[i]);
                let mut terms = self.around(parameters, (i, h), BEND);
                terms.extend(self.force(parameters, -30.0));
                Combination { terms, divisor: 12.0 * h * h }
            }
            [false, false] => {
                // A difference of the second order suffices: this derivative only steers the search.
                let h = step(parameters[j]);
                let above = self.first(&moved(parameters, j, h), i);
                let below = self.first(&moved(parameters, j, -h), i);
                let below_terms = below.terms.into_iter().map(|(asked, weight)| (asked, -weight));
                Combination {
                    terms: above.terms.into_iter().chain(below_terms).collect(),
                    divisor: above.divisor * 2.0 * h,
                }
            }
        }
    }
}

/// Whether `a + b = c + d` up to rounding.
fn balanced([a, b, c, d]: [&[f64]; 4]) -> bool {
    (0..a.len()).all(|i| {
        let size = [a[i], b[i], c[i], d[i]].iter().fold(0.0, |most: f64, t| most.max(t.abs()));
        // NaN is not linear.
        (a[i] + b[i] - c[i] - d[i]).abs() <= ROUNDING * size
    })
}

/// The step of a difference in the measure.
fn measure_step(c: f64, rest: f64) -> f64 {
    // A measure at rest of zero has no size that a step could be relative to.
    let size = if rest == 0.0 { c.abs() } else { rest.abs() };
    // Rest and measure are both zero for springs without a length: any step serves, since no other size is known.
    STEP * if size == 0.0 { 1.0 } else { size }
}

/// The step of a difference in an inner parameter.
fn step(parameter: f64) -> f64 {
    STEP * parameter.abs().max(SMALLEST)
}

fn moved(parameters: &[f64], i: usize, by: f64) -> Vec<f64> {
    let mut values = parameters.to_vec();
    values[i] += by;
    values
}
