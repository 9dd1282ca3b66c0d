//! Spring constants of cells as functions of node positions and moduli, with their derivatives.

use crate::arrays::{matrix, places, rows};
use crate::element::Element;
use crate::error::{invalid, raised};
use crate::progress::apart;
use crate::value::table;
use numpy::{PyArray2, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springfit::error::{Error, ErrorKind, Result};
use springfit::fit::{GradientFit, constants_gradient};
use springfit::material::{Material, Moduli, Plane};
use springfit::springs::Springs;
use springfit::study::{FitEntry, Recipe};
use std::path::Path;
use std::sync::Arc;

/// The constants of the cells of one element by one fit.
#[pyclass(frozen, module = "springfit._core")]
pub struct CellConstants {
    element: Arc<springfit::element::Element>,
    springs: Springs,
    recipe: Recipe,
    plane: Option<Plane>,
}

#[pymethods]
impl CellConstants {
    /// `keys` are those of a `[[fit]]` of a scene.
    #[new]
    #[pyo3(signature = (element, keys, plane=None))]
    fn new(py: Python, element: PyRef<Element>, keys: &Bound<PyDict>, plane: Option<&str>) -> PyResult<CellConstants> {
        let entry: FitEntry = table(keys)?
            .try_into()
            .map_err(|error: toml::de::Error| raised(py, Error::new(error.message().to_string())))?;
        let element = element.0.clone();
        let found = apart(py, || {
            entry.check()?;
            let named = entry.fits(Path::new(""))?.remove(0);
            let springs = match &named.recipe {
                Recipe::Exact(recipe) => recipe.resolve(None)?.springs(&element),
                Recipe::Stiffness(_) | Recipe::Sampled(_) | Recipe::Whole(_) | Recipe::Published(_) => {
                    Springs::select(&element, named.springs.as_deref())?
                }
            };
            let plane = match plane {
                None => None,
                Some("stress") => Some(Plane::Stress),
                Some("strain") => Some(Plane::Strain),
                Some(other) => {
                    return Err(Error::expected("plane", "\"stress\" or \"strain\"", format!("\"{other}\"")));
                }
            };
            let constants = CellConstants { element, springs, recipe: named.recipe, plane };
            constants.rule()?;
            Ok(constants)
        });
        found.map_err(|error| raised(py, error))
    }

    /// The nodes of each spring between two, `[pairs, 2]`; the springs on contents follow them.
    #[getter]
    fn pairs<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<i64>> {
        matrix(py, self.springs.pairs().iter().flat_map(|pair| pair.map(|a| a as i64)).collect(), 2)
    }

    /// The number of springs of a cell.
    #[getter]
    fn springs(&self) -> usize {
        self.springs.len()
    }

    /// The constants, `[cells, springs]`.
    fn values<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<f64>,
        cells: PyReadonlyArray2<i64>,
        young: f64,
        poisson: f64,
        thickness: f64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (points, cells) = self.arrays(py, &points, &cells)?;
        let found = apart(py, || {
            let material = self.material(young, poisson, thickness)?;
            let method = self.recipe.kind().cell_method().ok_or_else(not_of_cells)?;
            method.fit_cells(&self.element, &self.springs, &points, &cells, material)
        });
        let found = found.map_err(|error| raised(py, error))?;
        Ok(matrix(py, found.constants, self.springs.len()))
    }

    /// The gradient of `Σ w k` with respect to points, Young's modulus, Poisson's ratio and thickness; `weights` are `[cells, springs]`.
    #[expect(clippy::too_many_arguments, reason = "those of `values`, and the weights")]
    fn gradient<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<f64>,
        cells: PyReadonlyArray2<i64>,
        young: f64,
        poisson: f64,
        thickness: f64,
        weights: PyReadonlyArray2<f64>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, f64, f64, f64)> {
        let expected = [cells.shape()[0], self.springs.len()];
        if weights.shape() != expected {
            let found = format!("{:?}", weights.shape());
            return Err(invalid(py, "weights", &format!("an array of shape {expected:?}"), found));
        }
        let (points, cells) = self.arrays(py, &points, &cells)?;
        let weights = rows(&weights);
        let found = apart(py, || {
            let material = self.material(young, poisson, thickness)?;
            let (moduli, rule) = (material.moduli(), self.rule()?);
            let gradient = constants_gradient(&self.element, &self.springs, &points, &cells, moduli, &rule, &weights)?;
            Ok((gradient, material))
        });
        let (gradient, material) = found.map_err(|error| raised(py, error))?;
        let along = |moduli: Moduli| gradient.moduli[0] * moduli.lambda + gradient.moduli[1] * moduli.mu;
        let (young_slope, poisson_slope) = (material.moduli_by_young(), material.moduli_by_poisson());
        // λ and μ grow in proportion to E and to the thickness.
        let by_thickness = along(material.moduli()) / thickness;
        Ok((
            matrix(py, gradient.points, self.element.dimension()),
            along(young_slope),
            along(poisson_slope),
            by_thickness,
        ))
    }
}

impl CellConstants {
    fn rule(&self) -> Result<GradientFit> {
        match &self.recipe {
            Recipe::Stiffness(fit) => Ok(GradientFit::Closed(*fit)),
            Recipe::Exact(recipe) if recipe.positive.is_none() => Ok(GradientFit::Exact(recipe.resolve(None)?)),
            Recipe::Exact(_) | Recipe::Sampled(_) | Recipe::Whole(_) | Recipe::Published(_) => Err(not_of_cells()),
        }
    }

    fn material(&self, young: f64, poisson: f64, thickness: f64) -> Result<Material> {
        let thickness = (self.element.dimension() == 2).then_some(thickness);
        Material::for_body(self.element.dimension(), young, poisson, self.plane, thickness)
    }

    fn arrays(
        &self,
        py: Python,
        points: &PyReadonlyArray2<f64>,
        cells: &PyReadonlyArray2<i64>,
    ) -> PyResult<(Vec<f64>, Vec<usize>)> {
        for (key, name, width, found) in [
            ("points", "points", self.element.dimension(), points.shape()[1]),
            ("cells", "cells", self.element.nodes(), cells.shape()[1]),
        ] {
            if found != width {
                return Err(invalid(py, key, &format!("an array of shape ({name}, {width})"), found));
            }
        }
        Ok((rows(points), places(py, "cells", cells.as_array().iter())?))
    }
}

fn not_of_cells() -> Error {
    let expected = "\"exact\", \"frobenius\", \"offdiag\" or \"modal\" without bounds";
    Error::expected("objective", expected, "another").of_kind(ErrorKind::Unsupported)
}
