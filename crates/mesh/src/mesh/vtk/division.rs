//! Cells of VTK that consist of others: chains, strips, polygons of more than five corners, and prisms over pentagons and hexagons.

use crate::mesh::annotations::Annotations;
use crate::mesh::polygons::triangles;
use std::collections::{BTreeMap, HashMap};

/// What prisms must be.
const STACK: &str = "prisms whose bases can be divided alike in a whole stack of them; ParaView's filter Tetrahedralize makes tetrahedra of all";

/// Divides cells, and knows how faces have been divided that two cells share.
#[derive(Default)]
pub(super) struct Division {
    /// The ends of the diagonal of a base, by the sorted points of the base.
    diagonals: HashMap<Vec<usize>, [usize; 2]>,
    /// How many cells of each kind were divided.
    counts: BTreeMap<&'static str, usize>,
}

/// Cells: the type of each, and its nodes.
type Parts = Vec<(u8, Vec<usize>)>;

impl Division {
    /// The cells of which a cell consists; `None` for one that stays as it is, such as a polygon that is bent.
    ///
    /// # Errors
    /// What was expected: a prism has bases that its neighbours divide in ways that do not fit.
    pub fn parts(
        &mut self,
        cell_type: u8,
        nodes: &[usize],
        points: &[[f64; 3]],
    ) -> Result<Option<Parts>, &'static str> {
        let of = |cell_type: u8, parts: Vec<Vec<usize>>| parts.into_iter().map(|part| (cell_type, part)).collect();
        Ok(Some(match cell_type {
            2 => of(1, nodes.iter().map(|&node| vec![node]).collect()),
            4 => of(3, nodes.windows(2).map(<[usize]>::to_vec).collect()),
            // Every other triangle of a strip is turned round.
            6 => {
                let turned = |(i, t): (usize, &[usize])| if i % 2 == 0 { t.to_vec() } else { vec![t[1], t[0], t[2]] };
                of(5, nodes.windows(3).enumerate().map(turned).collect())
            }
            7 if nodes.len() > 5 => {
                let corners: Vec<[f64; 3]> = nodes.iter().map(|&node| points[node]).collect();
                let Some(parts) = triangles(&corners) else { return Ok(None) };
                *self.counts.entry("polygon of more than five corners: triangles").or_default() += 1;
                of(5, parts.into_iter().map(|part| part.map(|place| nodes[place]).to_vec()).collect())
            }
            15 | 16 => self.prism(nodes)?,
            _ => return Ok(None),
        }))
    }

    /// A prism over a pentagon is a hexahedron and a wedge, one over a hexagon two hexahedra. Both bases have the same diagonal, which is that of a
    /// neighbour if one has been divided.
    fn prism(&mut self, nodes: &[usize]) -> Result<Parts, &'static str> {
        let n = nodes.len() / 2;
        let (bottom, top) = nodes.split_at(n);
        let key = |base: &[usize]| {
            let mut key = base.to_vec();
            // A neighbour lists the same base in another order.
            key.sort_unstable();
            key
        };
        // The place at which the diagonal begins that a neighbour has; it ends three places on.
        let known = |base: &[usize]| {
            let ends = self.diagonals.get(&key(base))?;
            (0..n).find(|&i| {
                let own = [base[i], base[(i + 3) % n]];
                own == *ends || own == [ends[1], ends[0]]
            })
        };
        let (below, above) = (known(bottom), known(top));
        let first = match (below, above) {
            // In a hexagon the diagonal from the third place on is the same one backwards; in a pentagon each place has its own.
            (Some(a), Some(b)) if a % 3 != b % 3 || (n == 5 && a != b) => {
                return Err(STACK);
            }
            (below, above) => below.or(above).unwrap_or(0),
        };
        // The cells on both bases are to divide theirs along it too.
        for base in [bottom, top] {
            self.diagonals.insert(key(base), [base[first], base[(first + 3) % n]]);
        }
        let what = if n == 5 {
            "prism over a pentagon: a hexahedron and a wedge"
        } else {
            "prism over a hexagon: two hexahedra"
        };
        *self.counts.entry(what).or_default() += 1;
        let over = |places: &[usize]| -> Vec<usize> {
            let at = |base: &[usize]| places.iter().map(|&k| base[(first + k) % n]).collect::<Vec<_>>();
            [at(bottom), at(top)].concat()
        };
        let rest = if n == 5 { (13, over(&[3, 4, 0])) } else { (12, over(&[3, 4, 5, 0])) };
        Ok(vec![(12, over(&[0, 1, 2, 3])), rest])
    }

    /// Says what was divided.
    pub fn tell(&self, annotations: &mut Annotations) {
        for (what, count) in &self.counts {
            let (what, parts) = what.split_once(": ").unwrap_or((what, ""));
            let (is, s) = if *count == 1 { ("is", "") } else { ("are", "s") };
            let what = match what.split_once(' ') {
                Some((kind, rest)) => format!("{kind}{s} {rest}"),
                None => format!("{what}{s}"),
            };
            let each = if *count == 1 { "" } else { " each" };
            let each = if parts == "triangles" { "" } else { each };
            annotations.remark(format!("{count} {what} {is} {parts}{each} here"));
        }
    }
}
