//! The last level.

use crate::block::{Block, zero};
use crate::entry::Entry;
use crate::level::inverses;
use crate::matrix::BlockMatrix;
use crate::smoother::scale;
use faer::linalg::solvers::{Llt, Solve};
use faer::prelude::MatMut;
use faer::{Mat, Side};

#[derive(Debug)]
pub(crate) enum Bottom<const N: usize> {
    /// `L Lᵀ`.
    Dense(Llt<f64>),
    /// No node is coupled to another.
    Diagonal(Vec<Block<N, N>>),
}

impl<const N: usize> Bottom<N> {
    /// A motion that shows that the matrix is not positive definite is an error.
    pub fn dense(a: &BlockMatrix<N, N>, is_held: &[[bool; N]]) -> Result<Bottom<N>, Vec<[f64; N]>> {
        let held = is_held.as_flattened();
        let mut dense = Mat::<f64>::zeros(held.len(), held.len());
        for row in 0..a.rows() {
            for at in a.pattern.starts[row]..a.pattern.starts[row + 1] {
                let column = a.pattern.columns[at] as usize;
                for i in 0..N {
                    for j in 0..N {
                        dense[(row * N + i, column * N + j)] = a.values[at][i][j];
                    }
                }
            }
        }
        // What is held gets an equation of its own, without which there is no factor.
        for (i, _) in held.iter().enumerate().filter(|(_, held)| **held) {
            (0..held.len()).for_each(|j| (dense[(i, j)], dense[(j, i)]) = (0.0, 0.0));
            dense[(i, i)] = 1.0;
        }
        // The eigenvectors cost many times a factor: they are worked out only to show why there is none.
        if let Ok(factor) = dense.llt(Side::Lower) {
            return Ok(Bottom::Dense(factor));
        }
        let mut motion = vec![[0.0; N]; a.rows()];
        if let Ok(eigen) = dense.self_adjoint_eigen(Side::Lower) {
            // Ascending.
            // The equations of what is held have the eigenvalue 1, so that the
            // least one, which is not above zero here, is a motion of what is free.
            let softest = eigen.U().col(0);
            motion.as_flattened_mut().iter_mut().enumerate().for_each(|(i, x)| *x = softest[i]);
        }
        Err(motion)
    }

    pub fn diagonal(a: &BlockMatrix<N, N>, is_held: &[[bool; N]]) -> Result<Bottom<N>, Vec<[f64; N]>> {
        inverses(a, is_held).map(Bottom::Diagonal)
    }

    /// `x ← A⁻¹ b`.
    pub fn solve<T: Entry>(&self, b: &[[T; N]], x: &mut [[T; N]]) {
        match self {
            Bottom::Diagonal(inverse) => scale(inverse, b, x),
            Bottom::Dense(factor) => {
                let rows = x.len() * N;
                let b = b.as_flattened();
                // The factor reads whole columns, whereas an entry has the numbers of all right-hand sides side by side.
                let mut columns: Vec<f64> =
                    (0..T::COUNT).flat_map(|lane| b.iter().map(move |b| b.lane(lane))).collect();
                factor.solve_in_place(MatMut::from_column_major_slice_mut(&mut columns, rows, T::COUNT));
                for (i, x) in x.as_flattened_mut().iter_mut().enumerate() {
                    *x = T::of_each(|lane| columns[lane * rows + i]);
                }
            }
        }
    }
}

pub(crate) fn is_diagonal<const N: usize>(a: &BlockMatrix<N, N>) -> bool {
    let pattern = a.pattern();
    (0..a.rows()).all(|row| {
        let own = pattern.starts[row]..pattern.starts[row + 1];
        // Products store blocks that are zero, which couple nothing.
        own.into_iter().all(|at| pattern.columns[at] as usize == row || a.values[at] == zero())
    })
}
