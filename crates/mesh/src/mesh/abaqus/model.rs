//! Nodes, elements, sets and surfaces of a part, and the body that its instances form.

use super::placement::place;
use super::sets::{On, Patch, Sets};
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::listing::Listing;
use std::collections::{HashMap, HashSet};

/// What the lines of a part, of an instance or of a flat file state.
#[derive(Default, Clone)]
pub(super) struct Model {
    pub listing: Listing,
    pub node_sets: Sets,
    pub element_sets: Sets,
    pub surfaces: Vec<Surface>,
    /// The numbers of elements that are no part of the body.
    pub left_out: HashSet<u64>,
    /// The numbers of elements of types of shells and membranes, whose first two sides are their faces.
    pub shells: HashSet<u64>,
    nodes: Places,
    cells: Places,
    /// The first cell of each type name, in the order of the cells.
    type_names: Vec<(usize, String)>,
}

/// Where the numbers of a growing list are, as far as they have been asked for.
#[derive(Default, Clone)]
struct Places {
    places: HashMap<u64, usize>,
    seen: usize,
}

impl Places {
    fn find(&mut self, numbers: &[u64], number: u64) -> Option<usize> {
        self.places.extend(numbers.iter().enumerate().skip(self.seen).map(|(place, &number)| (number, place)));
        self.seen = numbers.len();
        self.places.get(&number).copied()
    }
}

/// A surface by its patches.
#[derive(Clone)]
pub(super) struct Surface {
    pub name: String,
    /// The instance of the part that has the surface.
    pub instance: Option<String>,
    /// The line on which it is named.
    pub line: usize,
    pub patches: Vec<Patch>,
}

/// An instance of a part in the assembly: what is added to the numbers of its nodes and elements.
pub(super) struct Instance {
    pub name: String,
    pub nodes: u64,
    pub elements: u64,
}

impl Model {
    /// The place of the node with this number.
    pub fn node(&mut self, number: u64) -> Option<usize> {
        self.nodes.find(&self.listing.node_numbers, number)
    }

    /// The place of the cell with this number.
    pub fn cell(&mut self, number: u64) -> Option<usize> {
        self.cells.find(&self.listing.cells.numbers, number)
    }

    /// Adds a node, or moves the one of this number.
    pub fn put_node(&mut self, number: u64, point: [f64; 3]) {
        match self.node(number) {
            Some(place) => self.listing.points[place] = point,
            None => {
                self.listing.node_numbers.push(number);
                self.listing.points.push(point);
            }
        }
    }

    /// Says the type of the last `added` cells and of those that follow.
    pub fn begin_type(&mut self, name: &str, added: usize) {
        if self.type_names.last().is_none_or(|(_, last)| last != name) {
            self.type_names.push((self.listing.cells.len() - added, name.to_string()));
        }
    }

    /// The type of a cell as the file names it.
    pub fn type_name(&self, cell: usize) -> &str {
        let after = self.type_names.partition_point(|(first, _)| *first <= cell);
        after.checked_sub(1).map_or("", |of| &self.type_names[of].1)
    }

    /// Adds an instance of a part, where its lines put it. The numbers of the first stay, those of others follow.
    ///
    /// # Errors
    /// The lines have another form, or numbers become too large.
    pub fn add(&mut self, name: &str, mut part: Model, placement: &[Vec<f64>]) -> Result<Instance> {
        place(&mut part.listing.points, placement)?;
        let after = |numbers: &[u64]| numbers.iter().max().copied().unwrap_or(0);
        let nodes = after(&self.listing.node_numbers);
        let elements = after(&self.listing.cells.numbers).max(self.left_out.iter().max().copied().unwrap_or(0));
        let limit = |number: u64, add: u64| {
            number.checked_add(add).ok_or_else(|| {
                Error::at("*INSTANCE", "has numbers that are too large in an assembly").of_kind(ErrorKind::Limit)
            })
        };
        let shifted =
            |list: &mut Vec<u64>, add: u64| list.iter_mut().try_for_each(|n| limit(*n, add).map(|new| *n = new));
        shifted(&mut part.listing.node_numbers, nodes)?;
        part.listing.cells.shift(nodes, elements).ok_or_else(|| limit(u64::MAX, 1).unwrap_err())?;
        self.listing.node_numbers.append(&mut part.listing.node_numbers);
        self.listing.points.append(&mut part.listing.points);
        self.listing.cells.append(part.listing.cells);
        let moved = |set: HashSet<u64>| set.into_iter().map(|n| limit(n, elements)).collect::<Result<HashSet<u64>>>();
        self.left_out.extend(moved(part.left_out)?);
        self.shells.extend(moved(part.shells)?);
        let [of_nodes, of_elements] = [self.node_sets.sets.len(), self.element_sets.sets.len()];
        self.node_sets.add(part.node_sets, name, nodes, of_elements)?;
        self.element_sets.add(part.element_sets, name, elements, of_elements)?;
        for mut surface in part.surfaces {
            surface.instance = Some(name.to_string());
            for patch in &mut surface.patches {
                match &mut patch.on {
                    On::Element(number) => *number = limit(*number, elements)?,
                    On::Node(number) => *number = limit(*number, nodes)?,
                    On::Elements(set) => *set += of_elements,
                    On::Nodes(set) => *set += of_nodes,
                }
            }
            self.surfaces.push(surface);
        }
        Ok(Instance { name: name.to_string(), nodes, elements })
    }

    /// The names of the groups of sets of nodes, of sets of elements and of surfaces. Those of an instance have its name before them if there are
    /// several, or if the assembly has something else of their name.
    pub fn names(&self, instances: usize) -> [Vec<String>; 3] {
        let of_assembly: HashSet<String> = {
            let sets = self.node_sets.sets.iter().chain(&self.element_sets.sets);
            let sets = sets.filter(|set| set.instance.is_none()).map(|set| set.name.to_uppercase());
            let surfaces = self.surfaces.iter().filter(|surface| surface.instance.is_none());
            sets.chain(surfaces.map(|surface| surface.name.to_uppercase())).collect()
        };
        let name = |name: &str, instance: Option<&str>| match instance {
            Some(instance) if instances > 1 || of_assembly.contains(&name.to_uppercase()) => {
                format!("{instance}.{name}")
            }
            _ => name.to_string(),
        };
        let of_sets = |sets: &Sets| sets.sets.iter().map(|set| name(&set.name, set.instance.as_deref())).collect();
        let of_surfaces = self.surfaces.iter().map(|surface| name(&surface.name, surface.instance.as_deref()));
        [of_sets(&self.node_sets), of_sets(&self.element_sets), of_surfaces.collect()]
    }
}
