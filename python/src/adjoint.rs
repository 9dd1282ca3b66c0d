//! The statics of springs whose numbers are arrays, with derivatives: one factor serves the solution and its gradient.

use crate::arrays::{list, matrix, places, vectors};
use crate::error::{invalid, raised};
use crate::gradient::CellConstants;
use crate::progress::{alone, apart};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use springfit::element::SpringKind;
use springfit::error::{Error, Result};
use springfit::model::{Elastic, Entries, LengthSpring, MeasureSpring, Network, NetworkNumbers, Support, displaced};
use springfit::solve::{Ending, Factor, Newton, System};
use springfit::springs::Measure;
use std::sync::Arc;

/// The share of the forces that a solution may leave; springs that leave more have a motion without stiffness.
const LEFT: f64 = 1e-3;

/// A list of numbers of NumPy.
type Numbers<'py> = PyReadonlyArray1<'py, f64>;
/// The constants and rest lengths of springs between two points, and the constants and rest measures of the others.
type Given<'py> = (Numbers<'py>, Numbers<'py>, Numbers<'py>, Numbers<'py>);
/// As [`Given`], returned, with a vector for each point.
type Found<'py> = (
    (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>),
    Bound<'py, PyArray2<f64>>,
);

/// What springs measure, on points that may move.
#[pyclass(frozen, module = "springfit._core")]
pub struct SpringBody {
    points: usize,
    dimension: usize,
    pairs: Vec<[usize; 2]>,
    /// The other measures with their points.
    others: Vec<(SpringKind, Vec<usize>, Measure)>,
}

/// Springs at an equilibrium, or at rest, with the factor of their tangent there under some supports.
#[pyclass(frozen, module = "springfit._core")]
pub struct Tangent(Arc<At>);

struct At {
    network: Network,
    x: Vec<f64>,
    tangent: Entries,
    system: System,
    factor: Factor,
}

#[pymethods]
impl SpringBody {
    /// The springs between two points and those of the cells of each block on other measures, on so many points.
    #[new]
    fn new(
        py: Python,
        points: usize,
        dimension: usize,
        pairs: PyReadonlyArray2<i64>,
        blocks: Vec<(Py<CellConstants>, PyReadonlyArray2<i64>)>,
    ) -> PyResult<SpringBody> {
        let ends = places(py, "springs", pairs.as_array().iter())?;
        let mut others = Vec::new();
        for (constants, cells) in &blocks {
            let rule = &constants.get().rule;
            let cells = places(py, "cells", cells.as_array().iter())?;
            let springs = &rule.springs;
            let functions = springs.functions().iter().map(|f| f.kind);
            let areas = springs.areas().iter().map(|_| SpringKind::PointArea);
            let at_points = springs.points().iter().map(|_| SpringKind::PointContent);
            let kinds: Vec<SpringKind> = functions.chain(areas).chain(at_points).chain(springs.content()).collect();
            let measures = rule.measures();
            for nodes in cells.chunks_exact(rule.element.nodes()) {
                for (kind, (own, measure)) in kinds.iter().zip(&measures) {
                    others.push((*kind, own.iter().map(|&a| nodes[a]).collect(), measure.clone()));
                }
            }
        }
        if let Some(place) = ends.iter().chain(others.iter().flat_map(|(_, nodes, _)| nodes)).find(|p| **p >= points) {
            return Err(invalid(py, "cells", &format!("places of points below {points}"), place));
        }
        let pairs = ends.as_chunks::<2>().0.to_vec();
        Ok(SpringBody { points, dimension, pairs, others })
    }

    /// The springs at rest, whose tangent is that of small displacements.
    fn at_rest(
        &self,
        py: Python,
        points: PyReadonlyArray2<f64>,
        numbers: Given,
        held: PyReadonlyArray2<bool>,
    ) -> PyResult<Tangent> {
        let x = self.vectors(py, "points", &points)?;
        let (network, support) = (self.network(py, &numbers)?, self.support(py, &held, None)?);
        let at = alone(py, move || {
            let tangent = network.stiffness(&x);
            At::new(network, x, tangent, &support)
        })?;
        Ok(Tangent(Arc::new(at)))
    }

    /// The equilibrium at any deformation under `forces` and `prescribed` displacements of what is held, by Newton's method from rest; the
    /// displacements, and whether the forces balance only up to their rounding.
    #[expect(clippy::too_many_arguments, reason = "the numbers of a network, and its load")]
    fn equilibrium<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<f64>,
        numbers: Given,
        forces: PyReadonlyArray2<f64>,
        held: PyReadonlyArray2<bool>,
        prescribed: PyReadonlyArray2<f64>,
        guess: Option<PyReadonlyArray2<f64>>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, bool, Tangent)> {
        let x = self.vectors(py, "points", &points)?;
        let forces = self.vectors(py, "forces", &forces)?;
        let prescribed = self.vectors(py, "displacement", &prescribed)?;
        let guess = guess.map(|guess| self.vectors(py, "guess", &guess)).transpose()?;
        let network = self.network(py, &numbers)?;
        let support = self.support(py, &held, Some(prescribed))?;
        let (u, is_rounded, at) = alone(py, move || {
            let newton = Newton::default();
            let near = match guess {
                Some(guess) => newton.settle(&network, &x, &support, &forces, &guess, None)?,
                None => None,
            };
            let (u, is_rounded) = match near {
                Some(u) => (u, false),
                None => {
                    let found = newton.solve(&network, &x, &support, &forces)?;
                    if found.ending != Ending::Converged {
                        let reached = format!("loads with an equilibrium under {:.1} % of them", 100.0 * found.load);
                        let expected = "loads under which the springs have an equilibrium";
                        return Err(Error::expected("forces", expected, reached));
                    }
                    (found.displacement, found.is_rounded)
                }
            };
            let x = displaced(&x, &u);
            let undefined = || Error::expected("points", "positions where the springs have a tangent", "others");
            let tangent = network.respond(&x).ok_or_else(undefined)?.tangent;
            let held = Support { prescribed: support.prescribed.iter().map(|p| p.map(|_| 0.0)).collect() };
            Ok((u, is_rounded, At::new(network, x, tangent, &held)?))
        })?;
        Ok((matrix(py, u, self.dimension), is_rounded, Tangent(Arc::new(at))))
    }
}

impl SpringBody {
    fn vectors(&self, py: Python, key: &str, given: &PyReadonlyArray2<f64>) -> PyResult<Vec<f64>> {
        vectors(py, key, given, [self.points, self.dimension])
    }

    fn support(&self, py: Python, held: &PyReadonlyArray2<bool>, u: Option<Vec<f64>>) -> PyResult<Support> {
        if held.shape() != [self.points, self.dimension] {
            let expected = format!("an array of shape ({}, {})", self.points, self.dimension);
            return Err(invalid(py, "fix", &expected, format!("{:?}", held.shape())));
        }
        let given = |dof: usize| u.as_ref().map_or(0.0, |u| u[dof]);
        let prescribed = held.as_array().iter().enumerate().map(|(dof, held)| held.then_some(given(dof))).collect();
        Ok(Support { prescribed })
    }

    fn network(&self, py: Python, (constants, rest, contents, rests): &Given) -> PyResult<Network> {
        let read = |key: &str, given: &Numbers, count: usize| {
            let values: Vec<f64> = given.as_array().iter().copied().collect();
            if values.len() != count {
                return Err(invalid(py, key, &format!("an array of shape ({count},)"), values.len()));
            }
            match values.iter().position(|value| !value.is_finite()) {
                Some(place) => Err(invalid(py, &format!("{key}[{place}]"), "a finite number", values[place])),
                None => Ok(values),
            }
        };
        let (constants, rest) =
            (read("constants", constants, self.pairs.len())?, read("rest", rest, self.pairs.len())?);
        let (contents, rests) =
            (read("contents", contents, self.others.len())?, read("rest_contents", rests, self.others.len())?);
        let lengths = self.pairs.iter().zip(constants.into_iter().zip(rest));
        let others = self.others.iter().zip(contents.into_iter().zip(rests));
        Ok(Network {
            dimension: self.dimension,
            lengths: lengths.map(|(&points, (constant, rest))| LengthSpring { points, constant, rest }).collect(),
            others: others
                .map(|((kind, points, measure), (constant, rest))| MeasureSpring {
                    kind: *kind,
                    points: points.iter().copied().collect(),
                    constant,
                    rest,
                    measure: measure.clone(),
                    law: None,
                })
                .collect(),
        })
    }
}

impl At {
    fn new(network: Network, x: Vec<f64>, tangent: Entries, support: &Support) -> Result<At> {
        let system = System::new(&tangent, support)?.placed(&x, network.dimension);
        let factor = system.factorize()?.ok_or_else(|| loose("a motion without stiffness"))?;
        Ok(At { network, x, tangent, system, factor })
    }

    /// `K v`.
    fn product(&self, v: &[f64]) -> Vec<f64> {
        let mut image = vec![0.0; v.len()];
        for entry in &self.tangent {
            image[entry.row] += entry.val * v[entry.col];
            if entry.row != entry.col {
                image[entry.col] += entry.val * v[entry.row];
            }
        }
        image
    }

    fn numbers<'py>(&self, py: Python<'py>, found: NetworkNumbers) -> Found<'py> {
        let NetworkNumbers { mut constants, mut rests, mut points } = found;
        let (contents, of_contents) =
            (constants.split_off(self.network.lengths.len()), rests.split_off(self.network.lengths.len()));
        points.resize(self.x.len(), 0.0);
        let numbers = (list(py, constants), list(py, rests), list(py, contents), list(py, of_contents));
        (numbers, matrix(py, points, self.network.dimension))
    }
}

#[pymethods]
impl Tangent {
    /// Whether the tangent is positive definite under its supports.
    #[getter]
    fn is_stable(&self) -> bool {
        self.0.factor.is_positive_definite()
    }

    /// The displacements under `forces` with those of what is held `prescribed`; and the share of the forces that is left.
    fn solve<'py>(
        &self,
        py: Python<'py>,
        forces: PyReadonlyArray2<f64>,
        prescribed: PyReadonlyArray2<f64>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, f64)> {
        let mut forces = self.vectors(py, "forces", &forces)?;
        let prescribed = self.vectors(py, "displacement", &prescribed)?;
        let at = self.0.clone();
        let (u, left) = apart(py, || {
            if prescribed.iter().any(|u| *u != 0.0) {
                forces.iter_mut().zip(at.product(&prescribed)).for_each(|(f, pull)| *f -= pull);
            }
            let (mut u, left) = at.system.solve(&at.factor, &forces);
            u.iter_mut().zip(&prescribed).for_each(|(u, given)| *u += given);
            if left > LEFT { Err(loose("a motion without stiffness, on which forces act")) } else { Ok((u, left)) }
        })
        .map_err(|error| raised(py, error))?;
        Ok((matrix(py, u, self.0.network.dimension), left))
    }

    /// `K v`.
    fn product<'py>(&self, py: Python<'py>, v: PyReadonlyArray2<f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let v = self.vectors(py, "v", &v)?;
        Ok(matrix(py, apart(py, || self.0.product(&v)), self.0.network.dimension))
    }

    /// The gradient of `aᵀ K u` in the numbers of the springs and in the positions; without u that of `aᵀ F`, F the slopes of the energy.
    #[pyo3(signature = (a, u=None))]
    fn sensitivities<'py>(
        &self,
        py: Python<'py>,
        a: PyReadonlyArray2<f64>,
        u: Option<PyReadonlyArray2<f64>>,
    ) -> PyResult<Found<'py>> {
        let a = self.vectors(py, "a", &a)?;
        let u = u.map(|u| self.vectors(py, "u", &u)).transpose()?;
        let at = self.0.clone();
        let found = alone(py, move || {
            at.network.check_sensitivities(u.is_some())?;
            Ok(match &u {
                Some(u) => at.network.stiffness_sensitivities(&at.x, &a, u),
                None => at.network.force_sensitivities(&at.x, &a),
            })
        })?;
        Ok(self.0.numbers(py, found))
    }

    /// The change of `K u`, or without u of F, with changes of the numbers of the springs and of the positions.
    #[pyo3(signature = (numbers, points, u=None))]
    fn change<'py>(
        &self,
        py: Python<'py>,
        numbers: Given,
        points: PyReadonlyArray2<f64>,
        u: Option<PyReadonlyArray2<f64>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let points = self.vectors(py, "points", &points)?;
        let u = u.map(|u| self.vectors(py, "u", &u)).transpose()?;
        let joined = |a: &Numbers, b: &Numbers| a.as_array().iter().chain(b.as_array()).copied().collect::<Vec<f64>>();
        let (constants, rests) = (joined(&numbers.0, &numbers.2), joined(&numbers.1, &numbers.3));
        let count = self.0.network.len();
        if constants.len() != count || rests.len() != count {
            return Err(invalid(py, "numbers", &format!("those of {count} springs"), constants.len()));
        }
        let change = NetworkNumbers { constants, rests, points };
        let at = self.0.clone();
        let found = alone(py, move || {
            at.network.check_sensitivities(u.is_some())?;
            Ok(match &u {
                Some(u) => at.network.stiffness_change(&at.x, u, &change),
                None => at.network.force_change(&at.x, &change),
            })
        })?;
        Ok(matrix(py, found, self.0.network.dimension))
    }
}

impl Tangent {
    fn vectors(&self, py: Python, key: &str, given: &PyReadonlyArray2<f64>) -> PyResult<Vec<f64>> {
        let d = self.0.network.dimension;
        vectors(py, key, given, [self.0.x.len() / d, d])
    }
}

/// The error of supports that do not hold the springs.
fn loose(found: &str) -> Error {
    Error::expected("fix", "supports that hold the network, and springs that resist every motion", found)
}
