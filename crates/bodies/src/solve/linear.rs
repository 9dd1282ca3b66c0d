//! Linear statics: `K u = f` with prescribed displacements.
//!
//! Theory: page *Precision* of the book.

use super::cholesky::{Analysis, SymmetricFactor, out_of_memory};
use super::ordering::Places;
use super::positions::positions;
use crate::error::{Error, Result};
use crate::memory;
use crate::model::{ADVICE, Entries, Support};
use crate::scalar::{DoubleDouble, Scalar, Sum, vectorized};
use crate::springs::norm;
use faer::linalg::solvers::ShapeCore;
use faer::prelude::{MatMut, Solve};
use faer::sparse::linalg::LuError;
use faer::sparse::linalg::solvers::Lu;
use faer::sparse::{FaerError, SparseColMat, SymbolicSparseColMat};
use rayon::prelude::*;
use std::sync::{Arc, OnceLock};

/// The largest number of refinements of a solution. Two are enough unless the factor has only a few digits of K. A
/// correction that is just below half of the last one gains one bit, so that sixty give all digits.
const REFINEMENTS: usize = 60;
/// The refinement ends if a correction is not below this share of the previous one.
const SLOWEST: f64 = 0.5;
/// The fraction of the golden ratio.
const GOLDEN: f64 = 0.618_033_988_749_894_8;
/// The share of a load that a solution with a symmetric factor with pivots may leave. One that leaves more has lost half of its digits to pivots that are
/// small beside what they eliminate.
const ACCURATE: f64 = 1e-8;
/// The memory of L and U with pivots, as a multiple of that of a Cholesky factor: the order of the columns must do for any pivots, and
/// fills more. Measured on 16³ to 20³ hexahedra: 5 to 10.
const GENERAL: u64 = 10;

/// The equations of the free degrees of freedom.
#[derive(Debug, Clone)]
pub struct System {
    /// The matrix, `[free × free]`, both triangles.
    matrix: SparseColMat<usize, f64>,
    /// The rounding error of each of its sums, which is added to it when residuals are computed.
    lost: Vec<f64>,
    /// The forces of the prescribed displacements on the free degrees of freedom, `K_fp u_p`, `[free]`.
    reaction: Vec<DoubleDouble>,
    prescribed: Vec<Option<f64>>,
    pattern: Arc<Pattern>,
}

/// What systems with entries at the same positions share.
#[derive(Debug)]
struct Pattern {
    /// The free degrees of freedom.
    free: Vec<usize>,
    /// The row of each degree of freedom; `usize::MAX` if it is held.
    place: Vec<usize>,
    symbolic: SymbolicSparseColMat<usize>,
    /// The index in the matrix to which each entry is added.
    slots: Vec<usize>,
    /// Where the free degrees of freedom are, if it is known.
    places: OnceLock<Places>,
    /// The analysis, made when it is first needed.
    cholesky: OnceLock<Result<Analysis>>,
}

/// A factorisation of the matrix of a [`System`].
#[derive(Debug, Clone)]
pub enum Factor {
    /// `L Lᵀ`: the matrix is positive definite; or `L B Lᵀ` with pivoting in blocks of columns: it is not.
    Symmetric(SymmetricFactor),
    /// `L U` with pivoting: the matrix is not positive definite, and no pivots of the symmetric factor will do.
    General(Box<Lu<usize, f64>>),
}

impl System {
    /// The equations of the free degrees of freedom.
    ///
    /// # Errors
    /// The matrix does not fit into memory.
    pub fn new(entries: &Entries, support: &Support) -> Result<System> {
        let mut place = vec![usize::MAX; support.prescribed.len()];
        let free: Vec<usize> = (0..place.len()).filter(|&dof| !support.is_fixed(dof)).collect();
        free.iter().enumerate().for_each(|(i, &dof)| place[dof] = i);
        let list = |tell: &mut dyn FnMut(usize, usize)| {
            each_value(entries, &place, |row, column, _| {
                // A column that is held goes to the right-hand side: the order here is that of `System::of`.
                if place[column] != usize::MAX {
                    tell(place[row], place[column]);
                }
            });
        };
        let (symbolic, slots) = positions(free.len(), list).map_err(too_large)?;
        let (places, cholesky) = Default::default();
        Ok(System::of(Arc::new(Pattern { free, place, symbolic, slots, places, cholesky }), entries, support))
    }

    /// Gives the points of the equations their places, `[points × dimension]`, m. A large factor in space then has less than half of the
    /// entries. Places of another number of degrees of freedom are not used.
    pub fn placed(self, points: &[f64], dimension: usize) -> System {
        if dimension > 0 && points.len() == self.degrees() && points.len().is_multiple_of(dimension) {
            self.pattern.places.get_or_init(|| Places::of(self.free(), points, dimension));
        }
        self
    }

    /// The equations with other values at the same positions in the same order, and other prescribed displacements of
    /// the same degrees of freedom. The analysis of the pattern is reused.
    ///
    /// # Errors
    /// The matrix does not fit into memory.
    pub fn renewed(&self, entries: &Entries, support: &Support) -> Result<System> {
        Ok(System::of(self.pattern.clone(), entries, support))
    }

    fn of(pattern: Arc<Pattern>, entries: &Entries, support: &Support) -> System {
        let mut sums = vec![Sum::default(); pattern.symbolic.row_idx().len()];
        let mut reaction = vec![DoubleDouble::from(0.0); pattern.free.len()];
        let mut slots = pattern.slots.iter();
        each_value(entries, &pattern.place, |row, column, value| match support.prescribed[column] {
            // A support at rest pulls nothing, and most supports are at rest.
            Some(0.0) => {}
            Some(u) => {
                let reaction = &mut reaction[pattern.place[row]];
                *reaction = reaction.plus_product(&value.into(), &u.into());
            }
            None => {
                if let Some(&slot) = slots.next() {
                    sums[slot].add(value);
                }
            }
        });
        debug_assert!(slots.next().is_none(), "a pattern is that of as many entries");
        // The factor needs no more than the rounded sums; residuals get both parts.
        let (values, lost) = sums.iter().map(|sum| (sum.kept().hi, sum.kept().lo)).unzip();
        let matrix = SparseColMat::new(pattern.symbolic.clone(), values);
        System { matrix, lost, reaction, prescribed: support.prescribed.clone(), pattern }
    }

    /// The number of degrees of freedom, free or held.
    pub fn degrees(&self) -> usize {
        self.prescribed.len()
    }

    /// The number of free degrees of freedom.
    pub fn size(&self) -> usize {
        self.pattern.free.len()
    }

    /// The free degrees of freedom, ascending.
    pub fn free(&self) -> &[usize] {
        &self.pattern.free
    }

    /// The Cholesky factor, or one with pivots if the matrix is not positive definite; `None` if it is singular.
    ///
    /// # Errors
    /// The factor does not fit into memory.
    pub fn factorize(&self) -> Result<Option<Factor>> {
        match self.cholesky()? {
            Some(factor) => Ok(Some(factor)),
            None => self.general(),
        }
    }

    /// A factor with pivots, of a matrix that is not positive definite; `None` if it is singular. A symmetric factor has a tenth of the entries of
    /// `L U`, which is made where the symmetric one has too few digits.
    ///
    /// # Errors
    /// The factor does not fit into memory: kind `Limit`.
    pub fn general(&self) -> Result<Option<Factor>> {
        let pivoted = Factor::Symmetric(self.analysis()?.pivoted(self.matrix.as_ref())?);
        if self.is_accurate(&pivoted) {
            return Ok(Some(pivoted));
        }
        // Its memory is free before that of L and U is asked for.
        drop(pivoted);
        let what = "the factor of the stiffness, which is not positive definite,";
        memory::require(what, GENERAL * self.analysis()?.bytes(), ADVICE)?;
        match self.matrix.sp_lu() {
            Ok(lu) => Ok(Some(Factor::General(Box::new(lu)))),
            Err(LuError::SymbolicSingular { .. }) => Ok(None),
            Err(LuError::Generic(cause)) => Err(out_of_memory(what, cause)),
        }
    }

    /// Whether a solution with the factor leaves little of a load that moves all: refinements then find the other digits.
    fn is_accurate(&self, factor: &Factor) -> bool {
        // Multiples of the golden ratio are spread evenly, and neighbours differ: every motion has a part in them.
        let rough: Vec<f64> = (0..self.size()).map(|i| (i as f64 * GOLDEN).fract() - 0.5).collect();
        let load = self.apply(&rough);
        let mut u = load.clone();
        factor.solve(&mut u);
        let left: Vec<f64> = load.iter().zip(self.apply(&u)).map(|(f, inner)| f - inner).collect();
        norm(&left) <= ACCURATE * norm(&load)
    }

    /// The Cholesky factor; `None` if the matrix is not positive definite.
    ///
    /// # Errors
    /// The factor does not fit into memory.
    pub fn cholesky(&self) -> Result<Option<Factor>> {
        Ok(self.analysis()?.factorize(self.matrix.as_ref())?.map(Factor::Symmetric))
    }

    fn analysis(&self) -> Result<&Analysis> {
        let analyse = || Analysis::new(self.matrix.symbolic(), self.pattern.places.get());
        self.pattern.cholesky.get_or_init(analyse).as_ref().map_err(Clone::clone)
    }

    /// `K x` on the free degrees of freedom.
    pub fn apply(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        for (column, &xj) in x.iter().enumerate() {
            let rows = self.matrix.row_idx_of_col_raw(column);
            for (row, value) in rows.iter().zip(self.matrix.val_of_col(column)) {
                y[*row] += value * xj;
            }
        }
        y
    }

    /// The displacements of all degrees of freedom under the nodal forces `f`, `[points · dimension]`, N, refined with
    /// residuals in double-double numbers (Demmel et al., ACM Trans. Math. Softw. 32, 2006). Also the relative residual
    /// `‖f − K u‖/‖f‖`, or the last relative correction if it is larger and the corrections have stopped decreasing.
    ///
    /// K is the exact sum of its entries, without the rounding of the sums, so that soft parts beside stiff ones keep
    /// their digits.
    pub fn solve(&self, factor: &Factor, f: &[f64]) -> (Vec<f64>, f64) {
        let exact = |(&dof, reaction): (&usize, &DoubleDouble)| DoubleDouble::from(f[dof]) - reaction;
        let rhs: Vec<DoubleDouble> = self.free().iter().zip(&self.reaction).map(exact).collect();
        let size = norm(&rhs.iter().map(|f| f.hi).collect::<Vec<_>>());
        let mut u = vec![DoubleDouble::from(0.0); rhs.len()];
        let mut residual: Vec<f64> = rhs.iter().map(|f| f.hi).collect();
        let (mut last, mut unsettled) = (f64::INFINITY, 1.0);
        for _ in 0..REFINEMENTS {
            let mut correction = residual.clone();
            factor.solve(&mut correction);
            let change = norm(&correction);
            // Corrections that do not decrease show that the factor is too inaccurate.
            // A correction that is NaN ends the refinement here as well.
            if !(change < SLOWEST * last) {
                break;
            }
            u.iter_mut().zip(&correction).for_each(|(u, c)| *u = *u + &DoubleDouble::from(*c));
            residual = self.residual(&rhs, &u);
            unsettled = change / norm(&u.iter().map(|u| u.hi).collect::<Vec<_>>());
            let ratio = if last.is_finite() { change / last } else { 1.0 };
            last = change;
            // The next correction would be smaller by the same ratio: it would change no digit.
            // A body without forces moves nowhere: 0/0 is NaN, and ends here as settled.
            if !(unsettled * ratio > f64::EPSILON) {
                unsettled = 0.0;
                break;
            }
        }
        let mut all: Vec<f64> = self.prescribed.iter().map(|p| p.unwrap_or(0.0)).collect();
        self.free().iter().zip(&u).for_each(|(&dof, u)| all[dof] = u.hi);
        // NaN is no solution.
        let is_finite = size.is_finite() && all.iter().all(|u| u.is_finite());
        let left = if size == 0.0 { 0.0 } else { (norm(&residual) / size).max(unsettled) };
        (all, if is_finite { left } else { f64::INFINITY })
    }

    /// The displacements under each of several nodal forces, without refinement.
    pub fn solve_all(&self, factor: &Factor, forces: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let held: Vec<f64> = self.prescribed.iter().map(|p| p.unwrap_or(0.0)).collect();
        let reaction: Vec<f64> = self.reaction.iter().map(|force| force.hi).collect();
        self.columns(factor, forces, &reaction, &held)
    }

    /// The displacements under each of several nodal forces, and the relative residual of each; only those with a residual above
    /// `tolerance` are refined, because a refinement takes two solutions more, each by itself.
    pub fn solve_each(&self, factor: &Factor, forces: &[Vec<f64>], tolerance: f64) -> Vec<(Vec<f64>, f64)> {
        let checked = |(f, u): (&Vec<f64>, Vec<f64>)| {
            let free: Vec<f64> = self.free().iter().map(|&dof| u[dof]).collect();
            let rest = self.free().iter().zip(&self.reaction).map(|(&dof, reaction)| f[dof] - reaction.hi);
            let (rest, inner): (Vec<f64>, Vec<f64>) = (rest.collect(), self.apply(&free));
            let left: Vec<f64> = rest.iter().zip(&inner).map(|(f, inner)| f - inner).collect();
            let residual = if norm(&left) == 0.0 { 0.0 } else { norm(&left) / norm(&rest) };
            // A residual that is NaN is refined too, and then told to be infinite.
            if residual <= tolerance { (u, residual) } else { self.solve(factor, f) }
        };
        forces.iter().zip(self.solve_all(factor, forces)).map(checked).collect()
    }

    /// The changes of the displacements for changes of the nodal forces.
    pub fn respond_all(&self, factor: &Factor, forces: &[Vec<f64>]) -> Vec<Vec<f64>> {
        self.columns(factor, forces, &vec![0.0; self.size()], &vec![0.0; self.prescribed.len()])
    }

    fn columns(&self, factor: &Factor, forces: &[Vec<f64>], reaction: &[f64], held: &[f64]) -> Vec<Vec<f64>> {
        let free = self.free();
        // One part for each thread, whose columns the factor solves side by side: it is then read once for all of them.
        let part = forces.len().div_ceil(rayon::current_num_threads()).max(1);
        let solve = |forces: &[Vec<f64>]| -> Vec<Vec<f64>> {
            let rhs = |f: &Vec<f64>| free.iter().zip(reaction).map(|(&dof, r)| f[dof] - r).collect::<Vec<f64>>();
            let mut columns: Vec<f64> = forces.iter().flat_map(rhs).collect();
            factor.solve(&mut columns);
            let all = |column: &[f64]| {
                let mut u = held.to_vec();
                free.iter().zip(column).for_each(|(&dof, x)| u[dof] = *x);
                u
            };
            // Chunks of no entries are a panic: a body that is held everywhere has no free ones.
            columns.chunks_exact(free.len().max(1)).map(all).collect()
        };
        // The parts are collected in the order of the forces, whichever ends first.
        forces.par_chunks(part).flat_map_iter(solve).collect()
    }

    /// `f − K u` in double-double numbers.
    fn residual(&self, rhs: &[DoubleDouble], u: &[DoubleDouble]) -> Vec<f64> {
        let mut rest = rhs.to_vec();
        let (starts, rows) = (self.pattern.symbolic.col_ptr(), self.pattern.symbolic.row_idx());
        vectorized!(DoubleDouble::from(0.0), {
            for (column, u) in u.iter().enumerate() {
                for at in starts[column]..starts[column + 1] {
                    let entry = DoubleDouble { hi: self.matrix.val()[at], lo: self.lost[at] };
                    let rest = &mut rest[rows[at]];
                    *rest = rest.minus_product(&entry, u);
                }
            }
        });
        rest.iter().map(|rest| rest.hi).collect()
    }
}

/// The error for a matrix that does not fit into memory.
fn too_large(cause: FaerError) -> Error {
    out_of_memory("the stiffness", cause)
}

impl Factor {
    /// `x ← K⁻¹ x` on the free degrees of freedom, for all vectors that are stored in x one after the other.
    pub fn solve(&self, x: &mut [f64]) {
        let rows = match self {
            Factor::Symmetric(factor) => factor.rows(),
            Factor::General(lu) => lu.nrows(),
        };
        // A matrix without rows solves for nothing.
        let columns = x.len().checked_div(rows).unwrap_or(0);
        let x = MatMut::from_column_major_slice_mut(x, rows, columns);
        match self {
            Factor::Symmetric(factor) => factor.solve(x),
            Factor::General(lu) => lu.solve_in_place(x),
        }
    }

    /// Its name in reports.
    pub fn method(&self) -> &'static str {
        match self {
            Factor::Symmetric(factor) if factor.is_definite() => "cholesky",
            Factor::Symmetric(_) => "ldl",
            Factor::General(_) => "lu",
        }
    }

    /// Whether the matrix is positive definite.
    pub fn is_positive_definite(&self) -> bool {
        matches!(self, Factor::Symmetric(factor) if factor.is_definite())
    }
}

/// Calls `visit(row, column, value)` for every entry of both triangles in a free row.
fn each_value(entries: &Entries, place: &[usize], mut visit: impl FnMut(usize, usize, f64)) {
    for entry in entries {
        if place[entry.row] != usize::MAX {
            visit(entry.row, entry.col, entry.val);
        }
        if entry.row != entry.col && place[entry.col] != usize::MAX {
            visit(entry.col, entry.row, entry.val);
        }
    }
}
