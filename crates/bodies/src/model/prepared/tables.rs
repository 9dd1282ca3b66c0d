//! The cells that springs measure by quadrature, and the gradients of their shape functions.

use crate::element::Tabulation;
use crate::scalar::Packed;
use std::collections::HashMap;

/// Cells with as many nodes and points.
#[derive(Debug, Clone)]
pub struct Cells {
    pub nodes: usize,
    pub dimension: usize,
    pub points: usize,
    pub gradients: Gradients,
    /// The rows of the nodes, `[cells × nodes]`.
    pub rows: Vec<u32>,
    /// The number of points of the tables before.
    pub first: usize,
}

/// `∂N_a/∂ξ_l`, `[points × nodes × dimension]`.
#[derive(Debug, Clone)]
pub enum Gradients {
    /// All cells share one table, `[points × nodes × dimension]`.
    Shared(Vec<f64>),
    /// Each cell has a separate table, `[cells / LANES][points × nodes × dimension][LANES]`.
    Own(Vec<f64>),
}

/// The most lanes of any vector; the others are divisors of it. Tables of fewer cells would leave lanes empty.
pub const LANES: usize = 8;

impl Gradients {
    /// The number at that place of the table, for the cells from `first`, a multiple of the lanes.
    #[inline(always)]
    pub fn at<T: Packed>(&self, zero: &T, first: usize, [place, size]: [usize; 2]) -> T {
        match self {
            Gradients::Shared(table) => zero.constant(&table[place]),
            Gradients::Own(tables) => {
                let begin = (first / LANES * size + place) * LANES + first % LANES;
                let mut lanes = zero.clone();
                lanes.as_mut_slice().copy_from_slice(&tables[begin..begin + T::COUNT]);
                lanes
            }
        }
    }

    /// Appends the table of cell number `cell`, the last one so far.
    pub fn push(&mut self, cell: usize, table: &[f64]) {
        if let Gradients::Own(tables) = self {
            let first = cell / LANES * table.len() * LANES;
            tables.resize(first + table.len() * LANES, 0.0);
            table.iter().enumerate().for_each(|(i, g)| tables[first + i * LANES + cell % LANES] = *g);
        }
    }
}

/// The cells of tables that would leave lanes empty, with others of the same shape; and where each table is now: its index, and the
/// number of its first cell.
pub fn merged(tables: Vec<(Vec<f64>, Cells)>) -> (Vec<Cells>, Vec<[usize; 2]>) {
    let (mut all, mut homes, mut of_shape) = (Vec::<Cells>::new(), Vec::new(), HashMap::new());
    for (gradients, cells) in tables {
        let count = cells.rows.len() / cells.nodes;
        if count >= LANES {
            homes.push([all.len(), 0]);
            all.push(Cells { gradients: Gradients::Shared(gradients), ..cells });
            continue;
        }
        let shape = [cells.nodes, cells.dimension, cells.points];
        let home = *of_shape.entry(shape).or_insert(all.len());
        if home == all.len() {
            all.push(Cells { rows: Vec::new(), ..cells });
        }
        let own = &mut all[home];
        let first = own.rows.len() / own.nodes;
        homes.push([home, first]);
        own.rows.extend(cells.rows);
        (first..first + count).for_each(|cell| own.gradients.push(cell, &gradients));
    }
    (all, homes)
}

/// Collects cells by their table and nodes.
#[derive(Default)]
pub struct Tables {
    /// Each table of gradients with its cells.
    pub cells: Vec<(Vec<f64>, Cells)>,
    /// Tables by the bits of their gradients: cells of one shape have equal ones, and each fibre its own.
    by_value: HashMap<Vec<u64>, usize>,
    by_place: HashMap<*const Tabulation, usize>,
    known: HashMap<(usize, Vec<u32>), usize>,
}

impl Tables {
    /// The table and the cell of it.
    pub fn cell(&mut self, table: &Tabulation, rows: Vec<u32>) -> (usize, usize) {
        // The network holds its tables while they are collected, so that no two have one address.
        let index = match self.by_place.get(&std::ptr::from_ref(table)) {
            Some(index) => *index,
            None => self.table(table),
        };
        let (_, cells) = &mut self.cells[index];
        // Several springs may measure one cell, whose content is then computed once.
        let next = cells.rows.len() / cells.nodes;
        let cell = *self.known.entry((index, rows)).or_insert_with_key(|(_, rows)| {
            cells.rows.extend(rows);
            next
        });
        (index, cell)
    }

    fn table(&mut self, table: &Tabulation) -> usize {
        let shape = [table.nodes, table.dimension, table.points()].map(|n| n as u64);
        let key: Vec<u64> = shape.into_iter().chain(table.gradients.iter().map(|g| g.to_bits())).collect();
        let next = self.cells.len();
        let index = *self.by_value.entry(key).or_insert(next);
        if index == next {
            let Tabulation { nodes, dimension, .. } = *table;
            let (points, gradients, rows) = (table.points(), Gradients::Own(Vec::new()), Vec::new());
            let cells = Cells { nodes, dimension, points, gradients, rows, first: 0 };
            self.cells.push((table.gradients.clone(), cells));
        }
        // Cells of one element share its table: it is compared by its bits once, and then by where it is.
        self.by_place.insert(table, index);
        index
    }
}

/// The gradients of a simplex whose tangents are the edges from its first node.
pub fn simplex_gradients(d: usize) -> Vec<f64> {
    let of = |a: usize, l: usize| if a == 0 { -1.0 } else { f64::from(u8::from(a == l + 1)) };
    (0..=d).flat_map(|a| (0..d).map(move |l| of(a, l))).collect()
}
