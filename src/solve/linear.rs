//! Linear statics: `K u = f` with some displacements prescribed.

use crate::error::{Error, Result};
use crate::model::{Entries, Support};
use faer::Side;
use faer::linalg::solvers::ShapeCore;
use faer::prelude::{MatMut, Solve};
use faer::sparse::linalg::solvers::{Llt, Lu};
use faer::sparse::{SparseColMat, Triplet};

/// The equations of the free degrees of freedom.
#[derive(Debug, Clone)]
pub struct System {
    /// `[free × free]`, both triangles.
    matrix: SparseColMat<usize, f64>,
    /// Forces of the prescribed displacements on the free degrees of freedom: `K_fp u_p`, `[free]`.
    reaction: Vec<f64>,
    /// The free degrees of freedom.
    free: Vec<usize>,
    prescribed: Vec<Option<f64>>,
}

/// A factorisation of the matrix of a [`System`].
#[derive(Debug, Clone)]
pub enum Factor {
    /// `L Lᵀ`: the matrix is positive definite.
    Cholesky(Llt<usize, f64>),
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
        let mut inner = Entries::with_capacity(2 * entries.len());
        let mut reaction = vec![0.0; free.len()];
        let mut add = |row: usize, column: usize, value: f64| {
            if place[row] == usize::MAX {
                return;
            }
            match support.prescribed[column] {
                Some(u) => reaction[place[row]] += value * u,
                None => inner.push(Triplet::new(place[row], place[column], value)),
            }
        };
        for entry in entries {
            add(entry.row, entry.col, entry.val);
            if entry.row != entry.col {
                add(entry.col, entry.row, entry.val);
            }
        }
        let matrix = SparseColMat::try_new_from_triplets(free.len(), free.len(), &inner)
            .map_err(|e| Error::new(format!("the stiffness matrix cannot be built: {e:?}")))?;
        Ok(System { matrix, reaction, free, prescribed: support.prescribed.clone() })
    }

    /// The number of free degrees of freedom.
    pub fn size(&self) -> usize {
        self.free.len()
    }

    /// The free degrees of freedom, ascending.
    pub fn free(&self) -> &[usize] {
        &self.free
    }

    /// Cholesky's factor, or the pivoted one where the matrix is not positive definite; `None` where it is singular.
    pub fn factorize(&self) -> Option<Factor> {
        if let Ok(llt) = self.matrix.sp_cholesky(Side::Lower) {
            return Some(Factor::Cholesky(llt));
        }
        self.matrix.sp_lu().ok().map(|lu| Factor::General(Box::new(lu)))
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
        let rhs: Vec<f64> = self.free.iter().zip(&self.reaction).map(|(&dof, r)| f[dof] - r).collect();
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
        self.free.iter().zip(&u).for_each(|(&dof, &u)| all[dof] = u);
        let size = norm(&rhs);
        (all, if size > 0.0 { norm(&residual) / size } else { 0.0 })
    }

    fn residual(&self, rhs: &[f64], u: &[f64]) -> Vec<f64> {
        rhs.iter().zip(self.apply(u)).map(|(f, ku)| f - ku).collect()
    }
}

impl Factor {
    /// `x ← K⁻¹ x` on the free degrees of freedom, of as many vectors as stand in x one after the other.
    pub fn solve(&self, x: &mut [f64]) {
        let rows = match self {
            Factor::Cholesky(llt) => llt.nrows(),
            Factor::General(lu) => lu.nrows(),
        };
        let columns = x.len().checked_div(rows).unwrap_or(0);
        let x = MatMut::from_column_major_slice_mut(x, rows, columns);
        match self {
            Factor::Cholesky(llt) => llt.solve_in_place(x),
            Factor::General(lu) => lu.solve_in_place(x),
        }
    }

    pub fn is_positive_definite(&self) -> bool {
        matches!(self, Factor::Cholesky(_))
    }
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}
