//! The statics of springs whose numbers are arrays, with derivatives: one factor serves the solution and its gradient.

use crate::arrays::{list, matrix, places, vectors};
use crate::body::{Body, GivenBody};
use crate::equilibrium::{self, Loads};
use crate::error::{invalid, raised};
use crate::factorized::{Factorized, loose};
use crate::gradient::CellConstants;
use crate::network::Network;
use crate::progress::alone;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use springfit_bodies::model::{
    self, CompressedRows, Elastic, Entries, LengthSpring, MeasureSpring, NetworkNumbers, Support,
};
use springfit_bodies::solve::System;
use springfit_element::element::SpringKind;
use springfit_foundation::error::{Error, Result};
use springfit_foundation::number::first_not_finite;
use springfit_mesh::mesh::Mesh;
use springfit_report::report::NetworkFacts;
use std::sync::Arc;

/// A list of numbers of NumPy.
type Numbers<'py> = PyReadonlyArray1<'py, f64>;
/// The constants and rest lengths of springs between two points, and the constants and rest measures of the others.
type Given<'py> = (Numbers<'py>, Numbers<'py>, Numbers<'py>, Numbers<'py>);
/// The numbers of [`Given`], returned.
type Found<'py> =
    (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);
/// These, and a vector for each point.
type FoundWithPoints<'py> = (Found<'py>, Bound<'py, PyArray2<f64>>);

/// What springs measure, on points that may move.
#[pyclass(frozen, module = "springfit._core")]
pub struct SpringBody {
    points: usize,
    dimension: usize,
    pairs: Vec<[usize; 2]>,
    /// The springs on other measures; those with a law of force have the constant that its parameters belong to.
    others: Vec<MeasureSpring>,
}

/// Springs at an equilibrium, or at rest, with the factor of their tangent there under some supports.
#[pyclass(frozen, module = "springfit._core")]
pub struct Tangent {
    at: Factorized,
    /// The positions, `[points × dimension]`, m.
    x: Arc<Vec<f64>>,
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
        let ends = places(py, "springs", pairs.as_array())?;
        let mut others = Vec::new();
        for (constants, cells) in &blocks {
            let rule = &constants.get().rule;
            let cells = places(py, "cells", cells.as_array())?;
            let springs = &rule.springs;
            let functions = springs.functions().iter().map(|f| f.kind);
            let areas = springs.areas().iter().map(|_| SpringKind::PointArea);
            let at_points = springs.points().iter().map(|_| SpringKind::PointContent);
            let kinds: Vec<SpringKind> = functions.chain(areas).chain(at_points).chain(springs.content()).collect();
            let measures = rule.measures();
            for nodes in cells.chunks_exact(rule.element.nodes()) {
                for (kind, (own, measure)) in kinds.iter().zip(&measures) {
                    others.push(MeasureSpring {
                        kind: *kind,
                        points: own.iter().map(|&a| nodes[a]).collect(),
                        constant: 0.0,
                        rest: 0.0,
                        measure: measure.clone(),
                        law: None,
                    });
                }
            }
        }
        if let Some(place) = ends.iter().chain(others.iter().flat_map(|spring| &spring.points)).find(|p| **p >= points)
        {
            return Err(invalid(py, "cells", &format!("places of points below {points}"), place));
        }
        let pairs = ends.as_chunks::<2>().0.to_vec();
        Ok(SpringBody { points, dimension, pairs, others })
    }

    /// Takes the springs of a network, whose laws of force are expressions.
    #[staticmethod]
    fn of_network(py: Python, network: &Network) -> PyResult<SpringBody> {
        let own = network.body.network();
        own.check_sensitivities(false).map_err(|error| raised(py, error))?;
        let [points, dimension] = network.body.shape();
        let pairs = own.lengths.iter().map(|spring| spring.points).collect();
        Ok(SpringBody { points, dimension, pairs, others: own.others.clone() })
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
        let support = self.support(py, &held, None)?;
        let body = self.body(x.clone(), self.network(py, &numbers)?);
        alone(py, move || {
            if !body.is_held(&support) {
                return Err(Error::expected(
                    "fix",
                    "supports that hold every connected part",
                    "one that can move as it is",
                ));
            }
            let tangent = body.network().stiffness(&x);
            Tangent::new(body, x, tangent, support)
        })
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
        let support = self.support(py, &held, Some(prescribed))?;
        let body = self.body(x.clone(), self.network(py, &numbers)?);
        let (u, is_rounded, tangent) = alone(py, move || {
            let start = guess.map(|guess| model::displaced(&x, &guess));
            let loads = Loads { forces, support, start };
            let found = equilibrium::find(&body, &loads)?;
            let u = found.x.iter().zip(&x).map(|(now, rest)| now - rest).collect();
            let undefined = || Error::expected("points", "positions where the springs have a tangent", "others");
            let tangent = body.network().respond(&found.x).ok_or_else(undefined)?.tangent;
            // The tangent is for changes of the equilibrium, in which what is held stays where it is.
            let support = Support { prescribed: loads.support.prescribed.iter().map(|p| p.map(|_| 0.0)).collect() };
            Ok((u, found.is_rounded, Tangent::new(body, found.x, tangent, support)?))
        })?;
        Ok((matrix(py, u, self.dimension), is_rounded, tangent))
    }
}

impl SpringBody {
    fn vectors(&self, py: Python, key: &str, given: &PyReadonlyArray2<f64>) -> PyResult<Vec<f64>> {
        vectors(py, key, given, [self.points, self.dimension])
    }

    fn body(&self, points: Vec<f64>, network: model::Network) -> Body {
        let mesh = Arc::new(Mesh::of_cells(self.dimension, points, Vec::new()));
        Body::given(GivenBody { mesh, network, masses: None, facts: NetworkFacts::default() }, false)
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

    fn network(&self, py: Python, (constants, rest, contents, rests): &Given) -> PyResult<model::Network> {
        let read = |key: &str, given: &Numbers, count: usize| {
            let values: Vec<f64> = given.as_array().iter().copied().collect();
            if values.len() != count {
                return Err(invalid(py, key, &format!("an array of shape ({count},)"), values.len()));
            }
            match first_not_finite(&values) {
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
        Ok(model::Network {
            dimension: self.dimension,
            lengths: lengths.map(|(&points, (constant, rest))| LengthSpring { points, constant, rest }).collect(),
            others: others
                .map(|(spring, (constant, rest))| {
                    let mut own = spring.clone();
                    if own.law.is_some() {
                        own.scale(constant / spring.constant);
                    }
                    (own.constant, own.rest) = (constant, rest);
                    own
                })
                .collect(),
        })
    }
}

impl Tangent {
    fn new(body: Body, x: Vec<f64>, tangent: Entries, support: Support) -> Result<Tangent> {
        if tangent.iter().any(|entry| !entry.val.is_finite()) {
            return Err(loose("a spring without a stiffness"));
        }
        let system = System::new(&tangent, &support)?.placed(&x, body.dimension());
        let factor = system.factorize()?.ok_or_else(|| loose("a motion without stiffness"))?;
        let stiffness = Arc::new(CompressedRows::of_lower(x.len(), &tangent));
        let (support, system, factor) = (Arc::new(support), Arc::new(system), Arc::new(factor));
        Ok(Tangent { at: Factorized { body, stiffness, support, system, factor }, x: Arc::new(x) })
    }

    fn vectors(&self, py: Python, key: &str, given: &PyReadonlyArray2<f64>) -> PyResult<Vec<f64>> {
        vectors(py, key, given, self.at.body.shape())
    }

    fn dimension(&self) -> usize {
        self.at.body.dimension()
    }
}

#[pymethods]
impl Tangent {
    /// Whether the tangent is positive definite under its supports.
    #[getter]
    fn is_stable(&self) -> bool {
        self.at.factor.is_positive_definite()
    }

    /// The displacements under `forces` with those of what is held `prescribed`; and the share of the forces that is left.
    fn solve<'py>(
        &self,
        py: Python<'py>,
        forces: PyReadonlyArray2<f64>,
        prescribed: PyReadonlyArray2<f64>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, f64)> {
        let forces = self.vectors(py, "forces", &forces)?;
        let prescribed = self.vectors(py, "displacement", &prescribed)?;
        let at = self.at.clone();
        let found = alone(py, move || at.displacements(&[forces], &[prescribed]))?;
        let (u, left) = found.into_iter().next().unwrap_or_default();
        Ok((matrix(py, u, self.dimension()), left))
    }

    /// `K v`.
    fn product<'py>(&self, py: Python<'py>, v: PyReadonlyArray2<f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let v = self.vectors(py, "v", &v)?;
        Ok(matrix(py, self.at.stiffness.apply(&v), self.dimension()))
    }

    /// The gradient of `aᵀ K u` in the numbers of the springs and in the positions; without u that of `aᵀ F`, F the slopes of the energy.
    #[pyo3(signature = (a, u=None))]
    fn sensitivities<'py>(
        &self,
        py: Python<'py>,
        a: PyReadonlyArray2<f64>,
        u: Option<PyReadonlyArray2<f64>>,
    ) -> PyResult<FoundWithPoints<'py>> {
        let a = self.vectors(py, "a", &a)?;
        let u = u.map(|u| self.vectors(py, "u", &u)).transpose()?;
        let (body, x) = (self.at.body.clone(), self.x.clone());
        let found = alone(py, move || {
            let network = body.network();
            network.check_sensitivities(u.is_some())?;
            Ok(match &u {
                Some(u) => network.stiffness_sensitivities(&x, &a, u),
                None => network.force_sensitivities(&x, &a),
            })
        })?;
        let NetworkNumbers { mut constants, mut rests, mut points } = found;
        let lengths = self.at.body.network().lengths.len();
        let (contents, of_contents) = (constants.split_off(lengths), rests.split_off(lengths));
        // Forces have no gradient in the points: their list is empty.
        points.resize(self.x.len(), 0.0);
        let numbers = (list(py, constants), list(py, rests), list(py, contents), list(py, of_contents));
        Ok((numbers, matrix(py, points, self.dimension())))
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
        let network = self.at.body.network();
        let counts = [network.lengths.len(), network.others.len()];
        for (key, given, count) in [
            ("constants", &numbers.0, counts[0]),
            ("rest", &numbers.1, counts[0]),
            ("contents", &numbers.2, counts[1]),
            ("rest_contents", &numbers.3, counts[1]),
        ] {
            if given.len() != count {
                return Err(invalid(py, key, &format!("an array of shape ({count},)"), given.len()));
            }
        }
        let joined = |a: &Numbers, b: &Numbers| a.as_array().iter().chain(b.as_array()).copied().collect::<Vec<f64>>();
        let (constants, rests) = (joined(&numbers.0, &numbers.2), joined(&numbers.1, &numbers.3));
        let change = NetworkNumbers { constants, rests, points };
        let (body, x) = (self.at.body.clone(), self.x.clone());
        let found = alone(py, move || {
            let network = body.network();
            network.check_sensitivities(u.is_some())?;
            Ok(match &u {
                Some(u) => network.stiffness_change(&x, u, &change),
                None => network.force_change(&x, &change),
            })
        })?;
        Ok(matrix(py, found, self.dimension()))
    }
}

/// The constants and rest measures of the springs of a network, in the order of [`SpringBody::of_network`].
#[pyfunction]
pub fn spring_numbers<'py>(py: Python<'py>, network: &Network) -> (Bound<'py, PyArray2<i64>>, Found<'py>) {
    let own = network.body.network();
    let pairs = matrix(py, own.lengths.iter().flat_map(|s| s.points.map(|p| p as i64)).collect(), 2);
    let numbers = (
        list(py, own.lengths.iter().map(|s| s.constant).collect()),
        list(py, own.lengths.iter().map(|s| s.rest).collect()),
        list(py, own.others.iter().map(|s| s.constant).collect()),
        list(py, own.others.iter().map(|s| s.rest).collect()),
    );
    (pairs, numbers)
}
