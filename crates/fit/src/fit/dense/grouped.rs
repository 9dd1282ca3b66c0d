//! The three loops of order n³ in groups of numbers, for kinds of numbers that have groups. Every number goes through the same operations in
//! the same order as in the loops over single numbers, so that results agree to the last bit.

use super::pivot::accepted;
use crate::scalar::{Group, GroupWork, Real};

/// Rows that are worked out together, because their sums do not wait for each other.
const ROWS: usize = 4;
/// Matrices of fewer rows or columns are not worth the groups.
pub const LEAST: usize = 8;

/// Rows of length `width` by columns, so that numbers of one column that are next to each other are one group.
struct Columns<G> {
    /// `[groups of rows × width]`.
    groups: Vec<G>,
    width: usize,
}

impl<G> Columns<G> {
    #[inline(always)]
    fn empty<T>(zero: G, rows: usize, width: usize) -> Columns<G>
    where
        G: Group<T>,
    {
        Columns { groups: vec![zero; rows.div_ceil(G::COUNT) * width], width }
    }

    #[inline(always)]
    fn of_rows<T>(zero: G, rows: &[T], width: usize) -> Columns<G>
    where
        G: Group<T>,
    {
        let mut columns = Columns::empty(zero, rows.len() / width, width);
        for (i, row) in rows.chunks_exact(width).enumerate() {
            for (k, number) in row.iter().enumerate() {
                columns.set(i, k, number);
            }
        }
        columns
    }

    /// Entry k of row i.
    #[inline(always)]
    fn set<T>(&mut self, i: usize, k: usize, number: &T)
    where
        G: Group<T>,
    {
        self.groups[i / G::COUNT * self.width + k].set(i % G::COUNT, number);
    }

    /// The columns of a group of rows.
    #[inline(always)]
    fn of(&self, group: usize) -> &[G] {
        &self.groups[group * self.width..(group + 1) * self.width]
    }
}

/// `sum_i ± Σ_k f_ik c_k`, one k after the other.
#[inline(always)]
fn add_products<T, G: Group<T>, const PLUS: bool>(sums: &mut [G; ROWS], factors: &[&[T]; ROWS], columns: &[G]) {
    for (k, column) in columns.iter().enumerate() {
        for i in 0..ROWS {
            let factor = column.filled(&factors[i][k]);
            sums[i] = if PLUS { sums[i].plus_product(factor, *column) } else { sums[i].minus_product(factor, *column) };
        }
    }
}

/// Rows from `first` on, of `width` numbers; beyond the last one that one again, whose sums are left out.
#[inline(always)]
fn rows_from<T>(all: &[T], width: usize, first: usize, last: usize) -> [&[T]; ROWS] {
    let mut rows = [all; ROWS];
    for (i, row) in rows.iter_mut().enumerate() {
        let at = (first + i).min(last);
        *row = &all[at * width..(at + 1) * width];
    }
    rows
}

/// Puts the first numbers of a group into `to`.
#[inline(always)]
fn store<T, G: Group<T>>(group: &G, to: &mut [T]) {
    for (i, number) in to.iter_mut().enumerate() {
        *number = group.get(i);
    }
}

/// [`row_products`](super::row_products).
pub struct RowProducts<'a, T> {
    pub a: &'a [T],
    pub b: &'a [T],
    pub n: usize,
    pub lower: bool,
    pub out: &'a mut [T],
}

impl<T: Real> GroupWork<T> for RowProducts<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<G: Group<T>>(self, zero: G) {
        let RowProducts { a, b, n, lower, out } = self;
        let (rows, count) = (a.len() / n, b.len() / n);
        let columns = Columns::of_rows(zero, b, n);
        for first in (0..rows).step_by(ROWS) {
            let factors = rows_from(a, n, first, rows - 1);
            let here = ROWS.min(rows - first);
            let last = if lower { (first + here).min(count) } else { count };
            for from in (0..last).step_by(G::COUNT) {
                let mut sums = [zero; ROWS];
                add_products::<T, G, true>(&mut sums, &factors, columns.of(from / G::COUNT));
                for (i, sum) in sums.iter().enumerate().take(here) {
                    let row = (first + i) * count;
                    store(sum, &mut out[row + from..row + last.min(from + G::COUNT)]);
                }
            }
        }
    }
}

/// [`add_outers`](super::add_outers).
pub struct AddOuters<'a, T> {
    pub a: &'a mut [T],
    pub g: &'a [T],
    pub n: usize,
    pub c: &'a [T],
    pub unknowns: &'a [usize],
    pub sign: f64,
}

impl<T: Real> GroupWork<T> for AddOuters<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<G: Group<T>>(self, zero: G) {
        let AddOuters { a, g, n, c, unknowns, sign } = self;
        let rows = g.len() / n;
        // Entry i of every g, and the same times c: the sum over the rows is one of products.
        let mut columns = Columns::empty(zero, n, rows);
        let mut factors = vec![c[0].zero(); n * rows];
        for (s, row) in g.chunks_exact(n).enumerate() {
            let factor = c[unknowns[s]].clone().scaled(&sign);
            for (i, entry) in row.iter().enumerate() {
                columns.set(i, s, entry);
                factors[i * rows + s] = factor.clone() * entry;
            }
        }
        for first in (0..n).step_by(ROWS) {
            let factors = rows_from(&factors, rows, first, n - 1);
            let here = ROWS.min(n - first);
            for from in (0..first + here).step_by(G::COUNT) {
                let mut sums = [zero; ROWS];
                let own =
                    |i: usize| (first + i) * n + from..(first + i) * n + (first + i + 1).clamp(from, from + G::COUNT);
                for i in 0..here {
                    sums[i] = zero.load(&a[own(i)]);
                }
                add_products::<T, G, true>(&mut sums, &factors, columns.of(from / G::COUNT));
                for (i, sum) in sums.iter().enumerate().take(here) {
                    store(sum, &mut a[own(i)]);
                }
            }
        }
    }
}

/// [`factorize`](super::factorize).
pub struct Factorize<'a, T> {
    pub a: &'a mut [T],
    pub n: usize,
    pub floor: f64,
    pub inverse: &'a mut [T],
}

impl<T: Real> GroupWork<T> for Factorize<'_, T> {
    type Output = T;

    #[inline(always)]
    fn run<G: Group<T>>(self, zero: G) -> T {
        let Factorize { a, n, floor, inverse } = self;
        let (one, none) = (a[0].one(), a[0].zero());
        let mut least = one.clone();
        // L by columns, as far as it is known.
        let mut known: Columns<G> = Columns::empty(zero, n, n);
        // `L_sr D_r` of the rows of one block.
        let mut products = vec![none.clone(); G::COUNT.max(ROWS) * n];
        for from in (0..n).step_by(G::COUNT) {
            let count = G::COUNT.min(n - from);
            // Columns before the block.
            for first in (0..count).step_by(ROWS) {
                let here = ROWS.min(count - first);
                for before in (0..from).step_by(G::COUNT) {
                    let columns = known.of(before / G::COUNT);
                    let mut sums = [zero; ROWS];
                    for i in 0..here {
                        sums[i] = zero.load(&a[(from + first + i) * n + before..][..G::COUNT]);
                    }
                    let factors = rows_from(&products, n, first, first + here - 1);
                    add_products::<T, G, false>(&mut sums, &factors, &columns[..before]);
                    for k in 0..G::COUNT {
                        for i in 0..here {
                            // Later numbers of the group wait for this one.
                            let product = sums[i].get(k);
                            sums[i] = sums[i].minus_product(zero.filled(&product), columns[before + k]);
                            products[(first + i) * n + before + k] = product;
                        }
                    }
                }
            }
            for i in 0..count {
                let s = from + i;
                for r in 0..from {
                    let scaled = products[i * n + r].clone() * &inverse[r];
                    known.set(s, r, &scaled);
                    a[s * n + r] = scaled;
                }
            }
            // The columns of the block, up to the diagonal.
            for first in (0..count).step_by(ROWS) {
                let here = ROWS.min(count - first);
                let mut sums = [zero; ROWS];
                for i in 0..here {
                    sums[i] = zero.load(&a[(from + first + i) * n + from..][..=first + i]);
                }
                let factors = rows_from(&products, n, first, first + here - 1);
                add_products::<T, G, false>(&mut sums, &factors, &known.of(from / G::COUNT)[..from]);
                for i in 0..here {
                    store(&sums[i], &mut products[(first + i) * n + from..][..=first + i]);
                }
            }
            for i in 0..count {
                let (s, row) = (from + i, i * n + from);
                for t in 0..i {
                    let mut product = products[row + t].clone();
                    for r in 0..t {
                        product = product.minus_product(&products[row + r], &a[(from + t) * n + from + r]);
                    }
                    products[row + t] = product;
                }
                let mut pivot = products[row + i].clone();
                for t in 0..i {
                    let scaled = products[row + t].clone() * &inverse[from + t];
                    pivot = pivot.minus_product(&products[row + t], &scaled);
                    known.set(s, from + t, &scaled);
                    a[s * n + from + t] = scaled;
                }
                inverse[s] = accepted(pivot, &a[s * n + s], floor, &mut least);
            }
        }
        least
    }
}
