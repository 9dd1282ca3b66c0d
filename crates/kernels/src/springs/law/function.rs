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
}

/// The step of a difference of the fourth order, relative to the variable: its error and that of rounding are some 1e-12 there.
const STEP: f64 = 1e-3;
/// Inner parameters below this count as of this size, so that their steps do not vanish.
const SMALLEST: f64 = 1e-2;
/// The strains, and the sizes of the parameters, at which a function is tried for being linear in some of them.
const STRAINS: [f64; 5] = [-0.5, -0.1, 0.0, 0.2, 0.9];
const SIZES: [f64; 3] = [0.7, 1.9, 1e4];
/// The rounding of sums of three forces, relative to the largest.
const ROUNDING: f64 = 1e-12;
/// The weights of the values at −2h, −h, h and 2h in `12 h` times the slope, and in `12 h²` times the bend without its middle, −30.
const SLOPE: [f64; 4] = [1.0, -8.0, 8.0, -1.0];
const BEND: [f64; 4] = [-1.0, 16.0, 16.0, -1.0];
const AROUND: [f64; 4] = [-2.0, -1.0, 1.0, 2.0];

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
            let others: Vec<usize> = (0..i).filter(|&j| outer[j]).collect();
            outer[i] = own.is_straight(i, parameters) && others.into_iter().all(|j| own.is_apart(i, j, parameters));
        }
        // Without its outer parameters the force vanishes.
        let inner: Vec<f64> = outer.iter().map(|outer| if *outer { 0.0 } else { 1.0 }).collect();
        if own.tried(&inner).iter().any(|t| *t != 0.0) {
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
        let mut forces = vec![f64::NAN; c.len()];
        self.function.forces(c, rest, parameters, &mut forces);
        forces
    }

    /// `dT/dc`, to some 1e-11.
    pub fn slope(&self, c: f64, rest: f64, parameters: &[f64]) -> f64 {
        let h = STEP * if rest == 0.0 { c.abs() } else { rest.abs() };
        let forces = self.forces(&AROUND.map(|share| c + share * h), rest, parameters);
        forces.iter().zip(SLOPE).map(|(t, weight)| t * weight).sum::<f64>() / (12.0 * h)
    }

    /// The values of [`Law::respond`](super::Law::respond).
    pub fn respond(&self, c: &[f64], (rest, parameters): (f64, &[f64]), wanted: &[bool], results: &mut [f64]) {
        let count = parameters.len();
        let mut rows = results.chunks_exact_mut(c.len()).zip(wanted);
        let mut set = |found: &dyn Fn() -> Vec<f64>| {
            if let Some((row, true)) = rows.next() {
                row.copy_from_slice(&found());
            }
        };
        set(&|| self.forces(c, rest, parameters));
        for i in 0..count {
            set(&|| self.first(c, rest, parameters, i));
        }
        for (i, j) in (0..count).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            set(&|| self.second(c, rest, parameters, [i, j]));
        }
    }

    /// `∂T/∂p_i`.
    pub fn first(&self, c: &[f64], rest: f64, parameters: &[f64], i: usize) -> Vec<f64> {
        if self.outer[i] {
            return self.forces(c, rest, &self.unit(parameters, i));
        }
        let h = step(parameters[i]);
        self.around(c, rest, parameters, (i, h), SLOPE, 12.0 * h)
    }

    /// `∂²T/∂p_i∂p_j`.
    fn second(&self, c: &[f64], rest: f64, parameters: &[f64], [i, j]: [usize; 2]) -> Vec<f64> {
        match [self.outer[i], self.outer[j]] {
            [true, true] => vec![0.0; c.len()],
            [true, false] => self.first(c, rest, &self.unit(parameters, i), j),
            [false, true] => self.first(c, rest, &self.unit(parameters, j), i),
            [false, false] if i == j => {
                let h = step(parameters[i]);
                let sum = self.around(c, rest, parameters, (i, h), BEND, 1.0);
                let middle = self.forces(c, rest, parameters);
                sum.iter().zip(middle).map(|(sum, t)| (sum - 30.0 * t) / (12.0 * h * h)).collect()
            }
            [false, false] => {
                let h = step(parameters[j]);
                let slope = |sign: f64| self.first(c, rest, &moved(parameters, j, sign * h), i);
                slope(1.0).iter().zip(slope(-1.0)).map(|(above, below)| (above - below) / (2.0 * h)).collect()
            }
        }
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
        balanced([&at(1.3, 0.6), &at(0.0, 0.0), &at(1.3, 0.0), &at(0.0, 0.6)])
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

/// The step of a difference in an inner parameter.
fn step(parameter: f64) -> f64 {
    STEP * parameter.abs().max(SMALLEST)
}

fn moved(parameters: &[f64], i: usize, by: f64) -> Vec<f64> {
    let mut values = parameters.to_vec();
    values[i] += by;
    values
}
