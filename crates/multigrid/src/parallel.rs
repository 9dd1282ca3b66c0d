//! Loops over rows on all threads, and sums whose order does not depend on the number of threads.

use crate::entry::Entry;
use rayon::prelude::*;
use std::ops::Range;

/// Rows that one task takes at least: fixed, so that sums over these pieces are the same on any number of threads.
pub(crate) const PIECE: usize = 2048;

/// `work` in the widest vector instructions of the machine.
#[inline(always)]
pub(crate) fn vectorized<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}

/// `Σ x·y` of each vector, piece by piece.
pub(crate) fn dot<T: Entry, const N: usize>(x: &[[T; N]], y: &[[T; N]]) -> T {
    let piece = |(x, y): (&[[T; N]], &[[T; N]])| -> T {
        vectorized(
            #[inline(always)]
            || {
                // N sums do not wait for each other, and the compiler may not reorder one.
                let mut sums = [T::ZERO; N];
                for (x, y) in x.iter().zip(y) {
                    for i in 0..N {
                        sums[i] += x[i] * y[i];
                    }
                }
                sums.into_iter().fold(T::ZERO, T::add)
            },
        )
    };
    // One piece has the same sum either way, without a list and a task.
    if x.len() <= PIECE {
        return piece((x, y));
    }
    let parts: Vec<T> = x.par_chunks(PIECE).zip(y.par_chunks(PIECE)).map(piece).collect();
    parts.into_iter().fold(T::ZERO, T::add)
}

/// `y ← a y + b x`.
pub(crate) fn combine<T: Entry, const N: usize>(y: &mut [[T; N]], a: T, x: &[[T; N]], b: T) {
    // Entries are independent of each other, so that threads do not change them.
    y.par_chunks_mut(PIECE).zip(x.par_chunks(PIECE)).for_each(|(y, x)| {
        vectorized(
            #[inline(always)]
            || {
                for (y, x) in y.as_flattened_mut().iter_mut().zip(x.as_flattened()) {
                    *y = a * *y + b * *x;
                }
            },
        );
    });
}

/// Calls `fill(row, entries)` for each row of a ragged array whose rows begin at `starts`, `[rows + 1]`. Each task has a `room` of its own.
pub(crate) fn fill_rows<T: Send, S>(
    starts: &[usize],
    entries: &mut [T],
    room: impl Fn() -> S + Sync,
    fill: impl Fn(&mut S, usize, &mut [T]) + Sync,
) {
    fn part<T: Send, S>(
        starts: &[usize],
        rows: Range<usize>,
        entries: &mut [T],
        room: &(impl Fn() -> S + Sync),
        fill: &(impl Fn(&mut S, usize, &mut [T]) + Sync),
    ) {
        if rows.len() > PIECE {
            // Rows are filled independently of each other: where they are split changes no result.
            let middle = rows.start + rows.len() / 2;
            let (before, after) = entries.split_at_mut(starts[middle] - starts[rows.start]);
            rayon::join(
                || part(starts, rows.start..middle, before, room, fill),
                || part(starts, middle..rows.end, after, room, fill),
            );
            return;
        }
        let mut room = room();
        let mut rest = entries;
        for row in rows {
            let (own, others) = rest.split_at_mut(starts[row + 1] - starts[row]);
            fill(&mut room, row, own);
            rest = others;
        }
    }
    part(starts, 0..starts.len() - 1, entries, &room, &fill);
}

/// The entries of each row, which `list(room, row, entries)` appends: where the rows begin, and all entries.
pub(crate) fn list_rows<T: Send + Copy, S>(
    rows: usize,
    room: impl Fn() -> S + Sync,
    list: impl Fn(&mut S, usize, &mut Vec<T>) + Sync,
) -> (Vec<usize>, Vec<T>) {
    let firsts: Vec<usize> = (0..rows).step_by(PIECE).collect();
    let piece = |first: &usize| {
        let (mut room, mut entries, mut ends) = (room(), Vec::new(), Vec::new());
        for row in *first..(first + PIECE).min(rows) {
            list(&mut room, row, &mut entries);
            ends.push(entries.len());
        }
        (ends, entries)
    };
    // Pieces are joined in the order of their rows, whichever thread has made them.
    let parts: Vec<(Vec<usize>, Vec<T>)> = firsts.par_iter().map(piece).collect();
    let total = parts.iter().map(|(_, entries)| entries.len()).sum();
    let (mut starts, mut all) = (Vec::with_capacity(rows + 1), Vec::with_capacity(total));
    starts.push(0);
    for (ends, entries) in parts {
        let before = all.len();
        starts.extend(ends.iter().map(|end| before + end));
        all.extend(entries);
    }
    (starts, all)
}
