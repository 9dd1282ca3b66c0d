//! Pieces of a surface: triangles that are joined by edges.

use super::holes::{Hole, holes};
use crate::mesh::disjoint::DisjointSets;
use crate::mesh::fill::edges::{Pass, by_edge, counts, passes};
use crate::mesh::fill::triangles::Triangles;

/// A piece of a surface with its holes closed.
pub(super) struct Piece {
    /// The places of its triangles in the list.
    pub triangles: Vec<usize>,
    pub holes: Vec<Hole>,
    /// The volume that it encloses as it is turned, m³.
    pub volume: f64,
    /// The area of its triangles, m².
    pub area: f64,
}

impl Piece {
    /// The pieces, in the order of their first triangles.
    pub fn all(triangles: &Triangles) -> Vec<Piece> {
        let passes = passes(&triangles.corners);
        let mut sets = DisjointSets::new(triangles.corners.len());
        by_edge(&passes).for_each(|of_edge| {
            of_edge[1..].iter().for_each(|pass| sets.join(pass.triangle as usize, of_edge[0].triangle as usize));
        });
        let members = sets.sets();
        let mut piece_of = vec![0; triangles.corners.len()];
        for (piece, members) in members.iter().enumerate() {
            members.iter().for_each(|&triangle| piece_of[triangle] = piece);
        }
        let mut borders: Vec<Vec<Pass>> = vec![Vec::new(); members.len()];
        let is_border = |of_edge: &&[Pass]| counts(of_edge)[0] != counts(of_edge)[1];
        for of_edge in by_edge(&passes).filter(is_border) {
            borders[piece_of[of_edge[0].triangle as usize]].extend(of_edge);
        }
        // The volume of a closed surface does not depend on the place, but its digits do: a corner of the box is near.
        let [from, _] = triangles.ends();
        let piece = |(members, border): (Vec<usize>, Vec<Pass>)| {
            let holes = holes(triangles, &border);
            let own = members.iter().map(|&t| triangles.corners[t]);
            let caps = holes.iter().flat_map(|hole| &hole.cap).copied();
            let volume = own.clone().chain(caps).map(|t| triangles.volume(t, from)).sum();
            let area = own.map(|t| triangles.area(t)).sum();
            Piece { triangles: members, holes, volume, area }
        };
        members.into_iter().zip(borders).map(piece).collect()
    }

    /// The share of the closed surface that closes holes.
    pub fn open_share(&self) -> f64 {
        if self.holes.is_empty() {
            return 0.0;
        }
        let closed: f64 = self.holes.iter().map(|hole| hole.area).sum();
        closed / (closed + self.area)
    }

    /// Its triangles and those that close its holes, turned round if `is_turned`.
    pub fn closed(&self, triangles: &Triangles, is_turned: bool) -> Vec<[usize; 3]> {
        let own = self.triangles.iter().map(|&t| triangles.corners[t]);
        let caps = self.holes.iter().flat_map(|hole| &hole.cap).copied();
        own.chain(caps).map(|[a, b, c]| if is_turned { [a, c, b] } else { [a, b, c] }).collect()
    }
}
