//! `fit` and the finite elements of the same body.

use crate::arguments::{self, number};
use crate::entry::fit_entry;
use crate::error::invalid;
use crate::functions::{Functions, Given};
use crate::mesh::Mesh;
use crate::network::Network;
use crate::progress::{self, alone};
use crate::sparse::{self, Rows};
use crate::stated::Stated;
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springfit_bodies::model::{
    self, BlockStiffness, CompressedRows, ConsistentMasses, Lumping, Support, lumped_masses,
};
use springfit_element::material::MaterialMap;
use springfit_foundation::error::{Error, Result};
use springfit_studies::study::{
    Controls, Event, FitEntry, NamedFit, Outcome, Reference, WholeBody, fit_without_errors, learning_curve as learn,
    point_masses,
};
use std::borrow::Cow;

/// The material of the mesh, and the fit of these keys for it, with functions in place of some of them.
fn posed<'a>(
    mesh: &'a springfit_mesh::mesh::Mesh,
    entry: &FitEntry,
    stated: &Stated,
    functions: Option<&Functions>,
) -> Result<(Cow<'a, springfit_mesh::mesh::Mesh>, MaterialMap, NamedFit)> {
    entry.check()?;
    let (mesh, map) = stated.on(mesh)?;
    let uniform = || {
        let expected = "one isotropic material of all cells, beside functions of Python";
        map.uniform().ok_or_else(|| Error::expected("material", expected, "one that differs from cell to cell"))
    };
    let own = functions.map(|functions| functions.of(uniform()?)).transpose()?.unwrap_or_default();
    let named = entry.fits_with(std::path::Path::new(""), &own)?.remove(0);
    Ok((mesh, map, named))
}

/// Fits the springs of every cell; `keys` are those of a `[[fit]]` of a scene, and `functions` stand for some of them.
#[pyfunction]
#[pyo3(signature = (mesh, material, keys, held=None, progress=None, functions=None))]
pub fn fit(
    py: Python,
    mesh: &Mesh,
    material: &Bound<PyAny>,
    keys: &Bound<PyDict>,
    held: Option<PyReadonlyArray2<bool>>,
    progress: Option<Py<PyAny>>,
    functions: Option<Given>,
) -> PyResult<Network> {
    let support = held.map(|held| support(py, mesh, &held)).transpose()?;
    let entry = fit_entry(py, keys)?;
    let stated = Stated::given(material)?;
    let functions = functions.map(|given| Functions::new(py, given, stated.young())).transpose()?;
    let ends = functions.as_ref().map(|functions| functions.ends.clone());
    let mesh = mesh.mesh.clone();
    let work = move |told: &mut dyn FnMut(Event)| {
        let (body, map, named) = posed(&mesh, &entry, &stated, functions.as_ref())?;
        let controls = Controls::default();
        let masses = map.density().map(|density| point_masses(&body, density, &map)).transpose()?;
        let whole = match (named.recipe.whole(), &support) {
            (Some(_), Some(support)) => {
                let mut whole = WholeBody::new(&body, &map, support, &controls);
                whole.masses = masses.as_ref().map(|masses| &masses.values[..]);
                Some(whole)
            }
            (Some(_), None) => return Err(Error::expected("fix", "what is held, for whole-object fits", "nothing")),
            (None, _) => None,
        };
        // Points that are held in all directions belong to no patch.
        let d = body.dimension;
        let is_held = |point: usize| support.as_ref().is_some_and(|own| (0..d).all(|k| own.is_fixed(point * d + k)));
        let held: Vec<bool> = (0..body.point_count()).map(is_held).collect();
        let reference = Reference { whole: whole.as_ref(), held: &held, ..Reference::default() };
        let (fit, cells) = fit_without_errors(&body, &map, &reference, &named, told)?;
        let assumed = stated.assumption(&body);
        let outcome = Outcome::of_fit(String::new(), body.into_owned(), map, masses, fit);
        Ok((Outcome { assumed, ..outcome }, cells))
    };
    let (outcome, cells) = match &ends {
        Some(ends) => progress::run_functions(py, progress, ends, work)?,
        None => progress::run(py, progress, work)?,
    };
    Ok(Network::new(outcome, cells, ends.is_some()))
}

/// The errors of a sampled fit to the first shapes of a sequence, as a list in JSON; the other arguments are those of [`fit`].
#[pyfunction]
#[pyo3(signature = (mesh, material, keys, counts, seeds, progress=None, functions=None))]
#[allow(clippy::too_many_arguments)]
pub fn learning_curve(
    py: Python,
    mesh: &Mesh,
    material: &Bound<PyAny>,
    keys: &Bound<PyDict>,
    counts: &Bound<PyAny>,
    seeds: &Bound<PyAny>,
    progress: Option<Py<PyAny>>,
    functions: Option<Given>,
) -> PyResult<String> {
    let (entry, stated) = (fit_entry(py, keys)?, Stated::given(material)?);
    let counts = arguments::counts("counts", counts)?;
    let seeds: Vec<u64> = arguments::counts("seeds", seeds)?.into_iter().map(|seed| seed as u64).collect();
    let functions = functions.map(|given| Functions::new(py, given, stated.young())).transpose()?;
    let ends = functions.as_ref().map(|functions| functions.ends.clone());
    let mesh = mesh.mesh.clone();
    let work = move |told: &mut dyn FnMut(Event)| {
        let (body, map, named) = posed(&mesh, &entry, &stated, functions.as_ref())?;
        let points = learn(&body, &map, &Reference::default(), &named, &counts, &seeds, told)?;
        serde_json::to_string(&points).map_err(|e| Error::new(e.to_string()))
    };
    match &ends {
        Some(ends) => progress::run_functions(py, progress, ends, work),
        None => progress::run(py, progress, work),
    }
}

/// What is held at rest, `[points, dimension]`.
pub fn support(py: Python, mesh: &Mesh, held: &PyReadonlyArray2<bool>) -> PyResult<Support> {
    let shape = [mesh.mesh.point_count(), mesh.mesh.dimension];
    if held.shape() != shape {
        return Err(invalid(py, "fix", &format!("an array of shape {shape:?}"), format!("{:?}", held.shape())));
    }
    Ok(Support { prescribed: held.as_array().iter().map(|held| held.then_some(0.0)).collect() })
}

/// The stiffness of the finite elements, row by row.
#[pyfunction]
pub fn finite_elements<'py>(py: Python<'py>, mesh: &Mesh, material: &Bound<PyAny>) -> PyResult<Rows<'py>> {
    let (stated, mesh) = (Stated::given(material)?, mesh.mesh.clone());
    let found = alone(py, move || {
        let (body, map) = stated.on(&mesh)?;
        match BlockStiffness::is_of(&body) {
            true => Ok(BlockStiffness::of_body(&body, map.moduli(), 2, 0)?.rows()),
            false => Ok(CompressedRows::of_lower(body.points.len(), &model::finite_elements(&body, map.moduli()))),
        }
    })?;
    Ok(sparse::rows(py, found))
}

/// The mass matrix `(1 − s) M_c + s diag(m)` of the shape functions and of the share s of lumped masses, row by row.
#[pyfunction]
pub fn masses<'py>(py: Python<'py>, mesh: &Mesh, material: &Bound<PyAny>, share: &Bound<PyAny>) -> PyResult<Rows<'py>> {
    let (stated, share) = (Stated::given(material)?, number("share", share)?);
    let (mesh, d) = (mesh.mesh.clone(), mesh.mesh.dimension);
    let found = alone(py, move || {
        let (body, map) = stated.on(&mesh)?;
        let density = map.density().ok_or_else(|| Error::expected("density", "kg/m³", "none"))?;
        let thickness = map.thicknesses();
        let lumped = lumped_masses(&body, density, thickness.clone(), Lumping::Hrz);
        let matrix = ConsistentMasses::of_mesh(&body, density, thickness)?.blended(&lumped, share)?;
        let entries: Vec<(usize, usize, f64)> = matrix.entries().collect();
        Ok(sparse::along_axes(&CompressedRows::of(body.point_count(), entries.iter().copied()), d))
    })?;
    Ok(sparse::rows(py, found))
}
