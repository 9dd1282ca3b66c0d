//! `fit` and the finite elements of the same body.

use crate::arrays::list;
use crate::error::{invalid, raised};
use crate::functions::{Functions, Given};
use crate::mesh::Mesh;
use crate::network::{Network, Triplets};
use crate::progress::{self, apart};
use crate::value::table;
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springfit::error::{Error, Result};
use springfit::material::{Material, MaterialMap, Plane};
use springfit::model::{self, ConsistentMasses, Lumping, Support, lumped_masses};
use springfit::study::{BodyConstants, Controls, Event, FitEntry, Reference, WholeBody, fit_mesh, point_masses};

/// Young's modulus (Pa), Poisson's ratio, the state of a plane body, its thickness (m) or the cross-section of rods (m²).
#[derive(FromPyObject)]
pub struct Constants {
    young: f64,
    poisson: f64,
    plane: Option<String>,
    thickness: Option<f64>,
    area: Option<f64>,
    density: Option<f64>,
}

impl Constants {
    fn of(&self, mesh: &Mesh) -> Result<Material> {
        let &Constants { young, poisson, thickness, area, .. } = self;
        let plane = self.plane.as_deref().map(|name| match name {
            "stress" => Ok(Plane::Stress),
            "strain" => Ok(Plane::Strain),
            other => Err(Error::expected("plane", "\"stress\" or \"strain\"", format!("\"{other}\""))),
        });
        BodyConstants { young, poisson, plane: plane.transpose()?, thickness, area }.material(&mesh.0)
    }
}

/// Fits the springs of every cell; `keys` are those of a `[[fit]]` of a scene, and `functions` stand for some of them.
#[pyfunction]
#[pyo3(signature = (mesh, material, keys, held=None, progress=None, functions=None))]
pub fn fit(
    py: Python,
    mesh: &Mesh,
    material: Constants,
    keys: &Bound<PyDict>,
    held: Option<PyReadonlyArray2<bool>>,
    progress: Option<Py<PyAny>>,
    functions: Option<Given>,
) -> PyResult<Network> {
    let support = held.map(|held| support(py, mesh, &held)).transpose()?;
    let entry: FitEntry = table(keys)?
        .try_into()
        .map_err(|error: toml::de::Error| raised(py, Error::new(error.message().to_string())))?;
    let (density, constants) = (material.density, material);
    let functions = functions.map(|given| Functions::new(py, given, constants.young)).transpose()?;
    let work = |told: &mut dyn FnMut(Event)| {
        entry.check()?;
        let material = constants.of(mesh)?;
        let own = functions.as_ref().map(|functions| functions.of(material)).transpose()?.unwrap_or_default();
        let named = entry.fits_with(std::path::Path::new(""), &own)?.remove(0);
        let controls = Controls::default();
        let map = MaterialMap::from(material);
        let whole = match (named.recipe.whole(), &support) {
            (Some(_), Some(support)) => Some(WholeBody::new(&mesh.0, &map, support, &controls)),
            (Some(_), None) => return Err(Error::expected("fix", "what is held, for whole-object fits", "nothing")),
            (None, _) => None,
        };
        let reference = Reference { whole: whole.as_ref(), ..Reference::default() };
        let fit = fit_mesh(&mesh.0, material, &reference, &named, told)?;
        let masses = density.map(|density| point_masses(&mesh.0, density, material)).transpose()?;
        Ok((material, masses, fit))
    };
    let ends = functions.as_ref().map(|functions| functions.ends.clone());
    let (material, masses, fit) = match &ends {
        Some(ends) => progress::run_functions(py, progress, ends, work)?,
        None => progress::run(py, progress, work)?,
    };
    Ok(Network::new(mesh.0.clone(), material, masses, fit, ends))
}

/// What is held at rest, `[points, dimension]`.
pub fn support(py: Python, mesh: &Mesh, held: &PyReadonlyArray2<bool>) -> PyResult<Support> {
    let shape = [mesh.0.point_count(), mesh.0.dimension];
    if held.shape() != shape {
        return Err(invalid(py, "fix", &format!("an array of shape {shape:?}"), format!("{:?}", held.shape())));
    }
    Ok(Support { prescribed: held.as_array().iter().map(|held| held.then_some(0.0)).collect() })
}

/// The stiffness of the finite elements, in triplets of both triangles.
#[pyfunction]
pub fn finite_elements<'py>(py: Python<'py>, mesh: &Mesh, material: Constants) -> PyResult<Triplets<'py>> {
    let entries = apart(py, || Ok(model::finite_elements(&mesh.0, material.of(mesh)?.moduli())));
    let entries = entries.map_err(|error| raised(py, error))?;
    Ok(crate::network::triplets(py, &entries, list))
}

/// The mass matrix `(1 − s) M_c + s diag(m)` of the shape functions and of the share s of lumped masses, in triplets that are to be added.
#[pyfunction]
pub fn masses<'py>(py: Python<'py>, mesh: &Mesh, material: Constants, share: f64) -> PyResult<Triplets<'py>> {
    let matrix = apart(py, || {
        let density = material.density.ok_or_else(|| Error::expected("density", "kg/m³", "none"))?;
        let density = springfit::range::positive("density", density, "kg/m³")?;
        let thickness = MaterialMap::from(material.of(mesh)?).thicknesses();
        let lumped = lumped_masses(&mesh.0, density, thickness.clone(), Lumping::Hrz);
        ConsistentMasses::of_mesh(&mesh.0, density, thickness)?.blended(&lumped, share)
    });
    let matrix = matrix.map_err(|error| raised(py, error))?;
    let d = mesh.0.dimension;
    let dofs = |p: usize| (0..d).map(move |k| (p * d + k) as i64);
    let rows = matrix.entries().flat_map(|(a, ..)| dofs(a)).collect();
    let columns = matrix.entries().flat_map(|(_, b, _)| dofs(b)).collect();
    let values = matrix.entries().flat_map(|(.., value)| std::iter::repeat_n(value, d)).collect();
    Ok((list(py, rows), list(py, columns), list(py, values)))
}
