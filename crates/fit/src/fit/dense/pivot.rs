//! Which pivots of an elimination count.

use crate::scalar::Real;

/// `1/pivot`, or nearly zero in place of a pivot that is not above `floor`; `least` becomes the least pivot so far. Pivots are relative to the
/// diagonal `entry`.
#[inline(always)]
pub fn accepted<T: Real>(pivot: T, entry: &T, floor: f64, least: &mut T) -> T {
    let one = pivot.one();
    // Its reciprocal is zero beside those of other pivots, and its square does not overflow.
    let huge = one.constant(&1e30);
    // An entry that is not above zero has no relative pivot; its direction is removed below.
    let diagonal = entry.choose(entry, &one);
    // The quotient is not in the chain from pivot to pivot.
    *least = least.least(&(pivot.clone() / &diagonal));
    // The choice is one of values and no branch, because lanes may differ.
    let pivot = (pivot.clone() - &diagonal.scaled(&floor)).choose(&pivot, &huge);
    one / &pivot
}
