//! The normal equations of one element with many springs, whose sums are taken eight terms at a time. Those of one element per lane are in
//! `normal.rs`.

use super::normal::{Normal, RANK};
use crate::scalar::{Packed, dispatched};

/// Numbers of one group: those of the widest registers.
const WIDTH: usize = 8;
type Group = [f64; WIDTH];

/// Rows of a factor that are worked out together, because their sums do not wait for each other.
const ROWS: usize = 4;

/// `M k = b` of one element in the scaling in which M has a unit diagonal, with the lower triangle of M in rows of whole groups, the last one
/// filled with zeros.
pub struct VectorizedNormal {
    /// `[size × groups]`.
    gram: Vec<Group>,
    rhs: Vec<f64>,
    /// `k_s` is `scale_s` times the scaled constant.
    scale: Vec<f64>,
    factor: Vec<Group>,
    /// The scaled constants, zero outside the set that was solved for last.
    constants: Vec<Group>,
}

impl VectorizedNormal {
    /// The equations in these lanes, all of which have diagonal entries above zero.
    pub fn of_lanes<T: Packed>(normal: &Normal<T>, lanes: &[usize]) -> Vec<VectorizedNormal> {
        let size = normal.size();
        let groups = size.div_ceil(WIDTH);
        let of_lane = |&lane: &usize| {
            let own = |value: &T| value.as_slice()[lane];
            let scale: Vec<f64> = (0..size).map(|s| 1.0 / own(&normal.gram[s * size + s]).sqrt()).collect();
            let rhs = normal.rhs.iter().zip(&scale).map(|(b, scale)| own(b) * scale).collect();
            let (gram, constants) = (vec![[0.0; WIDTH]; size * groups], vec![[0.0; WIDTH]; groups]);
            VectorizedNormal { gram, rhs, scale, factor: Vec::new(), constants }
        };
        let mut all: Vec<VectorizedNormal> = lanes.iter().map(of_lane).collect();
        // The lanes of an entry are next to each other: it is read once for all of them.
        for s in 0..size {
            for (t, entry) in normal.gram[s * size..][..=s].iter().enumerate() {
                for (own, &lane) in all.iter_mut().zip(lanes) {
                    let scaled = entry.as_slice()[lane] * own.scale[s] * own.scale[t];
                    own.gram[s * groups + t / WIDTH][t % WIDTH] = scaled;
                }
            }
        }
        all
    }

    pub fn size(&self) -> usize {
        self.rhs.len()
    }

    /// The largest |b| in the scaling.
    pub fn largest(&self) -> f64 {
        self.rhs.iter().fold(0.0, |largest, b| largest.max(b.abs()))
    }

    /// The equations in the scaling.
    pub fn scaled(&self) -> Normal {
        let (m, stride) = (self.size(), self.constants.len() * WIDTH);
        let entries = self.gram.as_flattened();
        Normal::new((0..m * m).map(|st| entries[st / m * stride + st % m]).collect(), self.rhs.clone())
    }

    /// Solves for the constants `set`, in ascending order, with all others zero; false if a pivot is within `rounding`, as in
    /// [`Normal::solve_to`].
    pub fn solve(&mut self, set: &[usize], rounding: f64) -> bool {
        dispatched(
            #[inline(always)]
            || self.solve_for(set, rounding),
        )
    }

    /// The scaled constants that were solved for last.
    pub fn constants(&self) -> &[f64] {
        &self.constants.as_flattened()[..self.size()]
    }

    /// Scaled constants as they are, N/m for lengths.
    pub fn unscaled(&self, constants: &[f64]) -> Vec<f64> {
        constants.iter().zip(&self.scale).map(|(k, scale)| k * scale).collect()
    }

    /// `M k − b` in the scaling, for the constants that were solved for last.
    pub fn slopes(&self) -> Vec<f64> {
        let groups = self.constants.len();
        let mut product = vec![[0.0; WIDTH]; groups];
        dispatched(
            #[inline(always)]
            || {
                for (s, row) in self.gram.chunks_exact(groups).enumerate() {
                    let (at, lane) = (s / WIDTH, s % WIDTH);
                    let (own, mut sums) = (self.constants[at][lane], [0.0; WIDTH]);
                    for ((row, k), product) in row[..=at].iter().zip(&self.constants).zip(&mut product) {
                        // Each entry of the lower triangle serves its row and its column: the matrix is read once.
                        for l in 0..WIDTH {
                            sums[l] += row[l] * k[l];
                            product[l] += row[l] * own;
                        }
                    }
                    // The diagonal entry is in both sums.
                    product[at][lane] += total(&sums) - row[at][lane] * own;
                }
            },
        );
        product.as_flattened().iter().zip(&self.rhs).map(|(product, b)| product - b).collect()
    }

    #[inline(always)]
    fn solve_for(&mut self, set: &[usize], rounding: f64) -> bool {
        let (m, full) = (set.len(), self.constants.len() * WIDTH);
        let groups = m.div_ceil(WIDTH);
        let gram = self.gram.as_flattened();
        self.factor.clear();
        self.factor.resize(m * groups, [0.0; WIDTH]);
        // With an empty set there are no groups, and a slice has no pieces of length zero.
        for (i, (row, &s)) in self.factor.chunks_exact_mut(groups.max(1)).zip(set).enumerate() {
            let own = &gram[s * full..(s + 1) * full];
            for (entry, &t) in row.as_flattened_mut().iter_mut().zip(&set[..i]) {
                *entry = own[t];
            }
        }
        let mut inverse = vec![0.0; m];
        let mut solution: Vec<Group> = vec![[0.0; WIDTH]; groups];
        for (first, block) in (0..m).step_by(ROWS).zip(0..) {
            let (before, rest) = self.factor.split_at_mut(block * ROWS * groups);
            let count = ROWS.min(m - first);
            let block = &mut rest[..count * groups];
            match count {
                ROWS => eliminate::<ROWS>(before, block, groups, first),
                _ => block.chunks_exact_mut(groups).for_each(|row| eliminate::<1>(before, row, groups, first)),
            }
            for i in 0..count {
                let (above, rest) = block.split_at_mut(i * groups);
                let row = &mut rest[..groups];
                for (t, other) in (first..).zip(above.chunks_exact(groups)) {
                    let sum = dot(&row[..t.div_ceil(WIDTH)], &other[..t.div_ceil(WIDTH)]);
                    row[t / WIDTH][t % WIDTH] -= sum;
                }
                let s = first + i;
                let own = gram[set[s] * full + set[s]];
                let mut pivot = own;
                for (entry, inverse) in row.as_flattened_mut().iter_mut().zip(&inverse[..s]) {
                    let scaled = *entry * inverse;
                    pivot -= *entry * scaled;
                    *entry = scaled;
                }
                // The comparison is negated so that a pivot that is not a number counts as zero.
                if !(pivot > own * RANK * rounding) {
                    return false;
                }
                inverse[s] = 1.0 / pivot;
                // The forward substitution goes along with the factor, while its row is in the cache.
                let sum = dot(&row[..s.div_ceil(WIDTH)], &solution[..s.div_ceil(WIDTH)]);
                solution[s / WIDTH][s % WIDTH] = self.rhs[set[s]] - sum;
            }
        }
        let k = solution.as_flattened_mut();
        k.iter_mut().zip(&inverse).for_each(|(k, inverse)| *k *= inverse);
        for s in (1..m).rev() {
            let row = self.factor[s * groups..][..groups].as_flattened();
            let last = k[s];
            k[..s].iter_mut().zip(row).for_each(|(k, l)| *k -= l * last);
        }
        self.constants.fill([0.0; WIDTH]);
        let constants = self.constants.as_flattened_mut();
        set.iter().zip(&*k).for_each(|(&s, k)| constants[s] = *k);
        true
    }
}

/// Takes what the rows before the first give out of a block of rows: `w_t ← w_t − Σ_{r<t} w_r L_tr`, t < first. Entries of L beyond the diagonal
/// are zero.
#[inline(always)]
fn eliminate<const B: usize>(before: &[Group], block: &mut [Group], groups: usize, first: usize) {
    let mut rows = block.chunks_exact_mut(groups);
    let rows: [&mut [Group]; B] = std::array::from_fn(|_| rows.next().expect("the block has B rows"));
    for (t, other) in before.chunks_exact(groups).take(first).enumerate() {
        let upto = t.div_ceil(WIDTH);
        let mut sums = [[0.0; WIDTH]; B];
        let others = &other[..upto];
        let own: [&[Group]; B] = rows.each_ref().map(|row| &row[..upto]);
        for (g, other) in others.iter().enumerate() {
            for b in 0..B {
                for l in 0..WIDTH {
                    sums[b][l] += own[b][g][l] * other[l];
                }
            }
        }
        for b in 0..B {
            rows[b][t / WIDTH][t % WIDTH] -= total(&sums[b]);
        }
    }
}

#[inline(always)]
fn dot(a: &[Group], b: &[Group]) -> f64 {
    let mut sums = [0.0; WIDTH];
    for (a, b) in a.iter().zip(b) {
        for l in 0..WIDTH {
            sums[l] += a[l] * b[l];
        }
    }
    total(&sums)
}

/// Halves are added, and their halves: the same on any machine.
#[inline(always)]
fn total(sums: &Group) -> f64 {
    let four: [f64; 4] = std::array::from_fn(|l| sums[l] + sums[l + 4]);
    (four[0] + four[2]) + (four[1] + four[3])
}
