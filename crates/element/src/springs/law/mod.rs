//! Force laws: the force of a spring as a function of what it measures, given as an expression with parameters, or as a function of the
//! program that uses the library.
//!
//! Theory: page *Sampled fits* of the book.

mod energy;
mod formula;
mod function;

pub use formula::{LawJet, LawRoom};
pub use function::AskedResponse;
pub use function::{AskedForces, ForceFunction};

use super::Springs;
use crate::error::{Error, ErrorKind, Result};
use crate::symbolic::{Expr, Scope, variables_of};
use formula::Formula;
use function::{Function, STRAINS};
use std::sync::Arc;

/// The variables of a law besides its parameters: the strain `s = (c − c₀)/c₀`, `c` and `c₀`.
const VARIABLES: [&str; 3] = ["s", "c", "c0"];
/// What rounding may leave between a function and the sum over its parameters, relative to the force.
// Slopes are differences that err by some 1e-12 (`STEP` of `function.rs`), and may be larger than the force that they add up to.
const LINEAR: f64 = 1e-9;

/// A force law `T(c)`, the derivative of a spring's energy in its measure c: in N if c is a length, in Pa if it is a
/// volume.
#[derive(Debug, Clone, PartialEq)]
pub struct Law {
    /// The expression; of a function its name and its parameters.
    pub text: String,
    /// The parameters: names in the text that are neither variables nor functions, in the order in which they appear.
    pub parameters: Vec<String>,
    body: Body,
    outer: Vec<bool>,
    linear: bool,
}

/// What gives the force.
#[derive(Debug, Clone, PartialEq)]
enum Body {
    Formula(Box<Formula>),
    Function(Function),
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
            // Linear in this parameter, with a slope that no outer one before it changes: linear in all of them
            // together.
            outer[i] = !slope.uses(first + i) && (0..i).all(|j| !outer[j] || !slope.uses(first + j));
        }
        let mut law = Law {
            text,
            linear: outer.iter().all(|outer| *outer),
            outer,
            parameters,
            body: Body::Formula(Box::new(Formula::new(&force, &by_parameter, first))),
        };
        // Without its outer parameters a law has no force, or it has a part that none of them scales.
        let inner: Vec<f64> = law.outer.iter().map(|outer| if *outer { 0.0 } else { 1.0 }).collect();
        if STRAINS.iter().any(|s| law.force(1.0 + s, 1.0, &inner) != 0.0) {
            law.linear = false;
            law.outer.fill(false);
        }
        Ok(law)
    }

    /// A law that is a function, under a name. It is tried at some values: in which parameters it is linear, see
    /// [`Law::outer`]. Derivatives are differences of the fourth order. A network with such a law cannot be written to a file.
    ///
    /// # Errors
    /// There is no parameter, two have the same name, or one has that of a variable.
    pub fn of_function(name: &str, parameters: Vec<String>, function: Arc<dyn ForceFunction>) -> Result<Law> {
        if parameters.is_empty() {
            return Err(Error::expected(
                "force",
                "a function with parameters to fit, such as f(s, k)",
                format!("{name}(s)"),
            ));
        }
        let is_taken = |i: usize| VARIABLES.contains(&&*parameters[i]) || parameters[..i].contains(&parameters[i]);
        if let Some(taken) = (0..parameters.len()).find(|&i| is_taken(i)) {
            let expected = format!("parameters with names of their own, not {}", VARIABLES.join(", "));
            return Err(Error::expected("force", expected, format!("\"{}\" in {name}", parameters[taken])));
        }
        let text = format!("{name}({})", parameters.join(", "));
        let function = Function::new(function, parameters.len());
        let outer = function.outer().to_vec();
        let linear = outer.iter().all(|outer| *outer);
        Ok(Law { text, parameters, body: Body::Function(function), outer, linear })
    }

    /// Whether the law is a function of the program, which no file can hold.
    pub fn is_function(&self) -> bool {
        match &self.body {
            Body::Formula(_) => false,
            Body::Function(_) => true,
        }
    }

    /// What tells the law from others: springs with the same one can be added.
    pub fn mark(&self) -> (&str, usize) {
        match &self.body {
            Body::Formula(_) => (&self.text, 0),
            Body::Function(function) => (&self.text, function.address()),
        }
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
        match &self.body {
            Body::Formula(formula) => formula.force(c, rest, parameters),
            Body::Function(function) => function.forces(&[c], rest, parameters)[0],
        }
    }

    /// The force `T` of N springs. `at` holds c, c₀ and the parameters of each spring; `room` is working memory.
    pub fn force_each<const N: usize>(&self, at: &[[f64; N]], room: &mut LawRoom<N>) -> [f64; N] {
        match &self.body {
            Body::Formula(formula) => formula.force_each(at, room),
            Body::Function(function) => {
                let own = |i: usize| AskedForces {
                    c: std::slice::from_ref(&at[0][i]),
                    rest: at[1][i],
                    parameters: at[2..].iter().map(|values| values[i]).collect(),
                };
                let forces = function.forces_of_all(&(0..N).map(own).collect::<Vec<_>>());
                std::array::from_fn(|i| forces[i])
            }
        }
    }

    /// T, its derivatives in the parameters p, and its second derivatives in `p_i` and `p_j`, j ≤ i, row by row, at the measures
    /// c of each of several springs, whose number is a multiple of N. A function is asked once for all springs.
    pub fn respond_all<const N: usize>(&self, asked: &mut [AskedResponse]) {
        let formula = match &self.body {
            Body::Formula(formula) => formula,
            Body::Function(function) => return function.respond_all(asked),
        };
        for AskedResponse { c, rest, parameters, wanted, results } in asked {
            let (mut room, mut rows) = (LawRoom::default(), vec![[0.0; N]; wanted.len()]);
            for (i, each) in c.as_chunks::<N>().0.iter().enumerate() {
                formula.respond_each(each, (*rest, *parameters), wanted, &mut room, &mut rows);
                for (row, values) in results.chunks_exact_mut(c.len()).zip(&rows) {
                    row[i * N..(i + 1) * N].copy_from_slice(values);
                }
            }
        }
    }

    /// The slope `dT/dc = (∂T/∂s)/c₀ + ∂T/∂c`.
    pub fn slope(&self, c: f64, rest: f64, parameters: &[f64]) -> f64 {
        match &self.body {
            Body::Formula(formula) => formula.slope(c, rest, parameters),
            Body::Function(function) => function.slope(c, rest, parameters),
        }
    }

    /// The force with its derivatives in c and c₀; `None` of a function, whose derivatives are not known.
    pub fn jet(&self, c: f64, rest: f64, parameters: &[f64]) -> Option<LawJet> {
        match &self.body {
            Body::Formula(formula) => Some(formula.jet(c, rest, parameters)),
            Body::Function(_) => None,
        }
    }

    /// Writes the derivatives `∂T/∂p` into `slopes`, `[parameters]`.
    pub fn by_parameter(&self, c: f64, rest: f64, parameters: &[f64], slopes: &mut [f64]) {
        match &self.body {
            Body::Formula(formula) => formula.by_parameter(c, rest, parameters, slopes),
            Body::Function(function) => {
                slopes
                    .iter_mut()
                    .enumerate()
                    .for_each(|(i, slope)| *slope = function.first(&[c], rest, parameters, i)[0]);
            }
        }
    }

    /// The forces of several springs, one after the other. A function is asked once.
    pub fn forces_of_all(&self, asked: &[AskedForces]) -> Vec<f64> {
        match &self.body {
            Body::Formula(_) => {
                let each = |one: &AskedForces| -> Vec<f64> {
                    one.c.iter().map(|&c| self.force(c, one.rest, &one.parameters)).collect()
                };
                asked.iter().flat_map(each).collect()
            }
            Body::Function(function) => function.forces_of_all(asked),
        }
    }

    /// Checks that a function is linear in its outer parameters at `parameters` as where it was tried.
    ///
    /// # Errors
    /// It is not.
    pub fn check_linear(&self, rest: f64, parameters: &[f64]) -> Result<()> {
        let Body::Function(function) = &self.body else { return Ok(()) };
        // A law without outer parameters promises no linearity.
        if !self.outer.contains(&true) {
            return Ok(());
        }
        let c = STRAINS.map(|s| (1.0 + s) * rest);
        let forces = function.forces(&c, rest, parameters);
        let mut sum = vec![0.0; c.len()];
        for i in (0..parameters.len()).filter(|&i| self.outer[i]) {
            let slopes = function.first(&c, rest, parameters, i);
            sum.iter_mut().zip(slopes).for_each(|(sum, slope)| *sum += parameters[i] * slope);
        }
        let size = forces.iter().fold(0.0, |most: f64, t| most.max(t.abs()));
        // A force without a value has nothing to be compared with.
        if forces.iter().zip(&sum).all(|(t, sum)| (t - sum).abs() <= LINEAR * size || t.is_nan()) {
            return Ok(());
        }
        let values: Vec<String> =
            self.parameters.iter().zip(parameters).map(|(n, p)| format!("{n} = {p:.3e}")).collect();
        let expected = format!("{} to be linear in its parameters as at values of about 1", self.text);
        Err(Error::expected("force", expected, format!("another force at {}", values.join(", ")))
            .of_kind(ErrorKind::Infeasible))
    }
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
    pub fn check(&self, groups: usize) -> Result<()> {
        match self {
            Force::Laws(laws) if laws.len() != groups => {
                Err(Error::expected("force", format!("a law for each of {groups} groups"), laws.len()))
            }
            Force::Linear | Force::FreeRest | Force::Laws(_) | Force::Exact { .. } => Ok(()),
        }
    }

    /// Gives one law to all groups of springs; `groups` is their number.
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
