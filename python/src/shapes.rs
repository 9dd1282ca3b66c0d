//! Networks at many shapes.

use crate::body::Body;
use crate::error::invalid;
use numpy::{PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use rayon::prelude::*;
use springfit_bodies::model::Elastic;
use springfit_foundation::error::Result;

/// From so many evaluations on it pays to sort the springs for them.
const MANY: usize = 200;

/// Evaluates each of several shapes, `[shapes, points, dimension]`, of which there are so many; the one at rest if there are none.
pub fn each<T: Send>(
    py: Python,
    body: &Body,
    x: Option<PyReadonlyArray3<f64>>,
    evaluate: impl Fn(&dyn Elastic, &[f64]) -> Result<T> + Sync,
) -> PyResult<(Option<usize>, Vec<T>)> {
    let Some(x) = x else {
        let own = body.evaluated(py, || evaluate(body.network(), body.points()))?;
        return Ok((None, vec![own]));
    };
    let [points, d] = body.shape();
    if x.shape()[1..] != [points, d] {
        let found = format!("{:?}", &x.shape()[1..]);
        return Err(invalid(py, "x", &format!("an array of shape ({points}, {d}), or many of this shape"), found));
    }
    let (count, size) = (x.shape()[0], points * d);
    let all: Vec<f64> = x.as_array().iter().copied().collect();
    if let Some(place) = all.iter().position(|value| !value.is_finite()) {
        let (shape, point) = (place / size, place % size / d);
        let key = if count == 1 { format!("x[{point}]") } else { format!("x[{shape}, {point}]") };
        return Err(invalid(py, &key, "finite numbers", all[place]));
    }
    let found = body.evaluated(py, || {
        let network = body.network();
        let one_by_one = || all.chunks(size.max(1)).map(|x| evaluate(network, x)).collect();
        let shapes = all.par_chunks(size.max(1));
        match count {
            // Functions end the call of this thread.
            _ if body.has_functions => one_by_one(),
            MANY.. => {
                let prepared = network.prepared();
                shapes.map(|x| evaluate(&prepared, x)).collect::<Result<Vec<T>>>()
            }
            2.. => shapes.map(|x| evaluate(network, x)).collect(),
            _ => one_by_one(),
        }
    })?;
    Ok((Some(count), found))
}
