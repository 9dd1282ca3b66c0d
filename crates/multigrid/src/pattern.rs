//! Which blocks of a matrix are stored.

use crate::parallel::list_rows;

/// The columns of each row, ascending.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    /// Where each row begins, `[rows + 1]`.
    pub(crate) starts: Vec<usize>,
    pub(crate) columns: Vec<u32>,
    pub(crate) width: usize,
}

/// Groups of nodes that act on each other: cells, springs.
pub struct Groups<'a> {
    /// Nodes of one group after those of another.
    pub nodes: &'a [u32],
    /// Where each group begins, `[groups + 1]`.
    pub starts: &'a [usize],
}

impl Groups<'_> {
    /// The number of groups.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The nodes of one group.
    pub fn of(&self, group: usize) -> &[u32] {
        &self.nodes[self.starts[group]..self.starts[group + 1]]
    }
}

impl Pattern {
    /// The diagonal, and a block for each two nodes of a group. Each row gathers the nodes of the groups around it: nothing is sorted as
    /// a whole, and no pair is stored twice.
    pub fn of_groups(count: usize, groups: &[Groups]) -> Pattern {
        let around: Vec<Vec<usize>> = groups.iter().map(|groups| starts_around(count, groups)).collect();
        let members: Vec<Vec<u32>> =
            groups.iter().zip(&around).map(|(groups, starts)| groups_around(groups, starts)).collect();
        let list = |_: &mut (), row: usize, columns: &mut Vec<u32>| {
            let first = columns.len();
            // The diagonal is stored even where no group has the node: smoother and bottom ask for it.
            columns.push(row as u32);
            for ((groups, starts), members) in groups.iter().zip(&around).zip(&members) {
                for &group in &members[starts[row]..starts[row + 1]] {
                    columns.extend_from_slice(groups.of(group as usize));
                }
            }
            columns[first..].sort_unstable();
            // `Vec::dedup` would go through the columns of all rows before this one.
            let mut kept = first;
            for at in first + 1..columns.len() {
                if columns[at] != columns[kept] {
                    kept += 1;
                    columns[kept] = columns[at];
                }
            }
            columns.truncate(kept + 1);
        };
        let (starts, columns) = list_rows(count, || (), list);
        Pattern { starts, columns, width: count }
    }

    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    /// The number of columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The number of blocks.
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Whether no block is stored.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// The columns of a row, ascending.
    pub fn row(&self, row: usize) -> &[u32] {
        &self.columns[self.starts[row]..self.starts[row + 1]]
    }

    /// Where the block is stored; `None` if it is not.
    pub fn place(&self, row: usize, column: usize) -> Option<usize> {
        let found = self.row(row).binary_search(&(column as u32));
        found.ok().map(|at| self.starts[row] + at)
    }

    /// For each column the rows that have it, ascending, each with the place of its block.
    pub(crate) fn transposed(&self) -> (Vec<usize>, Vec<[u32; 2]>) {
        // A count for each column and one pass in the order of the rows leave the rows of each column ascending, without sorting.
        let mut starts = vec![0; self.width + 1];
        self.columns.iter().for_each(|&column| starts[column as usize + 1] += 1);
        for i in 0..self.width {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut places = vec![[0; 2]; self.columns.len()];
        for row in 0..self.rows() {
            for at in self.starts[row]..self.starts[row + 1] {
                let next = &mut next[self.columns[at] as usize];
                places[*next] = [row as u32, at as u32];
                *next += 1;
            }
        }
        (starts, places)
    }
}

/// Where the groups around each node begin.
fn starts_around(count: usize, groups: &Groups) -> Vec<usize> {
    let mut starts = vec![0; count + 1];
    groups.nodes.iter().for_each(|&node| starts[node as usize + 1] += 1);
    for i in 0..count {
        starts[i + 1] += starts[i];
    }
    starts
}

fn groups_around(groups: &Groups, starts: &[usize]) -> Vec<u32> {
    let mut next = starts.to_vec();
    let mut members = vec![0; groups.nodes.len()];
    for group in 0..groups.len() {
        for &node in groups.of(group) {
            members[next[node as usize]] = group as u32;
            next[node as usize] += 1;
        }
    }
    members
}
