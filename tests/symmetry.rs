//! The symmetry of reference cells.

use springfit_element::element::{Cell, permutations};

/// The orders of the groups: 2, 6, 8, 24, 48, the wedge's 6 · 2, the pyramid's 8; of the rational pentagon its mirror.
#[test]
fn cells_have_the_symmetry_of_their_shape() {
    let orders = Cell::ALL.map(|cell| {
        let corners = cell.corners().concat();
        permutations(cell, &corners).len()
    });
    assert_eq!(orders, [2, 6, 8, 2, 24, 48, 12, 8]);
}
