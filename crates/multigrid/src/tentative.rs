//! The tentative prolongator: on each aggregate an orthonormal basis of the motions that it has to carry.

use crate::aggregation::{Aggregates, NONE};
use crate::block::{Block, zero};
use rayon::prelude::*;

/// What is left of a motion after the others are taken out of it, as a share of it, where it is dependent on them.
const DEPENDENT: f64 = 1e-8;

/// `B_i = T_i B_c` for the nodes i of each aggregate c.
pub(crate) struct Tentative<const R: usize, const C: usize> {
    /// `T`, one block per node; zero in no aggregate.
    pub basis: Vec<Block<R, C>>,
    /// `B_c`, the motions on the next level.
    pub motions: Vec<Block<C, C>>,
    /// Columns of T that are zero because the aggregate is too small for them, or held: nothing moves on the next level there.
    pub is_held: Vec<[bool; C]>,
}

/// Gram's and Schmidt's method, twice, on each aggregate.
pub(crate) fn tentative<const R: usize, const C: usize>(
    aggregates: &Aggregates,
    motions: &[Block<R, C>],
) -> Tentative<R, C> {
    let mut starts = vec![0; aggregates.count + 1];
    let members = || aggregates.of.iter().enumerate().filter(|(_, own)| **own != NONE);
    members().for_each(|(_, &own)| starts[own as usize + 1] += 1);
    for i in 0..aggregates.count {
        starts[i + 1] += starts[i];
    }
    let mut next = starts.clone();
    let mut nodes = vec![0; starts[aggregates.count]];
    for (node, &own) in members() {
        nodes[next[own as usize]] = node;
        next[own as usize] += 1;
    }
    let one = |aggregate: usize| {
        let nodes = &nodes[starts[aggregate]..starts[aggregate + 1]];
        let mut q: Vec<Block<R, C>> = nodes.iter().map(|&node| motions[node]).collect();
        let (r, held) = orthonormalize(&mut q);
        (q, r, held)
    };
    let parts: Vec<(Vec<Block<R, C>>, Block<C, C>, [bool; C])> =
        (0..aggregates.count).into_par_iter().map(one).collect();
    let mut basis = vec![zero(); aggregates.of.len()];
    let (mut coarse, mut is_held) = (Vec::with_capacity(parts.len()), Vec::with_capacity(parts.len()));
    for (aggregate, (q, r, held)) in parts.into_iter().enumerate() {
        nodes[starts[aggregate]..starts[aggregate + 1]].iter().zip(q).for_each(|(&node, q)| basis[node] = q);
        coarse.push(r);
        is_held.push(held);
    }
    Tentative { basis, motions: coarse, is_held }
}

fn orthonormalize<const R: usize, const C: usize>(q: &mut [Block<R, C>]) -> (Block<C, C>, [bool; C]) {
    let mut r = zero::<C, C>();
    let mut held = [false; C];
    let product =
        |q: &[Block<R, C>], a: usize, b: usize| -> f64 { q.iter().flatten().map(|row| row[a] * row[b]).sum() };
    for j in 0..C {
        let size = product(q, j, j).sqrt();
        for _ in 0..2 {
            for i in (0..j).filter(|i| !held[*i]) {
                let along = product(q, i, j);
                r[i][j] += along;
                q.iter_mut().flatten().for_each(|row| row[j] -= along * row[i]);
            }
        }
        let left = product(q, j, j).sqrt();
        held[j] = !(left > DEPENDENT * size);
        let scale = if held[j] { 0.0 } else { 1.0 / left };
        r[j][j] = if held[j] { 0.0 } else { left };
        q.iter_mut().flatten().for_each(|row| row[j] *= scale);
    }
    (r, held)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigid::space_motions;

    /// The span of aggregates with less than three points that are not on a line has not all six motions.
    #[test]
    fn the_basis_is_orthonormal_and_spans_the_motions_whatever_the_points() {
        let shapes: [(&[f64], usize); 3] = [
            (&[0.3, 0.1, 5.0], 3),
            (&[0.0, 0.0, 0.0, 1.0, 2.0, 3.0], 5),
            (&[0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 0.5, -1.0, 2.0, 4.0, 4.0, 0.0], 6),
        ];
        for (points, rank) in shapes {
            let n = points.len() / 3;
            let motions = space_motions(points, &vec![false; 3 * n]);
            let t = tentative(&Aggregates { of: vec![0; n], count: 1 }, &motions);
            assert_eq!(t.is_held[0].iter().filter(|held| !**held).count(), rank);
            for a in 0..6 {
                for b in 0..6 {
                    let product: f64 = t.basis.iter().flatten().map(|row| row[a] * row[b]).sum();
                    let expected = f64::from(u8::from(a == b && !t.is_held[0][a]));
                    assert!((product - expected).abs() < 1e-12, "q_{a}·q_{b} = {product}");
                }
            }
            for (motion, basis) in motions.iter().zip(&t.basis) {
                for i in 0..3 {
                    for j in 0..6 {
                        let again: f64 = (0..6).map(|k| basis[i][k] * t.motions[0][k][j]).sum();
                        assert!((again - motion[i][j]).abs() < 1e-7, "B = T B_c");
                    }
                }
            }
        }
    }
}
