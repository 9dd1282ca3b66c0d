//! The sides of which the surfaces of an input file consist.

use super::model::Surface;
use super::sets::{On, Place};
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::listing::{Resolved, missing};
use std::collections::HashSet;

/// The members of the sets, and what is known of elements by their numbers.
pub(super) struct Members<'a> {
    pub elements: &'a [Vec<usize>],
    pub nodes: &'a [Vec<usize>],
    pub left_out: &'a HashSet<u64>,
    pub shells: &'a HashSet<u64>,
}

/// The place that a label of a surface names; `None` for the end of a beam, which is no side here.
///
/// Abaqus has S1 to S6 of solids and plane elements, SPOS, SNEG and E1 to E4 of shells. CalculiX has S1 and S2 for the faces of a shell and S3 to S6 for its
/// edges.
pub(super) fn place(label: &[u8]) -> Option<std::result::Result<Place, &'static str>> {
    let upper = label.to_ascii_uppercase();
    Some(Ok(match &upper[..] {
        b"" => Place::Outer,
        b"SPOS" | b"SNEG" | b"POS" | b"NEG" => Place::Whole,
        [b'S', digit @ b'1'..=b'6'] => Place::Side(usize::from(digit - b'1')),
        [b'E', digit @ b'1'..=b'4'] => Place::Edge(usize::from(digit - b'1')),
        b"END1" | b"END2" | b"END3" => return None,
        _ => return Some(Err("a side S1 to S6, a face SPOS or SNEG or an edge E1 to E4 of a shell")),
    }))
}

/// Adds what the surfaces are on to the groups with their names.
///
/// # Errors
/// A surface names an element that is not there, or a side that none of its elements has.
pub(super) fn add_surfaces(
    resolved: &mut Resolved,
    surfaces: &[Surface],
    names: &[String],
    numbers: &[u64],
    Members { elements, nodes, left_out, shells }: &Members,
) -> Result<()> {
    let is_outer = |surface: &Surface| surface.patches.iter().any(|p| p.place == Place::Outer);
    let outer = if surfaces.iter().any(is_outer) { resolved.outer_sides() } else { HashSet::new() };
    for (Surface { name, line, patches, .. }, title) in surfaces.iter().zip(names) {
        let group = resolved.group(title);
        let missing = |what: &str, number: u64| missing(format!("surface \"{name}\""), *line, what, number);
        for patch in patches {
            let one;
            let cells: &[usize] = match &patch.on {
                On::Nodes(set) => {
                    nodes[*set].iter().try_for_each(|&node| resolved.add_node(group, node))?;
                    continue;
                }
                On::Node(number) => {
                    let node = resolved.nodes.index(*number).ok_or_else(|| missing("node", *number))?;
                    resolved.add_node(group, node)?;
                    continue;
                }
                On::Elements(set) => &elements[*set],
                On::Element(number) => match resolved.cells.index(*number) {
                    Some(cell) => {
                        one = [cell];
                        &one
                    }
                    None if left_out.contains(number) => &[],
                    None => return Err(missing("element", *number)),
                },
            };
            // Of a set with cells of several types some may lack the side.
            let mut has_side = cells.is_empty();
            for &cell in cells {
                let is_solid = resolved.list.cell_type(cell).dimension() == 3;
                let is_shell = shells.contains(&numbers[cell]);
                match patch.place {
                    Place::Side(0 | 1) if is_shell => {
                        resolved.add_cell(group, cell)?;
                        has_side = true;
                    }
                    Place::Side(index) if is_shell => has_side |= resolved.add_side(group, cell, index - 2)?,
                    Place::Side(index) => has_side |= resolved.add_side(group, cell, index)?,
                    Place::Edge(index) if !is_solid => has_side |= resolved.add_side(group, cell, index)?,
                    Place::Edge(_) => {}
                    Place::Whole => {
                        resolved.add_cell(group, cell)?;
                        has_side = true;
                    }
                    Place::Outer if is_solid => {
                        for index in 0..resolved.list.cell_type(cell).sides().len() {
                            if outer.contains(&(cell, index)) {
                                resolved.add_side(group, cell, index)?;
                            }
                        }
                    }
                    Place::Outer => resolved.add_cell(group, cell)?,
                }
            }
            if let (Place::Side(index) | Place::Edge(index), false) = (patch.place, has_side) {
                let most = cells.iter().map(|&cell| resolved.list.cell_type(cell).sides().len()).max().unwrap_or(0);
                let what = if matches!(patch.place, Place::Edge(_)) { "edge" } else { "side" };
                let problem = format!("names {what} {} of elements with {most} sides", index + 1);
                let key = format!("surface \"{name}\"");
                return Err(Error::at(key, problem).of_kind(ErrorKind::Syntax).on_line(*line));
            }
        }
    }
    Ok(())
}
