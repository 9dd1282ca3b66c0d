//! The linear laws of the cells that are computed together, one cell per SIMD lane.

use super::packing::packed;
use crate::material::{BlockValues, Hooke, Moduli, Stiffness};
use crate::scalar::Packed;

/// The laws of the cells of a block, and that of the cells in the lanes.
pub struct PackedHooke<'a, T> {
    given: BlockValues<'a, Hooke>,
    dimension: usize,
    /// Whether the laws of all cells are isotropic.
    is_isotropic: bool,
    zero: T,
    /// That of the cells in the lanes: isotropic if all of them are.
    pub lanes: Hooke<T>,
}

impl<'a, T: Packed> PackedHooke<'a, T> {
    pub fn new(zero: &T, dimension: usize, given: BlockValues<'a, Hooke>) -> PackedHooke<'a, T> {
        let lanes = match given.values().first() {
            Some(any) => any.of_kind(zero),
            None => Hooke::Isotropic(Moduli { lambda: zero.clone(), mu: zero.clone() }),
        };
        let is_isotropic = given.values().iter().all(|hooke| !hooke.is_anisotropic());
        PackedHooke { given, dimension, is_isotropic, zero: zero.clone(), lanes }
    }

    /// Fills the lanes with the laws of `count` cells from `first` on; lanes without a cell repeat the first.
    pub fn set(&mut self, first: usize, count: usize) {
        let BlockValues::Each(all) = self.given else { return };
        let of_lane = |lane: usize| &all[first + if lane < count { lane } else { 0 }];
        // The common case sets two numbers in each lane and allocates nothing.
        if let (Hooke::Isotropic(lanes), true) = (&mut self.lanes, self.is_isotropic) {
            for lane in 0..T::COUNT {
                let Some(Moduli { lambda, mu }) = of_lane(lane).moduli() else { continue };
                lanes.lambda.as_mut_slice()[lane] = lambda;
                lanes.mu.as_mut_slice()[lane] = mu;
            }
            return;
        }
        let pack = |value: &dyn Fn(usize) -> f64| packed(&self.zero, T::COUNT, value);
        // Lanes compute with one kind of law: a single anisotropic cell makes all of them anisotropic.
        let moduli: Option<Vec<Moduli>> = (0..T::COUNT).map(|lane| of_lane(lane).moduli()).collect();
        self.lanes = match moduli {
            Some(moduli) => Hooke::Isotropic(Moduli {
                lambda: pack(&|lane| moduli[lane].lambda),
                mu: pack(&|lane| moduli[lane].mu),
            }),
            None => {
                let each: Vec<(Vec<f64>, f64)> =
                    (0..T::COUNT).map(|lane| of_lane(lane).entries(self.dimension)).collect();
                let entries = (0..each[0].0.len()).map(|e| pack(&|lane| each[lane].0[e])).collect();
                Hooke::Anisotropic(Stiffness::of_parts(self.dimension, entries, pack(&|lane| each[lane].1)))
            }
        };
    }

    /// The law of one cell.
    pub fn of_cell(&self, cell: usize) -> Hooke {
        self.given.at(cell).clone()
    }
}
