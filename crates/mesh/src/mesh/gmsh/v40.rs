//! The sections with a layout of MSH 4.0 in text: a node and its tag stand together, and the tag of an entity before its dimension.

use super::nodes::Nodes;
use super::v41::{Key, cells};
use crate::error::{ErrorKind, Result};
use crate::mesh::grouping::Gather;
use crate::mesh::reader::Reader;

/// What turns a file that is not read into one that is.
pub(super) const CONVERTS: &str = "; what converts it: gmsh old.msh -save -format msh41 -o new.msh";

pub(super) fn nodes(reader: &mut Reader) -> Result<Nodes> {
    let blocks: u64 = reader.number()?;
    let total: u64 = reader.number()?;
    reader.announce("nodes", total);
    let mut tags = Vec::with_capacity(reader.capacity::<u64>(total, 4));
    let mut points = Vec::with_capacity(reader.capacity::<u64>(total, 4));
    for _ in 0..blocks {
        reader.number::<i32>()?;
        reader.number::<i32>()?;
        let parametric: i32 = reader.number()?;
        if parametric != 0 {
            let error = reader.expected("nodes of version 4.0 without parameters", &parametric.to_string());
            return Err(error.of_kind(ErrorKind::Unsupported).followed_by(CONVERTS));
        }
        for _ in 0..reader.number::<u64>()? {
            tags.push(reader.number()?);
            points.push([reader.number()?, reader.number()?, reader.number()?]);
            reader.count_one();
        }
    }
    if points.len() as u64 != total {
        return Err(reader.expected(&format!("{total} nodes"), &points.len().to_string()));
    }
    Nodes::new(tags, points)
}

pub(super) fn elements(reader: &mut Reader, nodes: &Nodes) -> Result<Gather<Key>> {
    let blocks: u64 = reader.number()?;
    let total: u64 = reader.number()?;
    cells(reader, nodes, [blocks, total], |reader| {
        let entity: i32 = reader.number()?;
        Ok([reader.number()?, entity])
    })
}
