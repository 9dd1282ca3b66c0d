//! Spring constants of cells as functions of node positions and moduli, with their derivatives.

use crate::arguments::{number, optional, text};
use crate::arrays::{matrix, places, rows};
use crate::element::Element;
use crate::entry::fit_entry;
use crate::error::{invalid, raised};
use crate::progress::{alone, apart};
use numpy::{PyArray2, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};
use springfit::error::{Error, ErrorKind, Result};
use springfit::fit::{GradientFit, constants_gradient};
use springfit::material::{Material, Moduli, Plane};
use springfit::springs::Springs;
use springfit::study::Recipe;
use std::path::Path;
use std::sync::Arc;

/// Fewer cells than these take some milliseconds.
const FEW: usize = 1000;

/// The constants of the cells of one element by one fit.
#[pyclass(frozen, module = "springfit._core")]
pub struct CellConstants {
    rule: Arc<CellRule>,
    given: Arguments,
}

/// The element, the keys and the plane state of which constants are made.
type Arguments = (Py<Element>, Py<PyDict>, Option<String>);

/// How the constants follow from a cell.
struct CellRule {
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
    fn new(
        py: Python,
        element: Py<Element>,
        keys: &Bound<PyDict>,
        plane: Option<&Bound<PyAny>>,
    ) -> PyResult<CellConstants> {
        let entry = fit_entry(py, keys)?;
        let plane = optional("plane", plane, text)?;
        let given = (element.clone_ref(py), keys.copy()?.unbind(), plane.clone());
        let element = element.get().0.clone();
        let found = apart(py, || {
            entry.check()?;
            let named = entry.fits(Path::new(""))?.remove(0);
            let springs = match &named.recipe {
                Recipe::Exact(recipe) => recipe.resolve(None)?.springs(&element),
                Recipe::Stiffness(_) | Recipe::Sampled(_) | Recipe::Whole(_) | Recipe::Published(_) => {
                    Springs::select(&element, named.springs.as_deref())?
                }
            };
            let plane = match plane.as_deref() {
                None => None,
                Some("stress") => Some(Plane::Stress),
                Some("strain") => Some(Plane::Strain),
                Some(other) => {
                    return Err(Error::expected("plane", "\"stress\" or \"strain\"", format!("\"{other}\"")));
                }
            };
            let rule = CellRule { element, springs, recipe: named.recipe, plane };
            rule.gradient_fit()?;
            Ok(rule)
        });
        let rule = Arc::new(found.map_err(|error| raised(py, error))?);
        Ok(CellConstants { rule, given })
    }

    fn __reduce__<'py>(slf: Bound<'py, Self>) -> (Bound<'py, PyType>, Arguments) {
        let (py, (element, keys, plane)) = (slf.py(), &slf.get().given);
        (slf.get_type(), (element.clone_ref(py), keys.clone_ref(py), plane.clone()))
    }

    /// It never changes.
    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<PyAny>) -> Py<Self> {
        slf
    }

    /// The nodes of each spring between two, `[pairs, 2]`; the springs on contents follow them.
    #[getter]
    fn pairs<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<i64>> {
        matrix(py, self.rule.springs.pairs().iter().flat_map(|pair| pair.map(|a| a as i64)).collect(), 2)
    }

    /// The number of springs of a cell.
    #[getter]
    fn springs(&self) -> usize {
        self.rule.springs.len()
    }

    /// The constants, `[cells, springs]`.
    fn values<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<f64>,
        cells: PyReadonlyArray2<i64>,
        young: &Bound<PyAny>,
        poisson: &Bound<PyAny>,
        thickness: &Bound<PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rule = self.rule.clone();
        let (points, cells) = rule.arrays(py, &points, &cells)?;
        let constants = constants(young, poisson, thickness)?;
        let found = cellwise(py, cells.len() / self.rule.element.nodes(), move || {
            let method = rule.recipe.kind().cell_method().ok_or_else(not_of_cells)?;
            method.fit_cells(&rule.element, &rule.springs, &points, &cells, rule.material(constants)?)
        })?;
        Ok(matrix(py, found.constants, self.rule.springs.len()))
    }

    /// The gradient of `Σ w k` with respect to points, Young's modulus, Poisson's ratio and thickness; `weights` are `[cells, springs]`.
    #[expect(clippy::too_many_arguments, reason = "those of `values`, and the weights")]
    fn gradient<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<f64>,
        cells: PyReadonlyArray2<i64>,
        young: &Bound<PyAny>,
        poisson: &Bound<PyAny>,
        thickness: &Bound<PyAny>,
        weights: PyReadonlyArray2<f64>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, f64, f64, f64)> {
        let rule = self.rule.clone();
        let expected = [cells.shape()[0], rule.springs.len()];
        if weights.shape() != expected {
            let found = format!("{:?}", weights.shape());
            return Err(invalid(py, "weights", &format!("an array of shape {expected:?}"), found));
        }
        let (points, cells) = rule.arrays(py, &points, &cells)?;
        let weights = rows(&weights);
        let [young, poisson, thickness] = constants(young, poisson, thickness)?;
        let (gradient, material) = cellwise(py, expected[0], move || {
            let material = rule.material([young, poisson, thickness])?;
            let (moduli, fit) = (material.moduli(), rule.gradient_fit()?);
            let gradient = constants_gradient(&rule.element, &rule.springs, &points, &cells, moduli, &fit, &weights)?;
            Ok((gradient, material))
        })?;
        let along = |moduli: Moduli| gradient.moduli[0] * moduli.lambda + gradient.moduli[1] * moduli.mu;
        let (young_slope, poisson_slope) = (material.moduli_by_young(), material.moduli_by_poisson());
        // λ and μ of a plane body grow in proportion to E and to the thickness; no other body has one.
        let d = self.rule.element.dimension();
        let by_thickness = if d == 2 { along(material.moduli()) / thickness } else { 0.0 };
        Ok((matrix(py, gradient.points, d), along(young_slope), along(poisson_slope), by_thickness))
    }
}

/// Works on so many cells. A few are done on the thread of the call, because another takes longer to start than they do.
fn cellwise<T: Send + 'static>(
    py: Python,
    cells: usize,
    work: impl FnOnce() -> Result<T> + Send + 'static,
) -> PyResult<T> {
    if cells < FEW { apart(py, work).map_err(|error| raised(py, error)) } else { alone(py, work) }
}

/// Young's modulus, Poisson's ratio and the thickness.
fn constants(young: &Bound<PyAny>, poisson: &Bound<PyAny>, thickness: &Bound<PyAny>) -> PyResult<[f64; 3]> {
    Ok([number("young", young)?, number("poisson", poisson)?, number("thickness", thickness)?])
}

impl CellRule {
    fn gradient_fit(&self) -> Result<GradientFit> {
        match &self.recipe {
            Recipe::Stiffness(fit) => Ok(GradientFit::Closed(*fit)),
            Recipe::Exact(recipe) if recipe.positive.is_none() => Ok(GradientFit::Exact(recipe.resolve(None)?)),
            Recipe::Exact(_) | Recipe::Sampled(_) | Recipe::Whole(_) | Recipe::Published(_) => Err(not_of_cells()),
        }
    }

    fn material(&self, [young, poisson, thickness]: [f64; 3]) -> Result<Material> {
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
