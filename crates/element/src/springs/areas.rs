//! What the area springs of exact networks measure.

use crate::element::Tabulation;
use std::sync::Arc;

/// The pairs of tangents, as sums of the columns t₁, t₂, t₃ of the Jacobian, that span the areas `|n_k|` and
/// `|n_k + n_l|`, k < l, with n the columns of its cofactor matrix. On a tetrahedron these are twice the areas of three
/// faces and of the parallelograms of three pairs of opposite edges.
const SPANS: [[[f64; 3]; 2]; 6] = [
    [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    [[-1.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    [[0.0, 1.0, 0.0], [-1.0, 0.0, 1.0]],
    [[1.0, 0.0, 0.0], [0.0, 1.0, -1.0]],
];

/// A table for each of the six areas at each quadrature point.
pub(super) fn area_tables(table: &Tabulation) -> Vec<Arc<Tabulation>> {
    let size = table.nodes * table.dimension;
    let at = |q: usize| Tabulation {
        weights: vec![1.0],
        volumetric: Vec::new(),
        values: table.values[q * table.nodes..(q + 1) * table.nodes].to_vec(),
        gradients: table.gradients[q * size..(q + 1) * size].to_vec(),
        modes: None,
        ..*table
    };
    let spanned = |q: usize| SPANS.map(|span| Arc::new(at(q).along(&span.map(|t| t.to_vec()))));
    (0..table.points()).flat_map(spanned).collect()
}
