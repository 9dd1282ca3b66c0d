//! Affine maps of a reference cell.

/// The map `ξ ↦ origin + Σ_k ξ_k edges_k` of a reference cell into another one or into the unit cube.
#[derive(Debug, Clone)]
pub(super) struct Affine {
    pub origin: Vec<f64>,
    pub edges: Vec<Vec<f64>>,
}

impl Affine {
    pub fn place(&self, at: &[f64]) -> Vec<f64> {
        let mut x = self.origin.clone();
        for (xi, edge) in at.iter().zip(&self.edges) {
            x.iter_mut().zip(edge).for_each(|(x, e)| *x += xi * e);
        }
        x
    }

    /// The map of a reference simplex onto the simplex with these corners.
    pub fn onto_simplex(corners: &[Vec<f64>]) -> Affine {
        let from_first = |corner: &Vec<f64>| corner.iter().zip(&corners[0]).map(|(x, o)| x - o).collect();
        Affine { origin: corners[0].clone(), edges: corners[1..].iter().map(from_first).collect() }
    }
}
