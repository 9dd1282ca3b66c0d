//! Displacements under several loads side by side, so that one pass over the springs serves them all.

/// The number of loads in a block.
// They are the doubles of one register of 512 bits, and a pass reads each spring once for all of them.
pub(super) const LANES: usize = 8;
/// A number for each load of a block.
pub(super) type Lanes = [f64; LANES];
/// A vector for each load of a block, such as `[dofs]`.
pub(super) type Block = Vec<Lanes>;

/// Vectors as a block; those that lack are zero.
pub(super) fn block(vectors: &[Vec<f64>], size: usize) -> Block {
    let mut block = vec![[0.0; LANES]; size];
    for (lane, vector) in vectors.iter().enumerate() {
        block.iter_mut().zip(vector).for_each(|(all, own)| all[lane] = *own);
    }
    block
}

/// The first `count` vectors of a block.
pub(super) fn vectors(block: &[Lanes], count: usize) -> Vec<Vec<f64>> {
    (0..count).map(|lane| block.iter().map(|all| all[lane]).collect()).collect()
}

/// `a += factor b`.
#[inline(always)]
pub(super) fn add(a: &mut Lanes, b: &Lanes, factor: f64) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * b);
}

/// `Σ a b` in each lane.
pub(super) fn dots(a: &[Lanes], b: &[Lanes]) -> Lanes {
    let mut sum = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for lane in 0..LANES {
            sum[lane] += a[lane] * b[lane];
        }
    }
    sum
}
