//! `run`: whole scenes.

use crate::arrays::matrix;
use crate::element::Element;
use crate::error::{invalid, raised, unwritten};
use crate::mesh::Mesh;
use crate::network::Network;
use crate::progress::{self, apart};
use crate::stated::{Held, HeldByName, in_memory};
use crate::value::{table, text};
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springfit_foundation::error::{Error, Result};
use springfit_report::report;
use springfit_studies::study::{Controls, Outcome, Scene, Setting, run_with};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The report as JSON, displacements by load and model, the files that were written, and the body.
type Found<'py> = (String, BTreeMap<String, BTreeMap<String, Bound<'py, PyArray2<f64>>>>, Vec<PathBuf>, Ran);

/// What has been found, for the mesh and the networks of a report.
#[pyclass(frozen, module = "springfit._core")]
pub struct Ran {
    outcome: Arc<Outcome>,
    /// The elements of meshes in memory.
    elements: Vec<Element>,
    /// Files of elements that the scene names.
    files: Vec<PathBuf>,
}

#[pymethods]
impl Ran {
    /// The mesh, on whose points the displacements are.
    fn mesh(&self, py: Python) -> PyResult<Mesh> {
        let mesh = Arc::new(self.outcome.mesh.clone());
        let known = mesh.blocks.iter().map(|block| &block.element.name);
        let is_missing =
            |name: &String| !self.elements.iter().any(|own| own.0.name == *name) && Element::named(name).is_err();
        let mut own = self.elements.clone();
        if known.clone().any(is_missing) {
            let read =
                self.files.iter().map(|path| Element::named(&path.to_string_lossy())).collect::<Result<Vec<_>>>();
            own.extend(read.map_err(|error| raised(py, error))?);
        }
        Mesh::of_library(mesh, &own).map_err(|error| raised(py, error))
    }

    /// The names of the fits, in the order of the scene.
    #[getter]
    fn fits(&self) -> Vec<&str> {
        self.outcome.fits.iter().map(|fit| &*fit.fit.name).collect()
    }

    /// The network of a fit, by its place.
    fn network(&self, py: Python, fit: usize) -> PyResult<Network> {
        let Some(own) = self.outcome.fits.get(fit) else {
            return Err(invalid(py, "fit", &format!("a place below {}", self.outcome.fits.len()), fit));
        };
        // All that the files of the run have: masses, supports, loads and the motion.
        let outcome = Outcome { fits: vec![own.clone()], ..Outcome::clone(&self.outcome) };
        Ok(Network::new(outcome, Vec::new(), false))
    }
}

/// Runs a scene: a path, or a dictionary of its keys whose files are relative to `folder`; `settings` are values of keys in place of
/// those of the scene. With `out` its outputs are written there.
#[pyfunction]
#[pyo3(signature = (scene, folder, settings, held, out=None, progress=None))]
pub fn run<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyAny>,
    folder: PathBuf,
    settings: &Bound<'py, PyDict>,
    held: HeldByName<'py>,
    out: Option<PathBuf>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Found<'py>> {
    let (text, path) = text_of(py, scene, &folder)?;
    let unwritten_path = dictionary_path(scene, &path);
    let scene = Scene::parse_beside(&text, &path, &settings_of(py, settings)?, &in_memory(&held));
    let scene = scene.map_err(|error| raised(py, unwritten(keyless(error), unwritten_path.as_deref())))?;
    let open = |out: PathBuf| apart(py, || report::open_scene_outputs(&scene, &out));
    let edition = out.map(open).transpose().map_err(|error| raised(py, error))?;
    let (scene, outcome) = progress::run(py, progress, move |told| {
        let outcome = run_with(&scene, &Controls::default(), told);
        Ok((scene, outcome.map_err(|error| unwritten(error, unwritten_path.as_deref()))?))
    })?;
    let write = |edition| apart(py, || report::write_outputs(&outcome, scene.output(), edition));
    let written = edition.map(write).transpose().map_err(|error| raised(py, error))?;
    let (text, displacements) = (report::report(&outcome), displacements(py, &outcome));
    let of_meshes = |held: &Held| match held {
        Held::Mesh(mesh) => mesh.own_elements().to_vec(),
        Held::Values(..) => Vec::new(),
    };
    let input = scene.mesh();
    let named = input.elements.iter().chain(input.generated.iter().map(|entry| &entry.element));
    let named = named.chain(input.disc.iter().map(|entry| &entry.element));
    let named = named.chain(input.fill.iter().map(|entry| &entry.element)).filter(|name| name.ends_with(".toml"));
    let beside = scene.path().parent().unwrap_or(Path::new(""));
    let files = named.map(|name| beside.join(name)).collect();
    let ran = Ran { outcome: Arc::new(outcome), elements: held.values().flat_map(of_meshes).collect(), files };
    Ok((text, displacements, written.unwrap_or_default(), ran))
}

/// The path of a dictionary, which is no file.
pub fn dictionary_path(scene: &Bound<PyAny>, path: &Path) -> Option<PathBuf> {
    scene.cast::<PyDict>().is_ok().then(|| path.to_path_buf())
}

/// The text of a scene, and its path: of a file, or of a dictionary as if it were in `folder`.
pub fn text_of(py: Python, scene: &Bound<PyAny>, folder: &Path) -> PyResult<(String, PathBuf)> {
    match scene.cast::<PyDict>() {
        // The name is the title of a scene without one.
        Ok(keys) => Ok((text(&table(keys, "scene")?), folder.join("scene.toml"))),
        Err(_) => {
            let path: PathBuf = scene.extract()?;
            let read = std::fs::read_to_string(&path);
            Ok((read.map_err(|e| raised(py, Error::io("cannot be read", e).in_file(&path)))?, path))
        }
    }
}

/// The values of keys, by their paths.
pub fn settings_of(py: Python, values: &Bound<PyDict>) -> PyResult<Vec<Setting>> {
    // A scene leaves out what is None; a value that takes the place of another has to be one.
    if let Some((key, _)) = values.iter().find(|(_, value)| value.is_none()) {
        let key = key.extract::<String>().unwrap_or_else(|_| "set".into());
        return Err(invalid(py, &key, "a value in place of that of the scene", "None"));
    }
    let settings = table(values, "set")?.iter().map(|(key, value)| Setting::of(key, value)).collect::<Result<_>>();
    settings.map_err(|error| raised(py, error))
}

/// The error of a value that the command would have by an option.
pub fn keyless(error: Error) -> Error {
    match error.key().and_then(|key| key.strip_prefix("--set ")).map(String::from) {
        Some(key) => error.at_key(key),
        None => error,
    }
}

/// By load, of the finite elements (`""`) and of each fit, if they have an answer to the whole load.
fn displacements<'py>(
    py: Python<'py>,
    outcome: &Outcome,
) -> BTreeMap<String, BTreeMap<String, Bound<'py, PyArray2<f64>>>> {
    let d = outcome.mesh.dimension;
    let of_load = |(place, load): (usize, &springfit_studies::study::BodyLoad)| {
        let body = load.is_reached().then(|| (String::new(), matrix(py, load.fem.clone(), d)));
        let mut models = BTreeMap::from_iter(body);
        for fit in &outcome.fits {
            let answer = fit.loads.get(place).and_then(|load| load.displacement.as_deref().cloned());
            models.extend(answer.map(|u| (fit.fit.name.clone(), matrix(py, u, d))));
        }
        (load.name.clone(), models)
    };
    outcome.loads.iter().enumerate().map(of_load).collect()
}
