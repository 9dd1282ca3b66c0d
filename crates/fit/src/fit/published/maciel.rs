//! One constant for all springs, scaled to Young's modulus, after Maciel, Boulic and Thalmann (2003).

use super::cell_shape::Elasticity;
use crate::springs::{Springs, distance};
use std::collections::HashMap;

/// `k = d (d + 1)/2 · E V/Σ_s l_s²`, in N/m. Springs of all directions that follow the motion of the body have
/// `λ = μ = k Σ l²/(d (d + 2) V)`, and therefore Young's modulus E. V is the content of the cells, and the sum is over
/// their springs, each counted once; a spring that n cells share gets k/n from each. Writes `[cells × springs]`.
///
/// The authors adjust the constants by experiments with simulated samples. This closed form of the scale is derived
/// here and is not printed there. It is equal to Lloyd's constant for equilateral triangles and to Van Gelder's for
/// regular tetrahedra.
pub fn constants(
    springs: &Springs,
    points: &[f64],
    connectivity: &[usize],
    content: f64,
    bulk: &Elasticity,
    k: &mut [f64],
) {
    let mut shared: HashMap<[usize; 2], f64> = HashMap::new();
    let ends = |nodes: &[usize], [a, b]: [usize; 2]| [nodes[a].min(nodes[b]), nodes[a].max(nodes[b])];
    let mut squares = 0.0;
    for nodes in connectivity.chunks_exact(springs.nodes()) {
        for &pair in springs.pairs() {
            let [i, j] = ends(nodes, pair);
            let cells = shared.entry([i, j]).or_default();
            if *cells == 0.0 {
                let at = |i: usize| &points[i * springs.space()..(i + 1) * springs.space()];
                squares += distance(at(i), at(j)).powi(2);
            }
            *cells += 1.0;
        }
    }
    let d = springs.dimension() as f64;
    let constant = d * (d + 1.0) / 2.0 * bulk.young * content / squares;
    for (nodes, k) in connectivity.chunks_exact(springs.nodes()).zip(k.chunks_exact_mut(springs.len())) {
        for (k, &pair) in k.iter_mut().zip(springs.pairs()) {
            *k = constant / shared[&ends(nodes, pair)];
        }
    }
}
