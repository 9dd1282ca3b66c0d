//! `Network`.

use crate::arguments::{numbers, optional, text};
use crate::arrays::{list, matrix, vectors};
use crate::ends::Ends;
use crate::error::{invalid, raised};
use crate::progress::{alone, apart};
use crate::sampled;
use numpy::{PyArray1, PyArray2, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springfit::element::SpringKind;
use springfit::error::{Error, Result};
use springfit::export::{target_named, with_warnings, write_files};
use springfit::fit::{CellFits, Spread};
use springfit::mesh::Mesh;
use springfit::model::{self, Elastic, Entries, MeasureSpring, Support};
use springfit::report::{self, NetworkFile, NetworkFormat};
use springfit::solve::System;
use springfit::springs::Measure;
use springfit::study::{FitOutcome, Outcome, matrix_errors};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// The share of the forces that a solution may leave; a network that leaves more has a motion without stiffness.
const LEFT: f64 = 1e-3;

/// The springs of a fit on the points of its mesh.
#[pyclass(frozen, module = "springfit._core")]
pub struct Network {
    outcome: Arc<Outcome>,
    /// The springs of the cells, until the errors of their matrices have been asked for.
    cells: Mutex<Vec<CellFits>>,
    /// Whether its laws of force call functions of Python.
    has_functions: bool,
}

/// The outcome of a sampled fit as JSON, the errors of its shapes and the ends of its starts by columns.
type Sampled<'py> = (String, Bound<'py, PyDict>, Bound<'py, PyDict>);

/// Rows, columns and values of a matrix.
pub type Triplets<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<f64>>);

impl Network {
    /// That of an outcome of one fit.
    pub fn new(outcome: Outcome, cells: Vec<CellFits>, has_functions: bool) -> Network {
        Network { outcome: Arc::new(outcome), cells: Mutex::new(cells), has_functions }
    }

    /// Computes the errors of the matrices, if it has not been done.
    fn measure(&self) -> Result<()> {
        let mut cells = self.cells.lock().unwrap_or_else(PoisonError::into_inner);
        if self.fit().errors.get().is_none() {
            let errors = matrix_errors(self.mesh(), &self.outcome.material, &cells)?;
            self.fit().errors.get_or_init(|| errors);
            *cells = Vec::new();
        }
        Ok(())
    }

    /// Evaluates the springs, whose functions may raise exceptions; a function of Python hears signals itself.
    fn evaluated<T: Send>(&self, py: Python, evaluate: impl FnOnce() -> Result<T> + Send) -> PyResult<T> {
        let ends = Arc::new(Ends::default());
        let result = apart(py, || ends.during(evaluate));
        ends.check(py)?;
        result.map_err(|error| raised(py, error))
    }

    /// The tangent stiffness at positions `x`; at rest if there are none.
    fn tangent(&self, py: Python, x: Option<Vec<f64>>) -> PyResult<Entries> {
        let outcome = self.outcome.clone();
        let evaluate = move || {
            let network = &outcome.fits[0].network;
            match x {
                None => Ok(network.stiffness(&outcome.mesh.points)),
                Some(x) => network.respond(&x).map(|found| found.tangent).ok_or_else(|| undefined("a tangent")),
            }
        };
        if self.has_functions { self.evaluated(py, evaluate) } else { alone(py, evaluate) }
    }

    fn mesh(&self) -> &Mesh {
        &self.outcome.mesh
    }

    fn fit(&self) -> &FitOutcome {
        &self.outcome.fits[0]
    }

    fn network(&self) -> &model::Network {
        &self.fit().network
    }

    /// The positions that are given, or those at rest.
    fn positions(&self, py: Python, x: Option<PyReadonlyArray2<f64>>) -> PyResult<Vec<f64>> {
        let shape = [self.mesh().point_count(), self.mesh().dimension];
        x.map_or_else(|| Ok(self.mesh().points.clone()), |x| vectors(py, "x", &x, shape))
    }
}

#[pymethods]
impl Network {
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        matrix(py, self.mesh().points.clone(), self.mesh().dimension)
    }

    #[getter]
    fn springs<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<i32>> {
        matrix(py, self.network().lengths.iter().flat_map(|s| s.points.map(|p| p as i32)).collect(), 2)
    }

    #[getter]
    fn constants<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        list(py, self.network().lengths.iter().map(|s| s.constant).collect())
    }

    #[getter]
    fn rest<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        list(py, self.network().lengths.iter().map(|s| s.rest).collect())
    }

    #[getter]
    fn masses<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.outcome.masses.clone().map(|masses| list(py, masses))
    }

    /// The springs on other measures than lengths, gathered by kind, number of points and law.
    #[getter]
    fn others<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let mut lists: BTreeMap<(&str, usize, Option<&str>), Vec<&MeasureSpring>> = BTreeMap::new();
        for spring in &self.network().others {
            let law = spring.law.as_deref().map(|own| &own.law.text[..]);
            lists.entry((spring.kind.name(), spring.points.len(), law)).or_default().push(spring);
        }
        lists.into_values().map(|springs| record(py, &springs, self.mesh().dimension)).collect()
    }

    /// The energy at positions `x`, J.
    #[pyo3(signature = (x=None))]
    fn energy(&self, py: Python, x: Option<PyReadonlyArray2<f64>>) -> PyResult<f64> {
        let x = self.positions(py, x)?;
        self.evaluated(py, || self.network().energy(&x).ok_or_else(|| undefined("an energy")))
    }

    /// The forces of the springs on the points at positions `x`, N.
    #[pyo3(signature = (x=None))]
    fn forces<'py>(&self, py: Python<'py>, x: Option<PyReadonlyArray2<f64>>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let x = self.positions(py, x)?;
        let mut slopes = self.evaluated(py, || {
            let mut slopes = vec![0.0; x.len()];
            let has_forces = self.network().forces(&x, &mut slopes);
            has_forces.then_some(slopes).ok_or_else(|| undefined("a force"))
        })?;
        // The springs pull against the energy's slope.
        slopes.iter_mut().for_each(|slope| *slope = 0.0 - *slope);
        Ok(matrix(py, slopes, self.mesh().dimension))
    }

    /// The tangent stiffness at positions `x`, in triplets of both triangles.
    #[pyo3(signature = (x=None))]
    fn stiffness<'py>(&self, py: Python<'py>, x: Option<PyReadonlyArray2<f64>>) -> PyResult<Triplets<'py>> {
        let x = x.map(|x| self.positions(py, Some(x))).transpose()?;
        Ok(triplets(py, &self.tangent(py, x)?))
    }

    /// Small displacements under `forces`, where `held` says which components are `prescribed`; and what is left of the forces.
    fn solve<'py>(
        &self,
        py: Python<'py>,
        forces: PyReadonlyArray2<f64>,
        held: PyReadonlyArray2<bool>,
        prescribed: PyReadonlyArray2<f64>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, f64, bool)> {
        let shape = [self.mesh().point_count(), self.mesh().dimension];
        let forces = vectors(py, "forces", &forces, shape)?;
        let prescribed = vectors(py, "displacement", &prescribed, shape)?;
        if held.shape() != shape {
            return Err(invalid(py, "fix", &format!("an array of shape {shape:?}"), format!("{:?}", held.shape())));
        }
        let held = held.as_array();
        let support = Support { prescribed: held.iter().zip(prescribed).map(|(held, u)| held.then_some(u)).collect() };
        if !model::unheld_bodies(self.mesh(), &support).is_empty() {
            return Err(invalid(py, "fix", "supports that hold every piece of the mesh", "one that can move as it is"));
        }
        let (stiffness, outcome) = (self.tangent(py, None)?, self.outcome.clone());
        let (u, left, is_stable) = alone(py, move || {
            let system = System::new(&stiffness, &support)?.placed(&outcome.mesh.points, outcome.mesh.dimension);
            let factor = system.factorize()?.ok_or_else(|| loose("a motion without stiffness"))?;
            let (u, left) = system.solve(&factor, &forces);
            if left > LEFT {
                return Err(loose("a motion without stiffness, on which forces act"));
            }
            Ok((u, left, factor.is_positive_definite()))
        })?;
        Ok((matrix(py, u, self.mesh().dimension), left, is_stable))
    }

    /// Writes the springs: .json, .npz, .csv or .vtu.
    fn write(&self, py: Python, path: PathBuf) -> PyResult<()> {
        if NetworkFormat::of(&path).is_ok_and(|format| format.has_errors) {
            self.evaluated(py, || self.measure())?;
        }
        let written = apart(py, || {
            let format = NetworkFormat::of(&path)?;
            springfit::check_file(&path)?;
            format.write(&path, &NetworkFile::of(&self.outcome, self.fit()))
        });
        written.map_err(|error| raised(py, error))
    }

    /// Writes the files and scripts of another program into `folder`; what they leave out, and what a user types there.
    #[pyo3(signature = (to, folder, gravity=None))]
    fn export(
        &self,
        py: Python,
        to: &Bound<PyAny>,
        folder: PathBuf,
        gravity: Option<&Bound<PyAny>>,
    ) -> PyResult<(Vec<PathBuf>, Vec<String>, &'static str)> {
        let (to, gravity) = (text("to", to)?, optional("gravity", gravity, numbers)?);
        if let Some(place) = gravity.iter().flatten().position(|g| !g.is_finite()) {
            let found = gravity.iter().flatten().nth(place).copied().unwrap_or_default();
            return Err(invalid(py, &format!("gravity[{place}]"), "a finite number, m/s²", found));
        }
        let target = target_named(&to).map_err(|error| raised(py, error.at_key("to")))?;
        self.evaluated(py, || self.measure())?;
        let outcome = self.outcome.clone();
        let (files, left_out) = alone(py, move || {
            outcome.fits[0].network.check_formulas()?;
            let network = NetworkFile::of(&outcome, &outcome.fits[0]).record();
            let of_gravity = |e: springfit::error::Error| match e.key() {
                Some("--gravity") => e.at_key("gravity"),
                _ => e,
            };
            let files = target.files(&network, gravity.as_deref()).map_err(of_gravity)?;
            let warnings = target.at_rest(&network, gravity.as_deref()).map_err(of_gravity)?;
            let files = with_warnings(files, &warnings);
            Ok((files, [warnings, target.left_out(&network)].concat()))
        })?;
        let written = apart(py, || write_files(&files, &folder, &[]));
        Ok((written.map_err(|error| raised(py, error))?, left_out, target.command))
    }

    /// What is said of the mesh and of the fit: one sentence each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        report::mesh_notes(self.mesh()).into_iter().chain(report::notes_beside_summary(&self.outcome)).collect()
    }

    /// The name of the fit.
    #[getter]
    fn name(&self) -> &str {
        &self.fit().fit.name
    }

    /// One word for the state of the fit.
    #[getter]
    fn status(&self) -> &'static str {
        self.fit().status()
    }

    /// What the fit cost and how far its matrices are from those of the finite elements.
    #[getter]
    fn statistics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.evaluated(py, || self.measure())?;
        let (fit, record) = (self.fit(), PyDict::new(py));
        record.set_item("name", &fit.fit.name)?;
        record.set_item("status", fit.status())?;
        record.set_item("seconds", fit.seconds)?;
        record.set_item("seconds_assembly", fit.seconds_assembly)?;
        record.set_item("undetermined_cells", fit.deficient)?;
        record.set_item("unreached_cells", fit.unreached)?;
        record.set_item("reused_cells", fit.reused)?;
        record.set_item("negative", fit.network.negative())?;
        for (key, spread) in [("frobenius", fit.frobenius()), ("spectral", fit.spectral())] {
            let pair = |spread: Spread| (spread.mean, spread.max);
            record.set_item(key, spread.map(pair))?;
        }
        Ok(record)
    }

    /// The outcome of a sampled fit as JSON, and its data by columns; None of other fits.
    #[getter]
    fn sampled<'py>(&self, py: Python<'py>) -> PyResult<Option<Sampled<'py>>> {
        let Some(outcome) = self.fit().kind.sampled() else { return Ok(None) };
        let text = serde_json::to_string(outcome).map_err(|e| raised(py, Error::new(e.to_string())))?;
        Ok(Some((text, sampled::shapes(py, outcome)?, sampled::starts(py, outcome)?)))
    }

    fn __len__(&self) -> usize {
        self.network().len()
    }

    /// It never changes.
    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<PyAny>) -> Py<Self> {
        slf
    }
}

/// The error of positions where the springs have no energy or a derivative of it.
fn undefined(what: &str) -> Error {
    Error::expected("x", format!("positions where the springs have {what}"), "others")
}

/// The error of supports that do not hold the network.
fn loose(found: &str) -> Error {
    Error::expected("fix", "supports that hold the network, and springs that resist every motion", found)
}

/// Both triangles of entries of the lower one.
pub fn triplets<'py>(py: Python<'py>, entries: &Entries) -> Triplets<'py> {
    let across = || entries.iter().filter(|entry| entry.row != entry.col);
    let rows = entries.iter().map(|e| e.row as i64).chain(across().map(|e| e.col as i64)).collect();
    let columns = entries.iter().map(|e| e.col as i64).chain(across().map(|e| e.row as i64)).collect();
    let values = entries.iter().map(|e| e.val).chain(across().map(|e| e.val)).collect();
    (list(py, rows), list(py, columns), list(py, values))
}

/// Springs of one kind with as many points each.
fn record<'py>(py: Python<'py>, springs: &[&MeasureSpring], d: usize) -> PyResult<Bound<'py, PyDict>> {
    let (record, n) = (PyDict::new(py), springs[0].points.len());
    record.set_item("kind", springs[0].kind.name())?;
    record.set_item("unit", SpringKind::properties(springs[0].kind).unit)?;
    record
        .set_item("points", matrix(py, springs.iter().flat_map(|s| s.points.iter().map(|&p| p as i32)).collect(), n))?;
    record.set_item("constants", list(py, springs.iter().map(|s| s.constant).collect()))?;
    record.set_item("rest", list(py, springs.iter().map(|s| s.rest).collect()))?;
    if let Some(law) = &springs[0].law {
        record.set_item("law", &law.law.text)?;
        let parameters = PyDict::new(py);
        for (i, name) in law.law.parameters.iter().enumerate() {
            let values = springs.iter().flat_map(|s| &s.law).map(|own| own.parameters[i]);
            parameters.set_item(name, list(py, values.collect()))?;
        }
        record.set_item("parameters", parameters)?;
    }
    let of_point = |spring: &MeasureSpring| match &spring.measure {
        Measure::PointContent(element, q) => Some((element.tabulation.clone(), *q as usize)),
        Measure::Span(table) => Some((springfit::element::Tabulation::clone(table), 0)),
        _ => None,
    };
    if of_point(springs[0]).is_some() {
        let tables: Vec<_> = springs.iter().filter_map(|spring| of_point(spring)).collect();
        let own = tables.first().map_or(d, |(table, _)| table.dimension);
        let gradients = tables.iter().flat_map(|(t, q)| {
            let size = t.nodes * t.dimension;
            t.gradients[q * size..(q + 1) * size].to_vec()
        });
        record.set_item("gradients", matrix(py, gradients.collect(), n * own))?;
        record.set_item("weights", list(py, tables.iter().map(|(t, q)| t.point_weight(*q)).collect()))?;
    }
    if let Measure::Patch(_) = &springs[0].measure {
        let cells = springs.iter().map(|spring| match &spring.measure {
            Measure::Patch(patch) => patch.cells.clone(),
            _ => Vec::new(),
        });
        record.set_item("cells", cells.collect::<Vec<_>>())?;
    }
    Ok(record)
}
