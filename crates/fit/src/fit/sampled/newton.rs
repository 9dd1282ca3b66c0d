//! Newton steps within bounds on the inner parameters of laws, with the outer ones eliminated by least squares
//! (variable projection, Golub and Pereyra 1973; the second derivatives are exact, Ruhe and Wedin 1980).
//!
//! Theory: page *Sampled fits* of the book.

use super::block::{Curved, Drawn};
use crate::error::Result;
use crate::fit::constrained::solve_nonnegative;
use crate::fit::normal::Rank;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// The largest number of steps. A start that is not there then is reported as not converged, and others may be.
const STEPS: usize = 100;
/// The damping beyond which no step is expected to help. Such a step is 1e-12 of that along the slope: if it does not
/// lower the sum, rounding or the bounds decide.
const STIFFEST: f64 = 1e12;
/// Where a step succeeds with less damping than this, the next one has none. Without damping the last steps are those
/// of Newton, which converge quadratically.
const SLIGHTEST: f64 = 1e-7;
/// The damping below which the promise of a step counts as that of Newton's. With more damping a step is short, and a
/// small promise is no sign of an optimum.
const SLIGHT: f64 = 1e-2;
/// The least share of the curvature in one unknown that the elimination of the outer ones leaves. The difference of the
/// two may vanish or be below zero by rounding, and a damping of nothing damps nothing.
const LEFT: f64 = 1e-10;
/// What is added to the diagonal of equations that are singular, as a share of it. It changes the step where the
/// equations determine it by no more than the promise that ends the search.
const RIDGE: f64 = 1e-12;

/// The problem of one start.
pub struct Descent<'a> {
    /// The bounds of each unknown.
    pub bounds: &'a [[f64; 2]],
    /// Whether an unknown is eliminated: the forces are linear in all of these.
    pub eliminated: &'a [bool],
    /// Whether the eliminated unknowns may not be negative.
    pub nonnegative: bool,
}

/// Where a descent has ended.
pub struct End {
    pub unknowns: Vec<f64>,
    pub sums: Curved,
    pub converged: bool,
    /// The number of steps that were tried.
    pub steps: usize,
}

impl End {
    /// Whether the sums have values.
    pub fn is_finite(&self) -> bool {
        let Curved { sums, bends } = &self.sums;
        let values = sums.normal.gram.iter().chain(&sums.normal.rhs).chain(bends);
        values.chain([&sums.square]).all(|value| value.is_finite())
    }
}

impl Descent<'_> {
    /// Minimises from `unknowns`. It has converged when a step cannot lower the sum of squares by more than the share
    /// `promise`.
    ///
    /// # Errors
    /// Those of drawing a shape.
    pub fn run(&self, shapes: &Drawn, unknowns: Vec<f64>, promised: f64) -> Result<End> {
        let mut end = self.at(shapes, unknowns)?;
        // A slight damping costs a start that is near an optimum little; it grows where steps fail.
        let mut damping = 1e-3;
        for steps in 0..STEPS {
            end.steps = steps;
            let sums = &end.sums.sums;
            if !end.is_finite() {
                return Ok(end);
            }
            let (step, promise) = loop {
                match self.step(&end, damping) {
                    Some(found) => break found,
                    None if damping > STIFFEST => return Ok(end),
                    // A factor alone would leave a damping of zero where it is.
                    None => damping = (10.0 * damping).max(1e-3),
                }
            };
            let slight = promise <= promised * sums.square.max(promised * sums.size);
            if slight && damping <= SLIGHT {
                return Ok(End { converged: true, ..end });
            }
            let tried = end.unknowns.iter().zip(&step).zip(self.bounds);
            let tried = tried.map(|((p, d), b)| (p + d).clamp(b[0], b[1])).collect();
            // A law may have no value far from the start.
            // The linear parameters follow at each trial: the sum is a function of the others alone.
            let after = self.at(shapes, tried)?;
            let gain = (sums.square - after.sums.sums.square) / promise;
            // A gain of one is what the quadratic model promises. Near one the model is trusted more, and with hardly
            // any gain the step is not taken (Nocedal and Wright 2006, chapter 4).
            if gain > 1e-4 && after.is_finite() {
                end = after;
                end.steps = steps + 1;
                damping *= if gain > 0.75 { 0.1 } else { 1.0 };
                damping = if damping < SLIGHTEST { 0.0 } else { damping };
            } else if slight {
                // What is promised is below the rounding of the sums.
                damping *= 0.1;
            } else {
                // A damping of nothing begins here, above the least that counts as some.
                damping = (10.0 * damping).max(1e-6);
                if damping > STIFFEST {
                    return Ok(end);
                }
            }
        }
        Ok(end)
    }

    /// The eliminated unknowns of least squares, and the sums there.
    fn at(&self, shapes: &Drawn, mut unknowns: Vec<f64>) -> Result<End> {
        self.eliminate(shapes, &mut unknowns, self.eliminated, self.nonnegative)?;
        let sums = shapes.sums(&unknowns, &vec![true; unknowns.len()])?;
        Ok(End { unknowns, sums, converged: false, steps: 0 })
    }

    /// Sets the unknowns of `outer`, in which the forces are linear, to those of least squares. If these are not known,
    /// because a law has no value, they stay as they are.
    ///
    /// # Errors
    /// Those of drawing a shape.
    pub fn eliminate(&self, shapes: &Drawn, unknowns: &mut [f64], outer: &[bool], nonnegative: bool) -> Result<()> {
        let set: Vec<usize> = (0..unknowns.len()).filter(|&i| outer[i]).collect();
        if set.is_empty() {
            return Ok(());
        }
        let at: Vec<f64> = unknowns.iter().zip(outer).map(|(p, outer)| if *outer { 0.0 } else { *p }).collect();
        let normal = shapes.sums(&at, outer)?.sums.normal.restricted(&set);
        // Inner parameters at which a force has no value say nothing of the outer ones, which stay as they are.
        if !normal.gram.iter().chain(&normal.rhs).all(|x| x.is_finite()) {
            return Ok(());
        }
        let (found, rank) = if nonnegative { solve_nonnegative(&normal) } else { normal.solve() };
        if rank != Rank::Unsolved {
            set.iter().zip(found).for_each(|(&i, value)| unknowns[i] = value);
        }
        Ok(())
    }

    /// The step of the unknowns that are not eliminated, `(S + μ D) d = −∇`, with S what the elimination leaves of the
    /// second derivatives and D its diagonal where residuals do not count; and the decrease of the sum of squares that
    /// it promises. Unknowns that would cross a bound go to it, and the others follow. None if the matrix is not
    /// positive definite.
    fn step(&self, end: &End, damping: f64) -> Option<(Vec<f64>, f64)> {
        let (normal, bends) = (&end.sums.sums.normal, &end.sums.bends);
        let count = normal.size();
        let gram = |i: usize, j: usize| normal.gram[i * count + j];
        let hessian = |i: usize, j: usize| gram(i, j) - bends[i * count + j];
        // The right-hand side is the direction in which the sum falls: an unknown at its bound that it pushes outward stays.
        let is_pushed = |i: usize| {
            let ([lower, upper], p, slope) = (self.bounds[i], end.unknowns[i], normal.rhs[i]);
            (p <= lower && slope <= 0.0) || (p >= upper && slope >= 0.0)
        };
        let (gone, left): (Vec<usize>, Vec<usize>) =
            (0..count).filter(|&i| gram(i, i) > 0.0 && !is_pushed(i)).partition(|&i| self.eliminated[i]);
        let factor = factorized(DMatrix::from_fn(gone.len(), gone.len(), |i, j| gram(gone[i], gone[j])))?;
        let half = |entry: &dyn Fn(usize, usize) -> f64| {
            let mut half = DMatrix::from_fn(gone.len(), left.len(), |i, j| entry(gone[i], left[j]));
            factor.l_dirty().solve_lower_triangular_mut(&mut half);
            half
        };
        let (image, without) = (half(&hessian), half(&gram));
        let mut known = DVector::from_fn(gone.len(), |i, _| normal.rhs[gone[i]]);
        factor.l_dirty().solve_lower_triangular_mut(&mut known);
        let s = DMatrix::from_fn(left.len(), left.len(), |i, j| hessian(left[i], left[j])) - image.tr_mul(&image);
        let slope = DVector::from_fn(left.len(), |i, _| normal.rhs[left[i]]) - image.tr_mul(&known);
        let diagonal = |i: usize| {
            let own = gram(left[i], left[i]);
            (own - without.column(i).norm_squared()).max(LEFT * own)
        };
        let damped = &s + DMatrix::from_diagonal(&DVector::from_fn(left.len(), |i, _| damping * diagonal(i)));
        let mut d = DVector::zeros(left.len());
        let mut free: Vec<usize> = (0..left.len()).collect();
        // Each pass takes at least one unknown to its bound, so that there are no more passes than unknowns.
        while !free.is_empty() {
            let matrix = damped.select_rows(&free).select_columns(&free);
            let rest = &slope - &damped * d.map_with_location(|i, _, d: f64| if free.contains(&i) { 0.0 } else { d });
            let found = Cholesky::new(matrix)?.solve(&rest.select_rows(&free));
            free.iter().zip(found.iter()).for_each(|(&i, value)| d[i] = *value);
            let crossed = |i: usize| {
                let ([lower, upper], end) = (self.bounds[left[i]], end.unknowns[left[i]] + d[i]);
                if end < lower { Some(lower) } else { (end > upper).then_some(upper) }
            };
            let crossing: Vec<(usize, f64)> = free.iter().filter_map(|&i| Some((i, crossed(i)?))).collect();
            if crossing.is_empty() {
                break;
            }
            crossing.iter().for_each(|&(i, bound)| d[i] = bound - end.unknowns[left[i]]);
            free.retain(|i| crossing.iter().all(|(crossed, _)| crossed != i));
        }
        let mut step = vec![0.0; count];
        left.iter().zip(d.iter()).for_each(|(&i, d)| step[i] = *d);
        // The promise is that of the quadratic model without the damping, with which the fall is compared.
        Some((step, 2.0 * slope.dot(&d) - d.dot(&(&s * &d))))
    }
}

/// The factor of the matrix, or of the matrix with a slight ridge if it is singular.
fn factorized(matrix: DMatrix<f64>) -> Option<Cholesky<f64, Dyn>> {
    let ridge = DMatrix::from_diagonal(&matrix.diagonal().map(|entry| RIDGE * entry));
    Cholesky::new(matrix.clone()).or_else(|| Cholesky::new(matrix + ridge))
}
