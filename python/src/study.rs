//! `run`: whole scenes.

use crate::arrays::matrix;
use crate::error::raised;
use crate::progress;
use crate::value::{table, text};
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springfit::report;
use springfit::study::{Controls, Outcome, Scene, run_with};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The report as JSON, displacements by load and model, and the files that were written.
type Ran<'py> = (String, BTreeMap<String, BTreeMap<String, Bound<'py, PyArray2<f64>>>>, Vec<PathBuf>);

/// Runs a scene: a path, or a dictionary of its keys whose files are relative to `folder`. With `out` its outputs are written there.
#[pyfunction]
#[pyo3(signature = (scene, folder, out=None, progress=None))]
pub fn run<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyAny>,
    folder: PathBuf,
    out: Option<PathBuf>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Ran<'py>> {
    let scene = match scene.cast::<PyDict>() {
        Ok(keys) => {
            let text = text(&table(keys)?);
            // The name that a scene without a title gets.
            Scene::parse(&text, &folder.join("scene.toml"))
        }
        Err(_) => Scene::load(Path::new(&scene.extract::<PathBuf>()?)),
    };
    let scene = scene.map_err(|error| raised(py, error))?;
    let (outcome, written) = progress::run(py, progress, |told| {
        if let Some(out) = &out {
            report::check_scene_outputs(&scene, out, &[])?;
        }
        let outcome = run_with(&scene, &Controls::default(), told)?;
        let written = out.map(|out| report::write_outputs(&outcome, scene.output(), &out)).transpose()?;
        Ok((outcome, written.unwrap_or_default()))
    })?;
    Ok((report::report(&outcome), displacements(py, &outcome), written))
}

/// By load, of the finite elements (`""`) and of each fit that has an answer.
fn displacements<'py>(
    py: Python<'py>,
    outcome: &Outcome,
) -> BTreeMap<String, BTreeMap<String, Bound<'py, PyArray2<f64>>>> {
    let d = outcome.mesh.dimension;
    let of_load = |(place, load): (usize, &springfit::study::BodyLoad)| {
        let mut models = BTreeMap::from([(String::new(), matrix(py, load.fem.clone(), d))]);
        for fit in &outcome.fits {
            let answer = fit.loads.get(place).and_then(|load| load.displacement.clone());
            models.extend(answer.map(|u| (fit.fit.name.clone(), matrix(py, u, d))));
        }
        (load.name.clone(), models)
    };
    outcome.loads.iter().enumerate().map(of_load).collect()
}
