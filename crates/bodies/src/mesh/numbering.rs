//! The numbers that a file gives its nodes.

use super::source::Format;

/// The numbers that the points of a mesh have in the file that they come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Numbering {
    pub format: Format,
    /// `[points]`: tags of a Gmsh file, places from 0 of a VTK file.
    pub nodes: Vec<u64>,
}

impl Numbering {
    /// In words.
    pub fn title(&self) -> &'static str {
        match self.format {
            Format::Gmsh => "Gmsh node tags",
            Format::Vtk => "places in the VTK file, from 0",
        }
    }

    /// Whether the numbers of the points follow one another, as they do where none was left out.
    pub fn is_contiguous(&self) -> bool {
        self.nodes.windows(2).all(|pair| pair[0].checked_add(1) == Some(pair[1]))
    }
}
