//! The plane or line of the cells of surfaces and curves.

use super::sample::Sample;
use nalgebra::{DMatrix, DVector};

/// Orthonormal directions of the plane or line that fits the points of a sample best, `[space × d]`, and the root mean
/// square distance of the points from it, relative to their extent.
pub(super) fn frame(sample: &Sample, d: usize) -> (DMatrix<f64>, f64) {
    let space = sample.mesh.dimension;
    if d == space {
        return (DMatrix::identity(d, d), 0.0);
    }
    let x = DMatrix::from_column_slice(space, sample.points.len(), &sample.mesh.points);
    let mean = x.column_mean();
    let centred = DMatrix::from_fn(space, x.ncols(), |k, p| x[(k, p)] - mean[k]);
    let svd = centred.svd(true, false);
    let directions = svd.u.expect("it was asked for");
    let mut order: Vec<usize> = (0..svd.singular_values.len()).collect();
    order.sort_by(|&a, &b| svd.singular_values[b].total_cmp(&svd.singular_values[a]));
    let columns: Vec<DVector<f64>> = order[..d].iter().map(|&k| directions.column(k).into_owned()).collect();
    let height = order.get(d).map_or(0.0, |&k| svd.singular_values[k] / svd.singular_values[order[0]]);
    (DMatrix::from_columns(&columns), height)
}
