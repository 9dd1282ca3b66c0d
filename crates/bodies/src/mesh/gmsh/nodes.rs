//! The nodes of a Gmsh mesh, and their indices by tag.

use crate::error::{Error, ErrorKind, Result};
use crate::mesh::reader::Reader;
use std::collections::HashMap;

pub(super) struct Nodes {
    pub points: Vec<[f64; 3]>,
    /// The tags of the points.
    pub tags: Vec<u64>,
    places: Places,
}

enum Places {
    /// The index of the node with tag `first + i` is at `i`; `ABSENT` for a tag without a node.
    Dense {
        first: u64,
        places: Vec<usize>,
    },
    Sparse(HashMap<u64, usize>),
}

/// Marks a tag without a node.
const ABSENT: usize = usize::MAX;

impl Nodes {
    /// Nodes in which the one with `tags[i]` is at `points[i]`.
    ///
    /// # Errors
    /// A tag occurs twice.
    pub fn new(tags: Vec<u64>, points: Vec<[f64; 3]>) -> Result<Nodes> {
        let twice = |tag: u64| Error::at("$Nodes", format!("node {tag} occurs twice")).of_kind(ErrorKind::Syntax);
        let first = tags.iter().copied().min().unwrap_or(0);
        let span = tags.iter().copied().max().unwrap_or(0) - first;
        let dense = usize::try_from(span).ok().filter(|&span| span / 4 <= tags.len());
        let places = if let Some(span) = dense {
            let mut places = vec![ABSENT; span + 1];
            for (i, &tag) in tags.iter().enumerate() {
                // `tag - first` is at most `span`, which is a `usize`
                if std::mem::replace(&mut places[(tag - first) as usize], i) != ABSENT {
                    return Err(twice(tag));
                }
            }
            Places::Dense { first, places }
        } else {
            let mut places = HashMap::with_capacity(tags.len());
            for (i, &tag) in tags.iter().enumerate() {
                if places.insert(tag, i).is_some() {
                    return Err(twice(tag));
                }
            }
            Places::Sparse(places)
        };
        Ok(Nodes { points, tags, places })
    }

    /// The index into `points` of the node with this tag; `reader` has just read the element that names it.
    ///
    /// # Errors
    /// There is no such node.
    pub fn of_element(&self, reader: &Reader, element: u64, tag: u64) -> Result<usize> {
        let unknown = || reader.fault(format!("element {element} names node {tag}, which $Nodes lacks"));
        self.place(tag).ok_or_else(unknown)
    }

    fn place(&self, tag: u64) -> Option<usize> {
        match &self.places {
            Places::Dense { first, places } => {
                let i = usize::try_from(tag.checked_sub(*first)?).ok()?;
                places.get(i).copied().filter(|&place| place != ABSENT)
            }
            Places::Sparse(places) => places.get(&tag).copied(),
        }
    }
}
