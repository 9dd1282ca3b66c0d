//! Patches of a surface: triangles that are joined by edges of two triangles.

use crate::mesh::fill::edges::{Pass, by_edge};
use crate::mesh::fill::triangles::Triangles;

/// The patches of a surface.
pub(super) struct Patches {
    /// The patch of each triangle, `[triangles]`.
    pub of: Vec<usize>,
    pub count: usize,
    /// Whether the triangle has to be turned so that all of its patch are turned alike, `[triangles]`: the smaller area of each patch is.
    pub turned: Vec<bool>,
    /// Edges at which the triangles of a patch cannot be turned alike, as those of a Möbius strip.
    pub twisted: Vec<[usize; 2]>,
}

/// A triangle without a neighbour across an edge.
const NONE: u32 = u32::MAX;

impl Patches {
    /// The patches of these triangles with these passes.
    pub fn of(triangles: &Triangles, passes: &[Pass]) -> Patches {
        let count = triangles.corners.len();
        // The neighbours across edges of two triangles, and whether one of both is turned the other way.
        let mut neighbours = vec![[(NONE, false); 3]; count];
        let mut add = |of: u32, other: (u32, bool)| {
            // A triangle has three edges, so that there is room for each neighbour.
            let free = neighbours[of as usize].iter_mut().find(|(other, _)| *other == NONE);
            free.into_iter().for_each(|place| *place = other);
        };
        for of_edge in by_edge(passes) {
            if let [a, b] = of_edge {
                add(a.triangle, (b.triangle, a.is_up == b.is_up));
                add(b.triangle, (a.triangle, a.is_up == b.is_up));
            }
        }
        let mut patches =
            Patches { of: vec![usize::MAX; count], count: 0, turned: vec![false; count], twisted: Vec::new() };
        let mut members: Vec<usize> = Vec::new();
        for start in 0..count {
            if patches.of[start] != usize::MAX {
                continue;
            }
            members.clear();
            members.push(start);
            patches.of[start] = patches.count;
            let mut next = 0;
            while let Some(&triangle) = members.get(next) {
                next += 1;
                for (other, is_turned) in neighbours[triangle].into_iter().filter(|(other, _)| *other != NONE) {
                    let other = other as usize;
                    if patches.of[other] == usize::MAX {
                        patches.of[other] = patches.count;
                        // Two triangles that pass their edge in one direction are turned differently: one of both has to be turned.
                        patches.turned[other] = patches.turned[triangle] ^ is_turned;
                        members.push(other);
                    }
                }
            }
            // What most of the area says is right.
            let area = |&&t: &&usize| {
                if patches.turned[t] {
                    -triangles.area(triangles.corners[t])
                } else {
                    triangles.area(triangles.corners[t])
                }
            };
            if members.iter().map(|t| area(&t)).sum::<f64>() < 0.0 {
                members.iter().for_each(|&t| patches.turned[t] = !patches.turned[t]);
            }
            patches.count += 1;
        }
        let turned = |pass: &Pass| pass.is_up ^ patches.turned[pass.triangle as usize];
        let twisted = by_edge(passes).filter(|of_edge| matches!(of_edge, [a, b] if turned(a) == turned(b)));
        patches.twisted = twisted.map(|of_edge| of_edge[0].edge).collect();
        patches
    }
}
