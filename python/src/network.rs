//! `Network`.

use crate::arguments::{numbers, optional, text};
use crate::arrays::{list, matrix, vectors};
use crate::body::{Body, GivenBody, undefined};
use crate::element::Element;
use crate::equilibrium::{self, Found, Loads};
use crate::error::{invalid, raised};
use crate::factorized::Factorized;
use crate::given_springs::{self, GivenGroup, GivenLengths};
use crate::mesh::Mesh;
use crate::motion::{self, MotionArrays, MotionKeys};
use crate::progress::{alone, apart};
use crate::sampled;
use crate::shapes;
use crate::sparse::{self, Rows};
use crate::springs::{self, Changed};
use numpy::ndarray::Array3;
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArray3, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springfit::export::{target_named, with_warnings, write_files};
use springfit_bodies::model::Elastic;
use springfit_fit::fit::{CellFits, Spread};
use springfit_foundation::error::{Error, Result};
use springfit_mesh::mesh;
use springfit_report::report::{self, NetworkFormat, read_network};
use springfit_studies::study::{Outcome, matrix_errors};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// Springs on points.
#[pyclass(frozen, module = "springfit._core")]
pub struct Network {
    pub body: Body,
    /// The springs of the cells, until the errors of their matrices have been asked for.
    cells: Mutex<Vec<CellFits>>,
}

/// The outcome of a sampled fit as JSON, the errors of its shapes and the ends of its starts by columns.
type Sampled<'py> = (String, Bound<'py, PyDict>, Bound<'py, PyDict>);

/// A network, the mesh of its cells if there is one, and its name, its status and its notes.
type Read = (Network, Option<Mesh>, (Option<String>, Option<String>, Vec<String>));

impl Network {
    /// That of an outcome of one fit.
    pub fn new(outcome: Outcome, cells: Vec<CellFits>, has_functions: bool) -> Network {
        Network { body: Body::fitted(outcome, has_functions), cells: Mutex::new(cells) }
    }

    /// Computes the errors of the matrices, if it has not been done.
    fn measure(&self) -> Result<()> {
        let Some((outcome, fit)) = self.body.fit() else { return Ok(()) };
        let mut cells = self.cells.lock().unwrap_or_else(PoisonError::into_inner);
        if fit.errors.get().is_none() {
            let errors = matrix_errors(&outcome.mesh, &outcome.material, &cells)?;
            fit.errors.get_or_init(|| errors);
            *cells = Vec::new();
        }
        Ok(())
    }
}

impl From<Body> for Network {
    fn from(body: Body) -> Network {
        Network { body, cells: Mutex::default() }
    }
}

#[pymethods]
impl Network {
    /// Springs from arrays; `contents` are groups with all keys, `mesh` has the cells on the same points, and `facts` are those of [`Network::facts`].
    #[staticmethod]
    #[pyo3(signature = (points, springs, constants, rest, contents, masses=None, mesh=None, facts=None))]
    #[expect(clippy::too_many_arguments, reason = "what a network has")]
    fn of_arrays(
        py: Python,
        points: PyReadonlyArray2<f64>,
        springs: PyReadonlyArray2<i64>,
        constants: PyReadonlyArray1<f64>,
        rest: Option<PyReadonlyArray1<f64>>,
        contents: Vec<GivenGroup>,
        masses: Option<PyReadonlyArray1<f64>>,
        mesh: Option<&Mesh>,
        facts: Option<&str>,
    ) -> PyResult<Network> {
        let facts = facts.map(serde_json::from_str).transpose();
        let facts = facts.map_err(|e| invalid(py, "facts", "those of a network in JSON", e))?.unwrap_or_default();
        let [count, d] = [points.shape()[0], points.shape()[1]];
        if !(1..=3).contains(&d) {
            let expected = "an array of shape (points, 1), (points, 2) or (points, 3)";
            return Err(invalid(py, "points", expected, format!("one of shape ({count}, {d})")));
        }
        let places = vectors(py, "points", &points, [count, d])?;
        let mesh = match mesh {
            Some(mesh) if mesh.mesh.dimension != d || mesh.mesh.points != places => {
                return Err(invalid(py, "points", "those of the mesh", "others"));
            }
            Some(mesh) => mesh.mesh.clone(),
            None => Arc::new(mesh::Mesh::of_cells(d, places, Vec::new())),
        };
        let elements: Vec<_> = mesh.blocks.iter().map(|block| block.element.clone()).collect();
        let lengths = GivenLengths { springs: &springs, constants: &constants, rest: rest.as_ref() };
        let network = given_springs::network(py, (&mesh.points, d), &lengths, &contents, &elements)?;
        let masses = masses.map(|masses| given_springs::masses(py, &masses, count)).transpose()?;
        Ok(Body::given(GivenBody { mesh, network, masses, facts }, false).into())
    }

    /// The network of a JSON file. `elements` are those of its cells that are not shipped.
    #[staticmethod]
    fn read(py: Python, path: PathBuf, elements: Vec<PyRef<Element>>) -> PyResult<Read> {
        let own: Vec<Element> = elements.iter().map(|element| Element::clone(element)).collect();
        let elements: Vec<_> = own.iter().map(|element| element.0.clone()).collect();
        let (given, has_cells, facts) = alone(py, move || {
            let record = read_network(&path)?;
            let network = record.model(&elements).map_err(|e| e.in_file(&path))?;
            let mesh = record.mesh(&elements);
            let has_cells = mesh.is_some();
            let bare = || mesh::Mesh::of_cells(record.dimension, record.points.concat(), Vec::new());
            let mesh = Arc::new(mesh.unwrap_or_else(bare));
            let known = record.facts();
            let fit = record.provenance.fit;
            let facts = (fit.as_ref().map(|fit| fit.name.clone()), fit.map(|fit| fit.status), record.notes);
            Ok((GivenBody { mesh, network, masses: record.masses, facts: known }, has_cells, facts))
        })?;
        let mesh =
            has_cells.then(|| Mesh::of_library(given.mesh.clone(), &own)).transpose().map_err(|e| raised(py, e))?;
        Ok((Body::given(given, false).into(), mesh, facts))
    }

    /// The same springs with other numbers; `others` has those of each group of `others`, or none.
    #[pyo3(signature = (constants, rest, others))]
    fn changed(
        &self,
        py: Python,
        constants: Option<PyReadonlyArray1<f64>>,
        rest: Option<PyReadonlyArray1<f64>>,
        others: Vec<Changed>,
    ) -> PyResult<Network> {
        let network = springs::changed(py, self.body.network(), constants.as_ref(), rest.as_ref(), &others)?;
        Ok(self.body.with_network(network).into())
    }

    /// What is known beside points and springs, as JSON.
    #[getter]
    fn facts(&self, py: Python) -> PyResult<String> {
        serde_json::to_string(&self.body.file().facts()).map_err(|e| raised(py, Error::new(e.to_string())))
    }

    #[getter]
    fn dimension(&self) -> usize {
        self.body.dimension()
    }

    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        matrix(py, self.body.points().to_vec(), self.body.dimension())
    }

    #[getter]
    fn springs<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<i64>> {
        matrix(py, self.body.network().lengths.iter().flat_map(|s| s.points.map(|p| p as i64)).collect(), 2)
    }

    #[getter]
    fn constants<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        list(py, self.body.network().lengths.iter().map(|s| s.constant).collect())
    }

    #[getter]
    fn rest<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        list(py, self.body.network().lengths.iter().map(|s| s.rest).collect())
    }

    #[getter]
    fn masses<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.body.masses().map(|masses| list(py, masses.to_vec()))
    }

    /// The springs on other measures than lengths, in groups.
    #[getter]
    fn others<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let network = self.body.network();
        let of_group = |group: Vec<usize>| {
            let springs: Vec<_> = group.into_iter().map(|s| &network.others[s]).collect();
            springs::record(py, &springs, network.dimension)
        };
        springs::groups(network).into_iter().map(of_group).collect()
    }

    /// That no law of force is a function, which neither a file nor a pickle holds.
    fn check_formulas(&self, py: Python) -> PyResult<()> {
        self.body.network().check_formulas().map_err(|error| raised(py, error))
    }

    /// The energies of shapes, `[shapes, points, dimension]`, J; the one at rest if there are none.
    #[pyo3(signature = (x=None))]
    fn energy<'py>(&self, py: Python<'py>, x: Option<PyReadonlyArray3<f64>>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let evaluate = |model: &dyn Elastic, x: &[f64]| model.energy(x).ok_or_else(|| undefined("an energy"));
        Ok(list(py, shapes::each(py, &self.body, x, evaluate)?.1))
    }

    /// The forces of the springs on the points of shapes, N.
    #[pyo3(signature = (x=None))]
    fn forces<'py>(&self, py: Python<'py>, x: Option<PyReadonlyArray3<f64>>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let (count, found) = shapes::each(py, &self.body, x, |model, x| {
            let mut slopes = vec![0.0; x.len()];
            if !model.forces(x, &mut slopes) {
                return Err(undefined("a force"));
            }
            // The springs pull against the energy's slope.
            slopes.iter_mut().for_each(|slope| *slope = 0.0 - *slope);
            Ok(slopes)
        })?;
        let [points, d] = self.body.shape();
        let all: Vec<f64> = found.into_iter().flatten().collect();
        let array = Array3::from_shape_vec((count.unwrap_or(1), points, d), all);
        Ok(array.expect("each shape has a vector for each point").into_pyarray(py))
    }

    /// The tangent stiffness at positions `x`, row by row.
    #[pyo3(signature = (x=None))]
    fn stiffness<'py>(&self, py: Python<'py>, x: Option<PyReadonlyArray2<f64>>) -> PyResult<Rows<'py>> {
        let shape = self.body.shape();
        let x = x.map(|x| vectors(py, "x", &x, shape)).transpose()?;
        let found = self.body.worked(py, move |body| body.stiffness(x.as_deref()))?;
        Ok(sparse::rows(py, found))
    }

    /// The factor of the stiffness at rest where `held` says which components are prescribed.
    fn factorized(&self, py: Python, held: PyReadonlyArray2<bool>) -> PyResult<Factorized> {
        Factorized::new(py, &self.body, self.body.support(py, &held)?)
    }

    /// The positions in equilibrium at large deformation.
    #[pyo3(signature = (forces, held, prescribed, start=None))]
    fn equilibrium<'py>(
        &self,
        py: Python<'py>,
        forces: PyReadonlyArray2<f64>,
        held: PyReadonlyArray2<bool>,
        prescribed: PyReadonlyArray2<f64>,
        start: Option<PyReadonlyArray2<f64>>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, bool, usize)> {
        let shape = self.body.shape();
        let forces = vectors(py, "forces", &forces, shape)?;
        let given = vectors(py, "displacement", &prescribed, shape)?;
        let start = start.map(|start| vectors(py, "x0", &start, shape)).transpose()?;
        let mut support = self.body.support(py, &held)?;
        support.prescribed.iter_mut().zip(given).for_each(|(held, u)| *held = held.map(|_| u));
        let loads = Loads { forces, support, start };
        let Found { x, is_rounded, inverted } = self.body.worked(py, move |body| equilibrium::find(body, &loads))?;
        Ok((matrix(py, x, shape[1]), is_rounded, inverted))
    }

    /// The motion from a state, as arrays of the states that are kept.
    fn simulate<'py>(&self, py: Python<'py>, keys: MotionKeys) -> PyResult<MotionArrays<'py>> {
        motion::simulate(py, &self.body, keys)
    }

    /// A total force on a group of the mesh as forces on its points, N.
    fn group_forces<'py>(
        &self,
        py: Python<'py>,
        group: String,
        force: Vec<f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let d = self.body.dimension();
        if force.len() != d {
            let expected = format!("{d} numbers, N");
            return Err(invalid(py, &format!("forces.{group}"), &expected, force.len()));
        }
        let key = format!("forces.{group}");
        let found = apart(py, || self.body.group_forces(&group, force));
        found.map(|forces| matrix(py, forces, d)).map_err(|error| raised(py, error.at_key(key)))
    }

    /// Writes the springs: .json, .npz, .csv or .vtu.
    fn write(&self, py: Python, path: PathBuf) -> PyResult<()> {
        if NetworkFormat::of(&path).is_ok_and(|format| format.has_errors) {
            self.body.evaluated(py, || self.measure())?;
        }
        let written = apart(py, || {
            let format = NetworkFormat::of(&path)?;
            springfit_foundation::file::check_file(&path)?;
            format.write(&path, &self.body.file())
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
        self.body.evaluated(py, || self.measure())?;
        let body = self.body.clone();
        let (files, left_out) = alone(py, move || {
            body.network().check_formulas()?;
            let of_gravity = |e: Error| match e.key() {
                Some("--gravity") => e.at_key("gravity"),
                _ => e,
            };
            let prepared = target.prepared(body.file().record(), gravity.as_deref());
            let (network, mut warnings) = prepared.map_err(of_gravity)?;
            let files = target.files(&network, gravity.as_deref()).map_err(of_gravity)?;
            warnings.extend(target.at_rest(&network, gravity.as_deref()).map_err(of_gravity)?);
            let files = with_warnings(files, &warnings);
            Ok((files, [warnings, target.left_out(&network)].concat()))
        })?;
        let written = apart(py, || write_files(&files, &folder, &[]));
        Ok((written.map_err(|error| raised(py, error))?, left_out, target.command))
    }

    /// What is said of the mesh and of the fit: one sentence each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        let mesh = report::mesh_notes(self.body.mesh());
        let of_fit = self.body.fit().map(|(outcome, _)| report::notes_beside_summary(outcome));
        mesh.into_iter().chain(of_fit.into_iter().flatten()).collect()
    }

    /// The name of the fit.
    #[getter]
    fn name(&self) -> Option<&str> {
        Some(&self.body.fit()?.1.fit.name)
    }

    /// One word for the state of the fit.
    #[getter]
    fn status(&self) -> Option<&'static str> {
        Some(self.body.fit()?.1.status())
    }

    /// The number of constants below zero.
    #[getter]
    fn negative(&self) -> usize {
        self.body.network().negative()
    }

    /// What the fit cost and how far its matrices are from those of the finite elements; None of networks that were given. Without
    /// `measures`, errors that are not known yet are not computed.
    fn statistics<'py>(&self, py: Python<'py>, measures: bool) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some((_, fit)) = self.body.fit() else { return Ok(None) };
        if measures {
            self.body.evaluated(py, || self.measure())?;
        }
        let record = PyDict::new(py);
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
        Ok(Some(record))
    }

    /// The outcome of a sampled fit as JSON, and its data by columns; None of other fits.
    #[getter]
    fn sampled<'py>(&self, py: Python<'py>) -> PyResult<Option<Sampled<'py>>> {
        let Some(outcome) = self.body.fit().and_then(|(_, fit)| fit.kind.sampled()) else { return Ok(None) };
        let text = serde_json::to_string(outcome).map_err(|e| raised(py, Error::new(e.to_string())))?;
        Ok(Some((text, sampled::shapes(py, outcome)?, sampled::starts(py, outcome)?)))
    }

    fn __len__(&self) -> usize {
        self.body.network().len()
    }

    /// It never changes.
    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<PyAny>) -> Py<Self> {
        slf
    }
}
