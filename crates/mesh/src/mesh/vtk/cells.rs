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
        68 => return Some((1, None)),
        7 | 69 | 70 => return Some((2, None)),
        71..=74 => return Some((3, None)),
        _ => return None,
    };
    Some((dimension, Some(nodes)))
}

/// Whether VTK has a cell type with this number.
pub(super) fn is_known(cell_type: u8) -> bool {
    matches!(cell_type, 1..=16 | 21..=37 | 41 | 42 | 51..=56 | 60..=81)
}

/// Reorders a pixel or a voxel, whose nodes run along the axes, into a quadrangle or hexahedron, and turns a polygon of
/// three or four nodes into a triangle or quadrangle.
pub(super) fn without_raster(cell_type: u8, nodes: &mut [usize]) -> u8 {
    match cell_type {
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
