//! The sections with a layout of MSH 4.1. Text and binary files have the same numbers in the same order.

use super::nodes::Nodes;
use super::types::shape;
use crate::error::Result;
use crate::mesh::grouping::Gather;
use crate::mesh::reader::Reader;
use std::collections::HashMap;

/// The physical tags, in ascending order, of each entity, which is known by dimension and tag.
pub(super) type Entities = HashMap<(i32, i32), Vec<u32>>;

/// Cell type, and dimension and tag of the entity.
pub(super) type Key = (u32, i32, i32);

/// Reads the entities; a point has so many `place` numbers, and other entities have boxes of six.
pub(super) fn entities(reader: &mut Reader, place: usize) -> Result<Entities> {
    reader.start_data()?;
    listed(reader, place, |_| Ok(()))
}

/// Reads the entities of a mesh in partitions, which have tags of their own and the physical tags of their parents.
pub(super) fn partitioned_entities(reader: &mut Reader) -> Result<Entities> {
    reader.start_data()?;
    reader.number::<u64>()?;
    for _ in 0..reader.number::<u64>()? {
        // A ghost entity and its partition.
        reader.number::<i32>()?;
        reader.number::<i32>()?;
    }
    listed(reader, 3, |reader| {
        // The dimension and the tag of the parent, and the partitions.
        reader.number::<i32>()?;
        reader.number::<i32>()?;
        for _ in 0..reader.number::<u64>()? {
            reader.number::<i32>()?;
        }
        Ok(())
    })
}

/// Reads the numbers of entities by dimension, and each entity; `between` reads what stands between its tag and its place.
fn listed(reader: &mut Reader, place: usize, between: impl Fn(&mut Reader) -> Result<()>) -> Result<Entities> {
    let mut counts = [0_u64; 4];
    for count in &mut counts {
        *count = reader.number()?;
    }
    let total = counts.iter().fold(0, |sum: u64, &count| sum.saturating_add(count));
    reader.announce("entities", total);
    let mut entities = Entities::new();
    for (dimension, count) in (0_i32..).zip(counts) {
        for _ in 0..count {
            let tag = reader.number::<i32>()?;
            between(reader)?;
            for _ in 0..if dimension == 0 { place } else { 6 } {
                reader.number::<f64>()?;
            }
            groups(reader, dimension, tag, &mut entities)?;
        }
    }
    Ok(entities)
}

/// Reads the physical tags of an entity, and the tags of those that bound it.
fn groups(reader: &mut Reader, dimension: i32, tag: i32, entities: &mut Entities) -> Result<()> {
    let mut physical = Vec::new();
    for _ in 0..reader.number::<u64>()? {
        // A minus sign stands for the opposite orientation.
        physical.push(reader.number::<i32>()?.unsigned_abs());
    }
    physical.sort_unstable();
    physical.dedup();
    if dimension > 0 {
        for _ in 0..reader.number::<u64>()? {
            reader.number::<i32>()?;
        }
    }
    reader.count_one();
    if !physical.is_empty() {
        entities.insert((dimension, tag), physical);
    }
    Ok(())
}

pub(super) fn nodes(reader: &mut Reader) -> Result<Nodes> {
    reader.start_data()?;
    let blocks: u64 = reader.number()?;
    let total: u64 = reader.number()?;
    reader.number::<u64>()?;
    reader.number::<u64>()?;
    reader.announce("nodes", total);
    let mut tags = Vec::with_capacity(reader.capacity::<u64>(total, 4));
    let mut points = Vec::with_capacity(reader.capacity::<u64>(total, 4));
    for _ in 0..blocks {
        let dimension: i32 = reader.number()?;
        reader.number::<i32>()?;
        let parameters = match reader.number::<i32>()? {
            0 => 0,
            1 => dimension.clamp(0, 3),
            other => return Err(reader.expected("0 or 1 for parametric", &other.to_string())),
        };
        let count: u64 = reader.number()?;
        for _ in 0..count {
            tags.push(reader.number()?);
        }
        for _ in 0..count {
            points.push([reader.number()?, reader.number()?, reader.number()?]);
            for _ in 0..parameters {
                reader.number::<f64>()?;
            }
            reader.count_one();
        }
    }
    if points.len() as u64 != total {
        return Err(reader.expected(&format!("{total} nodes"), &points.len().to_string()));
    }
    Nodes::new(tags, points)
}

pub(super) fn elements(reader: &mut Reader, nodes: &Nodes) -> Result<Gather<Key>> {
    reader.start_data()?;
    let blocks: u64 = reader.number()?;
    let total: u64 = reader.number()?;
    reader.number::<u64>()?;
    reader.number::<u64>()?;
    cells(reader, nodes, [blocks, total], |reader| Ok([reader.number()?, reader.number()?]))
}

/// Reads `total` cells in `blocks` blocks; `entity` reads the dimension and the tag of the entity of a block.
pub(super) fn cells(
    reader: &mut Reader,
    nodes: &Nodes,
    [blocks, total]: [u64; 2],
    entity: impl Fn(&mut Reader) -> Result<[i32; 2]>,
) -> Result<Gather<Key>> {
    reader.announce("elements", total);
    let mut cells = Gather::new();
    let mut found = 0_u64;
    for _ in 0..blocks {
        let [dimension, entity] = entity(reader)?;
        let cell_type: u32 = reader.number()?;
        let (of_type, node_count) = shape(reader, cell_type)?;
        if usize::try_from(dimension) != Ok(of_type) {
            let expected = format!("dimension {of_type} for element type {cell_type}");
            return Err(reader.expected(&expected, &dimension.to_string()));
        }
        let count: u64 = reader.number()?;
        let capacity = reader.capacity::<u64>(count, node_count + 1) * node_count;
        let list = cells.list(&(cell_type, dimension, entity));
        list.reserve(capacity);
        for _ in 0..count {
            let element: u64 = reader.number()?;
            for _ in 0..node_count {
                let tag: u64 = reader.number()?;
                list.push(nodes.of_element(reader, element, tag)?);
            }
            reader.count_one();
            found += 1;
        }
    }
    if found != total {
        return Err(reader.expected(&format!("{total} elements"), &found.to_string()));
    }
    Ok(cells)
}
