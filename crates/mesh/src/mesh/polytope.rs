//! The cell types of VTK that the readers of numbered formats make: their faces and the middles of their edges.

use super::source::SourceBlock;

/// A type of cell by its number in VTK.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct CellType(pub u8);

impl CellType {
    pub const POINT: CellType = CellType(1);
    pub const LINE2: CellType = CellType(3);
    pub const LINE3: CellType = CellType(21);
    pub const TRI3: CellType = CellType(5);
    pub const TRI6: CellType = CellType(22);
    pub const QUAD4: CellType = CellType(9);
    pub const QUAD8: CellType = CellType(23);
    pub const QUAD9: CellType = CellType(28);
    pub const TET4: CellType = CellType(10);
    pub const TET10: CellType = CellType(24);
    pub const HEX8: CellType = CellType(12);
    pub const HEX20: CellType = CellType(25);
    pub const WEDGE6: CellType = CellType(13);
    pub const WEDGE15: CellType = CellType(26);
    pub const PYRAMID5: CellType = CellType(14);
    pub const PYRAMID13: CellType = CellType(27);

    /// Dimension, number of corners, number of nodes.
    fn shape(self) -> (usize, usize, usize) {
        match self {
            CellType::LINE2 => (1, 2, 2),
            CellType::LINE3 => (1, 2, 3),
            CellType::TRI3 => (2, 3, 3),
            CellType::TRI6 => (2, 3, 6),
            CellType::QUAD4 => (2, 4, 4),
            CellType::QUAD8 => (2, 4, 8),
            CellType::QUAD9 => (2, 4, 9),
            CellType::TET4 => (3, 4, 4),
            CellType::TET10 => (3, 4, 10),
            CellType::HEX8 => (3, 8, 8),
            CellType::HEX20 => (3, 8, 20),
            CellType::WEDGE6 => (3, 6, 6),
            CellType::WEDGE15 => (3, 6, 15),
            CellType::PYRAMID5 => (3, 5, 5),
            CellType::PYRAMID13 => (3, 5, 13),
            _ => (0, 1, 1),
        }
    }

    /// Points and sides of this type that belong to these groups.
    pub fn block(self, connectivity: Vec<usize>, groups: Vec<String>) -> SourceBlock {
        SourceBlock {
            dimension: self.dimension(),
            cell_type: self.0.into(),
            nodes_per_cell: self.nodes(),
            connectivity,
            groups,
            is_marker: true,
            runs: Vec::new(),
        }
    }

    /// Cells of this type that belong to these groups.
    pub fn cells(self, connectivity: Vec<usize>, groups: Vec<String>) -> SourceBlock {
        SourceBlock { is_marker: false, ..self.block(connectivity, groups) }
    }

    pub fn dimension(self) -> usize {
        self.shape().0
    }

    pub fn nodes(self) -> usize {
        self.shape().2
    }

    /// The corners of each side, in the order in which Abaqus numbers the sides.
    pub fn sides(self) -> &'static [&'static [usize]] {
        match self.shape() {
            (2, 3, _) => &[&[0, 1], &[1, 2], &[2, 0]],
            (2, 4, _) => &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]],
            (3, 4, _) => &[&[0, 1, 2], &[0, 3, 1], &[1, 3, 2], &[2, 3, 0]],
            (3, 5, _) => &[&[0, 1, 2, 3], &[0, 4, 1], &[1, 4, 2], &[2, 4, 3], &[3, 4, 0]],
            (3, 6, _) => &[&[0, 1, 2], &[3, 5, 4], &[0, 3, 4, 1], &[1, 4, 5, 2], &[2, 5, 3, 0]],
            (3, 8, _) => &[&[0, 1, 2, 3], &[4, 7, 6, 5], &[0, 4, 5, 1], &[1, 5, 6, 2], &[2, 6, 7, 3], &[3, 7, 4, 0]],
            _ => &[],
        }
    }

    /// The ends of the edges in whose middles the nodes after the corners are; empty for cells of corners alone.
    pub fn middles(self) -> &'static [[usize; 2]] {
        match self {
            CellType::LINE3 => &[[0, 1]],
            CellType::TRI6 => &[[0, 1], [1, 2], [2, 0]],
            CellType::QUAD8 | CellType::QUAD9 => &[[0, 1], [1, 2], [2, 3], [3, 0]],
            CellType::TET10 => &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]],
            CellType::PYRAMID13 => &[[0, 1], [1, 2], [2, 3], [3, 0], [0, 4], [1, 4], [2, 4], [3, 4]],
            CellType::WEDGE15 => &[[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]],
            CellType::HEX20 => {
                &[[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]]
            }
            _ => &[],
        }
    }

    /// The side with this index of a cell with these nodes: its type and its nodes, corners first.
    pub fn side(self, index: usize, cell: &[usize]) -> Option<(CellType, Vec<usize>)> {
        let corners = *self.sides().get(index)?;
        let mut nodes: Vec<usize> = corners.iter().map(|&a| cell[a]).collect();
        let (_, first, _) = self.shape();
        let is_closed = corners.len() > 2;
        let edges = if is_closed { corners.len() } else { 1 };
        for i in 0..edges {
            let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
            let joins = |ends: &[usize; 2]| *ends == [a, b] || *ends == [b, a];
            if let Some(edge) = self.middles().iter().position(joins) {
                nodes.push(cell[first + edge]);
            }
        }
        let cell_type = match nodes.len() {
            2 => CellType::LINE2,
            3 if is_closed => CellType::TRI3,
            3 => CellType::LINE3,
            4 => CellType::QUAD4,
            6 => CellType::TRI6,
            _ => CellType::QUAD8,
        };
        Some((cell_type, nodes))
    }
}
