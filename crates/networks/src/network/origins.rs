//! The groups of the element files that the springs of a network come from.

use super::record::OriginRecord;
use crate::element::SpringKind;
use crate::mesh::{CellBlock, Mesh};
use crate::model::Network;
use crate::springs::Springs;
use std::collections::HashMap;

/// The groups, and those of each spring.
pub struct Origins {
    /// The elements and groups.
    pub records: Vec<OriginRecord>,
    sets: Sets,
    /// The set of each spring, `[springs]`, length springs first.
    places: Vec<u32>,
}

impl Origins {
    /// Finds the origins of a network that the springs of each block of cells make.
    pub fn of(mesh: &Mesh, network: &Network, springs: &[Springs]) -> Origins {
        let mut records = Vec::new();
        let of_block = |(block, springs): (&CellBlock, &Springs)| {
            let named: Vec<usize> =
                springs.names().iter().map(|name| place(&mut records, &block.element.name, name)).collect();
            springs.groups().iter().map(|&g| named[g]).collect()
        };
        let groups: Vec<Vec<usize>> = mesh.blocks.iter().zip(springs).map(of_block).collect();
        let mut origins = Origins { sets: Sets::of(records.len()), records, places: vec![0; network.len()] };
        origins.add_lengths(mesh, network, springs, &groups);
        origins.add_others(mesh, network, springs, &groups);
        origins
    }

    /// The groups of spring s; none of one that belongs to no cell.
    pub fn groups(&self, s: usize) -> &[usize] {
        &self.sets.sets[self.places[s] as usize]
    }

    /// Those of springs between two points: of all cells that have a spring there.
    fn add_lengths(&mut self, mesh: &Mesh, network: &Network, springs: &[Springs], groups: &[Vec<usize>]) {
        let mut starts = vec![0; mesh.point_count() + 1];
        network.lengths.iter().for_each(|spring| starts[spring.points[0] + 1] += 1);
        (1..starts.len()).for_each(|p| starts[p] += starts[p - 1]);
        // Springs with laws, which are among the others.
        let ends = |points: &[usize]| [points[0].min(points[1]), points[0].max(points[1])];
        let others = || (network.lengths.len()..).zip(&network.others).filter(|(_, s)| s.kind == SpringKind::Length);
        let mut lawful: HashMap<[usize; 2], u32> = others().map(|(_, s)| (ends(&s.points), 0)).collect();
        for ((block, springs), groups) in mesh.blocks.iter().zip(springs).zip(groups) {
            for nodes in block.cells() {
                for (&[a, b], &group) in springs.pairs().iter().zip(groups) {
                    let [low, high] = ends(&[nodes[a], nodes[b]]);
                    let around = &network.lengths[starts[low]..starts[low + 1]];
                    if let Ok(at) = around.binary_search_by_key(&high, |spring| spring.points[1]) {
                        let place = &mut self.places[starts[low] + at];
                        *place = self.sets.with(*place, group);
                    }
                    if !lawful.is_empty()
                        && let Some(place) = lawful.get_mut(&[low, high])
                    {
                        *place = self.sets.with(*place, group);
                    }
                }
            }
        }
        others().for_each(|(s, spring)| self.places[s] = lawful[&ends(&spring.points)]);
    }

    /// Those of all other springs, which are in the order of the cells and of the springs of a cell; some may be absent.
    fn add_others(&mut self, mesh: &Mesh, network: &Network, springs: &[Springs], groups: &[Vec<usize>]) {
        let mut rest = (network.lengths.len()..)
            .zip(&network.others)
            .skip_while(|(_, spring)| spring.kind == SpringKind::Length)
            .peekable();
        for ((block, springs), groups) in mesh.blocks.iter().zip(springs).zip(groups) {
            let every: Vec<usize> = (0..springs.nodes()).collect();
            let functions = springs.functions().iter().map(|f| (f.kind, &f.nodes[..]));
            let areas = springs.areas().iter().map(|_| (SpringKind::PointArea, &every[..]));
            let points = springs.points().iter().map(|_| (SpringKind::PointContent, &every[..]));
            let content = springs.content().map(|kind| (kind, &every[..]));
            let kinds: Vec<_> = functions.chain(areas).chain(points).chain(content).collect();
            for nodes in block.cells() {
                for (&(kind, own), &group) in kinds.iter().zip(&groups[springs.pairs().len()..]) {
                    let points = own.iter().map(|&a| nodes[a]);
                    let is_next = |(_, spring): &(usize, &crate::model::MeasureSpring)| {
                        spring.kind == kind && spring.points.iter().copied().eq(points)
                    };
                    if let Some((s, _)) = rest.next_if(is_next) {
                        self.places[s] = self.sets.with(0, group);
                    }
                }
            }
        }
    }
}

/// The place of a group in the list, to which it is added if it is new.
fn place(records: &mut Vec<OriginRecord>, element: &str, group: &str) -> usize {
    let record = OriginRecord { element: element.into(), group: group.into() };
    let known = records.iter().position(|known| *known == record);
    known.unwrap_or_else(|| {
        records.push(record);
        records.len() - 1
    })
}

/// Sets of groups, each once; the first is empty.
struct Sets {
    sets: Vec<Vec<usize>>,
    /// The set that a set and each group make, once it is known.
    unions: Vec<Vec<Option<u32>>>,
    groups: usize,
}

impl Sets {
    fn of(groups: usize) -> Sets {
        Sets { sets: vec![Vec::new()], unions: vec![vec![None; groups]], groups }
    }

    /// The set with a group more.
    fn with(&mut self, set: u32, group: usize) -> u32 {
        if let Some(known) = self.unions[set as usize][group] {
            return known;
        }
        let mut union = self.sets[set as usize].clone();
        if !union.contains(&group) {
            union.push(group);
        }
        let place = self.sets.iter().position(|known| *known == union).unwrap_or_else(|| {
            self.sets.push(union);
            self.unions.push(vec![None; self.groups]);
            self.sets.len() - 1
        });
        self.unions[set as usize][group] = Some(place as u32);
        place as u32
    }
}
