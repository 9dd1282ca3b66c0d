//! Facets that bound a space: whether they close it, and on which side of them it is.

use super::disjoint::DisjointSets;
use super::mesh::{CellIndex, Mesh, SideIndex};
use super::selection::outer_sides;
use crate::error::{Error, ErrorKind, Result};
use crate::springs::{cross, dot};
use std::collections::{BTreeMap, HashMap};

/// An edge between facets, by its ends in ascending order.
type Edge = [usize; 2];

impl Mesh {
    /// The edges that one of these sides has and no other continues, each by its two points; in the plane the points at which a line of sides ends.
    /// There are none if the sides close a space.
    pub fn rim(&self, sides: &[SideIndex]) -> Vec<Vec<usize>> {
        // How much more often a part of the rim is passed forwards than backwards: of an edge of a solid, or of a point of the plane.
        let mut passed: BTreeMap<Vec<usize>, i64> = BTreeMap::new();
        for side in sides {
            // Without nodes at its corners an element has no edges either.
            let Some(corners) = self.side_corners(side) else { continue };
            if self.dimension == 2 {
                *passed.entry(vec![corners[0]]).or_default() += 1;
                *passed.entry(vec![corners[1]]).or_default() -= 1;
                continue;
            }
            for ([a, b], is_forward) in edges(&corners) {
                *passed.entry(vec![a, b]).or_default() += if is_forward { 1 } else { -1 };
            }
        }
        // Each continuation passes an edge the other way: sums of zero are no rim.
        passed.into_iter().filter(|(_, times)| *times != 0).map(|(points, _)| points).collect()
    }

    /// The middle of the first of these sides that has cells on both sides of it, `[dimension]`, m, and the number of such sides; `None` if all are on the
    /// outside of the body.
    pub fn inner_sides(&self, sides: &[SideIndex]) -> Option<(Vec<f64>, usize)> {
        let place = |side: &SideIndex| (side.cell.block, side.cell.cell, side.side);
        let outer = outer_sides(self, &vec![true; self.point_count()]);
        let mut inner = sides.iter().filter(|side| outer.binary_search_by_key(&place(side), place).is_err());
        let points = self.side_nodes(inner.next()?);
        Some((self.mean_place(&points), 1 + inner.count()))
    }

    /// The points at the corners of a side, in an order by which its normal points out of the cell; `None` if the element has no nodes at its
    /// corners.
    fn side_corners(&self, side: &SideIndex) -> Option<Vec<usize>> {
        let element = &self.blocks[side.cell.block].element;
        let nodes = self.cell_nodes(side.cell);
        let corners = element.cell.sides()[side.side].corners.iter();
        corners.map(|&corner| element.corner_node(corner).map(|node| nodes[node])).collect()
    }

    /// Whether each of these cells of a surface in space is numbered against the others of its piece, `[cells]`. The normal of a closed piece
    /// points outwards; that of another piece is the one that most of its cells have by the order of their nodes, in a right-handed sense.
    ///
    /// # Errors
    /// A piece has one side only, as a Möbius strip has; or an element has no nodes at its corners.
    pub fn turned(&self, cells: &[CellIndex]) -> Result<Vec<bool>> {
        let loops = cells.iter().map(|&cell| self.cell_corners(cell)).collect::<Result<Vec<_>>>()?;
        let mut neighbours: HashMap<Edge, Vec<(usize, bool)>> = HashMap::new();
        for (facet, corners) in loops.iter().enumerate() {
            for (edge, is_forward) in edges(corners) {
                neighbours.entry(edge).or_default().push((facet, is_forward));
            }
        }
        // Where three sheets meet none of them is the continuation of another.
        let joints = || neighbours.iter().filter(|(_, facets)| facets.len() == 2);
        let mut of_facet: Vec<Vec<(usize, bool)>> = vec![Vec::new(); cells.len()];
        let mut sets = DisjointSets::new(cells.len());
        for (_, facets) in joints() {
            let [(a, forward_a), (b, forward_b)] = [facets[0], facets[1]];
            let differs = forward_a == forward_b;
            of_facet[a].push((b, differs));
            of_facet[b].push((a, differs));
            sets.join(a, b);
        }
        let mut turned = vec![None; cells.len()];
        for first in 0..cells.len() {
            if turned[first].is_some() {
                continue;
            }
            // Which way the first cell is turned is free here, and decided for the whole piece below.
            turned[first] = Some(false);
            let mut front = vec![first];
            while let Some(facet) = front.pop() {
                for &(other, differs) in &of_facet[facet] {
                    let wanted = turned[facet].map(|is_turned: bool| is_turned != differs);
                    if turned[other].is_none() {
                        turned[other] = wanted;
                        front.push(other);
                    } else if turned[other] != wanted {
                        let place = self.middle(cells[other]);
                        let found = format!("one with one side, as a Möbius strip has, at {place:?} m");
                        return Err(Error::expected("pressure", "a surface with two sides", found));
                    }
                }
            }
        }
        let mut turned: Vec<bool> = turned.into_iter().map(|turned| turned.unwrap_or(false)).collect();
        for piece in sets.sets() {
            let is_closed = piece.iter().all(|&facet| {
                edges(&loops[facet]).all(|(edge, _)| neighbours.get(&edge).is_some_and(|facets| facets.len() == 2))
            });
            let against = match is_closed {
                // A normal that points outwards encloses a volume above zero (Gauss).
                true => self.enclosed(piece.iter().map(|&facet| (&loops[facet][..], turned[facet]))) < 0.0,
                false => 2 * piece.iter().filter(|&&facet| turned[facet]).count() > piece.len(),
            };
            if against {
                piece.iter().for_each(|&facet| turned[facet] = !turned[facet]);
            }
        }
        Ok(turned)
    }

    fn cell_corners(&self, cell: CellIndex) -> Result<Vec<usize>> {
        let (element, nodes) = (&self.blocks[cell.block].element, self.cell_nodes(cell));
        let corner = |corner: usize| {
            element.corner_node(corner).map(|node| nodes[node]).ok_or_else(|| {
                let expected = "an element with nodes at its corners, whose cells are turned alike";
                Error::expected("pressure", expected, &element.name).of_kind(ErrorKind::Unsupported)
            })
        };
        (0..element.cell.corners().len()).map(corner).collect()
    }

    /// The volume that facets with these corners enclose, whether each is turned: `Σ x·n dA/3`, from the first corner, m³.
    fn enclosed<'a>(&self, facets: impl Iterator<Item = (&'a [usize], bool)>) -> f64 {
        let mut origin = None;
        let mut volume = 0.0;
        for (corners, is_turned) in facets {
            // From a point of the piece and not from the origin: far from it digits would cancel.
            let origin = *origin.get_or_insert(corners[0]);
            let from = |p: usize| std::array::from_fn::<f64, 3, _>(|k| self.point(p)[k] - self.point(origin)[k]);
            for i in 2..corners.len() {
                let own = dot(&from(corners[0]), &cross(from(corners[i - 1]), from(corners[i]))) / 6.0;
                volume += if is_turned { -own } else { own };
            }
        }
        volume
    }
}

/// The edges of a facet with these corners, each with whether it is passed from its lower to its higher end.
fn edges(corners: &[usize]) -> impl Iterator<Item = (Edge, bool)> + '_ {
    let next = |i: usize| corners[(i + 1) % corners.len()];
    corners.iter().enumerate().map(move |(i, &a)| ([a.min(next(i)), a.max(next(i))], a < next(i)))
}
