//! An incomplete Cholesky factorisation in blocks, the preconditioner of conjugate gradients.

use super::blocks::{Block, Pattern, add_products, plus_turned};
use crate::scalar::{Coordinates, CoordinatesWork, with_coordinates};

/// Shares of dropped blocks that are moved to the diagonal, and shares of the diagonal that are added to it, in order until no pivot is
/// lost (Gustafsson 1978; Manteuffel 1980). With all of them moved, rigid translations have the forces that A gives them; with 0.8
/// iterations are as few, and folded membranes seldom lose a pivot.
const TRIALS: [[f64; 2]; 9] =
    [[0.8, 0.0], [0.0, 0.0], [0.0, 0.01], [0.0, 0.03], [0.0, 0.1], [0.0, 0.3], [0.0, 1.0], [0.0, 10.0], [0.0, 100.0]];
/// The highest level of fill. It is the fastest on membranes, see [`PRODUCTS`].
const LEVELS: usize = 2;
/// Products of blocks that a factor with fill may take for each block of A. Membranes of triangles take 8 at level 2, where factor and
/// iterations together are fastest; boxes of hexahedra take 17 at level 1, which costs more than it saves.
const PRODUCTS: usize = 10;
/// The target of a product outside the pattern.
const DROPPED: u32 = u32::MAX;

/// Off the diagonal single precision is enough: the product of rounded factors is symmetric and positive definite as well.
type Single<const D: usize> = [[f32; 4]; D];

/// `A ≈ (I + U)ᵀ E (I + U)`, with U of the off-diagonal pattern of A and some fill (Meijerink and van der Vorst 1977). With separate
/// pivots E a row waits for one product with the row before it, not for two. The factor is that of A over its largest entry.
#[derive(Debug)]
pub(super) struct Incomplete<const D: usize> {
    /// The pivots E, and then their inverses.
    pivots: Vec<Block<D>>,
    /// `E (I + U)` off the diagonal, and then U.
    beyond: Vec<Single<D>>,
    pattern: Pattern,
    /// The index in `beyond` of each off-diagonal block of A.
    own: Vec<u32>,
    /// For each pair of blocks p < q of a row, of one row after the other, the block that loses `U_pᵀ E U_q`.
    targets: Vec<u32>,
}

impl<const D: usize> Incomplete<D> {
    pub fn new(given: &Pattern) -> Incomplete<D> {
        let mut pattern = given.clone();
        for _ in 0..LEVELS {
            let next = pattern.filled();
            // A row with n blocks beyond the diagonal is multiplied with itself: n (n + 1)/2 products of pairs.
            let products: usize = next.starts.windows(2).map(|at| (at[1] - at[0]) * (at[1] - at[0] + 1) / 2).sum();
            if products > PRODUCTS * given.columns.len() {
                break;
            }
            pattern = next;
        }
        let index = |i: usize, j: u32| pattern.find(i, j as usize).map_or(DROPPED, |at| at as u32);
        let (mut own, mut targets) = (Vec::new(), Vec::new());
        for i in 0..pattern.rows() {
            own.extend(given.columns[given.starts[i]..given.starts[i + 1]].iter().map(|&j| index(i, j)));
            let row = &pattern.columns[pattern.starts[i]..pattern.starts[i + 1]];
            for (at, &j) in row.iter().enumerate() {
                targets.extend(row[at + 1..].iter().map(|&k| index(j as usize, k)));
            }
        }
        let (pivots, beyond) = (vec![[[0.0; 4]; D]; pattern.rows()], vec![[[0.0; 4]; D]; pattern.columns.len()]);
        Incomplete { pivots, beyond, pattern, own, targets }
    }

    /// Factorises A, given by its diagonal blocks first; false if it has no factor even with a hundred times its
    /// diagonal.
    pub fn refill(&mut self, blocks: &[Block<D>]) -> bool {
        TRIALS.iter().any(|&[moved, shift]| with_coordinates(Factorize { incomplete: self, blocks, moved, shift }))
    }

    /// `z ← (I + U)⁻¹ E⁻¹ (I + U)⁻ᵀ r`, and `r·z`.
    #[inline(always)]
    pub fn solve<C: Coordinates>(&self, zero: C, r: &[[f64; 4]], z: &mut [[f64; 4]]) -> f64 {
        let Incomplete { pivots, beyond, pattern, .. } = self;
        z.copy_from_slice(r);
        for i in 0..pattern.rows() {
            let at = pattern.starts[i]..pattern.starts[i + 1];
            let y = z[i];
            let less = y.map(|y| -y);
            for (block, &j) in beyond[at.clone()].iter().zip(&pattern.columns[at]) {
                let (block, j) = (block.map(|row| zero.load_single(&row)), j as usize);
                plus_turned(zero.load(&z[j]), block, &less).store(&mut z[j]);
            }
            plus_turned(zero, pivots[i].map(|row| zero.load(&row)), &y).store(&mut z[i]);
        }
        let mut product = zero;
        for i in (0..pattern.rows()).rev() {
            let at = pattern.starts[i]..pattern.starts[i + 1];
            let mut products = [zero; 4];
            // The nearest row last: it has just been computed.
            for (block, &j) in beyond[at.clone()].iter().zip(&pattern.columns[at]).rev() {
                add_products(&mut products, block.map(|row| zero.load_single(&row)), zero.load(&z[j as usize]));
            }
            let y = zero.load(&z[i]).minus(C::sums(products));
            y.store(&mut z[i]);
            product = product.plus_products(y, zero.load(&r[i]));
        }
        product.dot(zero.load(&[1.0; 4]))
    }
}

/// One trial of a factorisation.
struct Factorize<'a, const D: usize> {
    incomplete: &'a mut Incomplete<D>,
    blocks: &'a [Block<D>],
    moved: f64,
    shift: f64,
}

impl<const D: usize> CoordinatesWork for Factorize<'_, D> {
    /// Whether no pivot was lost.
    type Output = bool;

    #[inline(always)]
    fn run<C: Coordinates>(self, zero: C) -> bool {
        let Factorize { incomplete: Incomplete { pivots, beyond, pattern, own, targets }, blocks, moved, shift } = self;
        let (diagonal, others) = blocks.split_at(pattern.rows());
        // Over the largest entry the numbers are near one, whatever the units are, and within the range of single
        // precision.
        let largest = diagonal.iter().flat_map(|block| (0..D).map(|k| block[k][k])).fold(0.0, f64::max);
        for (pivot, block) in pivots.iter_mut().zip(diagonal) {
            *pivot = block.map(|row| row.map(|x| (1.0 + shift) * (x / largest)));
        }
        beyond.fill([[0.0; 4]; D]);
        for (block, &at) in others.iter().zip(&*own) {
            beyond[at as usize] = block.map(|row| row.map(|x| (x / largest) as f32));
        }
        let mut targets = targets.iter();
        for i in 0..pattern.rows() {
            let Some(inverse) = inverse(&pivots[i]) else { return false };
            pivots[i] = inverse;
            for p in pattern.starts[i]..pattern.starts[i + 1] {
                let whole = beyond[p].map(|row| zero.load_single(&row));
                let share = inverse.map(|row| plus_turned(zero, whole, &row));
                // Of −share, the columns: what each row of a target gets of the rows of the other factor.
                let mut turned = [[0.0; 4]; 4];
                (0..D).for_each(|k| zero.minus(share[k]).store(&mut turned[k]));
                let less: [[f64; 4]; D] = std::array::from_fn(|k| std::array::from_fn(|l| turned[l][k]));
                (0..D).for_each(|k| share[k].store_single(&mut beyond[p][k]));
                let j = pattern.columns[p] as usize;
                add(zero, &mut pivots[j], 1.0, less.map(|column| plus_turned(zero, whole, &column)));
                for (q, &target) in (p + 1..pattern.starts[i + 1]).zip(&mut targets) {
                    // Most products are dropped; they are not computed where nothing of them is moved.
                    if target == DROPPED && moved == 0.0 {
                        continue;
                    }
                    let other = beyond[q].map(|row| zero.load_single(&row));
                    let change = less.map(|column| plus_turned(zero, other, &column));
                    if target == DROPPED {
                        // Of this and its mirror image; the inverse of a pivot is that of its symmetric part.
                        add(zero, &mut pivots[j], moved, change);
                        add(zero, &mut pivots[pattern.columns[q] as usize], moved, change);
                    } else {
                        for (row, change) in beyond[target as usize].iter_mut().zip(change) {
                            zero.load_single(row).plus(change).store_single(row);
                        }
                    }
                }
            }
        }
        true
    }
}

/// `a ← a + factor b`.
#[inline(always)]
fn add<C: Coordinates, const D: usize>(zero: C, a: &mut Block<D>, factor: f64, b: [C; D]) {
    a.iter_mut().zip(b).for_each(|(a, b)| zero.load(a).plus_scaled(factor, b).store(a));
}

/// The inverse of the symmetric part by a Cholesky factor; `None` if that is not positive definite.
#[inline(always)]
fn inverse<const D: usize>(a: &Block<D>) -> Option<Block<D>> {
    let (mut l, mut inverse) = ([[0.0; D]; D], [[0.0; D]; D]);
    for j in 0..D {
        let pivot = a[j][j] - (0..j).map(|k| l[j][k] * l[j][k]).sum::<f64>();
        // What remains of it is a rounding error.
        if !(pivot > 1e-14 * a[j][j] && pivot.is_finite()) {
            return None;
        }
        inverse[j][j] = 1.0 / pivot.sqrt();
        for i in j + 1..D {
            // Moved products are not symmetric one by one.
            let entry = (a[i][j] + a[j][i]) / 2.0;
            l[i][j] = (entry - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>()) * inverse[j][j];
        }
    }
    for j in 0..D {
        for i in j + 1..D {
            inverse[i][j] = -(j..i).map(|k| l[i][k] * inverse[k][j]).sum::<f64>() * inverse[i][i];
        }
    }
    let mut product = [[0.0; 4]; D];
    for i in 0..D {
        for j in 0..D {
            product[i][j] = (i.max(j)..D).map(|k| inverse[k][i] * inverse[k][j]).sum();
        }
    }
    Some(product)
}
