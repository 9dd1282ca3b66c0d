//! The numbers that nodes have where a mesh comes from.

use super::source::Format;

/// The numbers that the points of a mesh have in the file or the arrays that they come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Numbering {
    /// What the numbers are.
    pub origin: NumberOrigin,
    /// `[points]`.
    pub nodes: Vec<u64>,
}

/// What the number of a node is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum NumberOrigin {
    /// The tag of a node in a Gmsh file.
    GmshTag,
    /// The place of a point in a VTK file, from 0.
    VtkPlace,
    /// The place of a point in the caller's array, from 0.
    ArrayPlace,
}

impl NumberOrigin {
    /// That of the nodes of a file.
    pub(super) fn of(format: Format) -> NumberOrigin {
        match format {
            Format::Gmsh => NumberOrigin::GmshTag,
            Format::Vtk => NumberOrigin::VtkPlace,
        }
    }
}

impl Numbering {
    /// In words.
    pub fn title(&self) -> &'static str {
        match self.origin {
            NumberOrigin::GmshTag => "Gmsh node tags",
            NumberOrigin::VtkPlace => "places in the VTK file, from 0",
            NumberOrigin::ArrayPlace => "places in the array of points, from 0",
        }
    }

    /// Whether the numbers of the points follow one another, as they do where none was left out.
    pub fn is_contiguous(&self) -> bool {
        self.nodes.windows(2).all(|pair| pair[0].checked_add(1) == Some(pair[1]))
    }
}
