//! The equations of an implicit step, solved by conjugate gradients (Hestenes and Stiefel 1952).

use super::blocks::{Block, Pattern};
use super::equations::{End, Equations, Solved};
use super::incomplete::Incomplete;
use crate::error::{Error, ErrorKind, Result};
use crate::model::places;
use crate::scalar::{Coordinates, CoordinatesWork, with_coordinates};

/// The relative residual to which definiteness is tested, whatever the tolerance of solutions is.
// The random force has a share of about `1/√n` along each of n motions, 1e-3 with a million of them, and the residual keeps it along a
// direction of negative curvature. A share as small as the bound has a chance of 1e-7.
const DEFINITE: f64 = 1e-10;
/// The largest number of iterations of a solution. A step whose equations take as many is reported as stalled; a
/// shorter one has better equations.
const ITERATIONS: usize = 5000;

/// The matrix in blocks of one point with D coordinates, and its incomplete factor. Held coordinates of a point that is
/// partly free have an equation `x = 0` of their own.
#[derive(Debug)]
pub(super) struct Gradients<const D: usize> {
    /// The degree of freedom of each row.
    order: Vec<usize>,
    /// The index of each row in vectors of all coordinates.
    coordinates: Vec<u32>,
    pattern: Pattern,
    /// The blocks of the diagonal, the other blocks, and one for the entries of held degrees of freedom.
    blocks: Vec<Block<D>>,
    /// The index to which each entry is added.
    slots: Vec<u32>,
    incomplete: Incomplete<D>,
    tolerance: f64,
    x: Vec<[f64; 4]>,
    residual: Vec<[f64; 4]>,
    toward: Vec<[f64; 4]>,
    along: Vec<[f64; 4]>,
    image: Vec<[f64; 4]>,
}

impl<const D: usize> Gradients<D> {
    /// For entries at these positions of the lower triangle; the diagonal is always included.
    ///
    /// # Errors
    /// There are more than 2³² entries.
    pub fn new(entries: &[(usize, usize)], held: &[bool], tolerance: f64) -> Result<Gradients<D>> {
        let mut pairs: Vec<(usize, usize)> = entries.iter().map(|(row, column)| (row / D, column / D)).collect();
        // The entries of a block of coordinates all name one pair of points.
        pairs.sort_unstable();
        pairs.dedup();
        let is_row: Vec<bool> = held.chunks(D).map(|held| held.contains(&false)).collect();
        let place = places(&pairs, &is_row);
        let rows = is_row.iter().filter(|is_row| **is_row).count();
        let pattern = Pattern::new(&pairs, &place, rows);
        let count = rows + pattern.columns.len();
        if u32::try_from((count + 1) * D * 4).is_err() {
            let problem = "the equations cannot be built: more than 2³² entries";
            return Err(Error::new(problem).of_kind(ErrorKind::Limit));
        }
        let slot = |&(row, column): &(usize, usize)| {
            let (a, b) = (place[row / D], place[column / D]);
            // Rows have four numbers, so that each is one load of a register.
            let within = |block: usize, k: usize, l: usize| (block * D + k) * 4 + l;
            let at = if held[row] || held[column] {
                within(count, 0, 0)
            } else if a == b {
                within(a, row % D, column % D)
            } else {
                // The block above the diagonal is stored; an entry below it in this order is turned.
                let (k, l) = if a < b { (row % D, column % D) } else { (column % D, row % D) };
                within(rows + pattern.find(a.min(b), a.max(b)).unwrap_or(count - rows), k, l)
            };
            at as u32
        };
        let slots = entries.iter().map(slot).collect();
        let mut points: Vec<usize> = (0..is_row.len()).filter(|point| is_row[*point]).collect();
        // Rows of the pattern are numbered by place.
        points.sort_unstable_by_key(|point| place[*point]);
        let order: Vec<usize> = points.iter().flat_map(|p| p * D..(p + 1) * D).filter(|dof| !held[*dof]).collect();
        let coordinates = order.iter().map(|dof| (place[dof / D] * 4 + dof % D) as u32).collect();
        let incomplete = Incomplete::new(&pattern);
        let [x, residual, toward, along, image] = std::array::from_fn(|_| vec![[0.0; 4]; rows]);
        let blocks = vec![[[0.0; 4]; D]; count + 1];
        Ok(Gradients {
            order,
            coordinates,
            pattern,
            blocks,
            slots,
            incomplete,
            tolerance,
            x,
            residual,
            toward,
            along,
            image,
        })
    }
}

impl<const D: usize> Equations for Gradients<D> {
    fn order(&self) -> &[usize] {
        &self.order
    }

    fn set_diagonal(&mut self, diagonal: &dyn Fn(usize) -> f64) {
        self.blocks.fill([[0.0; 4]; D]);
        let rows = self.pattern.rows();
        // Held coordinates keep their equation `x = 0`; what is free is overwritten below.
        self.blocks[..rows].iter_mut().for_each(|block| (0..D).for_each(|k| block[k][k] = 1.0));
        for (&dof, &at) in self.order.iter().zip(&self.coordinates) {
            let (row, k) = (at as usize / 4, at as usize % 4);
            self.blocks[row][k][k] = diagonal(dof);
        }
    }

    fn add(&mut self, first: usize, factor: f64, values: &[f64]) {
        let entries = self.blocks.as_flattened_mut().as_flattened_mut();
        for (value, &slot) in values.iter().zip(&self.slots[first..]) {
            entries[slot as usize] += factor * value;
        }
    }

    fn shift(&mut self, share: f64) {
        let places = || self.coordinates.iter().map(|&at| (at as usize / 4, at as usize % 4));
        let size = places().map(|(row, k)| self.blocks[row][k][k].abs()).fold(0.0, f64::max);
        places().for_each(|(row, k)| self.blocks[row][k][k] += share * size);
    }

    fn prepare(&mut self) -> bool {
        let rows = self.pattern.rows();
        for block in &mut self.blocks[..rows] {
            // Entries are those of the lower triangle of the whole matrix, so that blocks on its diagonal lack their
            // upper one.
            (0..D).for_each(|k| (0..k).for_each(|l| block[l][k] = block[k][l]));
        }
        let count = self.blocks.len() - 1;
        self.incomplete.refill(&self.blocks[..count])
    }

    /// Before a direction of negative curvature is found, the residual along it does not decrease: so small a residual
    /// of a random force proves that there is no such direction. Iterations that do not reach this residual prove
    /// nothing.
    fn is_definite(&mut self, is_prepared: bool, x: &mut [f64]) -> Option<bool> {
        // A user may ask for rough solutions, but a rough residual proves nothing.
        let tolerance = std::mem::replace(&mut self.tolerance, DEFINITE);
        let end = is_prepared.then(|| self.solve(x, None).end);
        self.tolerance = tolerance;
        match end? {
            End::Exact => Some(true),
            End::Indefinite => Some(false),
            End::Rough => None,
        }
    }

    fn solve(&mut self, x: &mut [f64], guess: Option<&[f64]>) -> Solved {
        self.x.fill([0.0; 4]);
        self.residual.fill([0.0; 4]);
        let residual = self.residual.as_flattened_mut();
        self.coordinates.iter().zip(&*x).for_each(|(&at, b)| residual[at as usize] = *b);
        if let Some(guess) = guess {
            let start = self.x.as_flattened_mut();
            self.coordinates.iter().zip(&self.order).for_each(|(&at, &dof)| start[at as usize] = guess[dof]);
        }
        let solved = with_coordinates(Iterations { equations: self, is_guessed: guess.is_some() });
        let found = self.x.as_flattened();
        x.iter_mut().zip(&self.coordinates).for_each(|(x, &at)| *x = found[at as usize]);
        solved
    }
}

/// Iterations from x until the residual is small.
struct Iterations<'a, const D: usize> {
    equations: &'a mut Gradients<D>,
    /// Whether x is a guess, which is dropped if zero is better.
    is_guessed: bool,
}

impl<const D: usize> CoordinatesWork for Iterations<'_, D> {
    type Output = Solved;

    #[inline(always)]
    fn run<C: Coordinates>(self, zero: C) -> Solved {
        let Gradients { pattern, blocks, incomplete, tolerance, x, residual, toward, along, image, .. } =
            self.equations;
        let matrix = &blocks[..blocks.len() - 1];
        let mut left = square(zero, residual);
        // Relative to the force and not to the first residual: a good guess is to save iterations, not to be improved.
        let size = *tolerance * left.sqrt();
        if self.is_guessed {
            pattern.multiply(zero, matrix, x, image);
            toward.copy_from_slice(residual);
            let after = combine(zero, toward, -1.0, image);
            if after < left {
                std::mem::swap(residual, toward);
                left = after;
            } else {
                x.fill([0.0; 4]);
            }
        }
        let (mut last, mut iterations) = (0.0, 0);
        let done = |end, iterations| Solved { end, iterations };
        // In this form a residual that is NaN goes on to the test of the curvature, which ends the iterations.
        while !(left.sqrt() <= size) {
            if iterations == ITERATIONS {
                return done(End::Rough, iterations);
            }
            let now = incomplete.solve(zero, residual, toward);
            let share = if iterations == 0 { 0.0 } else { now / last };
            for (along, toward) in along.iter_mut().zip(&*toward) {
                zero.load(toward).plus_scaled(share, zero.load(along)).store(along);
            }
            let curvature = pattern.multiply(zero, matrix, along, image);
            iterations += 1;
            // The second: the preconditioner, rounded to single precision, is not definite along the residual. The
            // third: the curvature is so small that the step would not be a number.
            if !(curvature > 0.0 && now > 0.0 && now / curvature < f64::INFINITY) {
                return done(End::Indefinite, iterations);
            }
            let length = now / curvature;
            combine(zero, x, length, along);
            left = combine(zero, residual, -length, image);
            last = now;
        }
        done(End::Exact, iterations)
    }
}

/// `|a|²`.
#[inline(always)]
fn square<C: Coordinates>(zero: C, a: &[[f64; 4]]) -> f64 {
    a.iter().fold(zero, |sum, a| sum.plus_products(zero.load(a), zero.load(a))).dot(zero.load(&[1.0; 4]))
}

/// `a ← a + factor b`, and `|a|²`.
#[inline(always)]
fn combine<C: Coordinates>(zero: C, a: &mut [[f64; 4]], factor: f64, b: &[[f64; 4]]) -> f64 {
    let mut sum = zero;
    for (a, b) in a.iter_mut().zip(b) {
        let new = zero.load(a).plus_scaled(factor, zero.load(b));
        new.store(a);
        sum = sum.plus_products(new, new);
    }
    sum.dot(zero.load(&[1.0; 4]))
}
