//! Means over the cells of a mesh.

use super::integration::each_cell_points;
use crate::element::Integrand;
use crate::mesh::Mesh;

/// The means over each cell of what the shape functions make of values of the points, `[points × components]`:
/// `Σ_a v_a ∫ N_a dV/∫ dV`, by block, `[cells × components]`. Those of the positions are the centroids.
pub fn cell_means(mesh: &Mesh, values: &[f64]) -> Vec<Vec<f64>> {
    let components = values.len() / mesh.point_count().max(1);
    let mut means: Vec<Vec<f64>> = mesh.blocks.iter().map(|_| Vec::new()).collect();
    each_cell_points(
        mesh,
        Integrand::Load(0),
        |_| true,
        |cell| {
            let own = &mut means[cell.index.block];
            let first = own.len();
            own.resize(first + components, 0.0);
            let mut content = 0.0;
            // Relative to the first node, so that the means of equal values are that value.
            let start = cell.nodes[0] * components;
            for (shapes, v) in cell.each() {
                content += v;
                for (&point, n) in cell.nodes.iter().zip(shapes) {
                    for k in 0..components {
                        own[first + k] += v * n * (values[point * components + k] - values[start + k]);
                    }
                }
            }
            (0..components).for_each(|k| own[first + k] = values[start + k] + own[first + k] / content);
        },
    );
    means
}
