//! The numbers that a mesh file gives its nodes.

use super::source::Format;

/// The numbers that the points of a mesh have in their file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Numbering {
    /// The format of the file.
    pub format: Format,
    /// The numbers, `[points]`: tags in a Gmsh file, indices from 0 in a VTK file.
    pub nodes: Vec<u64>,
}

impl Numbering {
    /// The kind of number, in words.
    pub fn title(&self) -> &'static str {
        match self.format {
            Format::Gmsh => "Gmsh node tags",
            Format::Vtk => "places in the VTK file, from 0",
        }
    }

    /// Whether the numbers are consecutive, as they are if no point was removed.
    pub fn is_contiguous(&self) -> bool {
        self.nodes.windows(2).all(|pair| pair[0].checked_add(1) == Some(pair[1]))
    }
}
