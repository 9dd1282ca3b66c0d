//! Expressions compiled for repeated evaluation in floating point.

use super::evaluate::Value;
use super::{Expr, Function};
use num_traits::ToPrimitive;

/// Values that a program keeps on the stack, without allocating memory; more than shape functions and energies need.
const ROOM: usize = 32;

/// An expression prepared for many evaluations in floating point. Its constants are converted and its operations are in
/// the order of [`Expr::evaluate`], so that the values agree to the last bit.
#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    steps: Vec<Step>,
    depth: usize,
}

#[derive(Debug, Clone, PartialEq)]
enum Step {
    Number(f64),
    Variable(usize),
    /// Replaces the last two values by their sum; [`Step::Multiply`] by their product.
    Add,
    Multiply,
    PowerOf(i32),
    Power(f64),
    Call(Function),
}

impl Program {
    /// Compiles the expression.
    pub fn of(expr: &Expr) -> Program {
        let mut program = Program { steps: Vec::new(), depth: 0 };
        program.push(expr, 0);
        program
    }

    /// Whether the expression is the constant zero.
    pub fn is_zero(&self) -> bool {
        self.steps == [Step::Number(0.0)]
    }

    /// Appends the steps of `expr`, which finds `below` values on the stack.
    fn push(&mut self, expr: &Expr, below: usize) {
        self.depth = self.depth.max(below + 1);
        match expr {
            Expr::Number(c) => self.steps.push(Step::Number(c.to_f64().unwrap_or(f64::NAN))),
            Expr::Variable(v) => self.steps.push(Step::Variable(*v)),
            Expr::Sum(inner) | Expr::Product(inner) => {
                for (i, part) in inner.iter().enumerate() {
                    // The parts before this one have become one number on the stack.
                    self.push(part, below + i.min(1));
                    if i > 0 {
                        self.steps.push(if matches!(expr, Expr::Sum(_)) { Step::Add } else { Step::Multiply });
                    }
                }
            }
            Expr::Power(base, exponent) => {
                self.push(base, below);
                self.steps.push(match exponent.to_i32().filter(|_| exponent.is_integer()) {
                    Some(n) => Step::PowerOf(n),
                    None => Step::Power(exponent.to_f64().unwrap_or(f64::NAN)),
                });
            }
            Expr::Call(function, argument) => {
                self.push(argument, below);
                self.steps.push(Step::Call(*function));
            }
        }
    }

    /// The value at `at`, which has one entry per variable; NaN or infinite if the expression has no finite value
    /// there.
    pub fn evaluate(&self, at: &[f64]) -> f64 {
        if self.depth <= ROOM { self.run(at, &mut [0.0; ROOM]) } else { self.run(at, &mut vec![0.0; self.depth]) }
    }

    /// Evaluates as [`Program::evaluate`] does, at N points at once, `at` with one entry per variable. Each step is
    /// read once for all points. `values` is working memory.
    pub fn evaluate_each<const N: usize>(&self, at: &[[f64; N]], values: &mut Vec<[f64; N]>) -> [f64; N] {
        values.resize(self.depth.max(values.len()), [0.0; N]);
        let mut next = 0;
        for step in &self.steps {
            match step {
                Step::Number(c) => (values[next], next) = ([*c; N], next + 1),
                Step::Variable(v) => (values[next], next) = (at[*v], next + 1),
                Step::Add | Step::Multiply => {
                    let last = values[next - 1];
                    next -= 1;
                    let into = values[next - 1].iter_mut().zip(&last);
                    match step {
                        Step::Add => into.for_each(|(a, b)| *a += b),
                        _ => into.for_each(|(a, b)| *a *= b),
                    }
                }
                Step::PowerOf(n) => values[next - 1].iter_mut().for_each(|x| *x = x.powi(*n)),
                // A root is rounded correctly on every machine, which a power need not be.
                Step::Power(p) if *p == 0.5 => values[next - 1].iter_mut().for_each(|x| *x = x.sqrt()),
                Step::Power(p) => values[next - 1].iter_mut().for_each(|x| *x = x.powf(*p)),
                Step::Call(f) => values[next - 1].iter_mut().for_each(|x| *x = x.apply(*f).unwrap_or(f64::NAN)),
            }
        }
        values[0]
    }

    fn run(&self, at: &[f64], values: &mut [f64]) -> f64 {
        let mut next = 0;
        for step in &self.steps {
            match step {
                Step::Number(c) => (values[next], next) = (*c, next + 1),
                Step::Variable(v) => (values[next], next) = (at[*v], next + 1),
                Step::Add => (values[next - 2], next) = (values[next - 2] + values[next - 1], next - 1),
                Step::Multiply => (values[next - 2], next) = (values[next - 2] * values[next - 1], next - 1),
                Step::PowerOf(n) => values[next - 1] = values[next - 1].powi(*n),
                Step::Power(p) if *p == 0.5 => values[next - 1] = values[next - 1].sqrt(),
                Step::Power(p) => values[next - 1] = values[next - 1].powf(*p),
                Step::Call(f) => values[next - 1] = values[next - 1].apply(*f).unwrap_or(f64::NAN),
            }
        }
        values[0]
    }
}
