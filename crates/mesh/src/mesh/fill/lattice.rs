//! The lattices of cubes and of tetrahedra, in half edges of a cube from the corner of least coordinates.

use crate::element::Cell;

/// One of the cells that repeat from cube to cube: its corners in half edges, in the order of the reference cell.
pub(super) struct Pattern {
    pub corners: Vec<[i32; 3]>,
    /// Four times the mean of the corners, which is whole for every pattern of cubes and tetrahedra here.
    pub centre: [i32; 3],
}

impl Pattern {
    fn of(corners: Vec<[i32; 3]>) -> Pattern {
        let count = corners.len() as i32;
        let centre = std::array::from_fn(|k| 4 * corners.iter().map(|c| c[k]).sum::<i32>() / count);
        Pattern { corners, centre }
    }
}

/// The cells for each cube: the cube itself, or the twelve tetrahedra of the body-centred cubic lattice whose first corner is
/// its centre. Each of those has its centre, that of a neighbour across a face, and an edge of that face as corners; all are
/// congruent. Empty for other cells.
pub(super) fn patterns(cell: Cell) -> Vec<Pattern> {
    match cell {
        Cell::Hexahedron => {
            let corners = cell.corners().iter().map(|c| [0, 1, 2].map(|k| if c[k] > 0.0 { 2 } else { 0 }));
            vec![Pattern::of(corners.collect())]
        }
        Cell::Tetrahedron => {
            let mut patterns = Vec::new();
            for (a, b, c) in [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)] {
                for sign in [-1, 1] {
                    let mut other = [1; 3];
                    other[a] = 3;
                    let end = |along: i32| {
                        let mut end = [1; 3];
                        end[a] = 2;
                        end[b] += sign;
                        end[c] += along;
                        end
                    };
                    patterns.push(Pattern::of(vec![[1; 3], other, end(-1), end(1)]));
                }
            }
            patterns
        }
        _ => Vec::new(),
    }
}
