//! A force law that is an expression, with the derivatives that follow from it.

use crate::symbolic::{Expr, Program};

/// The force, and its derivatives as programs.
#[derive(Debug, Clone, PartialEq)]
pub struct Formula {
    force: Program,
    slope_in_strain: Program,
    slope_in_measure: Program,
    by_parameter: Vec<Program>,
    /// `∂²T/∂p_i∂p_j` for j ≤ i, row by row.
    by_parameters: Vec<Program>,
    /// `∂T/∂c₀`.
    slope_in_rest: Program,
    /// The second derivatives in s and s, s and c, s and c₀, c and c, c and c₀.
    seconds: [Program; 5],
}

/// The force of a law and its derivatives in the measure c and in the measure at rest c₀.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LawJet {
    /// T.
    pub force: f64,
    /// `dT/dc`.
    pub slope: f64,
    /// `d²T/dc²`.
    pub curvature: f64,
    /// `dT/dc₀`.
    pub by_rest: f64,
    /// `d²T/dc dc₀`.
    pub slope_by_rest: f64,
}

/// Working memory of [`Law::force_each`](super::Law::force_each).
#[derive(Debug, Clone, Default)]
pub struct LawRoom<const N: usize> {
    at: Vec<[f64; N]>,
    values: Vec<[f64; N]>,
}

/// The number of values that are kept on the stack; most laws have fewer.
const ROOM: usize = 12;

impl Formula {
    /// Derives the formula from the force and its derivatives in the parameters; the variable `first` is the first parameter.
    pub fn new(force: &Expr, by_parameter: &[Expr], first: usize) -> Formula {
        // Second derivatives are symmetric: the lower triangle is all of them.
        let by_parameters =
            by_parameter.iter().enumerate().flat_map(|(i, slope)| (0..=i).map(move |j| slope.derivative(first + j)));
        let second = |a: usize, b: usize| Program::of(&force.derivative(a).derivative(b));
        Formula {
            slope_in_rest: Program::of(&force.derivative(2)),
            seconds: [second(0, 0), second(0, 1), second(0, 2), second(1, 1), second(1, 2)],
            by_parameters: by_parameters.map(|e| Program::of(&e)).collect(),
            slope_in_strain: Program::of(&force.derivative(0)),
            slope_in_measure: Program::of(&force.derivative(1)),
            force: Program::of(force),
            by_parameter: by_parameter.iter().map(Program::of).collect(),
        }
    }

    /// T.
    pub fn force(&self, c: f64, rest: f64, parameters: &[f64]) -> f64 {
        at(c, rest, parameters, |at| self.force.evaluate(at))
    }

    /// See [`Law::force_each`](super::Law::force_each).
    pub fn force_each<const N: usize>(&self, at: &[[f64; N]], room: &mut LawRoom<N>) -> [f64; N] {
        let LawRoom { at: all, values } = room;
        all.clear();
        all.push(std::array::from_fn(|i| (at[0][i] - at[1][i]) / at[1][i]));
        all.extend_from_slice(at);
        self.force.evaluate_each(all, values)
    }

    /// The values of [`Law::respond`](super::Law::respond) at N measures; `results` has a row for each.
    pub fn respond_each<const N: usize>(
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

    /// `dT/dc = (∂T/∂s)/c₀ + ∂T/∂c`.
    pub fn slope(&self, c: f64, rest: f64, parameters: &[f64]) -> f64 {
        at(c, rest, parameters, |at| {
            // There is no strain if the measure at rest is zero.
            let by_strain = if self.slope_in_strain.is_zero() { 0.0 } else { self.slope_in_strain.evaluate(at) / rest };
            by_strain + self.slope_in_measure.evaluate(at)
        })
    }

    /// The force with its derivatives in c and c₀, on which the strain `s = c/c₀ − 1` depends as well.
    pub fn jet(&self, c: f64, rest: f64, parameters: &[f64]) -> LawJet {
        at(c, rest, parameters, |at| {
            // A law without the strain has its derivatives at a measure at rest of zero as well, where s has none.
            let times = |factor: f64, program: &Program| match program.is_zero() {
                true => 0.0,
                false => factor * program.evaluate(at),
            };
            let (by_c, by_rest) = (1.0 / rest, -c / (rest * rest));
            let [ss, sc, sr, cc, cr] = &self.seconds;
            LawJet {
                force: self.force.evaluate(at),
                slope: times(by_c, &self.slope_in_strain) + self.slope_in_measure.evaluate(at),
                curvature: times(by_c * by_c, ss) + times(2.0 * by_c, sc) + cc.evaluate(at),
                by_rest: times(by_rest, &self.slope_in_strain) + self.slope_in_rest.evaluate(at),
                slope_by_rest: times(by_rest * by_c, ss)
                    + times(by_c, sr)
                    + times(by_rest, sc)
                    + times(-by_c * by_c, &self.slope_in_strain)
                    + cr.evaluate(at),
            }
        })
    }

    /// Writes the derivatives `∂T/∂p` into `slopes`, `[parameters]`.
    pub fn by_parameter(&self, c: f64, rest: f64, parameters: &[f64], slopes: &mut [f64]) {
        at(c, rest, parameters, |at| {
            slopes.iter_mut().zip(&self.by_parameter).for_each(|(slope, e)| *slope = e.evaluate(at))
        })
    }
}

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
