//! The cell types of VTK.

/// The dimension of a cell type, and its number of nodes if the type determines it.
pub(super) fn shape(cell_type: u8) -> Option<(usize, Option<usize>)> {
    let (dimension, nodes) = match cell_type {
        1 => (0, 1),
        3 => (1, 2),
        21 => (1, 3),
        35 => (1, 4),
        5 => (2, 3),
        22 => (2, 6),
        34 => (2, 7),
        8 | 9 => (2, 4),
        30 => (2, 6),
        23 => (2, 8),
        28 => (2, 9),
        10 => (3, 4),
        24 => (3, 10),
        11 | 12 => (3, 8),
        25 => (3, 20),
        33 => (3, 24),
        29 => (3, 27),
        13 => (3, 6),
        31 => (3, 12),
        26 => (3, 15),
        32 => (3, 18),
        14 => (3, 5),
        27 => (3, 13),
        15 => (3, 10),
        16 => (3, 12),
        2 => return Some((0, None)),
        4 | 68 => return Some((1, None)),
        6 | 7 | 69 | 70 => return Some((2, None)),
        71..=74 => return Some((3, None)),
        _ => return None,
    };
    Some((dimension, Some(nodes)))
}

/// Whether VTK has a cell type with this number.
pub(super) fn is_known(cell_type: u8) -> bool {
    matches!(cell_type, 1..=16 | 21..=37 | 41 | 42 | 51..=56 | 60..=81)
}

/// The type with the same nodes, in the same order, of a cell of Lagrange's of degree 1 or 2; those of other degrees stay.
fn lagrange(cell_type: u8, nodes: usize) -> u8 {
    match (cell_type, nodes) {
        (68, 2) => 3,
        (68, 3) => 21,
        (69, 3) => 5,
        (69, 6) => 22,
        (70, 4) => 9,
        (70, 9) => 28,
        (71, 4) => 10,
        (71, 10) => 24,
        (72, 8) => 12,
        (72, 27) => 29,
        (73, 6) => 13,
        (73, 18) => 32,
        (74, 5) => 14,
        (other, _) => other,
    }
}

/// Exchanges the middles of the last two upright edges of a hexahedron of Lagrange's where its points say so: VTK before version 9.1, and programs
/// that follow it, have that from 3 to 7 before that from 2 to 6, which other hexahedra have first.
fn untwist(nodes: &mut [usize], points: &[[f64; 3]]) {
    let from_middle = |middle: usize, ends: [usize; 2]| -> f64 {
        let x = |place: usize| points[nodes[place]];
        (0..3).map(|k| (x(middle)[k] - 0.5 * (x(ends[0])[k] + x(ends[1])[k])).powi(2)).sum()
    };
    let kept = from_middle(18, [2, 6]) + from_middle(19, [3, 7]);
    let exchanged = from_middle(19, [2, 6]) + from_middle(18, [3, 7]);
    if exchanged < kept {
        nodes.swap(18, 19);
    }
}

/// Reorders a pixel or a voxel, whose nodes run along the axes, into a quadrangle or hexahedron, and turns a polygon of
/// three or four nodes into a triangle or quadrangle, and a cell of Lagrange's of degree 1 or 2 into the cell with its nodes.
pub(super) fn plain(cell_type: u8, nodes: &mut [usize], points: &[[f64; 3]]) -> u8 {
    match lagrange(cell_type, nodes.len()) {
        29 if cell_type == 72 => {
            untwist(nodes, points);
            29
        }
        8 => {
            nodes.swap(2, 3);
            9
        }
        11 => {
            nodes.swap(2, 3);
            nodes.swap(6, 7);
            12
        }
        7 if nodes.len() == 3 => 5,
        7 if nodes.len() == 4 => 9,
        other => other,
    }
}
