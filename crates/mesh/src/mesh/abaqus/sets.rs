//! Sets of nodes or elements, and surfaces, before the numbers in them have been found.

use crate::error::{Error, ErrorKind, Result};
use crate::mesh::indices::Indices;
use crate::mesh::listing::{Resolved, missing};
use std::collections::{HashMap, HashSet};

/// Sets of one kind by name.
#[derive(Default)]
pub(super) struct Sets {
    pub sets: Vec<Set>,
    places: HashMap<String, usize>,
}

/// What a set lists.
#[derive(Default)]
pub(super) struct Set {
    pub name: String,
    /// The line on which it was first named.
    pub line: usize,
    pub numbers: Vec<u64>,
    /// First, last and step.
    pub ranges: Vec<[u64; 3]>,
    /// Indices of sets of the same kind, all before this one; they count with the members that they have at last.
    pub sets: Vec<usize>,
    /// Indices of sets of elements whose nodes belong to this set.
    pub of_elements: Vec<usize>,
}

impl Sets {
    /// The index of the set with this name, which is added if it is new. Names are compared without regard to case.
    pub fn named(&mut self, name: &str, line: usize) -> usize {
        let next = self.sets.len();
        let place = *self.places.entry(name.to_uppercase()).or_insert(next);
        if place == next {
            self.sets.push(Set { name: name.to_string(), line, ..Set::default() });
        }
        place
    }

    pub fn find(&self, name: &str) -> Option<usize> {
        self.places.get(&name.to_uppercase()).copied()
    }

    /// The members of each set as indices, ascending. `left_out` are numbers of things that are not read.
    ///
    /// # Errors
    /// A set names a number that is not there, or the sets have more than `most` members in all.
    pub fn members(
        &self,
        what: &str,
        numbers: &[u64],
        places: &Indices,
        left_out: &HashSet<u64>,
        most: usize,
    ) -> Result<Vec<Vec<usize>>> {
        let mut members: Vec<Vec<usize>> = Vec::with_capacity(self.sets.len());
        let mut total = 0;
        for set in &self.sets {
            let mut list = Vec::new();
            for &number in &set.numbers {
                match places.index(number) {
                    Some(place) => list.push(place),
                    None if left_out.contains(&number) => {}
                    None => return Err(missing(format!("set \"{}\"", set.name), set.line, what, number)),
                }
            }
            for &range in &set.ranges {
                // Numbers in a range need not exist.
                let (found, walked) = places.in_range(numbers, range);
                list.extend(found);
                total += walked;
                check(total, most)?;
            }
            for &other in &set.sets {
                list.extend(&members[other]);
                check(total + list.len(), most)?;
            }
            list.sort_unstable();
            list.dedup();
            total += list.len();
            check(total, most)?;
            members.push(list);
        }
        Ok(members)
    }
}

fn check(found: usize, most: usize) -> Result<()> {
    if found > most {
        let expected = format!("at most {most} members in a file of this length");
        return Err(Error::expected("sets", expected, "more").of_kind(ErrorKind::Limit));
    }
    Ok(())
}

/// A part of a surface: what it is on, and where on it.
pub(super) struct Patch {
    pub on: On,
    pub place: Place,
}

pub(super) enum On {
    Element(u64),
    /// The index of a set of elements.
    Elements(usize),
    /// The index of a set of nodes.
    Nodes(usize),
    Node(u64),
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Place {
    /// The side with this index.
    Side(usize),
    /// The sides that belong to one element alone.
    Outer,
    /// The element itself: a side of a shell.
    Whole,
}

/// Adds what the surfaces are on to the groups with their names.
///
/// # Errors
/// A surface names an element that is not there, or a side that none of its elements has.
pub(super) fn add_surfaces(
    resolved: &mut Resolved,
    surfaces: &[(String, usize, Vec<Patch>)],
    elements: &[Vec<usize>],
    nodes: &[Vec<usize>],
    left_out: &HashSet<u64>,
) -> Result<()> {
    let is_outer = |(_, _, patches): &(String, usize, Vec<Patch>)| patches.iter().any(|p| p.place == Place::Outer);
    let outer = if surfaces.iter().any(is_outer) { resolved.outer_sides() } else { HashSet::new() };
    for (name, line, patches) in surfaces {
        let group = resolved.group(name);
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
                match patch.place {
                    Place::Side(index) => has_side |= resolved.add_side(group, cell, index)?,
                    Place::Whole => resolved.add_cell(group, cell)?,
                    Place::Outer if resolved.list.cell_type(cell).dimension() == 3 => {
                        for index in 0..resolved.list.cell_type(cell).sides().len() {
                            if outer.contains(&(cell, index)) {
                                resolved.add_side(group, cell, index)?;
                            }
                        }
                    }
                    Place::Outer => resolved.add_cell(group, cell)?,
                }
            }
            if let (Place::Side(index), false) = (patch.place, has_side) {
                let most = cells.iter().map(|&cell| resolved.list.cell_type(cell).sides().len()).max().unwrap_or(0);
                let problem = format!("names side {} of elements with {most} sides", index + 1);
                let key = format!("surface \"{name}\"");
                return Err(Error::at(key, problem).of_kind(ErrorKind::Syntax).on_line(*line));
            }
        }
    }
    Ok(())
}
