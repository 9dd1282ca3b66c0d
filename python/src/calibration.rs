//! `calibrate`: moduli of a body from measurements.

use crate::error::{invalid, raised, unwritten};
use crate::mesh::Mesh;
use crate::progress;
use crate::study::{dictionary_path, keyless, settings_of, text_of};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springfit_foundation::error::Error;
use springfit_mesh::mesh::Scattered;
use springfit_studies::study::{self, Controls, Readings, Scene, Seen};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The places and displacements that were measured under a load, each of shape `[places, dimension]`, and the deviation of their noise.
type Given<'py> = (PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, f64>, Option<f64>);
/// A group, the components of the force that holds it, and the deviation of their noise.
type Force<'py> = (String, PyReadonlyArray1<'py, f64>, Option<f64>);

/// Calibrates the body of a scene; `mesh` is in place of that of the scene, and the measurements of loads in place of what their keys say. NaN
/// was not measured.
#[pyfunction]
#[pyo3(signature = (scene, folder, settings, mesh, displacements, forces, progress=None))]
#[expect(clippy::too_many_arguments, reason = "they are those of the Python function")]
pub fn calibrate(
    py: Python,
    scene: &Bound<PyAny>,
    folder: PathBuf,
    settings: &Bound<PyDict>,
    mesh: Option<PyRef<Mesh>>,
    displacements: BTreeMap<String, Given>,
    forces: BTreeMap<String, Vec<Force>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let (text, path) = text_of(py, scene, &folder)?;
    let own = dictionary_path(scene, &path);
    let scene = Scene::parse_with(&text, &path, &settings_of(py, settings)?);
    let scene = scene.map_err(|error| raised(py, unwritten(keyless(error), own.as_deref())))?;
    let mut readings = Readings::new();
    let known = |value: &f64| (!value.is_nan()).then_some(*value);
    for (load, (places, moved, sigma)) in &displacements {
        if places.shape() != moved.shape() {
            let expected = format!("displacements of shape {:?}, that of the places", places.shape());
            return Err(invalid(py, "measured", &expected, format!("{:?}", moved.shape())));
        }
        let finite = |values: &PyReadonlyArray2<f64>| values.as_array().iter().all(|x| !x.is_infinite());
        if !finite(places) || !finite(moved) || places.as_array().iter().any(|x| x.is_nan()) {
            return Err(invalid(
                py,
                "measured",
                "finite numbers, or NaN for a displacement that was not measured",
                "another",
            ));
        }
        let places = places.as_array().iter().copied().collect();
        let displacements = moved.as_array().iter().map(known).collect();
        let seen: &mut Seen = readings.entry(load.clone()).or_default();
        seen.displacements = Scattered { places, displacements };
        seen.sigma = *sigma;
    }
    for (load, forces) in &forces {
        for (group, force, sigma) in forces {
            let force = force.as_array().iter().map(known).collect();
            let reaction = study::Reaction { group: group.clone(), force, sigma: *sigma };
            readings.entry(load.clone()).or_default().reactions.push(reaction);
        }
    }
    let mesh = mesh.map(|mesh| springfit_mesh::mesh::Mesh::clone(&mesh.mesh));
    progress::run(py, progress, move |told| {
        let found = study::calibrate_with(&scene, mesh, &readings, &Controls::default(), told);
        let found = found.map_err(|error| unwritten(error, own.as_deref()))?;
        serde_json::to_string(&found).map_err(|e| Error::new(e.to_string()))
    })
}
