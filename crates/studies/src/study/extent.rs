//! The size of a body.

use crate::mesh::Mesh;
use crate::text::rounded;

/// The size of the box around the body along each axis, m.
pub fn extent(mesh: &Mesh) -> Vec<f64> {
    let along = |k: usize| {
        let range = mesh.points.iter().skip(k).step_by(mesh.dimension).take(mesh.node_count());
        let (least, largest) = range.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
        largest - least
    };
    (0..mesh.dimension).map(along).collect()
}

/// `from 0 to 0.1 m along x, …`: where the body is.
pub(in crate::study) fn extends(mesh: &Mesh) -> String {
    let along = |k: usize| {
        let range = mesh.points.iter().skip(k).step_by(mesh.dimension).take(mesh.node_count());
        let (least, most) = range.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
        format!("from {} to {} m along {}", rounded(least, 4), rounded(most, 4), ["x", "y", "z"][k])
    };
    (0..mesh.dimension).map(along).collect::<Vec<_>>().join(", ")
}
