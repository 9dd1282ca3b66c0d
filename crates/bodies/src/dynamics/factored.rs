//! The equations of an implicit step, solved by a Cholesky factorisation.

use super::equations::{End, Equations, Solved};
use crate::error::{Error, ErrorKind, Result};
use crate::memory;
use crate::solve::{elimination_order, positions};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::prelude::MatMut;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, Par, Side};

/// The work per entry, as a share of faer's default, from which columns are eliminated in dense groups. With three
/// coordinates per point this is twice as fast on membranes of a thousand triangles.
const SUPERNODAL: f64 = 0.2;
/// The name of the memory in errors.
const FACTOR: &str = "the factor of an implicit step";
/// What to do if it does not fit.
const ADVICE: &str = "take solver = \"conjugate-gradients\", which needs none, or a mesh with fewer points";

/// The matrix, in the order of elimination, and its Cholesky factor. Entries are written directly to their positions: a
/// step sorts nothing and allocates no memory.
#[derive(Debug)]
pub(super) struct Factored {
    /// The degree of freedom of each row.
    order: Vec<usize>,
    /// The lower triangle.
    pattern: SymbolicSparseColMat<usize>,
    /// The values of the pattern, and one more for the entries of held degrees of freedom.
    values: Vec<f64>,
    /// The index of the diagonal entry of each row.
    diagonal: Vec<usize>,
    /// The index to which each entry is added.
    slots: Vec<u32>,
    symbolic: SymbolicCholesky<usize>,
    factor: Vec<f64>,
    room: Room,
}

/// Working memory of a factorisation or solution.
struct Room(MemBuffer);

impl std::fmt::Debug for Room {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str("Room")
    }
}

impl Factored {
    /// For entries at these positions of the lower triangle, of points that are at `points` at rest; the diagonal is always
    /// included.
    ///
    /// # Errors
    /// The factor does not fit into memory.
    pub fn new(places: &[(usize, usize)], held: &[bool], points: &[f64], dimension: usize) -> Result<Factored> {
        let large = || Error::new(format!("{FACTOR} does not fit into memory: {ADVICE}")).of_kind(ErrorKind::Limit);
        let free: Vec<usize> = (0..held.len()).filter(|dof| !held[*dof]).collect();
        let n = free.len();
        // The places in an order of the free degrees of freedom, and the pairs of the lower triangle.
        let lower = |order: &[usize]| {
            let mut place = vec![usize::MAX; held.len()];
            order.iter().enumerate().for_each(|(i, &dof)| place[dof] = i);
            let pair = |&(row, column): &(usize, usize)| {
                let (a, b) = (place[row], place[column]);
                (a != usize::MAX && b != usize::MAX).then(|| (a.max(b), a.min(b)))
            };
            let diagonal = (0..n).map(|i| (i, i));
            let pairs: Vec<(usize, usize)> = places.iter().filter_map(pair).chain(diagonal).collect();
            (place, pairs)
        };
        let turned = |pairs: &[(usize, usize)]| -> Vec<(usize, usize)> {
            pairs.iter().map(|&(row, column)| (column, row)).collect()
        };
        let pattern_of = |pairs: &[(usize, usize)]| {
            let list = |tell: &mut dyn FnMut(usize, usize)| pairs.iter().for_each(|&(row, column)| tell(row, column));
            positions(n, list).map(|(pattern, _)| pattern).map_err(|_| large())
        };
        // The rows are stored in the order that keeps the factor sparse, so that no step permutes.
        let (_, mut pairs) = lower(&free);
        pairs.extend(turned(&pairs));
        let order = elimination_order(pattern_of(&pairs)?.as_ref(), &free, points, dimension).map_err(|_| large())?;
        let (place, pairs) = lower(&order);
        let pattern = pattern_of(&pairs)?;
        // Without a permutation the analysis reads the upper triangle, regardless of its argument `side`.
        let upper = pattern_of(&turned(&pairs))?;
        let supernodal_flop_ratio_threshold = SupernodalThreshold(SUPERNODAL);
        let params = CholeskySymbolicParams { supernodal_flop_ratio_threshold, ..Default::default() };
        let symbolic = factorize_symbolic_cholesky(upper.as_ref(), Side::Upper, SymmetricOrdering::Identity, params)
            .map_err(|_| large())?;
        let (starts, rows) = (pattern.col_ptr(), pattern.row_idx());
        let slot = |row: usize, column: usize| match (place[row], place[column]) {
            // What belongs to held degrees of freedom goes to a place beyond the matrix that nobody reads: no branch at
            // each entry of each step.
            (usize::MAX, _) | (_, usize::MAX) => rows.len(),
            (a, b) => {
                let (row, column) = (a.max(b), a.min(b));
                starts[column] + rows[starts[column]..starts[column + 1]].partition_point(|r| *r < row)
            }
        };
        // Slots of four bytes halve what a step reads of them. The casts below are within this bound.
        if u32::try_from(rows.len()).is_err() {
            return Err(large());
        }
        let slots = places.iter().map(|&(row, column)| slot(row, column) as u32).collect();
        let diagonal = order.iter().map(|&dof| slot(dof, dof)).collect();
        let request = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        // A factorisation and a solution never run at once: the larger of both is enough.
        let request = request.or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let bytes = 8 * (symbolic.len_val() + rows.len()) as u64 + request.unaligned_bytes_required() as u64;
        memory::require(FACTOR, bytes, ADVICE)?;
        let room = Room(MemBuffer::try_new(request).map_err(|_| large())?);
        // One more than the matrix has, for the entries of held degrees of freedom.
        let (values, factor) = (vec![0.0; rows.len() + 1], vec![0.0; symbolic.len_val()]);
        Ok(Factored { order, values, diagonal, slots, symbolic, factor, room, pattern })
    }
}

impl Equations for Factored {
    fn order(&self) -> &[usize] {
        &self.order
    }

    fn set_diagonal(&mut self, diagonal: &dyn Fn(usize) -> f64) {
        self.values.fill(0.0);
        self.order.iter().zip(&self.diagonal).for_each(|(&dof, &slot)| self.values[slot] = diagonal(dof));
    }

    fn add(&mut self, first: usize, factor: f64, values: &[f64]) {
        for (value, &slot) in values.iter().zip(&self.slots[first..]) {
            self.values[slot as usize] += factor * value;
        }
    }

    fn shift(&mut self, share: f64) {
        let size = self.diagonal.iter().map(|&slot| self.values[slot].abs()).fold(0.0, f64::max);
        self.diagonal.iter().for_each(|&slot| self.values[slot] += share * size);
    }

    fn prepare(&mut self) -> bool {
        let matrix = SparseColMatRef::new(self.pattern.as_ref(), &self.values[..self.values.len() - 1]);
        let (stack, none) = (MemStack::new(&mut self.room.0), Default::default());
        self.symbolic
            .factorize_numeric_llt(&mut self.factor, matrix, Side::Lower, none, Par::Seq, stack, Default::default())
            .is_ok()
    }

    /// The Cholesky factor is the proof.
    fn is_definite(&mut self, is_prepared: bool, _: &mut [f64]) -> Option<bool> {
        Some(is_prepared)
    }

    fn solve(&mut self, x: &mut [f64], _: Option<&[f64]>) -> Solved {
        let rows = x.len();
        let x = MatMut::from_column_major_slice_mut(x, rows, 1);
        let stack = MemStack::new(&mut self.room.0);
        LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(Conj::No, x, Par::Seq, stack);
        Solved { end: End::Exact, iterations: 0 }
    }
}
