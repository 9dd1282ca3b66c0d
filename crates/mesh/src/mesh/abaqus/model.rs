//! Nodes, elements, sets and surfaces of a part, and the body that its instances form.

use super::placement::place;
use super::sets::{On, Patch, Sets};
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::listing::Listing;
use std::collections::HashSet;

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
