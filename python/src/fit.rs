//! `fit` and the finite elements of the same body.

use crate::arguments::{self, found, number, text};
use crate::entry::fit_entry;
use crate::error::invalid;
use crate::functions::{Functions, Given};
use crate::mesh::Mesh;
use crate::network::Network;
use crate::progress::{self, alone};
use crate::sparse::{self, Rows};
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springfit::error::{Error, Result};
use springfit::material::{CellMap, Material, MaterialMap, Plane};
use springfit::model::{self, BlockStiffness, CompressedRows, ConsistentMasses, Lumping, Support, lumped_masses};
use springfit::study::{
    BodyConstants, Controls, Event, FitEntry, NamedFit, Outcome, Reference, WholeBody, assumed, fit_without_errors,
    learning_curve as learn, point_masses,
};

/// Young's modulus (Pa), Poisson's ratio, the state of a plane body, its thickness (m) or the cross-section of rods (m²), and the density.
pub struct Constants {
    young: f64,
    poisson: f64,
    plane: Option<String>,
    thickness: Option<f64>,
    area: Option<f64>,
    density: Option<f64>,
}

impl Constants {
    /// Those of a `Material`.
    fn given(material: &Bound<PyAny>) -> PyResult<Constants> {
        let attribute = |key: &str| {
            let missing = |_| invalid(material.py(), "material", "a Material", found(material));
            material.getattr(key).map_err(missing)
        };
        let required = |key: &str| number(key, &attribute(key)?);
        let optional = |key: &str| {
            let given = attribute(key)?;
            if given.is_none() { Ok(None) } else { number(key, &given).map(Some) }
        };
        let plane = attribute("plane")?;
        Ok(Constants {
            young: required("young")?,
            poisson: required("poisson")?,
            plane: if plane.is_none() { None } else { Some(text("plane", &plane)?) },
            thickness: optional("thickness")?,
            area: optional("area")?,
            density: optional("density")?,
        })
    }

    fn of(&self, mesh: &springfit::mesh::Mesh) -> Result<Material> {
        let &Constants { young, poisson, thickness, area, .. } = self;
        let plane = self.plane.as_deref().map(|name| match name {
            "stress" => Ok(Plane::Stress),
            "strain" => Ok(Plane::Strain),
            other => Err(Error::expected("plane", "\"stress\" or \"strain\"", format!("\"{other}\""))),
        });
        BodyConstants { young, poisson, plane: plane.transpose()?, thickness, area }.material(mesh)
    }
}

/// The material of the mesh, and the fit of these keys for it, with functions in place of some of them.
fn posed(
    mesh: &springfit::mesh::Mesh,
    entry: &FitEntry,
    constants: &Constants,
    functions: Option<&Functions>,
) -> Result<(Material, NamedFit)> {
    entry.check()?;
    let material = constants.of(mesh)?;
    let own = functions.map(|functions| functions.of(material)).transpose()?.unwrap_or_default();
    Ok((material, entry.fits_with(std::path::Path::new(""), &own)?.remove(0)))
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
    let constants = Constants::given(material)?;
    let functions = functions.map(|given| Functions::new(py, given, constants.young)).transpose()?;
    let ends = functions.as_ref().map(|functions| functions.ends.clone());
    let mesh = mesh.mesh.clone();
    let work = move |told: &mut dyn FnMut(Event)| {
        let (material, named) = posed(&mesh, &entry, &constants, functions.as_ref())?;
        let controls = Controls::default();
        let map = MaterialMap::from(material);
        let whole = match (named.recipe.whole(), &support) {
            (Some(_), Some(support)) => Some(WholeBody::new(&mesh, &map, support, &controls)),
            (Some(_), None) => return Err(Error::expected("fix", "what is held, for whole-object fits", "nothing")),
            (None, _) => None,
        };
        let reference = Reference { whole: whole.as_ref(), ..Reference::default() };
        let (fit, cells) = fit_without_errors(&mesh, &map, &reference, &named, told)?;
        let masses = constants.density.map(|density| point_masses(&mesh, density, material)).transpose()?;
        let assumed = assumed(&mesh, constants.thickness, constants.area);
        let material = MaterialMap::from(material).with_density(constants.density.map(CellMap::Uniform));
        let outcome = Outcome::of_fit(String::new(), springfit::mesh::Mesh::clone(&mesh), material, masses, fit);
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
    let (entry, constants) = (fit_entry(py, keys)?, Constants::given(material)?);
    let counts = arguments::counts("counts", counts)?;
    let seeds: Vec<u64> = arguments::counts("seeds", seeds)?.into_iter().map(|seed| seed as u64).collect();
    let functions = functions.map(|given| Functions::new(py, given, constants.young)).transpose()?;
    let ends = functions.as_ref().map(|functions| functions.ends.clone());
    let mesh = mesh.mesh.clone();
    let work = move |told: &mut dyn FnMut(Event)| {
        let (material, named) = posed(&mesh, &entry, &constants, functions.as_ref())?;
        let map = MaterialMap::from(material);
        let points = learn(&mesh, &map, &Reference::default(), &named, &counts, &seeds, told)?;
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
    let (constants, mesh) = (Constants::given(material)?, mesh.mesh.clone());
    let found = alone(py, move || {
        let moduli = constants.of(&mesh)?.moduli();
        match BlockStiffness::is_of(&mesh) {
            true => Ok(BlockStiffness::of_body(&mesh, moduli, 2, 0)?.rows()),
            false => Ok(CompressedRows::of_lower(mesh.points.len(), &model::finite_elements(&mesh, moduli))),
        }
    })?;
    Ok(sparse::rows(py, found))
}

/// The mass matrix `(1 − s) M_c + s diag(m)` of the shape functions and of the share s of lumped masses, row by row.
#[pyfunction]
pub fn masses<'py>(py: Python<'py>, mesh: &Mesh, material: &Bound<PyAny>, share: &Bound<PyAny>) -> PyResult<Rows<'py>> {
    let (constants, share) = (Constants::given(material)?, number("share", share)?);
    let (mesh, d) = (mesh.mesh.clone(), mesh.mesh.dimension);
    let found = alone(py, move || {
        let density = constants.density.ok_or_else(|| Error::expected("density", "kg/m³", "none"))?;
        let density = springfit::range::positive("density", density, "kg/m³")?;
        let thickness = MaterialMap::from(constants.of(&mesh)?).thicknesses();
        let lumped = lumped_masses(&mesh, density, thickness.clone(), Lumping::Hrz);
        let matrix = ConsistentMasses::of_mesh(&mesh, density, thickness)?.blended(&lumped, share)?;
        let entries: Vec<(usize, usize, f64)> = matrix.entries().collect();
        Ok(sparse::along_axes(&CompressedRows::of(mesh.point_count(), entries.iter().copied()), d))
    })?;
    Ok(sparse::rows(py, found))
}
