//! Symplectic Euler of a prepared network without an account: positions, velocities and forces stay in rows, four numbers for each
//! point in the numbers of the network, so that a step is one pass over the springs and one over the points.

use super::motion::Motion;
use super::pass::{self, PIECE};
use super::state::MotionState;
use crate::model::{RowForces, Rows, origin};
use crate::scalar::{Coordinate, Coordinates, CoordinatesWork, with_coordinates};
use rayon::prelude::*;
use std::fmt::Debug;

/// Rows that one thread takes at a time.
// A row has four numbers, of which a body in space uses three: these rows have as many numbers as a piece.
const ROWS: usize = PIECE / 4;

/// A motion in rows.
pub(super) trait RowMotion: Debug {
    /// Starts from a state; false if the model has no forces there.
    fn start(&mut self, state: &MotionState) -> bool;

    /// Replaces the loads, `[points · dimension]`, N.
    fn load(&mut self, loads: &[f64]);

    /// Makes a step, at whose end these degrees of freedom have the displacement in m and the velocity in m/s beside them. If the model
    /// has no forces there, the state is the one before up to rounding, and the answer is false.
    fn step(&mut self, driven: &[(usize, [f64; 2])]) -> bool;

    /// Whether no displacement is larger than this, m, and every velocity is a number.
    fn is_within(&self, largest: f64) -> bool;

    /// Writes displacements and velocities.
    fn write(&self, state: &mut MotionState);
}

/// The motion in steps of h, s, of a model that is a prepared network; `inverse` is 1/m of the degrees of freedom that are not held, zero
/// of the others, 1/kg.
pub(super) fn row_motion<'a>(motion: &Motion<'a>, h: f64, inverse: &[f64]) -> Option<Box<dyn RowMotion + 'a>> {
    let d = motion.dimension();
    Some(match motion.model.rows()? {
        Rows::Double(network) => Box::new(NetworkRows::new(network, d, motion.points, h, inverse)),
        Rows::Single(network) => Box::new(NetworkRows::new(network, d, motion.points, h, inverse)),
    })
}

#[derive(Debug)]
struct NetworkRows<'a, N> {
    network: &'a dyn RowForces<N>,
    dimension: usize,
    h: N,
    /// The positions at rest, m, from a place that all points share.
    rest: Vec<[N; 4]>,
    /// `h M⁻¹`, s/kg.
    share: Vec<[N; 4]>,
    /// f, N; none if no load acts.
    loads: Vec<[N; 4]>,
    u: Vec<[N; 4]>,
    v: Vec<[N; 4]>,
    x: Vec<[N; 4]>,
    /// The forces at x as (z, x, y).
    force: Vec<[N; 4]>,
    /// Displacement and velocity of the driven degrees of freedom before the last step.
    before: Vec<(usize, [N; 2])>,
}

impl<'a, N: Coordinate> NetworkRows<'a, N> {
    fn new(
        network: &'a dyn RowForces<N>,
        dimension: usize,
        points: &[f64],
        h: f64,
        inverse: &[f64],
    ) -> NetworkRows<'a, N> {
        let origin = origin::<N>(points, dimension);
        // A body far from the origin would lose the digits of its own size in single precision.
        let near: Vec<f64> = points.iter().enumerate().map(|(i, x)| x - origin[i % dimension]).collect();
        let rest = rows(&near, dimension, N::of);
        let share = rows(inverse, dimension, |inverse| N::of(h * inverse));
        let [u, v, x, force] = std::array::from_fn(|_| vec![[N::zero(); 4]; rest.len()]);
        let (h, loads, before) = (N::of(h), Vec::new(), Vec::new());
        NetworkRows { network, dimension, h, rest, share, loads, u, v, x, force, before }
    }

    /// Computes the forces at x; false if there are none.
    fn pull(&mut self) -> bool {
        self.network.pull_rows(&self.x, &mut self.force) && pass::all(self.force.as_flattened(), N::is_finite)
    }

    /// Sets displacement and velocity of one degree of freedom.
    fn set(&mut self, dof: usize, [u, v]: [N; 2]) {
        let (row, k) = (dof / self.dimension, dof % self.dimension);
        (self.u[row][k], self.v[row][k]) = (u, v);
        self.x[row][k] = self.rest[row][k] + u;
    }

    /// Undoes the last step.
    fn step_back(&mut self) {
        let (h, before) = (self.h, std::mem::take(&mut self.before));
        let moved = self.u.as_flattened_mut().iter_mut().zip(self.v.as_flattened());
        moved.for_each(|(u, v)| *u = *u - h * *v);
        for &(dof, was) in &before {
            self.set(dof, was);
        }
        pass::place(self.x.as_flattened_mut(), self.rest.as_flattened(), self.u.as_flattened());
        self.pull();
        for (row, v) in self.v.iter_mut().enumerate() {
            for k in 0..3 {
                let load = self.loads.get(row).map_or(N::zero(), |load| load[k]);
                // The forces come as (z, x, y).
                v[k] = v[k] - self.share[row][k] * (load - self.force[row][(k + 1) % 3]);
            }
        }
    }
}

impl<N: Coordinate> RowMotion for NetworkRows<'_, N> {
    fn start(&mut self, state: &MotionState) -> bool {
        self.u = rows(&state.displacement, self.dimension, N::of);
        self.v = rows(&state.velocity, self.dimension, N::of);
        pass::place(self.x.as_flattened_mut(), self.rest.as_flattened(), self.u.as_flattened());
        self.pull()
    }

    fn load(&mut self, loads: &[f64]) {
        // No list for bodies without loads: each step would read zeros of all points.
        self.loads = if loads.iter().all(|f| *f == 0.0) { Vec::new() } else { rows(loads, self.dimension, N::of) };
    }

    fn step(&mut self, driven: &[(usize, [f64; 2])]) -> bool {
        let NetworkRows { rest, share, loads, u, v, x, force, h, .. } = self;
        let whole = Points { h: *h, rest, share, loads, force, u, v, x };
        match whole.rest.len() {
            0..=ROWS => with_coordinates(whole),
            // Each row depends on itself alone: threads do not change it.
            _ => whole.pieces().into_par_iter().for_each(|piece| with_coordinates(piece)),
        }
        self.before.clear();
        for &(dof, end) in driven {
            let (row, k) = (dof / self.dimension, dof % self.dimension);
            // The pass has moved a driven point by h v, and its share of zero has kept v.
            self.before.push((dof, [self.u[row][k] - self.h * self.v[row][k], self.v[row][k]]));
            self.set(dof, end.map(N::of));
        }
        let is_sound = self.pull();
        if !is_sound {
            self.step_back();
        }
        is_sound
    }

    fn is_within(&self, largest: f64) -> bool {
        pass::all(self.u.as_flattened(), |u: N| u.wide().abs() <= largest)
            && pass::all(self.v.as_flattened(), N::is_finite)
    }

    fn write(&self, state: &mut MotionState) {
        for (numbers, rows) in [(&mut state.displacement, &self.u), (&mut state.velocity, &self.v)] {
            for (numbers, row) in numbers.chunks_exact_mut(self.dimension).zip(rows) {
                numbers.iter_mut().zip(row).for_each(|(x, own)| *x = own.wide());
            }
        }
    }
}

/// Rows of numbers, `[points · dimension]`, completed by zeros.
fn rows<N: Coordinate>(numbers: &[f64], dimension: usize, number: impl Fn(f64) -> N) -> Vec<[N; 4]> {
    let row = |numbers: &[f64]| std::array::from_fn(|k| numbers.get(k).map_or(N::zero(), |x| number(*x)));
    numbers.chunks_exact(dimension).map(row).collect()
}

/// `v ← v + h M⁻¹ (f − F)`, `u ← u + h v`, `x = X + u` of some points.
struct Points<'a, N> {
    h: N,
    rest: &'a [[N; 4]],
    share: &'a [[N; 4]],
    loads: &'a [[N; 4]],
    force: &'a [[N; 4]],
    u: &'a mut [[N; 4]],
    v: &'a mut [[N; 4]],
    x: &'a mut [[N; 4]],
}

impl<'a, N: Coordinate> Points<'a, N> {
    fn pieces(self) -> Vec<Points<'a, N>> {
        let Points { h, rest, share, loads, force, u, v, x } = self;
        let changed = u.chunks_mut(ROWS).zip(v.chunks_mut(ROWS)).zip(x.chunks_mut(ROWS));
        let given = rest.chunks(ROWS).zip(share.chunks(ROWS)).zip(force.chunks(ROWS));
        let of = |(at, (((rest, share), force), ((u, v), x)))| {
            // The list is empty where no load acts.
            let loads = loads.chunks(ROWS).nth(at).unwrap_or_default();
            Points { h, rest, share, loads, force, u, v, x }
        };
        given.zip(changed).enumerate().map(of).collect()
    }
}

impl<N: Coordinate> CoordinatesWork<N> for Points<'_, N> {
    type Output = ();

    #[inline(always)]
    fn run<C: Coordinates<N>>(self, zero: C) {
        let Points { h, rest, share, loads, force, u, v, x } = self;
        let count = rest.len();
        // Slices of one known length need no test of bounds in the loop.
        let (share, force) = (&share[..count], &force[..count]);
        let (u, v, x) = (&mut u[..count], &mut v[..count], &mut x[..count]);
        for row in 0..count {
            let load = loads.get(row).map_or(zero, |load| zero.load(load));
            let pull = load.minus(zero.load(&force[row]).turned());
            let next = zero.load(&v[row]).plus(zero.load(&share[row]).times(pull));
            let moved = zero.load(&u[row]).plus(next.scaled(h));
            next.store(&mut v[row]);
            moved.store(&mut u[row]);
            zero.load(&rest[row]).plus(moved).store(&mut x[row]);
        }
    }
}
