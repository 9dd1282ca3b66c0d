//! `run`: whole scenes.

use crate::arrays::matrix;
use crate::error::{invalid, raised};
use crate::progress::{self, apart};
use crate::value::{table, text};
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springfit::error::{Error, Result};
use springfit::report;
use springfit::study::{Controls, Outcome, Scene, Setting, run_with};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The report as JSON, displacements by load and model, and the files that were written.
type Ran<'py> = (String, BTreeMap<String, BTreeMap<String, Bound<'py, PyArray2<f64>>>>, Vec<PathBuf>);

/// Runs a scene: a path, or a dictionary of its keys whose files are relative to `folder`; `settings` are values of keys in place of
/// those of the scene. With `out` its outputs are written there.
#[pyfunction]
#[pyo3(signature = (scene, folder, settings, out=None, progress=None))]
pub fn run<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyAny>,
    folder: PathBuf,
    settings: &Bound<'py, PyDict>,
    out: Option<PathBuf>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Ran<'py>> {
    let (text, path) = text_of(py, scene, &folder)?;
    let scene = Scene::parse_with(&text, &path, &settings_of(py, settings)?);
    let scene = scene.map_err(|error| raised(py, keyless(error)))?;
    let open = |out: PathBuf| apart(py, || report::open_scene_outputs(&scene, &out));
    let edition = out.map(open).transpose().map_err(|error| raised(py, error))?;
    let (scene, outcome) = progress::run(py, progress, move |told| {
        let outcome = run_with(&scene, &Controls::default(), told)?;
        Ok((scene, outcome))
    })?;
    let write = |edition| apart(py, || report::write_outputs(&outcome, scene.output(), edition));
    let written = edition.map(write).transpose().map_err(|error| raised(py, error))?;
    Ok((report::report(&outcome), displacements(py, &outcome), written.unwrap_or_default()))
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
    let of_load = |(place, load): (usize, &springfit::study::BodyLoad)| {
        let body = load.is_reached().then(|| (String::new(), matrix(py, load.fem.clone(), d)));
        let mut models = BTreeMap::from_iter(body);
        for fit in &outcome.fits {
            let answer = fit.loads.get(place).and_then(|load| load.displacement.clone());
            models.extend(answer.map(|u| (fit.fit.name.clone(), matrix(py, u, d))));
        }
        (load.name.clone(), models)
    };
    outcome.loads.iter().enumerate().map(of_load).collect()
}
