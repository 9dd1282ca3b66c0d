//! What a Cholesky factor of a body will cost, before anything is assembled.

use super::cholesky::Analysis;
use super::ordering::Places;
use super::positions::positions;
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use faer::{Mat, Side};
use std::sync::OnceLock;
use std::time::Instant;

/// The size of a factor and the work that it takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FactorCost {
    /// Entries of `L`.
    pub entries: f64,
    /// Multiplications with an addition each: `Σ c²` over the columns of `L` with `c` entries.
    pub operations: f64,
}

/// The cost of the factor of the stiffness of a mesh, all of whose points are free: with the order of the factorisation itself, but
/// of points in place of their directions, which takes a ninth of the memory in space.
///
/// # Errors
/// The analysis does not fit into memory.
pub fn factor_cost(mesh: &Mesh) -> Result<FactorCost> {
    factor_cost_of(&mesh.points, mesh.dimension, mesh.blocks.iter().flat_map(|block| block.cells()))
}

/// [`factor_cost`] of points, `[points × dimension]`, m, and of the lists of those that act on each other.
///
/// # Errors
/// The analysis does not fit into memory.
pub fn factor_cost_of<'a>(
    points: &[f64],
    dimension: usize,
    coupled: impl Iterator<Item = &'a [usize]>,
) -> Result<FactorCost> {
    let count = points.len() / dimension.max(1);
    // Each point has its diagonal entry, also one without cells.
    let mut places: Vec<(usize, usize)> = (0..count).map(|point| (point, point)).collect();
    for nodes in coupled {
        let all = nodes.iter().flat_map(|&a| nodes.iter().map(move |&b| (a, b)));
        places.extend(all.filter(|(a, b)| a != b));
    }
    cost_of(points, dimension, places)
}

/// [`factor_cost_of`], without parameters of type: compiled here, where code is optimised, and not with each caller.
fn cost_of(points: &[f64], dimension: usize, places: Vec<(usize, usize)>) -> Result<FactorCost> {
    let count = points.len() / dimension.max(1);
    let pattern = positions(count, |tell| places.iter().for_each(|&(row, column)| tell(row, column)));
    let (pattern, _) = pattern.map_err(|_| Error::new("the pattern of the stiffness does not fit into memory"))?;
    let places = Places { coordinates: points.to_vec(), dimension };
    let (entries, operations) = Analysis::new(pattern.as_ref(), Some(&places))?.cost();
    let d = dimension as f64;
    // A column with c points becomes d columns of d·c entries, whose squares sum to d³ c².
    Ok(FactorCost { entries: d.powi(2) * entries, operations: d.powi(3) * operations })
}

/// Multiplications with an addition each that this machine makes in a second while it factorises a dense matrix; measured once, in
/// about 10 ms.
pub fn dense_rate() -> f64 {
    static RATE: OnceLock<f64> = OnceLock::new();
    *RATE.get_or_init(|| {
        // Large enough for blocks and threads to count, small enough to take a few milliseconds.
        const SIZE: usize = 512;
        let matrix =
            // The rows outside the diagonal sum to less than ln 512 + 1, so that the diagonal makes the matrix positive
            // definite.
            Mat::<f64>::from_fn(SIZE, SIZE, |i, j| if i == j { SIZE as f64 } else { 1.0 / (1 + i + j) as f64 });
        let run = || {
            let start = Instant::now();
            let factor = matrix.llt(Side::Lower);
            (start.elapsed().as_secs_f64(), factor.is_ok())
        };
        // The first one starts the threads.
        let seconds = run().0.min(run().0).min(run().0);
        // `Σ c²` of a dense factor, the count that costs of sparse ones have. A clock with coarse ticks may measure no
        // time at all.
        (SIZE as f64).powi(3) / 3.0 / seconds.max(1e-9)
    })
}
