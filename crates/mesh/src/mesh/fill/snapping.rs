//! Where a surface cuts the edges of a body-centred cubic lattice, and the points of the lattice that are moved onto it.
//!
//! F. Labelle and J. R. Shewchuk, *Isosurface stuffing: fast tetrahedral meshes with good dihedral angles*, ACM Transactions on
//! Graphics 26 (2007): a point that is near a cut is moved there, so that no tetrahedron between cuts is thin.

use super::columns::Columns;
use super::grid::Grid;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// A point of the lattice in half edges of a cube: even coordinates are corners of cubes, odd ones centres.
pub(super) type Site = [i32; 3];

/// Where a site is to the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Inside,
    /// Moved onto the surface.
    On,
    Outside,
}

/// A site is moved to a cut that is nearer than this share of the edge: of the edges between centres or between corners, and of the
/// shorter ones between a centre and a corner. With them, and a smooth surface that cuts an edge once, dihedral angles are from 10.78° to
/// 164.74° (table 1 of the paper).
const NEAR_LONG: f64 = 0.24999;
const NEAR_SHORT: f64 = 0.41189;
/// Halvings of an edge on the way to its cut: to a part in 2³⁰ of its length.
const HALVINGS: usize = 30;

/// The lattice at a surface.
pub(super) struct Snapping<'a> {
    grid: &'a Grid,
    inside: HashSet<Site>,
    moved: HashMap<Site, [f64; 3]>,
    /// By the ends inside and outside, the share of the edge from the first to the cut.
    cuts: HashMap<[Site; 2], f64>,
}

impl<'a> Snapping<'a> {
    /// The cuts of all edges that leave `inside`, and the sites that are moved.
    pub fn of(grid: &'a Grid, columns: &Columns, inside: HashSet<Site>) -> Snapping<'a> {
        // The sites at the surface with their edges, inside first, in an order that depends on nothing else.
        let mut edges: BTreeMap<Site, Vec<[Site; 2]>> = BTreeMap::new();
        let mut cuts = HashMap::new();
        for &site in &inside {
            for other in neighbours(site).into_iter().filter(|other| !inside.contains(other)) {
                cuts.insert([site, other], cut(columns, grid.site(site), grid.site(other)));
                [site, other].into_iter().for_each(|end| edges.entry(end).or_default().push([site, other]));
            }
        }
        let mut moved = HashMap::new();
        for (site, mut edges) in edges {
            edges.sort_unstable();
            let from_site = |edge: &[Site; 2]| {
                let share = cuts.get(edge).map(|share| if edge[0] == site { *share } else { 1.0 - share })?;
                let (near, length) = if is_long(*edge) { (NEAR_LONG, 2.0) } else { (NEAR_SHORT, 3f64.sqrt()) };
                (share < near).then_some((share * length, *edge))
            };
            // Lengths are compared and not shares, because the edges of a site have two lengths.
            let Some((_, nearest)) = edges.iter().filter_map(from_site).min_by(|a, b| a.0.total_cmp(&b.0)) else {
                continue;
            };
            moved.insert(site, between(grid, nearest, cuts[&nearest]));
            // The site is on the surface now, so that none of its edges crosses it.
            for edge in edges {
                cuts.remove(&edge);
            }
        }
        Snapping { grid, inside, moved, cuts }
    }

    /// Where a site is to the surface.
    pub fn side(&self, site: Site) -> Side {
        match (self.moved.contains_key(&site), self.inside.contains(&site)) {
            (true, _) => Side::On,
            (false, true) => Side::Inside,
            (false, false) => Side::Outside,
        }
    }

    /// The coordinates of a site, m.
    pub fn place(&self, site: Site) -> [f64; 3] {
        self.moved.get(&site).copied().unwrap_or_else(|| self.grid.site(site))
    }

    /// The coordinates of the cut of an edge from inside to outside, m.
    pub fn cut(&self, edge: [Site; 2]) -> [f64; 3] {
        between(self.grid, edge, *self.cuts.get(&edge).expect("neither end of an edge that is cut was moved"))
    }

    /// The cubes that may have tetrahedra with a site inside, sorted by z, y and x.
    pub fn cubes(&self) -> Vec<[i32; 3]> {
        let mut cubes = BTreeSet::new();
        for site in self.inside.iter().filter(|site| self.side(**site) == Side::Inside) {
            // A tetrahedron reaches from its cube into the next along one axis.
            // Sites below zero need rounding down: division alone rounds them towards zero.
            let [x, y, z] = site.map(|s| s.div_euclid(2));
            for i in 0..8 {
                let back = |k: i32| i >> k & 1;
                cubes.insert([z - back(2), y - back(1), x - back(0)]);
            }
        }
        cubes.into_iter().map(|[z, y, x]| [x, y, z]).collect()
    }
}

/// Whether an edge joins two centres or two corners.
pub(super) fn is_long([a, b]: [Site; 2]) -> bool {
    (a[0] - b[0]) % 2 == 0
}

/// The sites at the other ends of the edges of a site.
fn neighbours([x, y, z]: Site) -> [Site; 14] {
    std::array::from_fn(|i| match i {
        0..8 => {
            let step = |k: usize| if i >> k & 1 == 1 { 1 } else { -1 };
            [x + step(0), y + step(1), z + step(2)]
        }
        _ => {
            let mut other = [x, y, z];
            other[(i - 8) / 2] += if i % 2 == 0 { 2 } else { -2 };
            other
        }
    })
}

/// The share of the way from a place inside to one outside at which the surface is left.
fn cut(columns: &Columns, inside: [f64; 3], outside: [f64; 3]) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = (low + high) / 2.0;
        if columns.winding(along(inside, outside, middle)) > 0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    (low + high) / 2.0
}

fn between(grid: &Grid, [a, b]: [Site; 2], share: f64) -> [f64; 3] {
    along(grid.site(a), grid.site(b), share)
}

fn along(a: [f64; 3], b: [f64; 3], share: f64) -> [f64; 3] {
    std::array::from_fn(|k| a[k] + share * (b[k] - a[k]))
}
