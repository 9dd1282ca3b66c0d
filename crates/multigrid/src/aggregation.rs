//! Groups of nodes that move together: the nodes of the next level.

use crate::block::square;
use crate::matrix::BlockMatrix;
use crate::parallel::list_rows;

/// A node in no aggregate.
pub(crate) const NONE: u32 = u32::MAX;

/// Nodes that are one node on the next level.
pub struct Aggregates {
    /// The aggregate of each node, or `NONE`.
    pub of: Vec<u32>,
    /// How many aggregates there are.
    pub count: usize,
}

/// Strong neighbours: `‖A_ij‖ > threshold · √(‖A_ii‖ ‖A_jj‖)`, in Frobenius' norm.
fn strong<const N: usize>(a: &BlockMatrix<N, N>, is_held: &[bool], threshold: f64) -> (Vec<usize>, Vec<(u32, f32)>) {
    let sizes: Vec<f64> = (0..a.rows()).map(|row| square(&a.diagonal(row)).sqrt()).collect();
    let pattern = a.pattern();
    list_rows(
        a.rows(),
        || (),
        |(), row, list| {
            // A held node does not move on any level, so that no aggregate needs it.
            if is_held[row] {
                return;
            }
            for at in pattern.starts[row]..pattern.starts[row + 1] {
                let column = pattern.columns[at] as usize;
                let coupling = square(&a.values[at]);
                // Squares are compared, so that most blocks need no root.
                let bound = threshold * threshold * sizes[row] * sizes[column];
                if column != row && !is_held[column] && coupling > bound {
                    // The diagonal of a node may be zero, by which nothing may be divided.
                    list.push((column as u32, (coupling.sqrt() / sizes[column].max(f64::MIN_POSITIVE)) as f32));
                }
            }
        },
    )
}

/// Vaněk's greedy aggregates (Vaněk, Mandel, Brezina, Computing 56, 1996) in the order of the nodes: first whole neighbourhoods, then
/// what is left joins the neighbour to which it is coupled most, then the rest by itself. Nodes without strong neighbours are in none: the smoother
/// solves for them.
pub(crate) fn aggregates<const N: usize>(a: &BlockMatrix<N, N>, is_held: &[bool], threshold: f64) -> Aggregates {
    let (starts, neighbours) = strong(a, is_held, threshold);
    let around = |node: usize| &neighbours[starts[node]..starts[node + 1]];
    let mut of = vec![NONE; a.rows()];
    let mut count = 0;
    for node in 0..a.rows() {
        let is_free = |(other, _): &(u32, f32)| of[*other as usize] == NONE;
        if of[node] == NONE && !around(node).is_empty() && around(node).iter().all(is_free) {
            of[node] = count;
            around(node).iter().for_each(|(other, _)| of[*other as usize] = count);
            count += 1;
        }
    }
    // A node that joins attracts no others, so that an aggregate reaches no farther than two couplings.
    let whole = of.clone();
    for node in (0..a.rows()).filter(|node| whole[*node] == NONE) {
        let joined = around(node).iter().filter(|(other, _)| whole[*other as usize] != NONE);
        // Of equal couplings that to the first node: the levels are the same on every machine.
        if let Some((other, _)) = joined.max_by(|x, y| x.1.total_cmp(&y.1).then(y.0.cmp(&x.0))) {
            of[node] = whole[*other as usize];
        }
    }
    for node in 0..a.rows() {
        if of[node] == NONE && !around(node).is_empty() {
            of[node] = count;
            for (other, _) in around(node) {
                if of[*other as usize] == NONE {
                    of[*other as usize] = count;
                }
            }
            count += 1;
        }
    }
    Aggregates { of, count: count as usize }
}
