//! `Factorized`: the stiffness of a network at rest under a support, factorised once for many loads.

use crate::body::Body;
use crate::error::{invalid, raised};
use crate::progress::alone;
use numpy::ndarray::Array3;
use numpy::{IntoPyArray, PyArray1, PyArray3, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use rayon::prelude::*;
use springfit_bodies::model::{CompressedRows, Deformation, Support};
use springfit_bodies::solve::{Factor, System};
use springfit_foundation::error::{Error, Result};
use springfit_foundation::number::first_not_finite;
use springfit_report::report::beyond_linear;
use std::sync::Arc;

/// The share of the forces that a solution may leave; a network that leaves more has a motion without stiffness.
const LEFT: f64 = 1e-3;
/// A solution that leaves a larger share of the forces is refined.
const REFINED: f64 = 1e-13;

/// The stiffness of a network at rest, with what solves its equations. Copies share it.
#[pyclass(frozen, module = "springfit._core")]
#[derive(Clone)]
pub struct Factorized {
    /// The springs.
    pub body: Body,
    /// The stiffness, `[points · dimension]` rows, N/m.
    pub stiffness: Arc<CompressedRows>,
    /// What is held, at rest.
    pub support: Arc<Support>,
    /// The equations of what is free.
    pub system: Arc<System>,
    /// The factor of these.
    pub factor: Arc<Factor>,
}

/// Displacements, `[loads, points, dimension]`, what each leaves of its forces, and what is beyond the linear theory.
type Solutions<'py> = (Bound<'py, PyArray3<f64>>, Bound<'py, PyArray1<f64>>, Option<String>);

impl Factorized {
    /// # Errors
    /// The support leaves a motion without stiffness, or the factor does not fit into memory.
    pub fn new(py: Python, body: &Body, support: Support) -> PyResult<Factorized> {
        if !body.is_held(&support) {
            return Err(invalid(py, "fix", "supports that hold every connected part", "one that can move as it is"));
        }
        body.worked(py, move |body| {
            let entries = body.network().stiffness(body.points());
            if entries.iter().any(|entry| !entry.val.is_finite()) {
                return Err(loose("a spring without a stiffness at rest"));
            }
            let system = System::new(&entries, &support)?.placed(body.points(), body.dimension());
            // The factor takes most of the memory, and needs the entries no more.
            drop(entries);
            let factor = system.factorize()?.ok_or_else(|| loose("a motion without stiffness"))?;
            let stiffness = Arc::new(body.stiffness(None)?);
            let (system, support) = (Arc::new(system), Arc::new(support));
            Ok(Factorized { body: body.clone(), stiffness, support, system, factor: Arc::new(factor) })
        })
    }

    /// The displacements under forces, `[points · dimension]`, N, where what is held is displaced as `prescribed`, m; and the share of the
    /// forces that each solution leaves.
    ///
    /// # Errors
    /// Forces act on a motion that has no stiffness.
    pub fn displacements(&self, forces: &[Vec<f64>], prescribed: &[Vec<f64>]) -> Result<Vec<(Vec<f64>, f64)>> {
        let rest = |(f, held): (&Vec<f64>, &Vec<f64>)| -> Vec<f64> {
            // Most loads displace nothing, and need no product with the stiffness.
            if held.iter().all(|u| *u == 0.0) {
                return f.clone();
            }
            f.iter().zip(self.stiffness.apply(held)).map(|(f, g)| f - g).collect()
        };
        let rest: Vec<Vec<f64>> = forces.par_iter().zip(prescribed).map(rest).collect();
        let found = match &rest[..] {
            [one] => vec![self.system.solve(&self.factor, one)],
            all => self.system.solve_each(&self.factor, all, REFINED),
        };
        let whole = |((mut u, left), held): ((Vec<f64>, f64), &Vec<f64>)| {
            if left.is_nan() || left > LEFT {
                return Err(loose("a motion without stiffness, on which forces act"));
            }
            u.iter_mut().zip(held).for_each(|(u, held)| *u += held);
            Ok((u, left))
        };
        found.into_iter().zip(prescribed).map(whole).collect()
    }
}

#[pymethods]
impl Factorized {
    /// Small displacements under each of the loads, `[loads, points, dimension]`; `prescribed` is zero where nothing is held.
    fn solve<'py>(
        &self,
        py: Python<'py>,
        forces: PyReadonlyArray3<f64>,
        prescribed: PyReadonlyArray3<f64>,
    ) -> PyResult<Solutions<'py>> {
        let [points, d] = self.body.shape();
        let count = forces.shape()[0];
        let forces = loads(py, "forces", &forces, [count, points, d])?;
        let prescribed = loads(py, "displacement", &prescribed, [count, points, d])?;
        let own = self.clone();
        let (found, beyond) = alone(py, move || {
            let found = own.displacements(&forces, &prescribed)?;
            let of = |(u, _): &(Vec<f64>, f64)| own.body.deformation(u);
            // The largest of all does not depend on the order in which threads compare.
            let largest = found.par_iter().map(of).reduce(Deformation::default, Deformation::max);
            Ok((found, beyond_linear(largest)))
        })?;
        let (all, left): (Vec<Vec<f64>>, Vec<f64>) = found.into_iter().unzip();
        let array = Array3::from_shape_vec((count, points, d), all.concat());
        let array = array.expect("each load has a vector for each point").into_pyarray(py);
        Ok((array, left.into_pyarray(py), beyond))
    }

    /// Whether the stiffness is positive definite.
    #[getter]
    fn is_stable(&self) -> bool {
        self.factor.is_positive_definite()
    }

    /// It never changes.
    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<PyAny>) -> Py<Self> {
        slf
    }
}

/// Vectors of each load.
pub fn loads(py: Python, key: &str, given: &PyReadonlyArray3<f64>, shape: [usize; 3]) -> PyResult<Vec<Vec<f64>>> {
    if given.shape() != shape {
        let [count, points, d] = shape;
        let expected = format!("an array of shape ({points}, {d}) or ({count}, {points}, {d})");
        return Err(invalid(py, key, &expected, format!("{:?}", given.shape())));
    }
    let of_load = |load: numpy::ndarray::ArrayView2<f64>| load.iter().copied().collect::<Vec<f64>>();
    let all: Vec<Vec<f64>> = given.as_array().outer_iter().map(of_load).collect();
    for values in &all {
        if let Some(place) = first_not_finite(values) {
            let key = format!("{key}[{}]", place / shape[2]);
            return Err(raised(py, Error::expected(key, "finite numbers", values[place])));
        }
    }
    Ok(all)
}

/// The error of supports that do not hold the network.
pub fn loose(found: &str) -> Error {
    Error::expected("fix", "supports that hold the network, and springs that resist every motion", found)
}
