//! The groups of the element files that the springs of a network come from.

use super::record::OriginRecord;
use crate::element::SpringKind;
use crate::mesh::Mesh;
use crate::springs::Springs;
use std::collections::HashMap;

/// The groups, and those of each spring.
#[derive(Default)]
pub struct Origins {
    /// The elements and groups.
    pub records: Vec<OriginRecord>,
    lengths: HashMap<[usize; 2], Vec<usize>>,
    others: HashMap<(SpringKind, Vec<usize>), Vec<usize>>,
}

impl Origins {
    /// Of the springs of each block of cells.
    pub fn of(mesh: &Mesh, springs: &[Springs]) -> Origins {
        let mut origins = Origins::default();
        for (block, springs) in mesh.blocks.iter().zip(springs) {
            let element = &block.element.name;
            let groups: Vec<usize> = springs.names().iter().map(|name| origins.place(element, name)).collect();
            let group = |s: usize| groups[springs.groups()[s]];
            let every: Vec<usize> = (0..springs.nodes()).collect();
            let mut others: Vec<(SpringKind, &[usize], usize)> = Vec::new();
            let first = springs.pairs().len();
            let functions = springs.functions().iter().map(|f| (f.kind, &f.nodes[..]));
            let areas = springs.areas().iter().map(|_| (SpringKind::PointArea, &every[..]));
            let points = springs.points().iter().map(|_| (SpringKind::PointContent, &every[..]));
            let content = springs.content().map(|kind| (kind, &every[..]));
            let all = functions.chain(areas).chain(points).chain(content);
            others.extend(all.enumerate().map(|(i, (kind, nodes))| (kind, nodes, group(first + i))));
            others.dedup();
            for nodes in block.cells() {
                for (s, &[a, b]) in springs.pairs().iter().enumerate() {
                    let ends = [nodes[a].min(nodes[b]), nodes[a].max(nodes[b])];
                    insert(origins.lengths.entry(ends).or_default(), group(s));
                }
                for (kind, own, group) in &others {
                    let points = own.iter().map(|&a| nodes[a]).collect();
                    insert(origins.others.entry((*kind, points)).or_default(), *group);
                }
            }
        }
        origins
    }

    fn place(&mut self, element: &str, group: &str) -> usize {
        let record = OriginRecord { element: element.into(), group: group.into() };
        let known = self.records.iter().position(|known| *known == record);
        known.unwrap_or_else(|| {
            self.records.push(record);
            self.records.len() - 1
        })
    }

    /// The groups of a spring; none of one that belongs to no cell.
    pub fn groups(&self, kind: SpringKind, points: &[usize]) -> Vec<usize> {
        let found = match (kind, points) {
            (SpringKind::Length, &[a, b]) => self.lengths.get(&[a.min(b), a.max(b)]),
            _ => self.others.get(&(kind, points.to_vec())),
        };
        found.cloned().unwrap_or_default()
    }
}

fn insert(groups: &mut Vec<usize>, group: usize) {
    if !groups.contains(&group) {
        groups.push(group);
    }
}
