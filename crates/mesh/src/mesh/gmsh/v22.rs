//! The sections with a layout of MSH 2.2, and of MSH 1, whose elements state their number of nodes.

use super::nodes::Nodes;
use super::types::shape;
use crate::error::{ErrorKind, Result};
use crate::mesh::grouping::Gather;
use crate::mesh::reader::{Encoding, Reader};

/// The largest number of groups of a cell, because each new group is compared with all previous ones.
const MOST_GROUPS: usize = 1000;

/// Cell type, and physical tags in ascending order.
pub(super) type Key = (u32, Vec<u32>);

/// Reads the nodes; `parametric` for a section that adds an entity and parameters to each node.
pub(super) fn nodes(reader: &mut Reader, parametric: bool) -> Result<Nodes> {
    let total: u64 = reader.text_number()?;
    reader.start_data()?;
    reader.announce("nodes", total);
    // Memory is taken for no more numbers than the bytes that follow can hold, whatever the file counts.
    let mut tags = Vec::with_capacity(reader.capacity::<f64>(total, 3));
    let mut points = Vec::with_capacity(reader.capacity::<f64>(total, 3));
    for _ in 0..total {
        tags.push(node_tag(reader)?);
        points.push([reader.number()?, reader.number()?, reader.number()?]);
        if parametric {
            let dimension: i32 = reader.number()?;
            reader.number::<i32>()?;
            let parameters = if dimension == 1 || dimension == 2 { dimension } else { 0 };
            for _ in 0..parameters {
                reader.number::<f64>()?;
            }
        }
        reader.count_one();
    }
    Nodes::new(tags, points)
}

/// Reads the elements; `counted` if each has two tags and states its number of nodes, as in MSH 1.
pub(super) fn elements(reader: &mut Reader, nodes: &Nodes, counted: bool) -> Result<Gather<Key>> {
    let total: u64 = reader.text_number()?;
    reader.start_data()?;
    reader.announce("elements", total);
    let mut cells = Cells::new();
    if reader.encoding == Encoding::Text {
        for _ in 0..total {
            let element: u64 = reader.number()?;
            let cell_type = reader.number()?;
            let (_, node_count) = shape(reader, cell_type)?;
            let tags: u64 = if counted { 2 } else { reader.number()? };
            cells.read(reader, nodes, Header { element, cell_type, tags, node_count, counted })?;
        }
    } else {
        let mut found = 0;
        while found < total {
            let cell_type = reader.number()?;
            let (_, node_count) = shape(reader, cell_type)?;
            let count: u32 = reader.number()?;
            let tags: u32 = reader.number()?;
            found += u64::from(count);
            if found > total {
                return Err(reader.expected(&format!("{total} elements"), &found.to_string()));
            }
            for _ in 0..count {
                let element = u64::from(reader.number::<u32>()?);
                let tags = tags.into();
                cells.read(reader, nodes, Header { element, cell_type, tags, node_count, counted })?;
            }
        }
    }
    cells.close();
    Ok(cells.gather)
}

/// The numbers before the tags of an element.
struct Header {
    element: u64,
    cell_type: u32,
    tags: u64,
    node_count: usize,
    counted: bool,
}

/// The cells that have been read so far.
///
/// The format repeats a cell for each of its physical groups, so that the last cell is kept until the next one differs.
struct Cells {
    gather: Gather<Key>,
    key: Key,
    entity: i32,
    nodes: Vec<usize>,
    next: Vec<usize>,
}

impl Cells {
    fn new() -> Self {
        Cells { gather: Gather::new(), key: (0, Vec::new()), entity: 0, nodes: Vec::new(), next: Vec::new() }
    }

    fn read(&mut self, reader: &mut Reader, nodes: &Nodes, header: Header) -> Result<()> {
        let Header { element, cell_type, tags, node_count, counted } = header;
        let (mut physical, mut entity) = (0, 0);
        for i in 0..tags {
            let tag: i32 = reader.number()?;
            match i {
                // A minus sign stands for the opposite orientation.
                0 => physical = tag.unsigned_abs(),
                1 => entity = tag,
                _ => {}
            }
        }
        if counted {
            let found: u64 = reader.number()?;
            if found != node_count as u64 {
                let expected = format!("{node_count} nodes of element {element} with type {cell_type}");
                return Err(reader.expected(&expected, &found.to_string()));
            }
        }
        self.next.clear();
        for _ in 0..node_count {
            let tag = node_tag(reader)?;
            self.next.push(nodes.of_element(reader, element, tag)?);
        }
        reader.count_one();
        let (last_type, groups) = &mut self.key;
        // Version 2.2 writes a cell once for each physical group that it belongs to.
        let again = *last_type == cell_type && self.entity == entity && self.nodes == self.next;
        if again && physical != 0 && !groups.is_empty() && !groups.contains(&physical) {
            groups.push(physical);
            if groups.len() > MOST_GROUPS {
                let expected = format!("element {element} in at most {MOST_GROUPS} physical groups");
                return Err(reader.expected(&expected, "more").of_kind(ErrorKind::Limit));
            }
            return Ok(());
        }
        self.close();
        self.key.0 = cell_type;
        self.key.1.extend((physical != 0).then_some(physical));
        self.entity = entity;
        std::mem::swap(&mut self.nodes, &mut self.next);
        Ok(())
    }

    /// Stores the cell that was kept.
    fn close(&mut self) {
        self.key.1.sort_unstable();
        self.gather.list(&self.key).append(&mut self.nodes);
        self.key.1.clear();
    }
}

fn node_tag(reader: &mut Reader) -> Result<u64> {
    if reader.encoding == Encoding::Text {
        return reader.number();
    }
    reader.number::<u32>().map(u64::from)
}
