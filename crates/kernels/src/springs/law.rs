//! Force laws: the force of a spring as a function of what it measures, given as an expression with parameters.
//!
//! Theory: page *Sampled fits* of the book.

use super::Springs;
use crate::error::{Error, Result};
use crate::symbolic::{Expr, Program, Scope, variables_of};
use gauss_quad::GaussLegendre;
use std::sync::{Arc, OnceLock};

/// The variables of a law besides its parameters: the strain `s = (c − c₀)/c₀`, `c` and `c₀`.
const VARIABLES: [&str; 3] = ["s", "c", "c0"];
/// The number of points of the quadrature that integrates the force; it is exact for polynomials up to degree 31.
const POINTS: usize = 16;
/// A change of the measure by this share of its value at rest is integrated without subdivision.
const SMOOTH: f64 = 0.1;
/// The relative agreement of a quadrature with that of its two halves at which it is accepted; about 50 rounding
/// errors.
const KNOWN: f64 = 1e-14;
/// The largest number of halvings of the interval.
const HALVINGS: usize = 10;
/// Strains at which a law is tested for being linear in its parameters.
const STRAINS: [f64; 5] = [-0.5, -0.1, 0.0, 0.2, 0.9];

/// A force law `T(c)`, the derivative of a spring's energy in its measure c: in N if c is a length, in Pa if it is a
/// volume.
#[derive(Debug, Clone, PartialEq)]
pub struct Law {
    /// The expression.
    pub text: String,
    /// The parameters: names in the text that are neither variables nor functions, in the order in which they appear.
    pub parameters: Vec<String>,
    force: Program,
    slope_in_strain: Program,
    slope_in_measure: Program,
    by_parameter: Vec<Program>,
    /// `∂²T/∂p_i∂p_j` for j ≤ i, row by row.
    by_parameters: Vec<Program>,
    outer: Vec<bool>,
    linear: bool,
}

impl Law {
    /// Parses a law.
    ///
    /// # Errors
    /// The text is not an expression, or has no parameter.
    pub fn parse(text: &str) -> Result<Law> {
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        let names = variables_of(&text);
        let parameters: Vec<String> = names.into_iter().filter(|name| !VARIABLES.contains(&name.as_str())).collect();
        let names: Vec<&str> = VARIABLES.into_iter().chain(parameters.iter().map(String::as_str)).collect();
        let force = Scope::new(&names).expression(&text)?;
        if !(force.uses(0) || force.uses(1)) {
            return Err(Error::expected("force", "a law of s or c, such as \"k1*s + k3*s^3\"", format!("\"{text}\"")));
        }
        if parameters.is_empty() {
            return Err(Error::expected("force", "a law with parameters to fit, such as \"k1*s + k3*s^3\"", text));
        }
        let first = VARIABLES.len();
        let by_parameter: Vec<Expr> = (first..names.len()).map(|v| force.derivative(v)).collect();
        let mut outer = vec![false; parameters.len()];
        for (i, slope) in by_parameter.iter().enumerate() {
            outer[i] = !slope.uses(first + i) && (0..i).all(|j| !outer[j] || !slope.uses(first + j));
        }
        let by_parameters =
            by_parameter.iter().enumerate().flat_map(|(i, slope)| (0..=i).map(move |j| slope.derivative(first + j)));
        let mut law = Law {
            text,
            by_parameters: by_parameters.map(|e| Program::of(&e)).collect(),
            slope_in_strain: Program::of(&force.derivative(0)),
            slope_in_measure: Program::of(&force.derivative(1)),
            linear: outer.iter().all(|outer| *outer),
            outer,
            parameters,
            force: Program::of(&force),
            by_parameter: by_parameter.iter().map(Program::of).collect(),
        };
        let inner: Vec<f64> = law.outer.iter().map(|outer| if *outer { 0.0 } else { 1.0 }).collect();
        if STRAINS.iter().any(|s| law.force(1.0 + s, 1.0, &inner) != 0.0) {
            law.linear = false;
            law.outer.fill(false);
        }
        Ok(law)
    }

    /// Whether the force is a linear function of the parameters. Then the parameters of parallel springs add up, and a
    /// least-squares fit is direct.
    pub fn is_linear(&self) -> bool {
        self.linear
    }

    /// For each parameter, whether it is an outer one. The force is linear in the outer parameters while the others,
    /// the inner ones, are fixed: in `k*(exp(a*s) - 1)`, `k` is outer and `a` is inner.
    pub fn outer(&self) -> &[bool] {
        &self.outer
    }

    /// The force `T(c)`.
    pub fn force(&self, c: f64, rest: f64, parameters: &[f64]) -> f64 {
        at(c, rest, parameters, |at| self.force.evaluate(at))
    }

    /// The force `T` of N springs. `at` holds c, c₀ and the parameters of each spring; `values` is working memory.
    pub fn force_each<const N: usize>(&self, at: &[[f64; N]], values: &mut LawRoom<N>) -> [f64; N] {
        let LawRoom { at: all, values } = values;
        all.clear();
        all.push(std::array::from_fn(|i| (at[0][i] - at[1][i]) / at[1][i]));
        all.extend_from_slice(at);
        self.force.evaluate_each(all, values)
    }

    /// T, its derivatives in the parameters p, and its second derivatives in `p_i` and `p_j`, j ≤ i, row by row, at N
    /// measures of one spring; `results` has a row for each, and those that are not `wanted` are left as they are.
    /// `room` is working memory.
    pub(crate) fn respond_each<const N: usize>(
        &self,
        c: &[f64; N],
        (rest, parameters): (f64, &[f64]),
        wanted: &[bool],
        room: &mut LawRoom<N>,
        results: &mut [[f64; N]],
    ) {
        let LawRoom { at, values } = room;
        at.clear();
        at.extend([c.map(|c| (c - rest) / rest), *c, [rest; N]]);
        at.extend(parameters.iter().map(|&p| [p; N]));
        let programs = std::iter::once(&self.force).chain(&self.by_parameter).chain(&self.by_parameters);
        for ((result, program), _) in results.iter_mut().zip(programs).zip(wanted).filter(|(_, wanted)| **wanted) {
            *result = program.evaluate_each(at, values);
        }
    }

    /// The slope `dT/dc = (∂T/∂s)/c₀ + ∂T/∂c`.
    pub fn slope(&self, c: f64, rest: f64, parameters: &[f64]) -> f64 {
        at(c, rest, parameters, |at| {
            // There is no strain if the measure at rest is zero.
            let by_strain = if self.slope_in_strain.is_zero() { 0.0 } else { self.slope_in_strain.evaluate(at) / rest };
            by_strain + self.slope_in_measure.evaluate(at)
        })
    }

    /// Writes the derivatives `∂T/∂p` into `slopes`, `[parameters]`.
    pub fn by_parameter(&self, c: f64, rest: f64, parameters: &[f64], slopes: &mut [f64]) {
        at(c, rest, parameters, |at| {
            slopes.iter_mut().zip(&self.by_parameter).for_each(|(slope, e)| *slope = e.evaluate(at))
        })
    }

    /// The energy `∫ T dc` from rest, by a quadrature that is refined until it agrees with that of its halves.
    pub fn energy(&self, c: f64, rest: f64, parameters: &[f64]) -> f64 {
        let whole = self.work([rest, c], rest, parameters);
        if (c - rest).abs() <= SMOOTH * rest.abs() {
            whole
        } else {
            self.refined([rest, c], whole, rest, parameters, HALVINGS)
        }
    }

    fn refined(&self, [from, to]: [f64; 2], whole: f64, rest: f64, parameters: &[f64], halvings: usize) -> f64 {
        let middle = from + (to - from) / 2.0;
        let halves = [[from, middle], [middle, to]];
        let works = halves.map(|half| self.work(half, rest, parameters));
        let sum = works[0] + works[1];
        if halvings == 0 || !sum.is_finite() || (sum - whole).abs() <= KNOWN * (works[0].abs() + works[1].abs()) {
            return sum;
        }
        (0..2).map(|i| self.refined(halves[i], works[i], rest, parameters, halvings - 1)).sum()
    }

    /// `∫ T dc` by one rule without refinement.
    fn work(&self, [from, to]: [f64; 2], rest: f64, parameters: &[f64]) -> f64 {
        static RULE: OnceLock<Vec<(f64, f64)>> = OnceLock::new();
        let points = POINTS.try_into().expect("there are points");
        let rule = RULE.get_or_init(|| GaussLegendre::new(points).iter().map(|(x, w)| (*x, *w)).collect());
        let half = (to - from) / 2.0;
        rule.iter().map(|(x, w)| w * half * self.force(from + half * (1.0 + x), rest, parameters)).sum()
    }
}

/// Working memory of [`Law::force_each`].
#[derive(Debug, Clone, Default)]
pub struct LawRoom<const N: usize> {
    at: Vec<[f64; N]>,
    values: Vec<[f64; N]>,
}

/// The force law that the springs of a fit share.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Force {
    /// `k (c − c₀)`, with c₀ the measure at rest.
    #[default]
    Linear,
    /// `k (c − L₀)` with a rest measure L₀ of its own, so that springs may pull at rest. The fit gives k and `k L₀`.
    FreeRest,
    /// A law for each group, in the order of [`Springs::names`](super::Springs::names). The fit gives the parameters.
    Laws(Vec<Arc<Law>>),
    /// For exact networks: `k c` for lengths and areas, whose rest measure is zero; for contents `k (c − L₀)`, with
    /// `k L₀` beside k, or the law.
    Exact {
        /// The law of the springs on contents, unless they are linear.
        content: Option<Arc<Law>>,
    },
}

impl Force {
    /// Checks that the number of laws is that of the groups.
    ///
    /// # Errors
    /// The numbers differ.
    pub(crate) fn check(&self, groups: usize) -> Result<()> {
        match self {
            Force::Laws(laws) if laws.len() != groups => {
                Err(Error::expected("force", format!("a law for each of {groups} groups"), laws.len()))
            }
            Force::Linear | Force::FreeRest | Force::Laws(_) | Force::Exact { .. } => Ok(()),
        }
    }

    /// The same law for each of so many groups.
    pub fn of_all(law: Law, groups: usize) -> Force {
        Force::Laws(std::iter::repeat_n(Arc::new(law), groups).collect())
    }

    /// The law of spring s, if it has one.
    pub fn law(&self, springs: &Springs, s: usize) -> Option<&Arc<Law>> {
        match self {
            Force::Linear | Force::FreeRest => None,
            Force::Laws(laws) => Some(&laws[springs.groups[s]]),
            Force::Exact { content } => content.as_ref().filter(|_| springs.is_on_content(s)),
        }
    }

    /// The number of values that spring s has besides its constant.
    fn parameters(&self, springs: &Springs, s: usize) -> usize {
        match (self, self.law(springs, s)) {
            (_, Some(law)) => law.parameters.len(),
            (Force::FreeRest, None) => 1,
            (Force::Exact { .. }, None) => usize::from(springs.is_on_content(s)),
            (Force::Linear | Force::Laws(_), None) => 0,
        }
    }

    /// The index at which the values of each spring begin among those of a cell, and their total number,
    /// `[springs + 1]`.
    pub fn places(&self, springs: &Springs) -> Vec<usize> {
        let mut places = vec![0];
        (0..springs.len()).for_each(|s| places.push(places[s] + self.parameters(springs, s)));
        places
    }

    /// The force `T` of spring s with the measure `c`, and the measure `rest` on the undeformed cell; `parameters` are
    /// those of the spring.
    pub fn tension(&self, springs: &Springs, s: usize, constant: f64, parameters: &[f64], [c, rest]: [f64; 2]) -> f64 {
        match (self, self.law(springs, s)) {
            (_, Some(law)) => law.force(c, rest, parameters),
            (Force::FreeRest, None) => constant * c - parameters[0],
            (Force::Exact { .. }, None) => constant * c - parameters.first().unwrap_or(&0.0),
            (Force::Linear | Force::Laws(_), None) => constant * (c - rest),
        }
    }
}

/// The number of values that are kept on the stack; most laws have fewer.
const ROOM: usize = 12;

/// Calls `work` with the values of the variables and parameters.
fn at<R>(c: f64, rest: f64, parameters: &[f64], work: impl FnOnce(&[f64]) -> R) -> R {
    let variables = [(c - rest) / rest, c, rest];
    let count = variables.len() + parameters.len();
    if count > ROOM {
        return work(&[&variables, parameters].concat());
    }
    let mut values = [0.0; ROOM];
    values[..variables.len()].copy_from_slice(&variables);
    values[variables.len()..count].copy_from_slice(parameters);
    work(&values[..count])
}
