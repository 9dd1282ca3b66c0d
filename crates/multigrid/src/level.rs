//! One level: its matrix, its smoother, and the way to the next one.

use crate::aggregation::aggregates;
use crate::block::{Block, add_transposed_product, inverse, softest};
use crate::entry::Entry;
use crate::galerkin::galerkin;
use crate::matrix::BlockMatrix;
use crate::parallel::{PIECE, vectorized};
use crate::prolongator::prolongator;
use crate::settings::{LevelSize, Settings};
use crate::smoother::{Room, Smoother};
use crate::tentative::tentative;
use rayon::prelude::*;
use std::sync::Arc;

/// Groups that leave more than this share of the nodes are none. A level with nearly as many nodes costs as much as the
/// one before it and corrects little that its smoother does not.
// Between 0.35 and 0.95 no level of boxes changes.
const COARSER: f64 = 0.7;

#[derive(Debug)]
pub(crate) struct Level<const R: usize, const C: usize> {
    pub matrix: Arc<BlockMatrix<R, R>>,
    pub smoother: Smoother<R>,
    pub prolongator: BlockMatrix<R, C>,
    rows_of: Vec<usize>,
    places: Vec<[u32; 2]>,
}

/// What the next level is built of.
pub(crate) struct Next<const C: usize> {
    pub matrix: Arc<BlockMatrix<C, C>>,
    pub motions: Vec<Block<C, C>>,
    pub is_held: Vec<[bool; C]>,
}

/// D⁻¹ of a level; a motion of one node, on the level, that shows that it is not positive.
pub(crate) fn inverses<const N: usize>(
    a: &BlockMatrix<N, N>,
    is_held: &[[bool; N]],
) -> Result<Vec<Block<N, N>>, Vec<[f64; N]>> {
    let free = |row: usize| is_held[row].map(|held| !held);
    let all: Vec<Option<Block<N, N>>> =
        (0..a.rows()).into_par_iter().map(|row| inverse(&a.diagonal(row), &free(row))).collect();
    // The first row in the order of the nodes is shown, on any number of threads.
    if let Some(row) = all.iter().position(Option::is_none) {
        let mut motion = vec![[0.0; N]; a.rows()];
        motion[row] = softest(&a.diagonal(row), &free(row));
        return Err(motion);
    }
    Ok(all.into_iter().flatten().collect())
}

pub(crate) fn size<const N: usize>(a: &BlockMatrix<N, N>) -> LevelSize {
    LevelSize { nodes: a.rows(), width: N, blocks: a.pattern().len() }
}

impl<const R: usize, const C: usize> Level<R, C> {
    /// `None` where the nodes do not group; an error is a motion that shows that the matrix is not positive.
    #[allow(clippy::type_complexity)]
    pub fn new(
        matrix: Arc<BlockMatrix<R, R>>,
        motions: &[Block<R, C>],
        is_held: &[[bool; R]],
        settings: &Settings,
        depth: i32,
    ) -> Result<Option<(Level<R, C>, Next<C>)>, Vec<[f64; R]>> {
        let inverse = inverses(&matrix, is_held)?;
        let all_held: Vec<bool> = is_held.iter().map(|held| held.iter().all(|h| *h)).collect();
        let free = all_held.iter().filter(|held| !**held).count();
        // Couplings even out from level to level, and with them the share that is strong (Vaněk, Mandel and Brezina,
        // Computing 56, 1996).
        let mut groups = aggregates(&matrix, &all_held, settings.threshold * 0.5_f64.powi(depth));
        if groups.count as f64 > COARSER * free as f64 {
            // With every coupling as a strong one, what is left still groups.
            groups = aggregates(&matrix, &all_held, 0.0);
        }
        if groups.count as f64 > COARSER * free as f64 {
            return Ok(None);
        }
        let smoother = Smoother::new(&matrix, inverse, settings.degree, settings.ratio);
        let tentative = tentative(&groups, motions);
        // The damping that makes the bound of the energy of the prolongator least (Vaněk, Mandel and Brezina 1996).
        let omega = 4.0 / 3.0 / smoother.upper;
        let prolongator = prolongator(&matrix, &smoother.inverse, omega, &groups, &tentative);
        let (rows_of, places) = prolongator.pattern.transposed();
        let coarse = Arc::new(galerkin(&matrix, &prolongator, &rows_of, &places));
        let next = Next { matrix: coarse, motions: tentative.motions, is_held: tentative.is_held };
        Ok(Some((Level { matrix, smoother, prolongator, rows_of, places }, next)))
    }

    /// `y ← Pᵀ r`.
    fn restrict<T: Entry>(&self, r: &[[T; R]], y: &mut [[T; C]]) {
        // A row of the next level sums over all nodes of an aggregate and around it: fewer of them are as much work as elsewhere.
        let piece = PIECE / 8;
        y.par_chunks_mut(piece).enumerate().for_each(|(part, y)| {
            vectorized(
                #[inline(always)]
                || {
                    for (coarse, y) in (part * piece..).zip(y) {
                        *y = [T::ZERO; C];
                        for &[row, at] in &self.places[self.rows_of[coarse]..self.rows_of[coarse + 1]] {
                            add_transposed_product(y, &self.prolongator.values[at as usize], &r[row as usize]);
                        }
                    }
                },
            );
        });
    }

    /// `x ← P y`.
    pub fn prolong<T: Entry>(&self, y: &[[T; C]], x: &mut [[T; R]]) {
        self.prolongator.product(y, x);
    }

    /// One V-cycle from zero for the right hand side in `room.residual`; `solve` replaces the right hand side of the next level, its
    /// first argument, by a solution in its second.
    pub fn cycle<T: Entry>(
        &self,
        x: &mut [[T; R]],
        room: &mut Room<R, T>,
        force: &mut [[T; C]],
        motion: &mut [[T; C]],
        solve: impl FnOnce(&mut [[T; C]], &mut [[T; C]]),
    ) {
        x.fill([T::ZERO; R]);
        // The same polynomial smooths before and after, so that the cycle is symmetric, as conjugate gradients need it.
        self.smoother.smooth(&self.matrix, x, room, true);
        self.restrict(&room.residual, force);
        solve(force, motion);
        self.prolong(motion, &mut room.next);
        let Room { residual, next, .. } = room;
        let add = |(x, next): (&mut [[T; R]], &[[T; R]])| {
            x.as_flattened_mut().iter_mut().zip(next.as_flattened()).for_each(|(x, p)| *x += *p);
        };
        x.par_chunks_mut(PIECE).zip(next.par_chunks(PIECE)).for_each(add);
        // The right-hand side has been overwritten by the residual, which is corrected by what the next level has changed.
        self.matrix.each_row(residual, next, |r, product| (0..R).for_each(|k| r[k] -= product[k]));
        // Nothing reads the residual after the cycle: it would cost one more product with the matrix.
        self.smoother.smooth(&self.matrix, x, room, false);
    }
}
