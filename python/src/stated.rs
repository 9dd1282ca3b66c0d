//! Materials and scenes as Python states them, with the meshes and arrays that they have in memory.

use crate::error::raised;
use crate::mesh::Mesh;
use crate::value::value_of;
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use springfit_element::material::MaterialMap;
use springfit_foundation::error::{Error, Result};
use springfit_studies::study::{CellValues, InMemory, Materials};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

/// What has a name in place of that of a file: a mesh, or the numbers of its cells, `[cells, components]`.
#[derive(FromPyObject)]
pub enum Held<'py> {
    Mesh(PyRef<'py, Mesh>),
    Values(Option<PyRef<'py, Mesh>>, PyReadonlyArray2<'py, f64>),
}

/// What is in memory, by name.
pub type HeldByName<'py> = BTreeMap<String, Held<'py>>;

pub fn in_memory(held: &HeldByName) -> InMemory {
    let mut memory = InMemory::default();
    for (name, held) in held {
        match held {
            Held::Mesh(mesh) => memory.add_mesh(name, mesh.mesh.clone()),
            Held::Values(mesh, values) => {
                let components = values.shape()[1];
                let mesh = mesh.as_ref().map(|mesh| mesh.mesh.clone());
                let values =
                    values.as_slice().map_or_else(|_| values.as_array().iter().copied().collect(), <[f64]>::to_vec);
                memory.add_values(name, CellValues { mesh, components, values });
            }
        }
    }
    memory
}

/// What a body is made of.
pub struct Stated {
    materials: Materials,
    memory: InMemory,
    /// The names of its regions, in the order of the materials; none of one material for all.
    regions: Vec<Option<String>>,
}

impl Stated {
    /// Reads a `Material`, or a dictionary of them by group.
    ///
    /// # Errors
    /// It is another object, or its values are wrong.
    pub fn given(material: &Bound<PyAny>) -> PyResult<Stated> {
        let (stated, held) = Stated::without_arrays(material)?;
        Ok(Stated { memory: in_memory(&held), ..stated })
    }

    /// As [`Stated::given`], with the arrays as Python has them.
    fn without_arrays<'py>(material: &Bound<'py, PyAny>) -> PyResult<(Stated, HeldByName<'py>)> {
        let py = material.py();
        let stated = py.import("springfit.material")?.call_method1("stated", (material,))?;
        let (table, held): (Bound<PyAny>, HeldByName) = stated.extract()?;
        let regions: Vec<Option<String>> = match table.cast::<pyo3::types::PyList>() {
            Ok(entries) => {
                entries.iter().map(|entry| entry.call_method1("get", ("group",))?.extract()).collect::<PyResult<_>>()?
            }
            Err(_) => Vec::new(),
        };
        let materials = parsed(&table, &regions)?;
        Ok((Stated { materials, memory: InMemory::default(), regions }, held))
    }

    /// The mesh with the membranes and rods of regions, and the materials of its cells.
    ///
    /// # Errors
    /// Those of [`Materials::on`].
    pub fn on<'a>(
        &self,
        mesh: &'a springfit_mesh::mesh::Mesh,
    ) -> Result<(Cow<'a, springfit_mesh::mesh::Mesh>, MaterialMap)> {
        let attached = self.materials.attached(mesh)?;
        let map = self.materials.on(&attached, Path::new(""), &self.memory);
        let map = map.map_err(|error| placed(error, &self.regions))?;
        Ok((attached, map))
    }

    /// Young's modulus, if all cells have one.
    pub fn young(&self) -> f64 {
        self.materials.number("young").unwrap_or(0.0)
    }

    /// What is assumed of the body.
    pub fn assumption(&self, mesh: &springfit_mesh::mesh::Mesh) -> Option<String> {
        self.materials.assumption(mesh)
    }
}

/// Reads the entry, or the entries of regions with these names, as a scene has them.
///
/// # Errors
/// A value is wrong.
fn parsed(stated: &Bound<PyAny>, regions: &[Option<String>]) -> PyResult<Materials> {
    let table = toml::Table::from_iter([("material".into(), value_of(stated, "material")?)]);
    Materials::parse(table).map_err(|error| raised(stated.py(), placed(error, regions)))
}

/// The error with the key as Python has it: `young`, or `material["core"].young`.
fn placed(error: Error, regions: &[Option<String>]) -> Error {
    let Some(key) = error.key().map(String::from) else { return error };
    if key == "material" && !regions.is_empty() && error.problem().contains("in none") {
        return error.followed_by("; in a dictionary of materials the key None stands for the rest");
    }
    if let Some(own) = key.strip_prefix("material.") {
        return error.at_key(own);
    }
    let entry = key.strip_prefix("material[").and_then(|rest| rest.split_once(']'));
    let region = |(index, rest): (&str, &str)| {
        let name = match regions.get(index.parse::<usize>().ok()?)? {
            Some(name) => format!("{name:?}"),
            None => "None".into(),
        };
        Some(format!("material[{name}]{rest}"))
    };
    match entry.and_then(region) {
        Some(own) => error.at_key(own),
        None => error,
    }
}

/// Checks what a material states that does not depend on a mesh; the numbers of these keys in SI units, None where they differ from cell to
/// cell.
///
/// # Errors
/// A value is wrong.
#[pyfunction]
pub fn checked_material(material: &Bound<PyAny>, keys: Vec<String>) -> PyResult<Vec<Option<f64>>> {
    let (stated, _) = Stated::without_arrays(material)?;
    Ok(keys.iter().map(|key| stated.materials.number(key)).collect())
}

/// Young's modulus in Pa and Poisson's ratio of the isotropic material with two constants, which have the keys of a scene.
///
/// # Errors
/// A constant is not a number, or no material has both.
#[pyfunction]
pub fn young_and_poisson(constants: &Bound<PyAny>) -> PyResult<(f64, f64)> {
    let materials = parsed(constants, &[])?;
    let number = |key: &str| {
        let expected = || Error::expected(key, "a number, or a text with a unit", "an expression or a file");
        materials.number(key).ok_or_else(|| raised(constants.py(), expected()))
    };
    Ok((number("young")?, number("poisson")?))
}
