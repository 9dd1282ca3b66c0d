//! The numbers that the nodes of a mesh have in its source.

/// The numbers that the points of a mesh have in the file or in the arrays that they come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Numbering {
    /// What the numbers mean.
    pub origin: NumberOrigin,
    /// The numbers, `[points]`.
    pub nodes: Vec<u64>,
}

/// The meaning of a node's number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum NumberOrigin {
    /// The tag of a node in a Gmsh file.
    GmshTag,
    /// The index of a point in a VTK file, from 0.
    VtkPlace,
    /// The number that a node has in a file that numbers its nodes, such as those of Abaqus, Nastran and TetGen.
    NodeNumber,
    /// The place of a point among those of a file of a surface, from 0; corners at equal coordinates are one point in STL.
    FilePlace,
    /// The index of a point in the caller's array, from 0.
    ArrayPlace,
}

impl Numbering {
    /// The kind of number, in words.
    pub fn title(&self) -> &'static str {
        match self.origin {
            NumberOrigin::GmshTag => "Gmsh node tags",
            NumberOrigin::VtkPlace => "places in the VTK file, from 0",
            NumberOrigin::NodeNumber => "node numbers of the file",
            NumberOrigin::FilePlace => "places among the points of the file, from 0",
            NumberOrigin::ArrayPlace => "places in the array of points, from 0",
        }
    }

    /// Whether the numbers are consecutive, as they are if no point was removed.
    pub fn is_contiguous(&self) -> bool {
        self.nodes.windows(2).all(|pair| pair[0].checked_add(1) == Some(pair[1]))
    }
}
