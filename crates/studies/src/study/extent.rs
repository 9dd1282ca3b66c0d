//! The size of a body.

use crate::mesh::Mesh;

/// The size of the box around the body along each axis, m.
pub fn extent(mesh: &Mesh) -> Vec<f64> {
    let along = |k: usize| {
        let range = mesh.points.iter().skip(k).step_by(mesh.dimension);
        let (least, largest) = range.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
        largest - least
    };
    (0..mesh.dimension).map(along).collect()
}
