//! Linear statics: `K u = f` with some displacements prescribed.

use super::cholesky::{Analysis, Cholesky, out_of_memory};
use crate::error::{Error, Result};
use crate::memory;
use crate::model::{ADVICE, Entries, Support};
use crate::springs::norm;
use faer::linalg::solvers::ShapeCore;
use faer::prelude::{MatMut, Solve};
use faer::sparse::linalg::LuError;
use faer::sparse::linalg::solvers::Lu;
use faer::sparse::{Argsort, CreationError, FaerError, Pair, SparseColMat, SymbolicSparseColMat};
use rayon::prelude::*;
use std::sync::{Arc, OnceLock};

/// The equations of the free degrees of freedom.
#[derive(Debug, Clone)]
pub struct System {
    /// `[free × free]`, both triangles.
    matrix: SparseColMat<usize, f64>,
    /// Forces of the prescribed displacements on the free degrees of freedom: `K_fp u_p`, `[free]`.
    reaction: Vec<f64>,
    prescribed: Vec<Option<f64>>,
    pattern: Arc<Pattern>,
}

/// What systems whose entries stand in the same places share.
#[derive(Debug)]
struct Pattern {
    /// The free degrees of freedom.
    free: Vec<usize>,
    /// The row of each degree of freedom, `usize::MAX` where it is held.
    place: Vec<usize>,
    symbolic: SymbolicSparseColMat<usize>,
    /// From the order of the entries to that of the matrix.
    order: Argsort<usize>,
    /// Analysed when first needed.
    cholesky: OnceLock<Result<Analysis>>,
}

/// A factorisation of the matrix of a [`System`].
#[derive(Debug, Clone)]
pub enum Factor {
    /// `L Lᵀ`: the matrix is positive definite.
    Cholesky(Cholesky),
    /// `L U` with pivoting: it is not.
    General(Box<Lu<usize, f64>>),
}

impl System {
    /// # Errors
    /// The matrix does not fit into memory.
    pub fn new(entries: &Entries, support: &Support) -> Result<System> {
        let mut place = vec![usize::MAX; support.prescribed.len()];
        let free: Vec<usize> = (0..place.len()).filter(|&dof| !support.is_fixed(dof)).collect();
        free.iter().enumerate().for_each(|(i, &dof)| place[dof] = i);
        let mut places = Vec::with_capacity(2 * entries.len());
        each_value(entries, &place, |row, column, _| {
            if place[column] != usize::MAX {
                places.push(Pair::new(place[row], place[column]));
            }
        });
        let (symbolic, order) =
            SymbolicSparseColMat::try_new_from_indices(free.len(), free.len(), &places).map_err(|e| match e {
                CreationError::Generic(cause) => too_large(cause),
                CreationError::OutOfBounds { .. } => unreachable!("each place is that of a free degree of freedom"),
            })?;
        let cholesky = OnceLock::new();
        System::of(Arc::new(Pattern { free, place, symbolic, order, cholesky }), entries, support)
    }

    /// The equations with other values at the same places in the same order, and other prescribed displacements of the same
    /// degrees of freedom: what depends on the places alone is not worked out again.
    ///
    /// # Errors
    /// The matrix does not fit into memory.
    pub fn renewed(&self, entries: &Entries, support: &Support) -> Result<System> {
        System::of(self.pattern.clone(), entries, support)
    }

    fn of(pattern: Arc<Pattern>, entries: &Entries, support: &Support) -> Result<System> {
        let mut values = Vec::with_capacity(2 * entries.len());
        let mut reaction = vec![0.0; pattern.free.len()];
        each_value(entries, &pattern.place, |row, column, value| match support.prescribed[column] {
            Some(u) => reaction[pattern.place[row]] += value * u,
            None => values.push(value),
        });
        let matrix =
            SparseColMat::new_from_argsort(pattern.symbolic.clone(), &pattern.order, &values).map_err(too_large)?;
        Ok(System { matrix, reaction, prescribed: support.prescribed.clone(), pattern })
    }

    /// The number of free degrees of freedom.
    pub fn size(&self) -> usize {
        self.pattern.free.len()
    }

    /// The free degrees of freedom, ascending.
    pub fn free(&self) -> &[usize] {
        &self.pattern.free
    }

    /// Cholesky's factor, or the pivoted one where the matrix is not positive definite; `None` where it is singular.
    ///
    /// # Errors
    /// The factor does not fit into memory.
    pub fn factorize(&self) -> Result<Option<Factor>> {
        if let Some(factor) = self.cholesky()? {
            return Ok(Some(factor));
        }
        let what = "the factor of the stiffness, which is not positive definite,";
        // L and U; pivoting adds to both.
        memory::require(what, 2 * self.analysis()?.bytes(), ADVICE)?;
        match self.matrix.sp_lu() {
            Ok(lu) => Ok(Some(Factor::General(Box::new(lu)))),
            Err(LuError::SymbolicSingular { .. }) => Ok(None),
            Err(LuError::Generic(cause)) => Err(out_of_memory(what, cause)),
        }
    }

    /// Cholesky's factor; `None` where the matrix is not positive definite.
    ///
    /// # Errors
    /// The factor does not fit into memory.
    pub fn cholesky(&self) -> Result<Option<Factor>> {
        Ok(self.analysis()?.factorize(self.matrix.as_ref())?.map(Factor::Cholesky))
    }

    fn analysis(&self) -> Result<&Analysis> {
        let analyse = || Analysis::new(self.matrix.symbolic());
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

    /// The displacements of all degrees of freedom under the nodal forces `f`, `[points · dimension]`, after one step
    /// of iterative refinement, and the relative residual `‖f − K u‖/‖f‖` that is left.
    pub fn solve(&self, factor: &Factor, f: &[f64]) -> (Vec<f64>, f64) {
        let rhs: Vec<f64> = self.free().iter().zip(&self.reaction).map(|(&dof, r)| f[dof] - r).collect();
        let mut u = rhs.clone();
        factor.solve(&mut u);
        let mut residual = self.residual(&rhs, &u);
        let mut correction = residual.clone();
        factor.solve(&mut correction);
        let refined: Vec<f64> = u.iter().zip(&correction).map(|(u, c)| u + c).collect();
        let refined_residual = self.residual(&rhs, &refined);
        if norm(&refined_residual) < norm(&residual) {
            (u, residual) = (refined, refined_residual);
        }
        let mut all: Vec<f64> = self.prescribed.iter().map(|p| p.unwrap_or(0.0)).collect();
        self.free().iter().zip(&u).for_each(|(&dof, &u)| all[dof] = u);
        let size = norm(&rhs);
        (all, if size > 0.0 { norm(&residual) / size } else { 0.0 })
    }

    /// The displacements under each of some nodal forces, without refinement.
    pub fn solve_all(&self, factor: &Factor, forces: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let held: Vec<f64> = self.prescribed.iter().map(|p| p.unwrap_or(0.0)).collect();
        self.columns(factor, forces, &self.reaction, &held)
    }

    /// How the displacements change when the nodal forces change so.
    pub fn respond_all(&self, factor: &Factor, forces: &[Vec<f64>]) -> Vec<Vec<f64>> {
        self.columns(factor, forces, &vec![0.0; self.size()], &vec![0.0; self.prescribed.len()])
    }

    fn columns(&self, factor: &Factor, forces: &[Vec<f64>], reaction: &[f64], held: &[f64]) -> Vec<Vec<f64>> {
        let free = self.free();
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
            columns.chunks_exact(free.len().max(1)).map(all).collect()
        };
        forces.par_chunks(part).flat_map_iter(solve).collect()
    }

    fn residual(&self, rhs: &[f64], u: &[f64]) -> Vec<f64> {
        rhs.iter().zip(self.apply(u)).map(|(f, ku)| f - ku).collect()
    }
}

/// The matrix does not fit into memory.
fn too_large(cause: FaerError) -> Error {
    out_of_memory("the stiffness", cause)
}

impl Factor {
    /// `x ← K⁻¹ x` on the free degrees of freedom, of as many vectors as stand in x one after the other.
    pub fn solve(&self, x: &mut [f64]) {
        let rows = match self {
            Factor::Cholesky(cholesky) => cholesky.rows(),
            Factor::General(lu) => lu.nrows(),
        };
        let columns = x.len().checked_div(rows).unwrap_or(0);
        let x = MatMut::from_column_major_slice_mut(x, rows, columns);
        match self {
            Factor::Cholesky(cholesky) => cholesky.solve(x),
            Factor::General(lu) => lu.solve_in_place(x),
        }
    }

    pub fn is_positive_definite(&self) -> bool {
        matches!(self, Factor::Cholesky(_))
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
