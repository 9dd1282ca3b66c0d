//! The element types of Gmsh.

use crate::error::{ErrorKind, Result};
use crate::mesh::reader::Reader;

/// Number, dimension and number of nodes of each type with a fixed number of nodes.
#[rustfmt::skip]
const TYPES: &[(u32, usize, usize)] = &[
    (15, 0, 1),
    // lines, orders 1 to 10
    (1, 1, 2), (8, 1, 3), (26, 1, 4), (27, 1, 5), (28, 1, 6), (62, 1, 7), (63, 1, 8), (64, 1, 9), (65, 1, 10),
    (66, 1, 11),
    // triangles, complete and serendipity
    (2, 2, 3), (9, 2, 6), (21, 2, 10), (23, 2, 15), (25, 2, 21), (42, 2, 28), (43, 2, 36), (44, 2, 45), (45, 2, 55),
    (46, 2, 66), (20, 2, 9), (22, 2, 12), (24, 2, 15), (52, 2, 18), (53, 2, 21), (54, 2, 24), (55, 2, 27), (56, 2, 30),
    // quadrangles, complete and serendipity
    (3, 2, 4), (10, 2, 9), (36, 2, 16), (37, 2, 25), (38, 2, 36), (47, 2, 49), (48, 2, 64), (49, 2, 81), (50, 2, 100),
    (51, 2, 121), (16, 2, 8), (39, 2, 12), (40, 2, 16), (41, 2, 20), (57, 2, 24), (58, 2, 28), (59, 2, 32), (60, 2, 36),
    (61, 2, 40),
    // tetrahedra, complete and serendipity
    (4, 3, 4), (11, 3, 10), (29, 3, 20), (30, 3, 35), (31, 3, 56), (71, 3, 84), (72, 3, 120), (73, 3, 165),
    (74, 3, 220), (75, 3, 286), (137, 3, 16), (32, 3, 22), (33, 3, 28), (79, 3, 34), (80, 3, 40), (81, 3, 46),
    (82, 3, 52), (83, 3, 58),
    // hexahedra, complete and serendipity
    (5, 3, 8), (12, 3, 27), (92, 3, 64), (93, 3, 125), (94, 3, 216), (95, 3, 343), (96, 3, 512), (97, 3, 729),
    (98, 3, 1000), (17, 3, 20), (99, 3, 32), (100, 3, 44), (101, 3, 56), (102, 3, 68), (103, 3, 80), (104, 3, 92),
    (105, 3, 104),
    // prisms, complete and serendipity
    (6, 3, 6), (13, 3, 18), (90, 3, 40), (91, 3, 75), (18, 3, 15),
    // pyramids, complete and serendipity
    (7, 3, 5), (14, 3, 14), (118, 3, 30), (119, 3, 55), (120, 3, 91), (121, 3, 140), (122, 3, 204), (123, 3, 285),
    (124, 3, 385), (19, 3, 13), (125, 3, 21), (126, 3, 29), (127, 3, 37), (128, 3, 45), (129, 3, 53), (130, 3, 61),
    (131, 3, 69),
];

/// Dimension and number of nodes of the type with this number.
pub(super) fn find(number: u32) -> Option<(usize, usize)> {
    TYPES.iter().find(|t| t.0 == number).map(|&(_, dimension, nodes)| (dimension, nodes))
}

/// Dimension and number of nodes of the type whose number `reader` has just read.
pub(super) fn shape(reader: &Reader, number: u32) -> Result<(usize, usize)> {
    let unknown = || reader.fault(format!("element type {number} is unknown")).of_kind(ErrorKind::Unsupported);
    find(number).ok_or_else(unknown)
}
