//! The tentative prolongator: on each aggregate an orthonormal basis of the motions that it has to carry.

use crate::aggregation::{Aggregates, NONE};
use crate::block::{Block, zero};
use rayon::prelude::*;

/// What is left of a motion after the others are taken out of it, as a share of it, where it is dependent on them. A
/// basis vector of less would carry the rounding of the first pass to all levels.
const DEPENDENT: f64 = 1e-8;

/// `B_i = T_i B_c` for the nodes i of each aggregate c.
pub struct Tentative<const R: usize, const C: usize> {
    /// `T`, one block per node; zero in no aggregate.
    pub basis: Vec<Block<R, C>>,
    /// `B_c`, the motions on the next level.
    pub motions: Vec<Block<C, C>>,
    /// Columns of T that are zero because the aggregate is too small for them, or held: nothing moves on the next level there.
    pub is_held: Vec<[bool; C]>,
}

/// Gram's and Schmidt's method, twice, on each aggregate.
pub fn tentative<const R: usize, const C: usize>(aggregates: &Aggregates, motions: &[Block<R, C>]) -> Tentative<R, C> {
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
        // Aggregates have no node in common, and are collected in their order.
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
        // One pass leaves rounding of the size of what it takes out; after the second the vectors are orthogonal to the last digits.
        for _ in 0..2 {
            for i in (0..j).filter(|i| !held[*i]) {
                let along = product(q, i, j);
                r[i][j] += along;
                q.iter_mut().flatten().for_each(|row| row[j] -= along * row[i]);
            }
        }
        let left = product(q, j, j).sqrt();
        // The comparison is negated so that a motion that is zero on the whole aggregate is held as well.
        held[j] = !(left > DEPENDENT * size);
        let scale = if held[j] { 0.0 } else { 1.0 / left };
        r[j][j] = if held[j] { 0.0 } else { left };
        q.iter_mut().flatten().for_each(|row| row[j] *= scale);
    }
    (r, held)
}
