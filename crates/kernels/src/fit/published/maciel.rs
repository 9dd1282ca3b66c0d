//! One constant for all springs, scaled to Young's modulus, after Maciel, Boulic and Thalmann (2003).

use super::cell_shape::Elasticity;
use crate::springs::{Springs, distance};
use std::collections::HashMap;

/// `k = d (d + 1)/2 · E V/Σ_s l_s²`, N/m: springs of all directions that follow the motion of the body have
/// `λ = μ = k Σ l²/(d (d + 2) V)`, and so Young's modulus E. V is the content of the cells, the sum goes over their
/// springs, each counted once; of the n cells that share a spring each gets k/n. Writes `[cells × springs]`.
///
/// The authors set constants by the modulus in experiments with simulated samples; this closed form of the scale is derived
/// here, and is not printed there. It is Lloyd's constant of equilateral triangles and Van Gelder's of regular
/// tetrahedra.
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
    for nodes in connectivity.chunks_exact(springs.nodes) {
        for &pair in &springs.pairs {
            let [i, j] = ends(nodes, pair);
            let cells = shared.entry([i, j]).or_default();
            if *cells == 0.0 {
                let at = |i: usize| &points[i * springs.space..(i + 1) * springs.space];
                squares += distance(at(i), at(j)).powi(2);
            }
            *cells += 1.0;
        }
    }
    let d = springs.dimension as f64;
    let constant = d * (d + 1.0) / 2.0 * bulk.young * content / squares;
    for (nodes, k) in connectivity.chunks_exact(springs.nodes).zip(k.chunks_exact_mut(springs.len())) {
        for (k, &pair) in k.iter_mut().zip(&springs.pairs) {
            *k = constant / shared[&ends(nodes, pair)];
        }
    }
}
