//! The moduli of the cells that are computed together, one cell per SIMD lane.

use crate::material::{BlockValues, Moduli};
use crate::scalar::Packed;

/// The moduli of the cells of a block, and those of the cells in the lanes.
pub struct PackedModuli<'a, T> {
    given: BlockValues<'a, Moduli>,
    /// Those of the cells in the lanes.
    pub lanes: Moduli<T>,
}

impl<'a, T: Packed> PackedModuli<'a, T> {
    pub fn new(zero: &T, given: BlockValues<'a, Moduli>) -> PackedModuli<'a, T> {
        let any = given.values().first().copied().unwrap_or(Moduli { lambda: 0.0, mu: 0.0 });
        PackedModuli { given, lanes: any.of_kind(zero) }
    }

    /// Fills the lanes with the moduli of `count` cells from `first` on; lanes without a cell repeat the first.
    pub fn set(&mut self, first: usize, count: usize) {
        let BlockValues::Each(all) = self.given else { return };
        for lane in 0..T::COUNT {
            let Moduli { lambda, mu } = all[first + if lane < count { lane } else { 0 }];
            self.lanes.lambda.as_mut_slice()[lane] = lambda;
            self.lanes.mu.as_mut_slice()[lane] = mu;
        }
    }

    /// The moduli of one cell.
    pub fn of_cell(&self, cell: usize) -> Moduli {
        *self.given.at(cell)
    }
}
