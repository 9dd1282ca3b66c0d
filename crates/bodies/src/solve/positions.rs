//! Where the entries of a sparse matrix are stored.

use faer::sparse::{FaerError, SymbolicSparseColMat};

/// The pattern of a square matrix of this size whose entries `list` tells as row and column, and the index in it to which each of them is
/// added. Entries come in any order and more than once; `list` tells them twice, in the same order. Nothing is sorted but the distinct rows of
/// each column, so that the work is in proportion to the entries.
///
/// # Errors
/// The pattern does not fit into memory.
pub(crate) fn positions(
    size: usize,
    list: impl Fn(&mut dyn FnMut(usize, usize)),
) -> Result<(SymbolicSparseColMat<usize>, Vec<usize>), FaerError> {
    let mut starts = zeros(size + 1)?;
    list(&mut |_, column| starts[column + 1] += 1);
    for column in 0..size {
        starts[column + 1] += starts[column];
    }
    let count = starts[size];
    // The row and the number of each entry, column after column.
    let (mut rows, mut numbers, mut next) = (zeros(count)?, zeros(count)?, starts.clone());
    let mut number = 0;
    list(&mut |row, column| {
        let at = next[column];
        next[column] += 1;
        (rows[at], numbers[at]) = (row, number);
        number += 1;
    });
    let (mut slots, mut ends, mut distinct) = (zeros(count)?, zeros(size + 1)?, Vec::new());
    // One more than the index at which each row is stored in the last column that has it, so that zero is that of none.
    let mut stored = next;
    stored.fill(0);
    for column in 0..size {
        let (first, own) = (distinct.len(), starts[column]..starts[column + 1]);
        for &row in &rows[own.clone()] {
            // A smaller index is that of a column before.
            if stored[row] <= first {
                distinct.push(row);
                stored[row] = distinct.len();
            }
        }
        // Columns of a sparse matrix have ascending rows.
        distinct[first..].sort_unstable();
        distinct[first..].iter().enumerate().for_each(|(i, &row)| stored[row] = first + i + 1);
        own.for_each(|at| slots[numbers[at]] = stored[rows[at]] - 1);
        ends[column + 1] = distinct.len();
    }
    Ok((SymbolicSparseColMat::new_checked(size, size, ends, None, distinct), slots))
}

/// A list of zeros, for which there may be no memory.
fn zeros(length: usize) -> Result<Vec<usize>, FaerError> {
    let mut list = Vec::new();
    list.try_reserve_exact(length).map_err(|_| FaerError::OutOfMemory)?;
    list.resize(length, 0);
    Ok(list)
}
