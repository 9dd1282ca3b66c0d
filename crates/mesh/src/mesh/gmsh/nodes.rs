//! The nodes of a Gmsh mesh, and their indices by tag.

use crate::error::{Error, ErrorKind, Result};
use crate::mesh::indices::Indices;
use crate::mesh::reader::Reader;

pub(super) struct Nodes {
    pub points: Vec<[f64; 3]>,
    /// The tags of the points.
    pub tags: Vec<u64>,
    places: Indices,
}

impl Nodes {
    /// Nodes in which the one with `tags[i]` is at `points[i]`.
    ///
    /// # Errors
    /// A tag occurs twice.
    pub fn new(tags: Vec<u64>, points: Vec<[f64; 3]>) -> Result<Nodes> {
        let twice = |tag: u64| Error::at("$Nodes", format!("node {tag} occurs twice")).of_kind(ErrorKind::Syntax);
        let places = Indices::of(&tags).map_err(twice)?;
        Ok(Nodes { points, tags, places })
    }

    /// The index into `points` of the node with this tag; `reader` has just read the element that names it.
    ///
    /// # Errors
    /// There is no such node.
    pub fn of_element(&self, reader: &Reader, element: u64, tag: u64) -> Result<usize> {
        let unknown = || reader.fault(format!("element {element} names node {tag}, which $Nodes lacks"));
        self.places.index(tag).ok_or_else(unknown)
    }
}
