//! The derivatives of a program at a point.

use super::Function;
use super::evaluate::Differentiable;
use super::program::{Program, Step};
use crate::scalar::DoubleDouble;

/// Directions along which second derivatives are computed together.
const DIRECTIONS: usize = 4;

/// A number with its first and second derivatives in some variables.
#[derive(Debug, Clone, PartialEq)]
pub struct Jet<T = f64> {
    /// The value.
    pub value: T,
    /// The gradient, `[variables]`.
    pub gradient: Vec<T>,
    /// The Hessian, `[variables × variables]`, both triangles.
    pub hessian: Vec<T>,
}

impl Program {
    /// Computes the value of the expression and its gradient, `[variables]`, at the point `at`, which has one entry for each variable. A number is
    /// NaN or infinite where the expression has no value or no derivative.
    ///
    /// One sweep from the last step to the first has the derivatives of the value in the results of all steps (Griewank and Walther,
    /// Evaluating Derivatives, 2nd ed. 2008, 3.2). For any number of variables it takes a few times as long as the value.
    pub fn gradient<T: Differentiable>(&self, at: &[T]) -> (T, Vec<T>) {
        let sweep = Sweep::of(self, at);
        (sweep.value(), sweep.gradient(at.len()))
    }

    /// Computes the value of the expression at the point `at`, as [`Program::gradient`] does, with its first and second derivatives in the
    /// first `variables` variables. The other variables count as constants.
    ///
    /// The sweep of [`Program::gradient`] is differentiated along some directions at once (Griewank and Walther 2008, 5.1).
    pub fn jet<T: Differentiable>(&self, at: &[T], variables: usize) -> Jet<T> {
        let sweep = Sweep::of(self, at);
        Jet { value: sweep.value(), gradient: sweep.gradient(variables), hessian: sweep.hessian(variables) }
    }
}

/// The results of all steps at a point, and their derivatives.
struct Sweep<'a, T> {
    steps: &'a [Step],
    results: Vec<T>,
    /// The derivative of the result of each step in the one that it works on; zero for steps that work on two or on none.
    slopes: Vec<T>,
    /// The derivative of the last result in each result.
    adjoints: Vec<T>,
}

impl<'a, T: Differentiable> Sweep<'a, T> {
    fn of(program: &'a Program, at: &[T]) -> Sweep<'a, T> {
        let results = program.results(at);
        let slopes: Vec<T> = program.steps.iter().zip(&results).map(|(step, y)| step.slope(&results, y)).collect();
        let mut adjoints = vec![T::from(0.0); results.len()];
        adjoints[results.len() - 1] = T::from(1.0);
        for (i, step) in program.steps.iter().enumerate().rev() {
            let adjoint = adjoints[i].clone();
            match *step {
                Step::Number(_) | Step::Variable(_) => {}
                Step::Add(a, b) => [a, b].iter().for_each(|&part| add(&mut adjoints[part], &adjoint)),
                Step::Multiply(a, b) => {
                    add(&mut adjoints[a], &(adjoint.clone() * &results[b]));
                    add(&mut adjoints[b], &(adjoint * &results[a]));
                }
                Step::WholePower(a, _) | Step::Root(a) | Step::Power(a, _) | Step::Call(a, _) => {
                    add(&mut adjoints[a], &(adjoint * &slopes[i]));
                }
            }
        }
        Sweep { steps: &program.steps, results, slopes, adjoints }
    }

    fn value(&self) -> T {
        self.results[self.results.len() - 1].clone()
    }

    /// The steps that are one of the first variables, with its number.
    fn variables(&self, count: usize) -> impl Iterator<Item = (usize, usize)> {
        let steps = self.steps.iter().enumerate();
        steps.filter_map(move |(i, step)| match *step {
            Step::Variable(v) if v < count => Some((i, v)),
            _ => None,
        })
    }

    fn gradient(&self, count: usize) -> Vec<T> {
        let mut gradient = vec![T::from(0.0); count];
        self.variables(count).for_each(|(i, v)| gradient[v] = self.adjoints[i].clone());
        gradient
    }

    fn hessian(&self, count: usize) -> Vec<T> {
        let curvatures: Vec<T> = (self.steps.iter().zip(&self.results).zip(&self.slopes))
            .map(|((step, y), slope)| step.curvature(&self.results, y, slope))
            .collect();
        let mut hessian = vec![T::from(0.0); count * count];
        for first in (0..count).step_by(DIRECTIONS) {
            let changes = self.adjoint_tangents(&curvatures, &self.tangents(first));
            for (i, v) in self.variables(count) {
                // One triangle is computed, so that the Hessian is symmetric to the last digit.
                for (column, entry) in (first..count).zip(&changes[i]).filter(|(column, _)| v <= *column) {
                    hessian[v * count + column] = entry.clone();
                    hessian[column * count + v] = entry.clone();
                }
            }
        }
        hessian
    }

    /// The derivatives of all results in the variables from the `first` on.
    fn tangents(&self, first: usize) -> Vec<[T; DIRECTIONS]> {
        let results = &self.results;
        let mut tangents: Vec<[T; DIRECTIONS]> = Vec::with_capacity(results.len());
        for (step, slope) in self.steps.iter().zip(&self.slopes) {
            tangents.push(match *step {
                Step::Number(_) => std::array::from_fn(|_| T::from(0.0)),
                Step::Variable(v) => std::array::from_fn(|l| T::from(f64::from(u8::from(v == first + l)))),
                Step::Add(a, b) => std::array::from_fn(|l| tangents[a][l].clone() + &tangents[b][l]),
                Step::Multiply(a, b) => std::array::from_fn(|l| {
                    results[a].clone() * &tangents[b][l] + &(results[b].clone() * &tangents[a][l])
                }),
                Step::WholePower(a, _) | Step::Root(a) | Step::Power(a, _) | Step::Call(a, _) => {
                    std::array::from_fn(|l| times(slope, &tangents[a][l]))
                }
            });
        }
        tangents
    }

    /// The derivatives of all adjoints along the directions of the tangents.
    fn adjoint_tangents(&self, curvatures: &[T], tangents: &[[T; DIRECTIONS]]) -> Vec<[T; DIRECTIONS]> {
        let mut all: Vec<[T; DIRECTIONS]> = vec![std::array::from_fn(|_| T::from(0.0)); self.steps.len()];
        for (i, step) in self.steps.iter().enumerate().rev() {
            let (adjoint, own) = (&self.adjoints[i], all[i].clone());
            // The result of this step has the derivative `slope` in that of step `a`, and `change` is how the slope changes.
            let mut pass = |a: usize, slope: &T, change: [T; DIRECTIONS]| {
                for (sum, (own, change)) in all[a].iter_mut().zip(own.iter().zip(&change)) {
                    add(sum, &(own.clone() * slope + &(adjoint.clone() * change)));
                }
            };
            match *step {
                Step::Number(_) | Step::Variable(_) => {}
                Step::Add(a, b) => {
                    for part in [a, b] {
                        all[part].iter_mut().zip(&own).for_each(|(sum, own)| add(sum, own));
                    }
                }
                Step::Multiply(a, b) => {
                    pass(a, &self.results[b], tangents[b].clone());
                    pass(b, &self.results[a], tangents[a].clone());
                }
                Step::WholePower(a, _) | Step::Root(a) | Step::Power(a, _) | Step::Call(a, _) => {
                    pass(a, &self.slopes[i], std::array::from_fn(|l| times(&curvatures[i], &tangents[a][l])));
                }
            }
        }
        all
    }
}

impl Step {
    /// The derivative of the result `y` in the one that the step works on; zero if it works on two or on none.
    fn slope<T: Differentiable>(&self, results: &[T], y: &T) -> T {
        let number = |c: f64| T::from(c);
        match *self {
            Step::Number(_) | Step::Variable(_) | Step::Add(..) | Step::Multiply(..) => number(0.0),
            Step::WholePower(a, n) => lower_power(&results[a], f64::from(n), n.saturating_sub(1)),
            Step::Root(_) => number(0.5) / &y.magnitude(),
            Step::Power(a, p) => T::number(p) * &results[a].clone().real_power(p - &DoubleDouble::from(1.0)),
            Step::Call(a, function) => {
                let x = &results[a];
                let of = |function| x.clone().apply(function).unwrap_or_else(|| number(f64::NAN));
                match function {
                    Function::Exp => y.clone(),
                    Function::Ln => number(1.0) / x,
                    Function::Sin => of(Function::Cos),
                    Function::Cos => of(Function::Sin).negated(),
                    Function::Tan => number(1.0) + &y.clone().squared(),
                    Function::Asin => number(1.0) / &(number(1.0) - &x.clone().squared()).sqrt(),
                    Function::Acos => number(-1.0) / &(number(1.0) - &x.clone().squared()).sqrt(),
                    Function::Atan => number(1.0) / &(number(1.0) + &x.clone().squared()),
                    // At zero the absolute value has no derivative. The slope to the right of zero is taken.
                    Function::Abs => number(x.rounded().signum()),
                    Function::Step => number(0.0),
                }
            }
        }
    }

    /// The second derivative of the result `y`, with its first.
    fn curvature<T: Differentiable>(&self, results: &[T], y: &T, slope: &T) -> T {
        let number = |c: f64| T::from(c);
        match *self {
            Step::Number(_) | Step::Variable(_) | Step::Add(..) | Step::Multiply(..) => number(0.0),
            Step::WholePower(a, n) => {
                lower_power(&results[a], f64::from(n) * (f64::from(n) - 1.0), n.saturating_sub(2))
            }
            Step::Root(a) => number(-0.5) * slope / &results[a],
            Step::Power(a, p) => {
                let before = p - &DoubleDouble::from(1.0);
                let power = results[a].clone().real_power(before - &DoubleDouble::from(1.0));
                T::number(p) * &T::number(before) * &power
            }
            Step::Call(a, function) => match function {
                Function::Exp => y.clone(),
                Function::Ln => slope.clone().squared().negated(),
                Function::Sin | Function::Cos => y.negated(),
                Function::Tan => number(2.0) * y * slope,
                Function::Asin | Function::Acos => results[a].clone() * &(slope.clone().squared() * slope),
                Function::Atan => number(-2.0) * &results[a] * &slope.clone().squared(),
                Function::Abs | Function::Step => number(0.0),
            },
        }
    }
}

/// `factor xⁿ`; zero if the factor is, even if the power is infinite.
fn lower_power<T: Differentiable>(x: &T, factor: f64, n: i32) -> T {
    if factor == 0.0 { T::from(0.0) } else { T::from(factor) * &x.clone().whole_power(n) }
}

/// The change of a result by that of the one on which it depends; none if that does not change, however steep the result is there.
fn times<T: Differentiable>(slope: &T, tangent: &T) -> T {
    if tangent.rounded() == 0.0 { T::from(0.0) } else { slope.clone() * tangent }
}

fn add<T: Differentiable>(sum: &mut T, term: &T) {
    *sum = sum.clone() + term;
}
