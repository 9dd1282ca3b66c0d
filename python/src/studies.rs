//! Studies that compare objectives, refine meshes and try extreme cases; each returns the document that the command prints as JSON.

use crate::arguments::{count, number, optional, text};
use crate::element::Element;
use crate::error::{raised, unwritten};
use crate::progress;
use crate::stated::{HeldByName, in_memory};
use crate::study::{dictionary_path, keyless, settings_of, text_of};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springfit_element::material::{Material, Plane};
use springfit_foundation::error::{Error, Result};
use springfit_report::report::{Report, comparison_values};
use springfit_studies::study::{self, Comparing, Event, Scene};
use std::path::PathBuf;

/// The path or the keys of a scene, the folder of its files, its keys with other values, and what it has in memory.
type Given<'py> = (Bound<'py, PyAny>, PathBuf, Bound<'py, PyDict>, HeldByName<'py>);

/// The scene, and the path that it has as a dictionary.
fn scene(py: Python, (scene, folder, settings, held): &Given) -> PyResult<(Scene, Option<PathBuf>)> {
    let (text, path) = text_of(py, scene, folder)?;
    let own = dictionary_path(scene, &path);
    let scene = Scene::parse_beside(&text, &path, &settings_of(py, settings)?, &in_memory(held));
    Ok((scene.map_err(|error| raised(py, unwritten(keyless(error), own.as_deref())))?, own))
}

fn written(document: serde_json::Result<String>) -> Result<String> {
    document.map_err(|e| Error::new(e.to_string()))
}

/// The plane state and the element of a study of one element.
fn material(element: &Element, poisson: f64, plane: Option<&str>) -> Result<Material> {
    let plane = plane.map(Plane::named).transpose()?;
    Material::for_body(element.0.dimension(), 10e3, poisson, plane, None)
}

/// Objectives and solvers on a scene.
#[pyfunction]
#[pyo3(signature = (given, progress=None))]
pub fn compare_scene(py: Python, given: Given, progress: Option<Py<PyAny>>) -> PyResult<String> {
    let (scene, own) = scene(py, &given)?;
    progress::run(py, progress, move |told| {
        let outcome = study::compare_scene(&scene, told).map_err(|error| unwritten(error, own.as_deref()))?;
        written(serde_json::to_string(&Report::of(&outcome)))
    })
}

/// Objectives and solvers on random shapes of an element.
#[pyfunction]
#[pyo3(signature = (element, poisson, plane, shapes, iterations, progress=None))]
pub fn compare_element(
    py: Python,
    element: PyRef<Element>,
    poisson: &Bound<PyAny>,
    plane: Option<&Bound<PyAny>>,
    shapes: &Bound<PyAny>,
    iterations: &Bound<PyAny>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let (poisson, plane) = (number("poisson", poisson)?, optional("plane", plane, text)?);
    let (shapes, iterations) = (count("shapes", shapes)?, count("iterations", iterations)? as u64);
    if iterations == 0 {
        return Err(crate::error::invalid(py, "iterations", "a number above 0", 0));
    }
    let material = material(&element, poisson, plane.as_deref()).map_err(|error| raised(py, error))?;
    let element = element.0.clone();
    progress::run(py, progress, move |told| {
        written(serde_json::to_string(&study::compare_element(&element, material, shapes, iterations, told)?))
    })
}

/// All values of a comparison, as columns in JSON.
#[pyfunction]
#[pyo3(signature = (comparison, folder, progress=None))]
pub fn compare_cases(
    py: Python,
    comparison: &Bound<PyAny>,
    folder: PathBuf,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let (text, path) = text_of(py, comparison, &folder)?;
    let own = dictionary_path(comparison, &path);
    let comparing = Comparing::parse(&text, &path);
    let comparing = comparing.map_err(|error| raised(py, unwritten(keyless(error), own.as_deref())))?;
    progress::run(py, progress, move |told: &mut dyn FnMut(Event)| {
        let records: Vec<_> = comparing.cases().iter().map(|case| comparing.record(case, told)).collect();
        match records.iter().find_map(|record| record.error.clone()) {
            Some(error) => Err(Error::new(error)),
            None => written(serde_json::to_string(&comparison_values(&records))),
        }
    })
}

/// Whether a text is that of a comparison.
#[pyfunction]
pub fn is_comparison(text: &str) -> bool {
    study::is_comparison(text)
}

/// The errors of a scene on finer and finer meshes; `truth` is a scene whose finite elements are the reference.
#[pyfunction]
#[pyo3(signature = (given, levels=None, truth=None, progress=None))]
pub fn converge(
    py: Python,
    given: Given,
    levels: Option<&Bound<PyAny>>,
    truth: Option<Given>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let levels = optional("levels", levels, count)?;
    let (own, path) = scene(py, &given)?;
    let truth = truth.map(|truth| scene(py, &truth)).transpose()?.map(|(truth, _)| truth);
    progress::run(py, progress, move |told: &mut dyn FnMut(Event)| {
        let found = match &truth {
            None => study::converge(&own, levels, told),
            Some(truth) => study::converge_to(&own, truth, levels, told),
        };
        written(serde_json::to_string(&found.map_err(|error| unwritten(error, path.as_deref()))?))
    })
}

/// Extreme cases of all shipped elements or of one.
#[pyfunction]
#[pyo3(signature = (element=None, progress=None))]
pub fn stability(py: Python, element: Option<PyRef<Element>>, progress: Option<Py<PyAny>>) -> PyResult<String> {
    let element = element.map(|element| springfit_element::element::Element::clone(&element.0));
    progress::run(py, progress, move |told| written(serde_json::to_string(&study::stability(element, told)?)))
}

/// A scene in other units and of other materials.
#[pyfunction]
#[pyo3(signature = (given, progress=None))]
pub fn stability_of_scene(py: Python, given: Given, progress: Option<Py<PyAny>>) -> PyResult<String> {
    let (scene, own) = scene(py, &given)?;
    progress::run(py, progress, move |told| {
        let found = study::stability_of_scene(&scene, told).map_err(|error| unwritten(error, own.as_deref()))?;
        written(serde_json::to_string(&found))
    })
}
