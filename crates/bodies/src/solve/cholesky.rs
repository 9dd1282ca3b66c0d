//! Cholesky factorisation of a sparse matrix, and that with pivots of one that is symmetric alone, with checks of the memory that they need.

use super::ordering::{Graph, Places};
use crate::error::{Error, ErrorKind, Result};
use crate::memory;
use crate::model::ADVICE;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::solvers::LltError;
use faer::perm::{Perm, PermRef};
use faer::prelude::MatMut;
use faer::sparse::linalg::cholesky::{
    IntranodeLbltRef, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{FaerError, SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Par, Side, get_global_parallelism};
use std::sync::Arc;

/// The analysis that all factors of matrices with one pattern share.
#[derive(Debug, Clone)]
pub(super) struct Analysis(Arc<SymbolicCholesky<usize>>);

/// The factor of a symmetric matrix A: L of `A = L Lᵀ`, or, of a matrix that is not positive definite, L and B of `P A Pᵀ = L B Lᵀ`.
#[derive(Debug, Clone)]
pub struct SymmetricFactor {
    analysis: Analysis,
    values: Vec<f64>,
    pivots: Option<Pivots>,
}

/// Blocks of one and two rows in B (Bunch & Kaufman, Math. Comp. 31, 1977). Pivots are sought among columns that are eliminated together, so that the factor has the entries of a
/// Cholesky factor; where none of them will do, it has few digits.
#[derive(Debug, Clone)]
struct Pivots {
    subdiagonal: Vec<f64>,
    /// The order of the pivots, and its inverse.
    order: [Vec<usize>; 2],
}

impl Analysis {
    /// Analyses a pattern with both triangles. Of the orders by minimum degree and by nested dissection, which needs the places of the
    /// unknowns, that with fewer operations is taken.
    ///
    /// # Errors
    /// It does not fit into memory.
    pub fn new(pattern: SymbolicSparseColMatRef<'_, usize>, places: Option<&Places>) -> Result<Analysis> {
        let full = |cause| out_of_memory("the analysis of the stiffness", cause);
        let analyse = |pattern, order: Option<&[usize]>| match order {
            None => ordered(pattern, SymmetricOrdering::Amd),
            Some(order) => {
                let mut position = vec![0; order.len()];
                // The permutation needs its inverse as well.
                order.iter().enumerate().for_each(|(i, &unknown)| position[unknown] = i);
                let order = Perm::new_checked(order.into(), position.into(), order.len());
                ordered(pattern, SymmetricOrdering::Custom(order.as_ref()))
            }
        };
        let graph = places.map(|places| (Graph::of(pattern), places));
        let dissected = graph.and_then(|(graph, places)| Some((graph.dissection(places)?, graph)));
        let Some((dissection, graph)) = dissected else { return analyse(pattern, None).map_err(full) };
        // Compared on the nodes: an analysis of them takes a ninth of the memory and time in space.
        let by_degree = analyse(graph.pattern(), None).map_err(full)?;
        let by_dissection = analyse(graph.pattern(), Some(&dissection)).map_err(full)?;
        let order = if by_dissection.cost().1 <= by_degree.cost().1 { dissection } else { by_degree.order() };
        analyse(pattern, Some(&graph.unknowns(&order))).map_err(full)
    }

    /// What is eliminated first, second and so on.
    fn order(&self) -> Vec<usize> {
        let natural = || (0..self.0.nrows()).collect();
        self.0.perm().map_or_else(natural, |order| order.arrays().0.to_vec())
    }

    /// The bytes of a factor, including those that are needed to compute it.
    pub fn bytes(&self) -> u64 {
        let scratch = self.0.factorize_numeric_llt_scratch::<f64>(get_global_parallelism(), Default::default());
        8 * self.0.len_val() as u64 + scratch.unaligned_bytes_required() as u64
    }

    /// The entries of the factor, and `Σ c²` over its columns with `c` entries.
    pub fn cost(&self) -> (f64, f64) {
        let sum = |columns: &mut dyn Iterator<Item = usize>| {
            columns.fold((0.0, 0.0), |(entries, squares), c| (entries + c as f64, squares + (c as f64).powi(2)))
        };
        match self.0.raw() {
            SymbolicCholeskyRaw::Simplicial(factor) => {
                sum(&mut factor.col_ptr().windows(2).map(|ends| ends[1] - ends[0]))
            }
            SymbolicCholeskyRaw::Supernodal(factor) => {
                let columns = |s: usize| {
                    let (width, below) =
                        (factor.supernode_end()[s] - factor.supernode_begin()[s], factor.supernode(s).pattern().len());
                    // The columns of a supernode form a triangle above the rows that they share: they have 1, 2 …
                    // `width` entries in it. The sums do not depend on the order.
                    (1..=width).map(move |column| column + below)
                };
                sum(&mut (0..factor.n_supernodes()).flat_map(columns))
            }
        }
    }

    /// The factor; `None` if the matrix is not positive definite.
    ///
    /// # Errors
    /// It does not fit into memory.
    pub fn factorize(&self, matrix: SparseColMatRef<'_, usize, f64>) -> Result<Option<SymmetricFactor>> {
        let what = "the factor of the stiffness";
        // Asked before the allocation, which may succeed on a system that promises more memory than it has.
        memory::require(what, self.bytes(), ADVICE)?;
        let full = || out_of_memory(what, FaerError::OutOfMemory);
        let mut values = Vec::new();
        // A reservation that fails is an error here; `resize` alone would end the program.
        values.try_reserve_exact(self.0.len_val()).map_err(|_| full())?;
        values.resize(self.0.len_val(), 0.0);
        let par = get_global_parallelism();
        let scratch = self.0.factorize_numeric_llt_scratch::<f64>(par, Default::default());
        let mut room = MemBuffer::try_new(scratch).map_err(|_| full())?;
        let (stack, none) = (MemStack::new(&mut room), Default::default());
        let done = self.0.factorize_numeric_llt(&mut values, matrix, Side::Lower, none, par, stack, Default::default());
        match done {
            Ok(_) => Ok(Some(SymmetricFactor { analysis: self.clone(), values, pivots: None })),
            Err(LltError::NonPositivePivot { .. }) => Ok(None),
        }
    }

    /// The factors with pivots, whatever digits they have.
    ///
    /// # Errors
    /// They do not fit into memory.
    pub fn pivoted(&self, matrix: SparseColMatRef<'_, usize, f64>) -> Result<SymmetricFactor> {
        let what = "the factor of the stiffness";
        let par = get_global_parallelism();
        let scratch = self.0.factorize_numeric_intranode_lblt_scratch::<f64>(par, Default::default());
        let rows = self.0.nrows();
        memory::require(
            what,
            // Beside the factor: the subdiagonal of B, and the order of the pivots in both directions.
            8 * (self.0.len_val() + 3 * rows) as u64 + scratch.unaligned_bytes_required() as u64,
            ADVICE,
        )?;
        let full = || out_of_memory(what, FaerError::OutOfMemory);
        let mut values = Vec::new();
        values.try_reserve_exact(self.0.len_val()).map_err(|_| full())?;
        values.resize(self.0.len_val(), 0.0);
        let mut room = MemBuffer::try_new(scratch).map_err(|_| full())?;
        let mut subdiagonal = vec![0.0; rows];
        let mut order = [vec![0; rows], vec![0; rows]];
        let [forward, inverse] = &mut order;
        self.0.factorize_numeric_intranode_lblt(
            &mut values,
            &mut subdiagonal,
            forward,
            inverse,
            matrix,
            Side::Lower,
            par,
            MemStack::new(&mut room),
            Default::default(),
        );
        Ok(SymmetricFactor { analysis: self.clone(), values, pivots: Some(Pivots { subdiagonal, order }) })
    }

    /// How a factor solves for so many columns at once, and the memory that it needs besides.
    fn room(&self, columns: usize) -> (Par, MemBuffer) {
        let par = get_global_parallelism();
        (par, MemBuffer::new(self.0.solve_in_place_scratch::<f64>(columns, par)))
    }
}

impl SymmetricFactor {
    pub(super) fn rows(&self) -> usize {
        self.analysis.0.nrows()
    }

    pub(super) fn is_definite(&self) -> bool {
        self.pivots.is_none()
    }

    pub(super) fn solve(&self, x: MatMut<'_, f64>) {
        let Analysis(symbolic) = &self.analysis;
        let (par, mut room) = self.analysis.room(x.ncols());
        let room = MemStack::new(&mut room);
        let Some(Pivots { subdiagonal, order: [forward, inverse] }) = &self.pivots else {
            return LltRef::new(symbolic, &self.values).solve_in_place_with_conj(Conj::No, x, par, room);
        };
        let order = PermRef::new_checked(forward, inverse, forward.len());
        let factor = IntranodeLbltRef::new(symbolic, &self.values, subdiagonal, order);
        factor.solve_in_place_with_conj(Conj::No, x, par, room);
    }
}

/// The degrees of freedom in the order in which a factor of a pattern of the `free` ones, both triangles, stays sparse.
///
/// # Errors
/// The analysis does not fit into memory.
pub(crate) fn elimination_order(
    pattern: SymbolicSparseColMatRef<'_, usize>,
    free: &[usize],
    points: &[f64],
    dimension: usize,
) -> Result<Vec<usize>> {
    let analysis = Analysis::new(pattern, Some(&Places::of(free, points, dimension)))?;
    Ok(analysis.order().into_iter().map(|i| free[i]).collect())
}

fn ordered(
    pattern: SymbolicSparseColMatRef<'_, usize>,
    order: SymmetricOrdering<'_, usize>,
) -> std::result::Result<Analysis, FaerError> {
    let symbolic = factorize_symbolic_cholesky(pattern, Side::Lower, order, Default::default())?;
    Ok(Analysis(Arc::new(symbolic)))
}

/// The error for a failed allocation that the estimates before did not predict.
pub(super) fn out_of_memory(what: &str, cause: FaerError) -> Error {
    let cause = match cause {
        FaerError::IndexOverflow => "has more entries than can be counted",
        _ => "does not fit into memory",
    };
    Error::new(format!("{what} {cause}: {ADVICE}")).of_kind(ErrorKind::Limit)
}
