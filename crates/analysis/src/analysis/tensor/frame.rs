//! The planes and lines of samples of surfaces and curves, and axes in them that all samples share.

use super::sample::Sample;
use nalgebra::{DMatrix, DVector};
use springfit_numerics::dense::singular;

/// The projection of a coordinate axis onto a plane has no direction to rely on if it is shorter than this.
// A plane that tilts by δ turns a projection of length s by up to `δ/s`. Some axis is always longer: a direction in a
// plane that is orthogonal to the first axis has `1/√2` along one of the others, and a line has `1/√3` along one of
// three.
const SHORT: f64 = 0.1;

/// The plane or line that fits the points of a sample best.
pub(super) struct Plane {
    /// Orthonormal directions in it, `[space × d]`.
    directions: DMatrix<f64>,
    /// The root mean square distance of the points from it, relative to their extent.
    pub(super) height: f64,
    /// The least cosine of the angle between it and a cell. Where sheets or curves meet it may be zero although the height is small.
    pub(super) along: f64,
}

impl Plane {
    /// Fits a plane or a line to a sample whose cells have dimension `d`.
    pub(super) fn of(sample: &Sample, d: usize) -> Plane {
        let space = sample.mesh.dimension;
        if d == space {
            return Plane { directions: DMatrix::identity(d, d), height: 0.0, along: 1.0 };
        }
        let (directions, height) = fitted(&sample.mesh.points, space, d);
        let cells = sample.mesh.blocks.iter().flat_map(|block| block.cells());
        let along = cells.map(|nodes| {
            let x: Vec<f64> = nodes.iter().flat_map(|&p| sample.mesh.point(p)).copied().collect();
            let (of_cell, _) = fitted(&x, space, d);
            // The least singular value of the product of two orthonormal bases is the cosine of the largest angle
            // between their planes.
            singular(directions.tr_mul(&of_cell)).map_or(0.0, |cosines| cosines.values.min())
        });
        let along = along.fold(1.0, f64::min);
        Plane { directions, height, along }
    }

    /// The projection of a coordinate axis onto the plane.
    fn projected(&self, axis: usize) -> DVector<f64> {
        &self.directions * self.directions.row(axis).transpose()
    }

    /// Orthonormal axes in the plane, `[space × d]`: the projections of the coordinate axes in this order, each without
    /// its part along those before it.
    pub(super) fn frame(&self, order: &[usize]) -> DMatrix<f64> {
        let d = self.directions.ncols();
        let mut axes: Vec<DVector<f64>> = Vec::new();
        for &axis in order {
            let mut own = self.projected(axis);
            axes.iter().for_each(|before| own -= before * before.dot(&own));
            if axes.len() < d && own.norm() > SHORT {
                axes.push(own.normalize());
            }
        }
        DMatrix::from_columns(&axes)
    }
}

/// Orthonormal directions, `[space × d]`, of the plane or line that fits points best, and their root mean square distance from it,
/// relative to their extent.
fn fitted(points: &[f64], space: usize, d: usize) -> (DMatrix<f64>, f64) {
    let x = DMatrix::from_column_slice(space, points.len() / space, points);
    let mean = x.column_mean();
    let centred = DMatrix::from_fn(x.ncols(), space, |p, k| x[(k, p)] - mean[k]);
    // Points so far apart that their mean is no number lie in no plane.
    let Some(singular) = singular(centred) else { return (DMatrix::identity(space, d), f64::INFINITY) };
    let height = if d < space { singular.values[d] / singular.values[0] } else { 0.0 };
    (singular.v.columns(0, d).into_owned(), height)
}

/// The order in which the coordinate axes give the samples their axes: first those that lie in the planes. The axes of
/// flat sheets are then the same in all samples, and those of a sheet in the plane of x and y are x and y.
pub(super) fn axis_order(planes: &[&Plane]) -> Vec<usize> {
    let space = planes[0].directions.nrows();
    // The part of each axis that is normal to the planes, in quarters: axes that differ by less keep their order.
    let normal = |axis: usize| {
        let within: f64 = planes.iter().map(|plane| plane.directions.row(axis).norm_squared()).sum();
        (4.0 * (1.0 - within / planes.len() as f64)).round() as i64
    };
    let mut order: Vec<usize> = (0..space).collect();
    order.sort_by_key(|&axis| normal(axis));
    order
}
