//! The numbers that the nodes of a mesh have in its source.

use super::source::Format;

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
    /// The index of a point in the caller's array, from 0.
    ArrayPlace,
}

impl NumberOrigin {
    /// The meaning of the numbers in a file of this format.
    pub(super) fn of(format: Format) -> NumberOrigin {
        match format {
            Format::Gmsh => NumberOrigin::GmshTag,
            Format::Vtk => NumberOrigin::VtkPlace,
        }
    }
}

impl Numbering {
    /// The kind of number, in words.
    pub fn title(&self) -> &'static str {
        match self.origin {
            NumberOrigin::GmshTag => "Gmsh node tags",
            NumberOrigin::VtkPlace => "places in the VTK file, from 0",
            NumberOrigin::ArrayPlace => "places in the array of points, from 0",
        }
    }

    /// Whether the numbers are consecutive, as they are if no point was removed.
    pub fn is_contiguous(&self) -> bool {
        self.nodes.windows(2).all(|pair| pair[0].checked_add(1) == Some(pair[1]))
    }
}
