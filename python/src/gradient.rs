//! Spring constants of cells as functions of node positions and moduli, with their derivatives.

use crate::arguments::{optional, text};
use crate::arrays::{list, matrix, places, rows};
use crate::element::Element;
use crate::entry::fit_entry;
use crate::error::{invalid, raised};
use crate::progress::{alone, apart};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};
use springfit_element::material::{BlockValues, Hooke, Material, Moduli, Plane};
use springfit_element::springs::{Force, Measure, Springs};
use springfit_fit::fit::{CellFits, CellFunction, CellNumbers, GradientFit, Inputs, fit_cells, fit_exact};
use springfit_foundation::error::{Error, ErrorKind, Result};
use springfit_studies::study::Recipe;
use std::path::Path;
use std::sync::Arc;

/// Fewer cells than these take some milliseconds.
const FEW: usize = 1000;

/// Two lists of numbers.
type Lists<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// The constants of the cells of one element by one fit.
#[pyclass(frozen, module = "springfit._core")]
pub struct CellConstants {
    pub rule: Arc<CellRule>,
    given: Arguments,
}

/// The element, the keys and the plane state of which constants are made.
type Arguments = (Py<Element>, Py<PyDict>, Option<String>);

/// A list of numbers of NumPy.
type Numbers<'py> = PyReadonlyArray1<'py, f64>;
/// Numbers of the springs of each cell, and of the rest contents of those on contents.
type OfSprings<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);
/// Numbers of the points, and of λ and μ of each cell.
type OfInputs<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);
/// The inputs of [`OfInputs`], given.
type GivenInputs<'py> = (PyReadonlyArray2<'py, f64>, Numbers<'py>, Numbers<'py>);

/// How the constants follow from a cell.
pub struct CellRule {
    pub element: Arc<springfit_element::element::Element>,
    pub springs: Springs,
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
            let plane = plane.as_deref().map(Plane::named).transpose()?;
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

    /// Whether springs between two points have no rest length, as those of exact networks.
    #[getter]
    fn is_restless(&self) -> bool {
        matches!(self.rule.recipe, Recipe::Exact(_))
    }

    /// λ and μ of each of the given materials, which are checked; in the plane times the thickness.
    fn moduli<'py>(
        &self,
        py: Python<'py>,
        young: Numbers,
        poisson: Numbers,
        thickness: Numbers,
    ) -> PyResult<Lists<'py>> {
        let materials = self.rule.materials(&young, &poisson, &thickness).map_err(|error| raised(py, error))?;
        let moduli: Vec<Moduli> = materials.iter().map(Material::moduli).collect();
        let of = |number: fn(&Moduli) -> f64| list(py, moduli.iter().map(number).collect());
        Ok((of(|m| m.lambda), of(|m| m.mu)))
    }

    /// The constants and the rest contents, with one material or one for each cell.
    fn values<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<f64>,
        cells: PyReadonlyArray2<i64>,
        young: Numbers,
        poisson: Numbers,
        thickness: Numbers,
    ) -> PyResult<OfSprings<'py>> {
        let rule = self.rule.clone();
        let (points, cells) = rule.arrays(py, &points, &cells)?;
        let materials = rule.materials(&young, &poisson, &thickness).map_err(|error| raised(py, error))?;
        let [m, r] = rule.counts();
        let (constants, rests) = cellwise(py, cells.len() / rule.element.nodes(), move || {
            let found = rule.fit(&points, &cells, &materials)?;
            let rests = rule.rests(&points, &cells, &found);
            Ok((found.constants, rests))
        })?;
        Ok((matrix(py, constants, m), matrix(py, rests, r)))
    }

    /// The derivatives of constants and rest contents along one change of the inputs; of two changes the second ones.
    #[expect(clippy::too_many_arguments, reason = "the inputs, and what is asked of them")]
    fn along<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<f64>,
        cells: PyReadonlyArray2<i64>,
        lambda: Numbers,
        mu: Numbers,
        first: GivenInputs,
        second: Option<GivenInputs>,
    ) -> PyResult<OfSprings<'py>> {
        let rule = self.rule.clone();
        let (points, cells) = rule.arrays(py, &points, &cells)?;
        let moduli = moduli(&lambda, &mu);
        let changes: Vec<Inputs> = [Some(first), second].into_iter().flatten().map(inputs).collect();
        let [m, r] = rule.counts();
        let found = cellwise(py, cells.len() / rule.element.nodes(), move || {
            rule.function(&points, &cells, &moduli)?.along(&changes.iter().collect::<Vec<_>>())
        })?;
        Ok((matrix(py, found.constants, m), matrix(py, found.rests, r)))
    }

    /// The gradient of `Σ w k + Σ v c₀` in points, λ and μ of each cell; with a change of these its derivative along the change.
    #[expect(clippy::too_many_arguments, reason = "the inputs, and what is asked of them")]
    fn gradient<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<f64>,
        cells: PyReadonlyArray2<i64>,
        lambda: Numbers,
        mu: Numbers,
        weights: (PyReadonlyArray2<f64>, PyReadonlyArray2<f64>),
        change: Option<GivenInputs>,
    ) -> PyResult<OfInputs<'py>> {
        let rule = self.rule.clone();
        let (points, cells) = rule.arrays(py, &points, &cells)?;
        let (moduli, change) = (moduli(&lambda, &mu), change.map(inputs));
        let weights = CellNumbers { constants: rows(&weights.0), rests: rows(&weights.1) };
        let d = self.rule.element.dimension();
        let found = cellwise(py, cells.len() / self.rule.element.nodes(), move || {
            rule.function(&points, &cells, &moduli)?.gradient(&weights, change.as_ref())
        })?;
        let of = |i: usize| list(py, found.moduli.iter().skip(i).step_by(2).copied().collect());
        let (lambda, mu) = (of(0), of(1));
        Ok((matrix(py, found.points, d), lambda, mu))
    }
}

/// Works on so many cells. A few are done on the thread of the call, because another takes longer to start than they do.
pub fn cellwise<T: Send + 'static>(
    py: Python,
    cells: usize,
    work: impl FnOnce() -> Result<T> + Send + 'static,
) -> PyResult<T> {
    if cells < FEW { apart(py, work).map_err(|error| raised(py, error)) } else { alone(py, work) }
}

fn moduli(lambda: &Numbers, mu: &Numbers) -> Vec<Moduli> {
    lambda.as_array().iter().zip(mu.as_array()).map(|(&lambda, &mu)| Moduli { lambda, mu }).collect()
}

fn inputs((points, lambda, mu): GivenInputs) -> Inputs {
    let moduli = lambda.as_array().iter().zip(mu.as_array()).flat_map(|(&lambda, &mu)| [lambda, mu]).collect();
    Inputs { points: rows(&points), moduli }
}

/// One value of all cells, or those of each.
fn each<T: Clone>(values: &[T]) -> BlockValues<'_, T> {
    BlockValues::listed(values, values.len() == 1)
}

impl CellRule {
    fn gradient_fit(&self) -> Result<GradientFit> {
        match &self.recipe {
            Recipe::Stiffness(fit) => Ok(GradientFit::Closed(*fit)),
            Recipe::Exact(recipe) if recipe.positive.is_none() => Ok(GradientFit::Exact(recipe.resolve(None)?)),
            Recipe::Exact(_) | Recipe::Sampled(_) | Recipe::Whole(_) | Recipe::Published(_) => Err(not_of_cells()),
        }
    }

    fn function<'a>(&'a self, points: &'a [f64], cells: &'a [usize], moduli: &'a [Moduli]) -> Result<CellFunction<'a>> {
        CellFunction::new(&self.element, &self.springs, points, cells, each(moduli), self.gradient_fit()?)
    }

    /// The number of springs of a cell, and that of those on other measures than lengths.
    pub fn counts(&self) -> [usize; 2] {
        [self.springs.len(), self.springs.len() - self.springs.pairs().len()]
    }

    fn materials(&self, young: &Numbers, poisson: &Numbers, thickness: &Numbers) -> Result<Vec<Material>> {
        let (d, count) = (self.element.dimension(), young.len());
        let each = young.as_array().into_iter().zip(poisson.as_array()).zip(thickness.as_array()).enumerate();
        each.map(|(cell, ((&young, &poisson), &thickness))| {
            let thickness = (d == 2).then_some(thickness);
            let found = Material::for_body(d, young, poisson, self.plane, thickness);
            found.map_err(|error| match error.key().map(String::from) {
                Some(key) if count > 1 => error.at_key(format!("{key}[{cell}]")),
                _ => error,
            })
        })
        .collect()
    }

    fn fit(&self, points: &[f64], cells: &[usize], materials: &[Material]) -> Result<CellFits> {
        let method = self.recipe.kind().cell_method().ok_or_else(not_of_cells)?;
        match (&self.recipe, materials) {
            (Recipe::Exact(recipe), _) => {
                let fit = recipe.resolve(None)?;
                let found = fit_exact(&self.element, points, cells, each(materials), &fit, &mut |_| {})?;
                let has_law = matches!(found.force, Force::Exact { content: Some(_) });
                if has_law || found.springs.len() != self.springs.len() {
                    let expected = "an energy whose springs are linear ones on lengths and contents: \"stable-neo-hookean\" without \"large\"";
                    let other = format!("\"{}\"", fit.energy.name());
                    return Err(Error::expected("energy", expected, other).of_kind(ErrorKind::Unsupported));
                }
                Ok(found)
            }
            (Recipe::Stiffness(fit), _) => {
                let hooke: Vec<Hooke> = materials.iter().map(|material| material.moduli().into()).collect();
                fit_cells(&self.element, &self.springs, points, cells, each(&hooke), fit, &mut |_| {})
            }
            (Recipe::Sampled(_) | Recipe::Whole(_) | Recipe::Published(_), [material]) => {
                method.fit_cells(&self.element, &self.springs, points, cells, *material)
            }
            (Recipe::Sampled(_) | Recipe::Whole(_) | Recipe::Published(_), _) => Err(not_of_cells()),
        }
    }

    /// The measures at rest of the springs on other measures than lengths, `[cells × their number]`.
    fn rests(&self, points: &[f64], cells: &[usize], found: &CellFits) -> Vec<f64> {
        let ([m, r], first) = (self.counts(), self.springs.pairs().len());
        if let Force::Exact { content: None } = found.force {
            // The fit writes k c₀.
            let constants = found.constants.chunks_exact(m.max(1)).flat_map(|all| &all[first..]);
            return found.parameters.iter().zip(constants).map(|(pull, k)| pull / k).collect();
        }
        let measures: Vec<(Vec<usize>, Measure)> = self.measures();
        let space = self.element.space();
        let mut x = Vec::new();
        let mut rests = Vec::with_capacity(cells.len() / self.element.nodes() * r);
        for nodes in cells.chunks_exact(self.element.nodes()) {
            for (own, measure) in &measures {
                x.clear();
                x.extend(own.iter().flat_map(|&a| &points[nodes[a] * space..(nodes[a] + 1) * space]));
                rests.push(measure.value(&x, space));
            }
        }
        rests
    }

    /// The nodes and the measure of each spring on another measure than a length.
    pub fn measures(&self) -> Vec<(Vec<usize>, Measure)> {
        let mut functions = self.springs.functions().iter();
        let of = |(nodes, measure): (Vec<usize>, Measure)| match measure {
            Measure::Function(_) => {
                let own = functions.next().map(|f| f.in_space.as_ref().unwrap_or(&f.function).clone());
                (nodes, own.map_or(measure, Measure::Function))
            }
            _ => (nodes, measure),
        };
        self.springs.measures(&self.element).into_iter().skip(self.springs.pairs().len()).map(of).collect()
    }

    fn arrays(
        &self,
        py: Python,
        points: &PyReadonlyArray2<f64>,
        cells: &PyReadonlyArray2<i64>,
    ) -> PyResult<(Vec<f64>, Vec<usize>)> {
        for (key, name, width, found) in [
            ("points", "points", self.element.space(), points.shape()[1]),
            ("cells", "cells", self.element.nodes(), cells.shape()[1]),
        ] {
            if found != width {
                return Err(invalid(py, key, &format!("an array of shape ({name}, {width})"), found));
            }
        }
        Ok((rows(points), places(py, "cells", cells.as_array())?))
    }
}

fn not_of_cells() -> Error {
    let expected = "\"exact\", \"frobenius\", \"offdiag\" or \"modal\" without bounds";
    Error::expected("objective", expected, "another").of_kind(ErrorKind::Unsupported)
}
