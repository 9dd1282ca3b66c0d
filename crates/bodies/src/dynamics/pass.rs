//! Passes over the degrees of freedom: on all threads where there are many, with the same bits on any number of them.

use crate::scalar::Coordinate;
use rayon::prelude::*;

/// Degrees of freedom that one thread takes at a time. A shorter pass stays on the calling thread: to wake another would take longer.
pub(super) const PIECE: usize = 1 << 16;

/// Whether all numbers pass the test.
pub(super) fn all<N: Coordinate>(numbers: &[N], test: impl Fn(N) -> bool + Sync) -> bool {
    // Without an early end the compiler tests several numbers at a time.
    let piece = |numbers: &[N]| numbers.iter().fold(true, |all, x| all & test(*x));
    match numbers.len() {
        0..=PIECE => piece(numbers),
        _ => numbers.par_chunks(PIECE).map(piece).reduce(|| true, |a, b| a & b),
    }
}

/// `x ← p + u`.
pub(super) fn place<N: Coordinate>(x: &mut [N], p: &[N], u: &[N]) {
    let piece = |(x, p, u): (&mut [N], &[N], &[N])| {
        x.iter_mut().zip(p).zip(u).for_each(|((x, p), u)| *x = *p + *u);
    };
    match x.len() {
        0..=PIECE => piece((x, p, u)),
        // Each number depends on those at its own place alone: threads do not change it.
        _ => (x.par_chunks_mut(PIECE), p.par_chunks(PIECE), u.par_chunks(PIECE)).into_par_iter().for_each(piece),
    }
}

/// What a step of symplectic Euler changes.
pub(super) struct Changed<'a> {
    pub displacement: &'a mut [f64],
    pub way: &'a mut [f64],
    pub velocity: &'a mut [f64],
}

/// The velocities before a step, the forces at that time, and the inverse masses.
pub(super) struct Given<'a> {
    pub velocity: &'a [f64],
    pub external: &'a [f64],
    pub elastic: &'a [f64],
    pub viscous: &'a [f64],
    pub inverse: &'a [f64],
}

/// `v ← v + h M⁻¹ (f − C v − F)`, `u ← u + h v`.
pub(super) fn leap(h: f64, changed: Changed, given: Given) {
    type Pieces<'a> = (&'a mut [f64], &'a mut [f64], &'a mut [f64], [&'a [f64]; 5]);
    let piece = |(u, way, next, [v, f, elastic, viscous, inverse]): Pieces| {
        let loads = f.iter().zip(elastic).zip(viscous).zip(inverse);
        for (((u, v), (way, next)), (((f, elastic), viscous), inverse)) in
            u.iter_mut().zip(v).zip(way.iter_mut().zip(next)).zip(loads)
        {
            *next = v + h * inverse * (f - elastic - viscous);
            *way = h * *next;
            *u += *way;
        }
    };
    let Changed { displacement: u, way, velocity: next } = changed;
    let given = [given.velocity, given.external, given.elastic, given.viscous, given.inverse];
    match u.len() {
        0..=PIECE => piece((u, way, next, given)),
        _ => {
            // A number depends on those of its own place alone, so that threads do not change it.
            let of = |at: usize| given.map(|list| &list[at * PIECE..(at * PIECE + PIECE).min(list.len())]);
            let pieces = (u.par_chunks_mut(PIECE), way.par_chunks_mut(PIECE), next.par_chunks_mut(PIECE));
            pieces.into_par_iter().enumerate().for_each(|(at, (u, way, next))| piece((u, way, next, of(at))));
        }
    }
}
