//! Expressions compiled for repeated evaluation.

use super::evaluate::{Differentiable, Value};
use super::{Expr, Function};
use crate::scalar::DoubleDouble;
use num_traits::ToPrimitive;
use std::collections::HashMap;
use std::ops::Deref;

/// Results that a program keeps without allocating memory; more than most shape functions and laws have.
const ROOM: usize = 64;

/// An expression prepared for many evaluations. Its constants are converted, and what occurs in it several times is computed once. Its
/// operations are in the order of [`Expr::evaluate`], so that the values agree to the last bit.
#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    pub(super) steps: Vec<Step>,
}

/// An operation, by the places of the steps on whose results it works, all of which are before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Step {
    Number(DoubleDouble),
    Variable(usize),
    Add(usize, usize),
    Multiply(usize, usize),
    WholePower(usize, i32),
    Root(usize),
    Power(usize, DoubleDouble),
    Call(usize, Function),
}

impl Program {
    /// Compiles the expression.
    pub fn of(expr: &Expr) -> Program {
        let mut program = Program { steps: Vec::new() };
        program.push(expr, &mut HashMap::new());
        program
    }

    /// Whether the expression is the constant zero.
    pub fn is_zero(&self) -> bool {
        self.steps == [Step::Number(DoubleDouble::from(0.0))]
    }

    /// The place of the step that computes `expr`, which is appended if the program lacks it. `known` has the steps by their keys.
    fn push(&mut self, expr: &Expr, known: &mut HashMap<Key, usize>) -> usize {
        let number = |c| DoubleDouble::from_rational(c).unwrap_or(DoubleDouble::from(f64::NAN));
        let step = match expr {
            Expr::Number(c) => Step::Number(number(c)),
            Expr::Variable(v) => Step::Variable(*v),
            Expr::Sum(inner) | Expr::Product(inner) => {
                let join = if matches!(expr, Expr::Sum(_)) { Step::Add } else { Step::Multiply };
                let joined = inner.iter().fold(None, |before, part| {
                    let part = self.push(part, known);
                    Some(before.map_or(part, |before| self.place(join(before, part), known)))
                });
                return joined.unwrap_or_else(|| self.place(Step::Number(DoubleDouble::from(f64::NAN)), known));
            }
            Expr::Power(base, exponent) => {
                let base = self.push(base, known);
                match exponent.to_i32().filter(|_| exponent.is_integer()) {
                    Some(n) => Step::WholePower(base, n),
                    // A root is rounded correctly on every machine, which a power need not be.
                    None if number(exponent) == DoubleDouble::from(0.5) => Step::Root(base),
                    None => Step::Power(base, number(exponent)),
                }
            }
            Expr::Call(function, argument) => Step::Call(self.push(argument, known), *function),
        };
        self.place(step, known)
    }

    /// The place of this step.
    fn place(&mut self, step: Step, known: &mut HashMap<Key, usize>) -> usize {
        *known.entry(step.key()).or_insert_with(|| {
            self.steps.push(step);
            self.steps.len() - 1
        })
    }

    /// The value at `at`, which has one entry per variable; NaN or infinite if the expression has no finite value
    /// there.
    pub fn evaluate(&self, at: &[f64]) -> f64 {
        let count = self.steps.len();
        if count <= ROOM { self.run(at, &mut [0.0; ROOM][..count]) } else { self.run(at, &mut vec![0.0; count]) }
    }

    /// Evaluates as [`Program::evaluate`] does, at N points at once, `at` with one entry per variable. Each step is
    /// read once for all points. `results` is working memory.
    pub fn evaluate_each<const N: usize>(&self, at: &[[f64; N]], results: &mut Vec<[f64; N]>) -> [f64; N] {
        results.clear();
        for step in &self.steps {
            results.push(match *step {
                Step::Number(c) => [c.hi; N],
                Step::Variable(v) => at[v],
                Step::Add(a, b) => std::array::from_fn(|l| results[a][l] + results[b][l]),
                Step::Multiply(a, b) => std::array::from_fn(|l| results[a][l] * results[b][l]),
                Step::WholePower(a, n) => results[a].map(|x| x.powi(n)),
                Step::Root(a) => results[a].map(f64::sqrt),
                Step::Power(a, p) => results[a].map(|x| x.powf(p.hi)),
                Step::Call(a, f) => results[a].map(|x| x.apply(f).unwrap_or(f64::NAN)),
            });
        }
        results[self.steps.len() - 1]
    }

    /// The results of all steps at `at`, which has one entry per variable.
    pub(super) fn results<T: Differentiable>(&self, at: &[T]) -> Vec<T> {
        let mut results = Vec::with_capacity(self.steps.len());
        for step in &self.steps {
            results.push(step.result(&results, at));
        }
        results
    }

    fn run(&self, at: &[f64], results: &mut [f64]) -> f64 {
        for (i, step) in self.steps.iter().enumerate() {
            results[i] = step.result(results, at);
        }
        results[results.len() - 1]
    }
}

/// A step as bits, which can be looked up.
type Key = (u8, u64, [u64; 2]);

impl Step {
    #[inline(always)]
    fn result<T: Differentiable>(&self, results: &[T], at: &[T]) -> T {
        match *self {
            Step::Number(c) => T::number(c),
            Step::Variable(v) => at[v].clone(),
            Step::Add(a, b) => results[a].clone() + &results[b],
            Step::Multiply(a, b) => results[a].clone() * &results[b],
            Step::WholePower(a, n) => results[a].clone().whole_power(n),
            Step::Root(a) => results[a].clone().sqrt(),
            Step::Power(a, p) => results[a].clone().real_power(p),
            Step::Call(a, f) => results[a].clone().apply(f).unwrap_or_else(|| T::from(f64::NAN)),
        }
    }

    fn key(&self) -> Key {
        let bits = |c: DoubleDouble| [c.hi.to_bits(), c.lo.to_bits()];
        match *self {
            Step::Number(c) => (0, 0, bits(c)),
            Step::Variable(v) => (1, v as u64, [0; 2]),
            // A sum or a product does not depend on the order of its two parts, but for the last digits of pairs of doubles.
            Step::Add(a, b) => (2, a.min(b) as u64, [a.max(b) as u64, 0]),
            Step::Multiply(a, b) => (3, a.min(b) as u64, [a.max(b) as u64, 0]),
            Step::WholePower(a, n) => (4, a as u64, [n as u64, 0]),
            Step::Root(a) => (5, a as u64, [0; 2]),
            Step::Power(a, p) => (6, a as u64, bits(p)),
            Step::Call(a, f) => (7, a as u64, [f as u64, 0]),
        }
    }
}

/// An expression with the program that evaluates it.
#[derive(Debug, Clone, PartialEq)]
pub struct Compiled {
    expression: Expr,
    program: Program,
}

impl Compiled {
    /// The value at `at`, as [`Program::evaluate`] gives it.
    pub fn evaluate(&self, at: &[f64]) -> f64 {
        self.program.evaluate(at)
    }

    /// The program, which has the derivatives as well.
    pub fn program(&self) -> &Program {
        &self.program
    }
}

impl From<Expr> for Compiled {
    fn from(expression: Expr) -> Compiled {
        Compiled { program: Program::of(&expression), expression }
    }
}

impl Deref for Compiled {
    type Target = Expr;

    fn deref(&self) -> &Expr {
        &self.expression
    }
}
