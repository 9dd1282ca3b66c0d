//! The motions that meet least and most resistance, measured by another matrix.

use crate::block::softest;
use crate::fault::Fault;
use crate::hierarchy::Multigrid;
use crate::matrix::BlockMatrix;
use crate::parallel::{combine, dot};
use crate::random::Random;
use crate::settings::{Event, Watch};

/// The quotient is found once it changes by less than this share of itself.
// The least quotient of a box of hexahedra with a network is 2e-3 too large then, after 20 steps. With 1e-2 it is
// 1.2e-2 too large after 11, with 1e-4 3e-4 after 30.
const SETTLED: f64 = 1e-3;
/// The number of such changes, one after the other, that are needed: a search may rest on a saddle for a step or two.
// With one such change it is 4e-3 too large, after three steps fewer.
const TIMES: usize = 4;

/// Which end of the quotients.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The least quotient.
    Least,
    /// The largest quotient.
    Largest,
}

/// A motion with the quotient of its energies.
#[derive(Debug, Clone, PartialEq)]
pub struct Extreme {
    /// `xᵀ A x / xᵀ B x`.
    pub quotient: f64,
    /// `xᵀ B x = 1`.
    pub displacement: Vec<f64>,
    /// Iterations of the method.
    pub iterations: usize,
    /// Whether the quotient has stopped changing.
    pub is_settled: bool,
}

/// A direction with its images.
#[derive(Clone)]
struct Direction<const D: usize> {
    x: Vec<[f64; D]>,
    ax: Vec<[f64; D]>,
    bx: Vec<[f64; D]>,
}

impl<const D: usize> Direction<D> {
    fn add(&mut self, factor: f64, other: &Direction<D>) {
        combine(&mut self.x, 1.0, &other.x, factor);
        combine(&mut self.ax, 1.0, &other.ax, factor);
        combine(&mut self.bx, 1.0, &other.bx, factor);
    }

    fn scale(&mut self, factor: f64) {
        for vector in [&mut self.x, &mut self.ax, &mut self.bx] {
            vector.as_flattened_mut().iter_mut().for_each(|x| *x *= factor);
        }
    }
}

impl<const D: usize, const M: usize> Multigrid<D, M> {
    /// The least or largest quotient `xᵀ A x / xᵀ B x` over the motions of what is not held, A the matrix that is `measured`, B another, positive one;
    /// the levels are those of one that is like A or B. `start` is where to begin, if something is known.
    ///
    /// Knyazev's locally optimal method (SIAM J. Sci. Comput. 23, 2001) with one vector: the best of the motion, its preconditioned
    /// residual, and the last step. Each iteration takes one product with A and B and one V-cycle. Every quotient that it meets is that of a
    /// motion: it is never beyond the true one.
    ///
    /// # Errors
    /// The sizes do not agree, B is not positive, numbers are not finite, or the watch broke off.
    pub fn extreme(
        &self,
        end: End,
        measured: &BlockMatrix<D, D>,
        by: &BlockMatrix<D, D>,
        start: Option<&[f64]>,
        steps: usize,
        watch: &mut Watch,
    ) -> Result<Extreme, Fault> {
        let rows = self.rows();
        for (what, found) in [("the rows", measured.rows()), ("the rows", by.rows())] {
            if found != rows {
                return Err(Fault::Size { what, expected: rows, found });
            }
        }
        // The largest quotient of A is the least of −A: one search for a least one serves both ends.
        let sign = match end {
            End::Least => 1.0,
            End::Largest => -1.0,
        };
        let images = |mut x: Vec<[f64; D]>| {
            self.mask(&mut x);
            let (mut ax, mut bx) = (vec![[0.0; D]; rows], vec![[0.0; D]; rows]);
            measured.apply(&x, &mut ax);
            by.apply(&x, &mut bx);
            self.mask(&mut ax);
            self.mask(&mut bx);
            Direction { x, ax, bx }
        };
        let start = match start {
            Some(start) if start.len() == rows * D => start.as_chunks::<D>().0.to_vec(),
            Some(start) => return Err(Fault::Size { what: "the motion", expected: rows * D, found: start.len() }),
            None => Random::new(11).vector(rows),
        };
        let mut room = self.workspace();
        // A smooth motion to begin with.
        let mut smooth = start.clone();
        if !by.values().is_empty() {
            let mut force = vec![[0.0; D]; rows];
            by.apply(&start, &mut force);
            self.apply(&force, &mut smooth, &mut room);
        }
        let mut best = images(smooth);
        // Where nothing is free there is no quotient; 1 is that of equal matrices.
        if !normalize(&mut best)? {
            return Ok(Extreme { quotient: 1.0, displacement: vec![0.0; rows * D], iterations: 0, is_settled: true });
        }
        let mut last: Option<Direction<D>> = None;
        let mut quotient = dot(&best.x, &best.ax);
        let mut settled = 0;
        for k in 1..=steps {
            let mut residual = best.ax.clone();
            combine(&mut residual, 1.0, &best.bx, -quotient);
            let mut w = vec![[0.0; D]; rows];
            self.apply(&residual, &mut w, &mut room);
            let mut basis = vec![best.clone()];
            for mut direction in [Some(images(w)), last.take()].into_iter().flatten() {
                // Twice, because the first pass leaves rounding of what it takes out.
                for _ in 0..2 {
                    for own in &basis {
                        let along = dot(&own.bx, &direction.x);
                        direction.add(-along, own);
                    }
                    if !normalize(&mut direction)? {
                        break;
                    }
                }
                // A direction that depends on the others is only rounding, which has no length of one after it is
                // scaled.
                if (dot(&direction.x, &direction.bx) - 1.0).abs() < 1e-6 {
                    basis.push(direction);
                }
            }
            let m = basis.len();
            let mut projected = [[0.0; 3]; 3];
            for i in 0..m {
                for j in 0..=i {
                    projected[i][j] = sign * dot(&basis[i].x, &basis[j].ax);
                    projected[j][i] = projected[i][j];
                }
            }
            let weights = softest(&projected, &std::array::from_fn(|i| i < m));
            // The next step is kept without the part along the motion itself. As a difference of two iterates it would be lost to
            // cancellation near the end (Knyazev 2001).
            let mut step = Direction { x: vec![[0.0; D]; rows], ax: vec![[0.0; D]; rows], bx: vec![[0.0; D]; rows] };
            (1..m).for_each(|i| step.add(weights[i], &basis[i]));
            best.scale(weights[0]);
            best.add(1.0, &step);
            last = Some(step);
            if !normalize(&mut best)? {
                return Err(Fault::NotFinite);
            }
            let next = dot(&best.x, &best.ax);
            if !next.is_finite() {
                return Err(Fault::NotFinite);
            }
            let change = (quotient - next).abs();
            if watch(Event::Iteration { number: k, residual: change }).is_break() {
                return Err(Fault::Interrupted);
            }
            settled = if change <= SETTLED * next.abs() || m == 1 { settled + 1 } else { 0 };
            quotient = next;
            if settled == TIMES || m == 1 {
                let displacement = images(best.x).x.as_flattened().to_vec();
                return Ok(Extreme { quotient, displacement, iterations: k, is_settled: true });
            }
        }
        let displacement = best.x.as_flattened().to_vec();
        Ok(Extreme { quotient, displacement, iterations: steps, is_settled: false })
    }
}

/// `xᵀ B x = 1`; whether there is something to scale.
fn normalize<const D: usize>(direction: &mut Direction<D>) -> Result<bool, Fault> {
    let square = dot(&direction.x, &direction.bx);
    if !square.is_finite() {
        return Err(Fault::NotFinite);
    }
    if square > 0.0 {
        direction.scale(1.0 / square.sqrt());
    }
    Ok(square > 0.0)
}
