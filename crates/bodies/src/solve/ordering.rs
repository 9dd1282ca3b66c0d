//! The order of elimination in which a Cholesky factor stays sparse: approximate minimum degree, or nested dissection where the
//! unknowns have places in space.
//!
//! Source: A. George, *Nested dissection of a regular finite element mesh*, SIAM J. Numer. Anal. 10 (1973) 345–363; each part is cut by
//! a plane across an axis, as in J. R. Gilbert, G. L. Miller, S.-H. Teng, *Geometric mesh partitioning*, SIAM J. Sci. Comput. 19 (1998).

use faer::sparse::{SymbolicSparseColMat, SymbolicSparseColMatRef};

/// A part with at most this number of nodes is not divided.
// On 16³ hexahedra parts of 1 to 128 nodes take the same time, and parts of 512 a quarter more.
const LEAF: usize = 8;
/// The largest distance of a cut from the middle of a part, as a share of its nodes. Parts of about equal size keep the
/// tree of the elimination low.
// Shares of 0.02 to 0.2 take the same time there, and 0.4 a tenth more.
const ASIDE: f64 = 0.1;
/// The least number of nodes for which dissection is tried. Smaller graphs cost about the same in both orders.
const NODES: usize = 500;
const ABSENT: u32 = u32::MAX;

/// Where the unknowns are: `[unknowns × dimension]`, m.
#[derive(Debug, Clone)]
pub(super) struct Places {
    pub coordinates: Vec<f64>,
    pub dimension: usize,
}

impl Places {
    /// Finds the places of the free degrees of freedom of points, `[points × dimension]`, m.
    pub fn of(free: &[usize], points: &[f64], dimension: usize) -> Places {
        let at = |dof: &usize| dof / dimension * dimension;
        let coordinates = free.iter().map(at).flat_map(|first| &points[first..first + dimension]).copied();
        Places { coordinates: coordinates.collect(), dimension }
    }
}

/// Unknowns with the same neighbours, one after the other, are a node: the directions of a point.
pub(super) struct Graph {
    /// The first unknown of each node, and their number.
    firsts: Vec<usize>,
    /// The nodes that each node is coupled to, itself among them, `[nodes × nodes]`.
    pattern: SymbolicSparseColMat<usize>,
}

impl Graph {
    /// Builds the graph of a symmetric pattern with both triangles.
    pub fn of(matrix: SymbolicSparseColMatRef<'_, usize>) -> Graph {
        let neighbours = |unknown: usize| matrix.row_idx_of_col_raw(unknown);
        let count = matrix.ncols();
        let mut firsts: Vec<usize> = (0..count).filter(|&i| i == 0 || neighbours(i) != neighbours(i - 1)).collect();
        let mut node_of = vec![0; count];
        firsts.push(count);
        firsts.windows(2).enumerate().for_each(|(node, ends)| node_of[ends[0]..ends[1]].fill(node));
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for &first in &firsts[..firsts.len() - 1] {
            let begin = rows.len();
            for unknown in neighbours(first) {
                let node = node_of[*unknown];
                if rows.len() == begin || rows[rows.len() - 1] != node {
                    rows.push(node);
                }
            }
            starts.push(rows.len());
        }
        let nodes = firsts.len() - 1;
        Graph { firsts, pattern: SymbolicSparseColMat::new_checked(nodes, nodes, starts, None, rows) }
    }

    pub fn pattern(&self) -> SymbolicSparseColMatRef<'_, usize> {
        self.pattern.as_ref()
    }

    /// The unknowns in an order of the nodes.
    pub fn unknowns(&self, order: &[usize]) -> Vec<usize> {
        order.iter().flat_map(|&node| self.firsts[node]..self.firsts[node + 1]).collect()
    }

    /// The nodes in the order of nested dissection; `None` for a graph too small for it.
    pub fn dissection(&self, places: &Places) -> Option<Vec<usize>> {
        let nodes = self.firsts.len() - 1;
        let d = places.dimension;
        let at = |node: &u32, axis: usize| places.coordinates[self.firsts[*node as usize] * d + axis];
        // From the last to the first.
        let mut order = Vec::with_capacity(nodes);
        let mut rank = vec![ABSENT; nodes];
        let mut parts: Vec<Vec<u32>> = vec![(0..nodes as u32).collect()];
        if nodes < NODES {
            return None;
        }
        while let Some(mut part) = parts.pop() {
            if part.len() <= LEAF {
                // Small parts cost less in any order than their separation would.
                order.extend(part.iter().rev().map(|&node| node as usize));
                continue;
            }
            let sort = |part: &mut Vec<u32>, axis: usize, rank: &mut Vec<u32>| {
                // Nodes at one coordinate are in the order of their numbers, which makes the order the same on every
                // machine.
                part.sort_unstable_by(|a, b| at(a, axis).total_cmp(&at(b, axis)).then(a.cmp(b)));
                part.iter().enumerate().for_each(|(i, &node)| rank[node as usize] = i as u32);
            };
            let cuts = (0..d).map(|axis| {
                sort(&mut part, axis, &mut rank);
                (axis, self.best_cut(&part, &rank))
            });
            let best = cuts.min_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
            let (axis, Cut { position, side, .. }) = best?;
            // The part is still in the order of the last axis that was tried.
            sort(&mut part, axis, &mut rank);
            let (mut low, mut high, mut separator) = (Vec::new(), Vec::new(), Vec::new());
            for (i, &node) in part.iter().enumerate() {
                let [least, most] = self.reach(node, &rank);
                match side {
                    Side::Low if i < position && most >= position => separator.push(node),
                    Side::High if i >= position && least < position => separator.push(node),
                    Side::Low | Side::High if i < position => low.push(node),
                    Side::Low | Side::High => high.push(node),
                }
            }
            // Nodes of this part are no neighbours within the next one.
            part.iter().for_each(|&node| rank[node as usize] = ABSENT);
            // A separator is eliminated after both of its sides, and the order is written backwards: it comes first.
            order.extend(separator.iter().rev().map(|&node| node as usize));
            parts.extend([low, high]);
        }
        order.reverse();
        Some(order)
    }

    /// The least and the largest rank among a node of a part and its neighbours there.
    fn reach(&self, node: u32, rank: &[u32]) -> [usize; 2] {
        let ranks = self.pattern.row_idx_of_col_raw(node as usize).iter().map(|other| rank[*other]);
        let within = ranks.filter(|rank| *rank != ABSENT).map(|rank| rank as usize);
        let own = rank[node as usize] as usize;
        within.fold([own, own], |[least, most], rank| [least.min(rank), most.max(rank)])
    }

    /// The cut of a sorted part near its middle with the smallest separator: the nodes on one side of it that have neighbours on the other.
    fn best_cut(&self, part: &[u32], rank: &[u32]) -> Cut {
        let count = part.len();
        // Changes, from one position to the next, of the numbers of nodes below that reach above, and of those above that reach below.
        let (mut below, mut above) = (vec![0_i32; count + 2], vec![0_i32; count + 2]);
        for (i, &node) in part.iter().enumerate() {
            let [least, most] = self.reach(node, rank);
            below[i + 1] += 1;
            below[most + 1] -= 1;
            above[least + 1] += 1;
            above[i + 1] -= 1;
        }
        let (first, last) = ((0.5 - ASIDE) * count as f64, (0.5 + ASIDE) * count as f64);
        // A cut is inside the part: both sides are smaller than the part, and the division ends.
        let positions = (first.max(1.0) as usize)..=(last as usize).min(count - 1);
        let mut best = Cut { cost: f64::INFINITY, position: count / 2, side: Side::Low };
        let (mut low, mut high) = (0, 0);
        for position in 0..=*positions.end() {
            low += below[position];
            high += above[position];
            // If separators are equally small, the one nearer to the middle is taken.
            let uneven = 1.0 + 0.5 * (position as f64 / count as f64 - 0.5).abs();
            for (size, side) in [(low, Side::Low), (high, Side::High)] {
                let cost = f64::from(size) * uneven;
                if positions.contains(&position) && cost < best.cost {
                    best = Cut { cost, position, side };
                }
            }
        }
        best
    }
}

/// Where a sorted part is cut, and on which side of it the separator is.
#[derive(Clone, Copy)]
struct Cut {
    cost: f64,
    position: usize,
    side: Side,
}

#[derive(Clone, Copy)]
enum Side {
    Low,
    High,
}
