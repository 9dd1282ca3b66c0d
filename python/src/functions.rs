//! Functions of Python in place of an energy and of laws of force. They are called on the threads of the fit, for many deformations or
//! measures at once.

use crate::called::Function;
use crate::ends::Ends;
use crate::error::{invalid, raised};
use crate::laws::{Argument, Force};
use crate::progress::calling;
use numpy::ndarray::ArrayD;
use numpy::{IntoPyArray, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use springfit_element::material::Material;
use springfit_element::springs::Law;
use springfit_element::stiffness::{EnergyFunction, StressFunction};
use springfit_fit::fit::{ResidualFunction, ResidualObjective};
use springfit_foundation::error::{Error, Result};
use springfit_studies::study::FitFunctions;
use std::sync::Arc;

/// The step of a difference of the fourth order in an entry of F: its error and that of rounding are some 1e-12 of the moduli.
const STEP: f64 = 1e-3;
/// The places of such a difference in steps, and the weights of the energies there.
const AROUND: [(f64, f64); 4] = [(-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0)];
/// The largest difference of a stress from that of its energy, as a share of Young's modulus.
const SAME: f64 = 1e-6;
/// The error of a difference of the fourth order, at most, as a share of what it is apart from one of the second order: where an energy
/// grows without bound, as at F of no volume, differences are rough.
const ROUGH: f64 = 0.1;

/// What a fit minimises: the value of the residual forces of a cell and its gradient.
#[derive(Debug)]
struct Residual(Function);

impl ResidualFunction for Residual {
    fn value(&self, residuals: &[f64], shape: [usize; 3], gradient: &mut [f64]) -> Result<f64> {
        let found = Python::attach(|py| {
            self.0.called(py, || {
                let array = ArrayD::from_shape_vec(shape.to_vec(), residuals.to_vec());
                let array = array.expect("the shape is that of the residuals").into_pyarray(py);
                let found = calling(|| self.0.call.bind(py).call1((array,)))?;
                let expected = "a pair from the function: the value, or one of each shape, and its gradient";
                let pair = found.cast::<PyTuple>().ok().filter(|pair| pair.len() == 2);
                let pair = pair.ok_or_else(|| {
                    let kind =
                        found.get_type().name().map_or_else(|_| "another object".into(), |name| name.to_string());
                    invalid(py, &self.0.key, expected, kind)
                })?;
                let values = self.0.real(py, &pair.get_item(0)?)?;
                // One value, or that of each shape.
                let own: &[usize] = if values.shape().is_empty() { &[] } else { &shape[..1] };
                let values = self.0.shaped(py, &values, "one value, or an array", own)?;
                let slopes = self.0.real(py, &pair.get_item(1)?)?;
                Ok((values.iter().sum::<f64>(), self.0.shaped(py, &slopes, "a gradient", &shape)?))
            })
        });
        // What ended it is raised in place of this.
        let (value, slopes) = found.ok_or_else(|| Error::at("norm", "the function has not returned"))?;
        gradient.copy_from_slice(&slopes);
        Ok(value)
    }
}

/// An energy `W(F)` and its derivative `P(F)`, of which one may be missing. F has the shape (n, 3, 3).
#[derive(Debug)]
struct Energy {
    energy: Option<Function>,
    stress: Option<Function>,
    young: f64,
}

impl Energy {
    fn of(function: &Function, f: &[[f64; 9]], shape: &[usize]) -> Result<Vec<f64>> {
        let found = Python::attach(|py| {
            let array = ArrayD::from_shape_vec(vec![f.len(), 3, 3], f.as_flattened().to_vec());
            let array = array.expect("each has nine numbers").into_pyarray(py);
            function.values(|py| PyTuple::new(py, [array]), py, shape)
        });
        // What ended it is raised in place of this.
        found.ok_or_else(|| Error::at("law", "the function has not returned"))
    }

    /// P by differences of W, and how far those of the second order are from it.
    fn slopes(energy: &Function, f: &[[f64; 9]]) -> Result<Vec<[f64; 2]>> {
        let moved = |f: &[f64; 9], i: usize, share: f64| {
            let mut f = *f;
            f[i] += share * STEP;
            f
        };
        let around = |f| (0..9).flat_map(move |i| AROUND.map(|(share, _)| moved(f, i, share)));
        let all: Vec<[f64; 9]> = f.iter().flat_map(around).collect();
        let energies = Energy::of(energy, &all, &[all.len()])?;
        let slope = |w: &[f64; 4]| {
            let fourth = w.iter().zip(AROUND).map(|(w, (_, weight))| w * weight).sum::<f64>() / (12.0 * STEP);
            let second = (w[2] - w[1]) / (2.0 * STEP);
            [fourth, (fourth - second).abs()]
        };
        Ok(energies.as_chunks::<4>().0.iter().map(slope).collect())
    }

    /// Checks that the stresses are those of the energy.
    fn check(&self, energy: &Function, f: &[[f64; 9]], stresses: &[f64]) -> Result<()> {
        let own = Energy::slopes(energy, f)?;
        for (f, (own, stress)) in f.iter().zip(own.chunks_exact(9).zip(stresses.chunks_exact(9))) {
            let apart = own.iter().zip(stress).map(|([own, _], p)| (own - p).abs()).fold(0.0, f64::max);
            let size = own.iter().fold(self.young, |most, [p, _]| most.max(p.abs()));
            let rough = own.iter().fold(0.0, |most: f64, [_, rough]| most.max(*rough));
            // NaN is found later.
            if apart > SAME * size + ROUGH * rough {
                let found = format!("another, {apart:.3e} Pa apart, at F = {f:.4?}");
                return Err(Error::expected("stress", "the derivative of the energy", found));
            }
        }
        Ok(())
    }
}

impl StressFunction for Energy {
    fn stresses(&self, f: &[[f64; 9]], stresses: &mut [[f64; 9]]) -> Result<()> {
        if f.is_empty() {
            return Ok(());
        }
        let found = match (&self.stress, &self.energy) {
            (Some(stress), energy) => {
                let found = Energy::of(stress, f, &[f.len(), 3, 3])?;
                if let Some(energy) = energy {
                    self.check(energy, f, &found)?;
                }
                found
            }
            (None, Some(energy)) => Energy::slopes(energy, f)?.into_iter().map(|[slope, _]| slope).collect(),
            (None, None) => return Err(Error::expected("law", "an energy or a stress", "none")),
        };
        stresses.as_flattened_mut().copy_from_slice(&found);
        Ok(())
    }
}

/// A law of force: the group of springs, or none for all; the function, its name and the names of its arguments.
type GivenForce = (Option<String>, Py<PyAny>, String, Vec<String>);

/// The name of an energy, W and P.
type GivenEnergy = (String, Option<Py<PyAny>>, Option<Py<PyAny>>);

/// The functions of a fit as they are given.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Given {
    energy: Option<GivenEnergy>,
    forces: Vec<GivenForce>,
    norm: Option<(String, Py<PyAny>)>,
}

/// Functions that have been tried.
pub struct Functions {
    pub ends: Arc<Ends>,
    given: FitFunctions,
    energy: Option<(String, Arc<dyn StressFunction>)>,
}

impl Functions {
    /// Those of Python, for a material of this modulus.
    ///
    /// # Errors
    /// A law does not return, or its arguments are wrong.
    pub fn new(py: Python, given: Given, young: f64) -> PyResult<Functions> {
        let ends = Arc::new(Ends::default());
        let function = |key: &str, call: Py<PyAny>| Function { key: key.into(), call, ends: ends.clone() };
        let energy = given.energy.map(|(name, energy, stress)| {
            let energy = energy.map(|call| function("law", call));
            let stress = stress.map(|call| function("stress", call));
            let own: Arc<dyn StressFunction> = Arc::new(Energy { energy, stress, young });
            (name, own)
        });
        let mut own = FitFunctions::default();
        for (group, call, name, names) in given.forces {
            let key = group.as_ref().map_or("force".into(), |group| format!("force.{group}"));
            let mut parameters = Vec::new();
            let argument = |name: String| match &*name {
                "s" => Argument::Strain,
                "c" => Argument::Measure,
                "c0" => Argument::Rest,
                _ => {
                    parameters.push(name);
                    Argument::Parameter(parameters.len() - 1)
                }
            };
            let arguments = names.into_iter().map(argument).collect();
            let mut force = Force { function: function(&key, call), arguments, takes_arrays: false };
            force.takes_arrays = force.tries_arrays(py, parameters.len())?;
            let law = Law::of_function(&name, parameters, Arc::new(force));
            ends.check(py)?;
            let law = law.map_err(|error| raised(py, error.at_key(key)))?;
            match group {
                Some(group) => own.groups.push((group, law)),
                None => own.force = Some(law),
            }
        }
        own.norm = given.norm.map(|(name, call)| {
            let function = Residual(function("norm", call));
            ResidualObjective::new(&name, Arc::new(function))
        });
        Ok(Functions { ends, given: own, energy })
    }

    /// Those of a fit of this material.
    ///
    /// # Errors
    /// Those of [`EnergyFunction::new`].
    pub fn of(&self, material: Material) -> Result<FitFunctions> {
        let energy = self.energy.as_ref().map(|(name, energy)| EnergyFunction::new(name, material, energy.clone()));
        let energy = energy.transpose().map_err(|error| error.at_key("law"))?;
        Ok(FitFunctions { energy, ..self.given.clone() })
    }
}
