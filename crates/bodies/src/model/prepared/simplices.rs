//! Springs on the content of lines, triangles and tetrahedra that fill their space, and of patches of them.
//!
//! With the edges `e_a = x_a − x_0` from the first node, completed to three by the remaining axes, the content is
//! `V = c det [e_1 e_2 e_3]`, and `∂det/∂x_1 = e_2 × e_3`, and cyclically. The gradient at the first node is minus the
//! sum of the others.

use super::laws::{Lawful, Laws, LawsRoom};
use crate::model::network::{MeasureSpring, Network};
use crate::scalar::{Coordinate, Coordinates};
use crate::springs::Measure;
use std::collections::HashMap;

/// The nodes of a cell, completed by zeros, and its linear springs, which pull with `slope · det − pull` along `∇det`.
#[derive(Debug, Clone, Copy)]
struct Simplex<N> {
    nodes: [u32; 4],
    slope: N,
    pull: N,
}

/// The patches that share a cell.
#[derive(Debug, Clone, Copy)]
struct Membership {
    /// The patches; unused entries name one that never pulls.
    patches: [u32; 4],
    /// `share · c`.
    share: f64,
}

/// The cells of a network, each once. Laws and the contents of patches are computed with the digits of an `f64`.
#[derive(Debug)]
pub struct Simplices<N> {
    cells: Vec<Simplex<N>>,
    laws: Laws,
    /// `[cells]`, or empty if there are no patches.
    memberships: Vec<Membership>,
    /// The indices of the springs on patches among the other springs of the network.
    patches: Vec<usize>,
}

/// What is computed before the forces, in memory that is kept.
#[derive(Debug, Default)]
pub struct Tensions {
    /// The tensions of laws and patches along `∇det`, `[cells]`.
    cells: Vec<f64>,
    /// First the contents and then the tensions of the patches, `[patches + 1]`.
    patches: Vec<f64>,
    laws: LawsRoom,
}

impl<N: Coordinate> Simplices<N> {
    /// The cells that these springs measure, in an order in which neighbouring rows follow each other.
    pub fn new(network: &Network, springs: &[usize], place: &[usize]) -> Simplices<N> {
        let mut all = Builder {
            nodes: network.dimension + 1,
            cells: Vec::new(),
            patches: Vec::new(),
            known: HashMap::new(),
            shares: Vec::new(),
            lawful: Vec::new(),
        };
        let rows = |points: &mut dyn Iterator<Item = usize>| {
            let mut nodes = [0; 4];
            nodes.iter_mut().zip(points).for_each(|(node, point)| *node = place[point] as u32);
            nodes
        };
        for &s in springs {
            let spring = &network.others[s];
            match &spring.measure {
                Measure::Patch(patch) => {
                    let scale = scale(&Measure::Content(patch.element.clone()), network.dimension);
                    let index = all.patches.len() as u32;
                    all.patches.push(s);
                    for (nodes, share) in &patch.cells {
                        let nodes = rows(&mut nodes.iter().map(|&place| spring.points[place]));
                        all.share(nodes, index, share * scale);
                    }
                }
                measure => {
                    let cell = all.cell(rows(&mut spring.points.iter().copied()));
                    let scale = scale(measure, network.dimension);
                    if spring.law.is_some() {
                        all.lawful.push(Lawful { cell, scale, spring: s });
                    } else {
                        let simplex = &mut all.cells[cell];
                        // The measure is `scale · det`, so that k times its square is the slope in the determinant:
                        // linear springs on one cell add up to one.
                        simplex.slope += spring.constant * scale * scale;
                        simplex.pull += spring.constant * scale * spring.rest;
                    }
                }
            }
        }
        all.finish(network)
    }

    /// Adds the forces of the rows, as (z, x, y); false if a spring has none.
    #[inline(always)]
    pub fn pull<C: Coordinates<N>, const D: usize>(
        &self,
        zero: C,
        others: &[MeasureSpring],
        x: &[[N; 4]],
        tensions: &mut Tensions,
        force: &mut [[N; 4]],
    ) -> bool {
        let force = &mut force[..x.len()];
        if self.laws.is_empty() && self.patches.is_empty() {
            return pull::<N, C, D>(zero, &self.cells, |_| N::zero(), x, force);
        }
        tensions.cells.clear();
        tensions.cells.resize(self.cells.len(), 0.0);
        let mut sound = self.pull_patches::<C, D>(zero, others, x, tensions);
        let determinant = |cell: usize| self.cells[cell].determinant::<C, D>(zero, x).wide();
        sound &= self.laws.pull(determinant, &mut tensions.laws, &mut tensions.cells);
        let cells = &tensions.cells[..self.cells.len()];
        // Both sides are evaluated, whether the tensions are sound or not: all forces are written in any case.
        sound & pull::<N, C, D>(zero, &self.cells, |cell| N::of(cells[cell]), x, force)
    }

    /// The tensions of the patches along `∇det` of their cells: first the content of every patch is computed, then its
    /// tension.
    #[inline(always)]
    fn pull_patches<C: Coordinates<N>, const D: usize>(
        &self,
        zero: C,
        others: &[MeasureSpring],
        x: &[[N; 4]],
        tensions: &mut Tensions,
    ) -> bool {
        let Tensions { cells, patches, .. } = tensions;
        patches.clear();
        // The place after the last patch takes what the unused entries of memberships add, so that the loop has no
        // branch.
        patches.resize(self.patches.len() + 1, 0.0);
        for (cell, membership) in self.cells.iter().zip(&self.memberships) {
            let part = membership.share * cell.determinant::<C, D>(zero, x).wide();
            for a in 0..=D {
                patches[membership.patches[a] as usize] += part;
            }
        }
        let mut sound = true;
        for (value, &spring) in patches.iter_mut().zip(&self.patches) {
            *value = others[spring].tension(*value);
            sound &= value.is_finite();
        }
        // The patch that never pulls has gathered the contents of unused entries.
        patches[self.patches.len()] = 0.0;
        for (tension, membership) in cells.iter_mut().zip(&self.memberships) {
            let mut sum = 0.0;
            for a in 0..=D {
                sum += patches[membership.patches[a] as usize];
            }
            *tension = membership.share * sum;
        }
        sound
    }
}

/// Whether a spring measures the content of a simplex in a space of its own dimension, or of a patch of such simplices.
pub fn measures_simplices(spring: &MeasureSpring, dimension: usize) -> bool {
    match &spring.measure {
        Measure::Content(element) | Measure::PointContent(element, _) => {
            element.dimension() == dimension && spring.points.len() == dimension + 1
        }
        Measure::Patch(patch) => {
            patch.element.dimension() == dimension && patch.cells.iter().all(|(nodes, _)| nodes.len() == dimension + 1)
        }
        Measure::Length | Measure::Span(_) | Measure::Turns(_) | Measure::Squares(_) | Measure::Function(_) => false,
    }
}

/// The factor c. Because the content is linear in each edge, it is the content of the cell whose edges are the axes.
fn scale(measure: &Measure, dimension: usize) -> f64 {
    let mut x = vec![0.0; (dimension + 1) * dimension];
    (0..dimension).for_each(|k| x[(k + 1) * dimension + k] = 1.0);
    measure.value(&x, dimension)
}

/// The unit vector of an axis.
#[inline(always)]
fn axis<N: Coordinate>(axis: usize) -> [N; 4] {
    std::array::from_fn(|k| if k == axis { N::one() } else { N::zero() })
}

impl<N: Coordinate> Simplex<N> {
    /// The three edges, and the same edges with permuted coordinates.
    #[inline(always)]
    fn edges<C: Coordinates<N>, const D: usize>(&self, zero: C, x: &[[N; 4]]) -> ([C; 3], [C; 3]) {
        let first = zero.load(&x[self.nodes[0] as usize]);
        let (mut edges, mut turned) = ([zero; 3], [zero; 3]);
        for a in 0..3 {
            edges[a] = if a < D { zero.load(&x[self.nodes[a + 1] as usize]).minus(first) } else { zero.load(&axis(a)) };
            turned[a] = edges[a].turned();
        }
        (edges, turned)
    }

    #[inline(always)]
    fn determinant<C: Coordinates<N>, const D: usize>(&self, zero: C, x: &[[N; 4]]) -> N {
        let (e, t) = self.edges::<C, D>(zero, x);
        t[0].turned().dot(cross((e[1], t[1]), (e[2], t[2])))
    }
}

/// `a × b` as (z, x, y), from vectors and their permutations.
#[inline(always)]
fn cross<N: Coordinate, C: Coordinates<N>>((a, turned_a): (C, C), (b, turned_b): (C, C)) -> C {
    a.difference_of_products(turned_b, turned_a, b)
}

/// Adds `T ∇det` of every cell, `T = slope · det − pull + tension(cell)`.
#[inline(always)]
fn pull<N: Coordinate, C: Coordinates<N>, const D: usize>(
    zero: C,
    cells: &[Simplex<N>],
    tension: impl Fn(usize) -> N,
    x: &[[N; 4]],
    force: &mut [[N; 4]],
) -> bool {
    let mut sound = true;
    for (cell, simplex) in cells.iter().enumerate() {
        let (e, t) = simplex.edges::<C, D>(zero, x);
        let first = cross((e[1], t[1]), (e[2], t[2]));
        let tension = simplex.slope * t[0].turned().dot(first) - simplex.pull + tension(cell);
        sound &= tension.is_finite();
        let mut normals = [first; 3];
        for a in 1..D {
            let (b, c) = ((a + 1) % 3, (a + 2) % 3);
            normals[a] = cross((e[b], t[b]), (e[c], t[c]));
        }
        let mut sum = zero;
        for a in 0..D {
            let own = normals[a].scaled(tension);
            sum = if a == 0 { own } else { sum.plus(own) };
            let at = &mut force[simplex.nodes[a + 1] as usize];
            zero.load(at).plus(own).store(at);
        }
        let at = &mut force[simplex.nodes[0] as usize];
        zero.load(at).minus(sum).store(at);
    }
    sound
}

/// Collects cells by their nodes.
struct Builder {
    /// The number of nodes of a cell.
    nodes: usize,
    cells: Vec<Simplex<f64>>,
    patches: Vec<usize>,
    known: HashMap<[u32; 4], usize>,
    /// For each cell its patches and their common share, times c.
    shares: Vec<(Vec<u32>, f64)>,
    lawful: Vec<Lawful>,
}

impl Builder {
    fn cell(&mut self, nodes: [u32; 4]) -> usize {
        match self.known.get(&nodes) {
            Some(cell) => *cell,
            None => self.add(nodes),
        }
    }

    fn add(&mut self, nodes: [u32; 4]) -> usize {
        let cell = self.cells.len();
        self.cells.push(Simplex { nodes, slope: 0.0, pull: 0.0 });
        self.shares.push((Vec::new(), 0.0));
        self.known.insert(nodes, cell);
        cell
    }

    /// A cell that is shared by more patches than it has nodes, or by unequal shares, is stored twice.
    fn share(&mut self, nodes: [u32; 4], patch: u32, share: f64) {
        let mut cell = self.cell(nodes);
        let (patches, own) = &self.shares[cell];
        // A cell has room for one patch around each of its nodes and one share for all. What does not fit is a cell of
        // the same nodes beside it.
        if patches.len() == self.nodes || (!patches.is_empty() && *own != share) {
            cell = self.add(nodes);
        }
        self.shares[cell].0.push(patch);
        self.shares[cell].1 = share;
    }

    fn finish<N: Coordinate>(self, network: &Network) -> Simplices<N> {
        let Builder { nodes, cells, patches, shares, mut lawful, .. } = self;
        let mut order: Vec<usize> = (0..cells.len()).collect();
        // In the order of the rows, so that positions of neighbours are still in the cache.
        order.sort_by_key(|&cell| cells[cell].nodes[..nodes].iter().copied().min());
        let mut place = vec![0; order.len()];
        order.iter().enumerate().for_each(|(at, &cell)| place[cell] = at);
        lawful.iter_mut().for_each(|lawful| lawful.cell = place[lawful.cell]);
        // Cells have moved, and laws are evaluated in the order in which contents lie in memory.
        lawful.sort_by_key(|lawful| lawful.cell);
        let rounded =
            |Simplex { nodes, slope, pull }: Simplex<f64>| Simplex { nodes, slope: N::of(slope), pull: N::of(pull) };
        let none = patches.len() as u32;
        let membership = |(own, share): &(Vec<u32>, f64)| {
            let mut patches = [none; 4];
            patches.iter_mut().zip(own).for_each(|(patch, own)| *patch = *own);
            Membership { patches, share: *share }
        };
        // Most networks have no patches, and need no list of memberships.
        let shared = if none > 0 { &order[..] } else { &[] };
        Simplices {
            cells: order.iter().map(|&cell| rounded(cells[cell])).collect(),
            laws: Laws::new(network, &lawful),
            memberships: shared.iter().map(|&cell| membership(&shares[cell])).collect(),
            patches,
        }
    }
}
