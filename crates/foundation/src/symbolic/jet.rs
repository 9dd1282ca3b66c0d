//! The derivatives of a program at a point.

use super::Function;
use super::evaluate::Differentiable;
use super::program::{Program, Step};
use crate::scalar::{DoubleDouble, Real};

/// Directions whose second derivatives are computed together.
const TOGETHER: usize = 4;

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
    /// The value and the gradient, `[variables]`, at the point `at`; NaN where there is none.
    ///
    /// One sweep from the last step to the first has the derivatives of the value in the results of all steps (Griewank and Walther,
    /// Evaluating Derivatives, 2nd ed. 2008, 3.2). For any number of variables it takes a few times as long as the value.
    pub fn gradient<T: Differentiable>(&self, at: &[T]) -> (T, Vec<T>) {
        let results = self.results(at);
        let mut gradient = vec![T::from(0.0); at.len()];
        let mut weights = self.weights::<T>();
        for (i, step) in self.steps.iter().enumerate().rev() {
            let weight = weights[i].clone();
            match *step {
                Step::Number(_) => {}
                Step::Variable(v) => gradient[v] = weight,
                Step::Add(a, b) => [a, b].iter().for_each(|&part| add(&mut weights[part], &weight)),
                Step::Multiply(a, b) => {
                    add(&mut weights[a], &(weight.clone() * &results[b]));
                    add(&mut weights[b], &(weight * &results[a]));
                }
                Step::WholePower(a, _) | Step::Root(a) | Step::Power(a, _) | Step::Call(a, _) => {
                    add(&mut weights[a], &(weight * &step.slopes(&results[a], &results[i])[0]));
                }
            }
        }
        (results[results.len() - 1].clone(), gradient)
    }

    /// The value with the derivatives in the first `variables` variables at the point `at`, which has one entry for each variable of the
    /// expression; NaN where there are none.
    ///
    /// The sweep of [`Program::gradient`] is differentiated along some directions at once (Griewank and Walther 2008, 5.1).
    pub fn jet<T: Differentiable>(&self, at: &[T], variables: usize) -> Jet<T> {
        let results = self.results(at);
        let slopes: Vec<[T; 2]> =
            self.steps.iter().zip(&results).map(|(step, y)| step.slopes_of(&results, y)).collect();
        let mut jet = Jet {
            value: results[results.len() - 1].clone(),
            gradient: vec![T::from(0.0); variables],
            hessian: vec![T::from(0.0); variables * variables],
        };
        for first in (0..variables).step_by(TOGETHER) {
            let tangents = self.tangents(&results, &slopes, first);
            self.bend(&results, &slopes, &tangents, first, &mut jet);
        }
        jet
    }

    /// The derivatives of all results in the variables from the `first` on.
    fn tangents<T: Differentiable>(&self, results: &[T], slopes: &[[T; 2]], first: usize) -> Vec<[T; TOGETHER]> {
        let mut tangents: Vec<[T; TOGETHER]> = Vec::with_capacity(results.len());
        for (i, step) in self.steps.iter().enumerate() {
            tangents.push(match *step {
                Step::Number(_) => std::array::from_fn(|_| T::from(0.0)),
                Step::Variable(v) => std::array::from_fn(|l| T::from(f64::from(u8::from(v == first + l)))),
                Step::Add(a, b) => std::array::from_fn(|l| tangents[a][l].clone() + &tangents[b][l]),
                Step::Multiply(a, b) => std::array::from_fn(|l| {
                    results[a].clone() * &tangents[b][l] + &(results[b].clone() * &tangents[a][l])
                }),
                Step::WholePower(a, _) | Step::Root(a) | Step::Power(a, _) | Step::Call(a, _) => {
                    std::array::from_fn(|l| slopes[i][0].clone() * &tangents[a][l])
                }
            });
        }
        tangents
    }

    /// Writes the gradient, and the rows and columns of the Hessian that belong to these directions.
    fn bend<T: Differentiable>(
        &self,
        results: &[T],
        slopes: &[[T; 2]],
        tangents: &[[T; TOGETHER]],
        first: usize,
        jet: &mut Jet<T>,
    ) {
        let n = jet.gradient.len();
        let mut weights = self.weights::<T>();
        let mut bends: Vec<[T; TOGETHER]> = vec![std::array::from_fn(|_| T::from(0.0)); results.len()];
        for (i, step) in self.steps.iter().enumerate().rev() {
            let (weight, bend) = (weights[i].clone(), bends[i].clone());
            // The result has this slope in that of step `a`, which changes so along the directions.
            let mut pass = |a: usize, slope: &T, change: [T; TOGETHER]| {
                add(&mut weights[a], &(weight.clone() * slope));
                for (sum, (bend, change)) in bends[a].iter_mut().zip(bend.iter().zip(&change)) {
                    add(sum, &(bend.clone() * slope + &(weight.clone() * change)));
                }
            };
            match *step {
                Step::Number(_) => {}
                Step::Variable(v) => {
                    // One triangle is computed, so that the Hessian is symmetric to the last digit.
                    for (column, entry) in (first..n).zip(bend).filter(|(column, _)| v <= *column) {
                        jet.hessian[v * n + column] = entry.clone();
                        jet.hessian[column * n + v] = entry;
                    }
                    if let Some(entry) = jet.gradient.get_mut(v) {
                        *entry = weight;
                    }
                }
                Step::Add(a, b) => {
                    for part in [a, b] {
                        add(&mut weights[part], &weight);
                        bends[part].iter_mut().zip(&bend).for_each(|(sum, bend)| add(sum, bend));
                    }
                }
                Step::Multiply(a, b) => {
                    pass(a, &results[b], tangents[b].clone());
                    pass(b, &results[a], tangents[a].clone());
                }
                Step::WholePower(a, _) | Step::Root(a) | Step::Power(a, _) | Step::Call(a, _) => {
                    let [slope, curvature] = &slopes[i];
                    pass(a, slope, std::array::from_fn(|l| curvature.clone() * &tangents[a][l]));
                }
            }
        }
    }

    /// The derivative of the last result in itself, and none yet in the others.
    fn weights<T: Differentiable>(&self) -> Vec<T> {
        let mut weights = vec![T::from(0.0); self.steps.len()];
        weights[self.steps.len() - 1] = T::from(1.0);
        weights
    }
}

impl Step {
    /// The derivatives of the result `y` in that of the step on which it works; zero if it works on two or none.
    fn slopes_of<T: Differentiable>(&self, results: &[T], y: &T) -> [T; 2] {
        match *self {
            Step::WholePower(a, _) | Step::Root(a) | Step::Power(a, _) | Step::Call(a, _) => {
                self.slopes(&results[a], y)
            }
            Step::Number(_) | Step::Variable(_) | Step::Add(..) | Step::Multiply(..) => [T::from(0.0), T::from(0.0)],
        }
    }

    /// The first and second derivative of the result `y` of a step that works on `x` alone.
    fn slopes<T: Differentiable>(&self, x: &T, y: &T) -> [T; 2] {
        let number = |c: f64| T::from(c);
        match *self {
            Step::WholePower(_, exponent) => {
                let p = f64::from(exponent);
                // A factor of zero stays zero even if the lower power is infinite.
                let lower = |factor: f64, by: i32| match factor == 0.0 {
                    true => number(0.0),
                    false => number(factor) * &x.clone().whole_power(exponent - by),
                };
                [lower(p, 1), lower(p * (p - 1.0), 2)]
            }
            Step::Root(_) => {
                let slope = number(0.5) / y;
                [slope.clone(), number(-0.5) * &slope / x]
            }
            Step::Power(_, exponent) => {
                let (p, one) = (T::from(exponent), DoubleDouble::from(1.0));
                let slope = p.clone() * &x.clone().fractional_power(exponent - &one);
                let curvature = p.clone() * &(p - &number(1.0)) * &x.clone().fractional_power(exponent - &one - &one);
                [slope, curvature]
            }
            Step::Call(_, function) => slopes_of_call(function, x, y),
            Step::Number(_) | Step::Variable(_) | Step::Add(..) | Step::Multiply(..) => [number(0.0), number(0.0)],
        }
    }
}

/// `f′` and `f″` at `x`, where the function has the value `y`.
fn slopes_of_call<T: Differentiable>(function: Function, x: &T, y: &T) -> [T; 2] {
    let number = |c: f64| T::from(c);
    let of = |function| x.clone().apply(function).unwrap_or_else(|| number(f64::NAN));
    match function {
        Function::Exp => [y.clone(), y.clone()],
        Function::Ln => [number(1.0) / x, number(-1.0) / &(x.clone() * x)],
        Function::Sin => [of(Function::Cos), y.negated()],
        Function::Cos => [of(Function::Sin).negated(), y.negated()],
        Function::Tan => {
            let slope = number(1.0) + &(y.clone() * y);
            [slope.clone(), number(2.0) * y * &slope]
        }
        Function::Asin | Function::Acos => {
            let root = (number(1.0) - &(x.clone() * x)).sqrt();
            let sign = number(if function == Function::Asin { 1.0 } else { -1.0 });
            let cube = root.clone() * &root * &root;
            [sign.clone() / &root, sign * x / &cube]
        }
        Function::Atan => {
            let slope = number(1.0) / &(number(1.0) + &(x.clone() * x));
            [slope.clone(), number(-2.0) * x * &slope * &slope]
        }
        // At zero the absolute value has no derivative. The slope to the right of zero is taken.
        Function::Abs => [number(x.rounded().signum()), number(0.0)],
        Function::Step => [number(0.0), number(0.0)],
    }
}

fn add<T: Real>(sum: &mut T, term: &T) {
    *sum = sum.clone() + term;
}
