//! Functions of Python in place of laws of force.

use crate::called::Function;
use crate::progress::calling;
use numpy::IntoPyArray;
use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use springfit_element::springs::{AskedForces, ForceFunction};

/// An argument of a law of force.
#[derive(Debug, Clone, Copy)]
pub enum Argument {
    Strain,
    Measure,
    Rest,
    Parameter(usize),
}

/// A law of force whose arguments are named.
#[derive(Debug)]
pub struct Force {
    pub function: Function,
    pub arguments: Vec<Argument>,
    /// Whether parameters and measures at rest may be arrays as well, so that many springs are asked for at once.
    pub takes_arrays: bool,
}

/// How far the forces of two springs that are asked for at once may be from those of each, relative to the largest.
const JOINT: f64 = 1e-12;

impl Force {
    /// The arguments with `of` in place of each.
    fn given<'py>(
        &self,
        py: Python<'py>,
        asked: &[AskedForces],
        array: impl Fn(Vec<f64>) -> Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyTuple>> {
        let count = asked.iter().map(|one| one.c.len()).sum();
        // There are many numbers: one loop for each spring.
        let argument = |argument: &Argument| {
            let mut values = Vec::with_capacity(count);
            for one in asked {
                match *argument {
                    Argument::Strain => values.extend(one.c.iter().map(|c| (c - one.rest) / one.rest)),
                    Argument::Measure => values.extend_from_slice(one.c),
                    Argument::Rest => values.resize(values.len() + one.c.len(), one.rest),
                    Argument::Parameter(i) => values.resize(values.len() + one.c.len(), one.parameters[i]),
                }
            }
            array(values)
        };
        PyTuple::new(py, self.arguments.iter().map(argument))
    }

    /// Whether the function gives the same for several springs at once as for each: one with expressions of NumPy does, one that asks
    /// whether a parameter is above zero does not.
    ///
    /// # Errors
    /// An interrupt.
    pub fn tries_arrays(&self, py: Python, parameters: usize) -> PyResult<bool> {
        // No two numbers are equal, so that springs or arguments which are mixed up show.
        let strains = [[-0.3, 0.1, 0.2], [0.05, -0.2, 0.4]];
        let rests = [1.0, 2.5];
        let measures: [Vec<f64>; 2] = std::array::from_fn(|i| strains[i].map(|s| (1.0 + s) * rests[i]).to_vec());
        let asked: Vec<AskedForces> = (0..2)
            .map(|i| AskedForces {
                c: &measures[i],
                rest: rests[i],
                parameters: (0..parameters).map(|j| 0.9 + 0.3 * j as f64 + 0.4 * i as f64).collect(),
            })
            .collect();
        let values = |found: &Bound<PyAny>, count: usize| -> PyResult<Vec<f64>> {
            let array = self.function.real(py, found)?;
            self.function.shaped(py, &array, "an array", &[count])
        };
        let call = |asked: &[AskedForces]| -> PyResult<Vec<f64>> {
            let given = self.given(py, asked, |values| values.into_pyarray(py).into_any())?;
            values(&calling(|| self.function.call.bind(py).call1(given))?, 3 * asked.len())
        };
        let compare = || -> PyResult<bool> {
            let joint = call(&asked)?;
            let mut single = vec![f64::NAN; joint.len()];
            for (one, forces) in asked.iter().zip(single.chunks_exact_mut(3)) {
                let found = self.call_one(py, one.c, one.rest, &one.parameters)?;
                forces.copy_from_slice(&values(&found, 3)?);
            }
            let size = single.iter().fold(0.0, |most: f64, t| most.max(t.abs()));
            let is_same = |(a, b): (&f64, &f64)| (a - b).abs() <= JOINT * size || a.is_nan() && b.is_nan();
            Ok(joint.iter().zip(&single).all(is_same))
        };
        match compare() {
            Ok(is_same) => Ok(is_same),
            // A function that takes no arrays raises. Interrupts are no such exceptions, and go on.
            Err(fault) if fault.is_instance_of::<PyException>(py) => Ok(false),
            Err(other) => Err(other),
        }
    }

    /// Calls the function for one spring, whose parameters are numbers.
    fn call_one<'py>(&self, py: Python<'py>, c: &[f64], rest: f64, parameters: &[f64]) -> PyResult<Bound<'py, PyAny>> {
        let given = self.of_one(py, c, rest, parameters)?;
        calling(|| self.function.call.bind(py).call1(given))
    }

    fn of_one<'py>(&self, py: Python<'py>, c: &[f64], rest: f64, parameters: &[f64]) -> PyResult<Bound<'py, PyTuple>> {
        let array = |values: Vec<f64>| values.into_pyarray(py).into_any();
        let argument = |argument: &Argument| match argument {
            Argument::Strain => array(c.iter().map(|c| (c - rest) / rest).collect()),
            Argument::Measure => array(c.to_vec()),
            Argument::Rest => rest.into_pyobject(py).expect("a number is no fault").into_any(),
            Argument::Parameter(i) => parameters[*i].into_pyobject(py).expect("a number is no fault").into_any(),
        };
        PyTuple::new(py, self.arguments.iter().map(argument))
    }
}

impl ForceFunction for Force {
    fn forces(&self, c: &[f64], rest: f64, parameters: &[f64], forces: &mut [f64]) {
        let found =
            Python::attach(|py| self.function.values(|py| self.of_one(py, c, rest, parameters), py, &[c.len()]));
        match found {
            Some(found) => forces.copy_from_slice(&found),
            // What ended it is raised in place of what follows.
            None => forces.fill(f64::NAN),
        }
    }

    fn forces_of_all(&self, asked: &[AskedForces], forces: &mut [f64]) {
        if !self.takes_arrays || asked.len() < 2 {
            let mut left = forces;
            for one in asked {
                let (own, others) = left.split_at_mut(one.c.len());
                self.forces(one.c, one.rest, &one.parameters, own);
                left = others;
            }
            return;
        }
        let found = Python::attach(|py| {
            let array = |values: Vec<f64>| values.into_pyarray(py).into_any();
            self.function.values(|py| self.given(py, asked, array), py, &[forces.len()])
        });
        match found {
            Some(found) => forces.copy_from_slice(&found),
            None => forces.fill(f64::NAN),
        }
    }
}
