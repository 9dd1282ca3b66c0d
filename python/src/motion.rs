//! The motion of a network.

use crate::arrays::{list, vectors};
use crate::body::Body;
use crate::ends::Ends;
use crate::error::invalid;
use crate::progress::{calling, run_functions};
use numpy::ndarray::{Array2, Array3};
use numpy::{IntoPyArray, PyArray1, PyArray3, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use springfit_bodies::dynamics::{
    Dampers, Damping, Drive, Integrator, Motion, MotionState, Options, Simulation, Step, StepOutcome,
};
use springfit_bodies::model::{Elastic, displaced};
use springfit_foundation::error::{Error, ErrorKind, Result};
use std::sync::Arc;

/// A displacement of this multiple of the size of the body means that the motion has diverged.
const AWAY: f64 = 1e9;

/// What a motion is, and how it is computed; all keys are given.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct MotionKeys<'py> {
    held: PyReadonlyArray2<'py, bool>,
    forces: PyReadonlyArray2<'py, f64>,
    prescribed: PyReadonlyArray2<'py, f64>,
    start: PyReadonlyArray2<'py, f64>,
    velocity: PyReadonlyArray2<'py, f64>,
    masses: Option<PyReadonlyArray1<'py, f64>>,
    gravity: Vec<f64>,
    step: f64,
    steps: usize,
    every: usize,
    method: String,
    rayleigh: [f64; 2],
    ratio: f64,
    callback: Option<Py<PyAny>>,
}

/// Times, positions and velocities of the states that are kept, and the number of steps whose equations were not solved to the tolerance.
pub type MotionArrays<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray3<f64>>, Bound<'py, PyArray3<f64>>, usize);

/// States one after the other.
#[derive(Default)]
struct States {
    times: Vec<f64>,
    positions: Vec<f64>,
    velocities: Vec<f64>,
    unsolved: usize,
}

/// Moves the network from the positions and velocities that are given.
pub fn simulate<'py>(py: Python<'py>, body: &Body, keys: MotionKeys) -> PyResult<MotionArrays<'py>> {
    let [points, d] = body.shape();
    let shape = [points, d];
    let forces = vectors(py, "forces", &keys.forces, shape)?;
    let prescribed = vectors(py, "displacement", &keys.prescribed, shape)?;
    let start = vectors(py, "x0", &keys.start, shape)?;
    let velocity = vectors(py, "v0", &keys.velocity, shape)?;
    let mut support = body.support(py, &keys.held)?;
    support.prescribed.iter_mut().zip(prescribed).for_each(|(held, u)| *held = held.map(|_| u));
    let masses = match (&keys.masses, body.masses()) {
        (Some(masses), _) => crate::given_springs::masses(py, masses, points)?,
        (None, Some(masses)) => masses.to_vec(),
        (None, None) => {
            return Err(invalid(py, "masses", "masses of the points, kg, as the material has no density", "none"));
        }
    };
    let integrator = Integrator::named(&keys.method).map_err(|e| crate::error::raised(py, e.at_key("method")))?;
    let (body, ends) = (body.clone(), Arc::new(Ends::default()));
    let MotionKeys { gravity, step, steps, every, rayleigh, ratio, callback, .. } = keys;
    let own = ends.clone();
    let work = move |_: &mut dyn FnMut(springfit_studies::study::Event)| -> Result<States> {
        let (network, rest) = (body.network(), body.points());
        let dampers = match ratio {
            0.0 => None,
            ratio => Some(Dampers::of_ratio(network, rest, &masses, &support, ratio).map_err(|e| e.at_key("damping"))?),
        };
        let damping = Damping { mass: rayleigh[0], stiffness: rayleigh[1], dampers };
        let mut drive = Drive::default();
        if forces.iter().any(|f| *f != 0.0) {
            drive = drive.forces(&forces, springfit_bodies::dynamics::Curve::constant(1.0));
        }
        if !gravity.is_empty() {
            drive = drive.gravity(&gravity);
        }
        // A function is asked for all springs at once by the network itself.
        let model: Box<dyn Elastic> =
            if body.has_functions { Box::new(network.clone()) } else { Box::new(network.prepared()) };
        let motion = Motion { support, drive, damping, ..Motion::free(&*model, rest, &masses) };
        let options = Options { step, integrator, account: false, ..Options::default() };
        let mut simulation = Simulation::new(motion, options).map_err(named)?;
        let from: Vec<f64> = start.iter().zip(rest).map(|(x, rest)| x - rest).collect();
        simulation.start(&from, &velocity).map_err(named)?;
        let largest = AWAY * rest.iter().fold(f64::MIN_POSITIVE, |most, x| x.abs().max(most));
        let mut states = States::default();
        let mut keep = |state: &MotionState| -> Result<()> {
            let x = displaced(rest, &state.displacement);
            if let Some(callback) = &callback {
                let goes_on = Python::attach(|py| called(py, callback, state, &x, [points, d]));
                return goes_on.map_err(|exception| {
                    own.set("callback", exception);
                    // What ended it is raised in place of this.
                    Error::at("callback", "the function has not returned")
                });
            }
            states.times.push(state.time);
            states.positions.extend(x);
            states.velocities.extend(&state.velocity);
            Ok(())
        };
        keep(simulation.state())?;
        let mut unsolved = 0;
        for done in 1..=steps {
            if own.is_set() {
                return Err(Error::new("the motion was ended"));
            }
            let Step { outcome, .. } = simulation.step();
            let time = done as f64 * step;
            let ended = |found: &str| {
                let expected = "a motion whose springs have forces at each step: a shorter step, or more damping";
                Err(Error::expected("dt", expected, format!("{found} at {time:.6e} s")).of_kind(ErrorKind::Infeasible))
            };
            match outcome {
                StepOutcome::NoResponse => return ended("none"),
                StepOutcome::Stalled => unsolved += 1,
                _ => {}
            }
            if done % every == 0 {
                if !simulation.is_within(largest) {
                    return ended("a motion without bound");
                }
                keep(simulation.state())?;
            }
        }
        states.unsolved = unsolved;
        Ok(states)
    };
    let found = run_functions(py, None, &ends, work)?;
    let count = found.times.len();
    let array = |values: Vec<f64>| {
        Array3::from_shape_vec((count, points, d), values).expect("each state has a vector for each point")
    };
    Ok((
        list(py, found.times),
        array(found.positions).into_pyarray(py),
        array(found.velocities).into_pyarray(py),
        found.unsolved,
    ))
}

/// Calls the function with time, positions and velocities.
fn called(py: Python, callback: &Py<PyAny>, state: &MotionState, x: &[f64], [points, d]: [usize; 2]) -> PyResult<()> {
    let array = |values: &[f64]| {
        let array = Array2::from_shape_vec((points, d), values.to_vec());
        array.expect("a state has a vector for each point").into_pyarray(py)
    };
    calling(|| callback.call1(py, (state.time, array(x), array(&state.velocity)))).map(drop)
}

/// Errors of a motion by the names of its arguments.
fn named(error: Error) -> Error {
    match error.key() {
        Some("step") => error.at_key("dt"),
        Some("displacement") => error.at_key("x0"),
        Some("velocity") => error.at_key("v0"),
        Some("support") => error.at_key("fix"),
        _ => error,
    }
}
