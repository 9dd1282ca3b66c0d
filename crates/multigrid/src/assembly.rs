//! Sums of small dense matrices over groups of nodes.

use crate::matrix::BlockMatrix;
use crate::parallel::PIECE;
use crate::pattern::{Groups, Pattern};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Entries of matrices that are in memory at a time, about: 8 MB, more than all threads need to have work, and little beside the matrix of a body.
const BATCH: usize = 1 << 20;
/// Groups that one thread works out at a time.
// The matrices of 64 hexahedra of eight nodes have 300 kB and fit into the second cache of a core.
const PART: usize = 64;

impl<const D: usize> BlockMatrix<D, D> {
    /// `Σ_g K_g`: `matrix(groups, entries)` fills `entries`, zero before, with the symmetric matrices of some groups, one after the other,
    /// each `[nodes · D × nodes · D]`, or stops all with an error.
    ///
    /// The matrices of some groups at a time are worked out on all threads; then each thread adds them into rows of its own.
    /// Each block is a sum in the order of the groups, the same on any number of threads.
    ///
    /// # Errors
    /// The first of those that `matrix` gives.
    pub fn assemble<E: Send>(
        pattern: Arc<Pattern>,
        groups: &Groups,
        matrix: impl Fn(Range<usize>, &mut [f64]) -> Result<(), E> + Sync,
    ) -> Result<BlockMatrix<D, D>, E> {
        let mut sum = BlockMatrix::zero(pattern);
        sum.add(groups, matrix)?;
        Ok(sum)
    }

    /// Adds the matrices of more groups, all of whose pairs are in the pattern; blocks that are not are left out.
    ///
    /// # Errors
    /// As [`BlockMatrix::assemble`].
    pub fn add<E: Send>(
        &mut self,
        groups: &Groups,
        matrix: impl Fn(Range<usize>, &mut [f64]) -> Result<(), E> + Sync,
    ) -> Result<(), E> {
        let pattern = self.pattern.clone();
        let threads = rayon::current_num_threads();
        let size = |group: usize| (groups.of(group).len() * D).pow(2);
        let mut end = 0;
        while end < groups.len() {
            let first = end;
            let mut entries = 0;
            while end < groups.len() && entries < BATCH {
                entries += size(end);
                end += 1;
            }
            let batch: Vec<usize> = (first..end).collect();
            let parts: Vec<Result<Vec<f64>, E>> = batch
                .par_chunks(PART)
                .map(|part| {
                    let mut entries = vec![0.0; part.iter().map(|&group| size(group)).sum()];
                    matrix(part[0]..part[0] + part.len(), &mut entries)?;
                    Ok(entries)
                })
                .collect();
            // The errors are looked through in the order of the groups, so that the same one is told on any number of threads.
            let parts = parts.into_iter().collect::<Result<Vec<Vec<f64>>, E>>()?;
            let touched = batch.iter().flat_map(|&group| groups.of(group)).copied();
            let (low, high) = touched.fold((u32::MAX, 0), |(low, high), node| (low.min(node), high.max(node)));
            // Groups without nodes touch no row; the fold then has its start.
            if low > high {
                continue;
            }
            let (low, high) = (low as usize, high as usize + 1);
            // A piece for each thread, unless it would be too short to be worth one.
            let share = (high - low).div_ceil(threads).max(PIECE / 16);
            let mut pieces = Vec::new();
            let mut rest = &mut self.values[pattern.starts[low]..pattern.starts[high]];
            for begin in (low..high).step_by(share) {
                let end = (begin + share).min(high);
                let (own, others) = rest.split_at_mut(pattern.starts[end] - pattern.starts[begin]);
                pieces.push((begin..end, own));
                rest = others;
            }
            // Each thread goes through all groups of the batch and adds what falls into its rows: no lock is needed, and each block is
            // summed in the order of the groups.
            pieces.into_par_iter().for_each(|(rows, values)| {
                let before = pattern.starts[rows.start];
                for (part, entries) in batch.chunks(PART).zip(&parts) {
                    let mut offset = 0;
                    for &group in part {
                        let nodes = groups.of(group);
                        let width = nodes.len() * D;
                        for (a, &row) in nodes.iter().enumerate().filter(|(_, row)| rows.contains(&(**row as usize))) {
                            for (b, &column) in nodes.iter().enumerate() {
                                let Some(place) = pattern.place(row as usize, column as usize) else { continue };
                                let block = &mut values[place - before];
                                for i in 0..D {
                                    let from = offset + (a * D + i) * width + b * D;
                                    let entries = &entries[from..from + D];
                                    (0..D).for_each(|j| block[i][j] += entries[j]);
                                }
                            }
                        }
                        offset += width * width;
                    }
                }
            });
        }
        Ok(())
    }
}
