//! The stiffness of either model in blocks of points, made of the cells and springs without a list of entries.

use super::Entries;
use super::network::{LengthSpring, Network};
use super::size::ADVICE;
use super::system::in_space;
use crate::error::Result;
use crate::material::{CellMap, Hooke};
use crate::memory;
use crate::mesh::Mesh;
use crate::stiffness;
use springfit_multigrid::{BlockMatrix, Groups, Pattern};
use std::convert::Infallible;
use std::ops::Range;
use std::sync::Arc;

/// A stiffness, N/m, of d × d blocks, one for each two points that act on each other.
#[derive(Debug, Clone)]
pub enum BlockStiffness {
    /// In the plane.
    Plane(Arc<BlockMatrix<2, 2>>),
    /// In space.
    Space(Arc<BlockMatrix<3, 3>>),
}

/// What solves with a stiffness, as blocks of it for each point: the levels after it, the vectors, and what is in memory while they are
/// built. Measured in space: 33 for hexahedra, 44 for tetrahedra, and up to 110 for networks with positive constants, whose stiffness is that of few of their
/// springs, on hexahedra of 20 nodes.
// With this number the memory that is expected is within a factor of 1.5 of what is used, for all elements
// (`benches/memory.py`).
const LEVELS: usize = 62;

impl BlockStiffness {
    /// Whether the stiffness of that mesh can be stored so: a mesh of the plane or of space without directors, whose points can be counted in 32 bits.
    pub fn is_of(mesh: &Mesh) -> bool {
        mesh.directors.is_none() && (2..=3).contains(&mesh.dimension) && mesh.point_count() < u32::MAX as usize
    }

    /// The bytes of so many stiffnesses of models of a mesh, and of so many times what solves with one.
    pub fn expected_bytes(mesh: &Mesh, models: usize, levels: usize) -> u64 {
        bytes(&places(mesh).1, mesh.dimension, models, levels)
    }

    /// Whether so many stiffnesses, and so many times what solves with one, fit into memory.
    ///
    /// # Errors
    /// They do not; kind `Limit`.
    pub fn check_size(mesh: &Mesh, models: usize, levels: usize) -> Result<()> {
        require(BlockStiffness::expected_bytes(mesh, models, levels))
    }

    /// Assembles the stiffness of the finite elements, once it is known that `models` such matrices and `levels` times what solves with one
    /// fit into memory.
    ///
    /// # Errors
    /// They do not; kind `Limit`.
    pub fn of_body(
        mesh: &Mesh,
        moduli: impl Into<CellMap<Hooke>>,
        models: usize,
        levels: usize,
    ) -> Result<BlockStiffness> {
        Self::of_cells(mesh, &moduli.into(), models, levels)
    }

    /// [`Self::of_body`], without parameters of type: compiled here, where code is optimised, and not with each caller.
    fn of_cells(mesh: &Mesh, moduli: &CellMap<Hooke>, models: usize, levels: usize) -> Result<BlockStiffness> {
        Ok(match mesh.dimension {
            2 => BlockStiffness::Plane(Arc::new(body(mesh, moduli, models, levels)?)),
            _ => BlockStiffness::Space(Arc::new(body(mesh, moduli, models, levels)?)),
        })
    }

    /// The tangent stiffness of a network at rest, in the places of `shared` if its springs are between points that act on each other
    /// there as well.
    pub fn of_network(network: &Network, points: &[f64], shared: Option<&BlockStiffness>) -> BlockStiffness {
        match (network.dimension, shared) {
            (2, Some(BlockStiffness::Plane(shared))) => {
                BlockStiffness::Plane(Arc::new(springs(network, points, Some(shared.pattern()))))
            }
            (2, _) => BlockStiffness::Plane(Arc::new(springs(network, points, None))),
            (_, Some(BlockStiffness::Space(shared))) => {
                BlockStiffness::Space(Arc::new(springs(network, points, Some(shared.pattern()))))
            }
            (_, _) => BlockStiffness::Space(Arc::new(springs(network, points, None))),
        }
    }

    /// Where the blocks of each point begin, `[points + 1]`, the other point of each, ascending, and the d × d blocks themselves, row
    /// after row, N/m.
    pub fn parts(&self) -> (Vec<usize>, Vec<u32>, Vec<f64>) {
        fn parts<const D: usize>(matrix: &BlockMatrix<D, D>) -> (Vec<usize>, Vec<u32>, Vec<f64>) {
            let (pattern, mut starts) = (matrix.pattern(), vec![0]);
            let mut columns = Vec::with_capacity(pattern.len());
            for row in 0..pattern.rows() {
                columns.extend(pattern.row(row));
                starts.push(columns.len());
            }
            (starts, columns, matrix.values().as_flattened().as_flattened().to_vec())
        }
        match self {
            BlockStiffness::Plane(matrix) => parts(matrix),
            BlockStiffness::Space(matrix) => parts(matrix),
        }
    }

    /// The entries row by row.
    pub fn rows(&self) -> CompressedRows {
        match self {
            BlockStiffness::Plane(matrix) => compressed(matrix),
            BlockStiffness::Space(matrix) => compressed(matrix),
        }
    }

    /// `K u`, `[points · dimension]`.
    pub fn apply(&self, u: &[f64]) -> Vec<f64> {
        fn product<const D: usize>(matrix: &BlockMatrix<D, D>, u: &[f64]) -> Vec<f64> {
            let mut force = vec![[0.0; D]; matrix.rows()];
            matrix.apply(u.as_chunks::<D>().0, &mut force);
            force.into_flattened()
        }
        match self {
            BlockStiffness::Plane(matrix) => product(matrix, u),
            BlockStiffness::Space(matrix) => product(matrix, u),
        }
    }

    /// `Σ_j |K_ij| w_j`, `[points · dimension]`.
    pub fn absolute_sums(&self, w: &[f64]) -> Vec<f64> {
        fn sums<const D: usize>(matrix: &BlockMatrix<D, D>, w: &[f64]) -> Vec<f64> {
            let (pattern, w) = (matrix.pattern(), w.as_chunks::<D>().0);
            // Blocks are stored in the order of the rows, each of which goes on where the last one ended.
            let mut blocks = matrix.values().iter();
            let row = |row: usize| {
                let mut sum = [0.0; D];
                for (&column, block) in pattern.row(row).iter().zip(&mut blocks) {
                    for i in 0..D {
                        sum[i] += (0..D).map(|j| block[i][j].abs() * w[column as usize][j]).sum::<f64>();
                    }
                }
                sum
            };
            (0..matrix.rows()).flat_map(row).collect()
        }
        match self {
            BlockStiffness::Plane(matrix) => sums(matrix, w),
            BlockStiffness::Space(matrix) => sums(matrix, w),
        }
    }
}

/// A sparse matrix row by row, without two entries at one place.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CompressedRows {
    /// Where each row begins, `[rows + 1]`.
    pub starts: Vec<usize>,
    /// The columns of each row, ascending.
    pub columns: Vec<u32>,
    /// The values at these columns.
    pub values: Vec<f64>,
}

impl CompressedRows {
    /// The sums of entries in any order, `(row, column, value)`, of a matrix with so many rows.
    pub fn of(rows: usize, entries: impl Iterator<Item = (usize, usize, f64)> + Clone) -> CompressedRows {
        let mut starts = vec![0; rows + 1];
        entries.clone().for_each(|(row, ..)| starts[row + 1] += 1);
        (0..rows).for_each(|row| starts[row + 1] += starts[row]);
        let mut next = starts.clone();
        let mut unsorted = vec![(0_u32, 0.0); starts[rows]];
        // Counted and put in their rows first: sorting each short row is quicker than sorting all entries.
        for (row, column, value) in entries {
            unsorted[next[row]] = (column as u32, value);
            next[row] += 1;
        }
        let mut found = CompressedRows { starts: vec![0], ..CompressedRows::default() };
        for at in starts.windows(2) {
            let row = &mut unsorted[at[0]..at[1]];
            // Stable: equal columns are added in the order in which they are given.
            row.sort_by_key(|(column, _)| *column);
            for own in row.chunk_by(|a, b| a.0 == b.0) {
                found.columns.push(own[0].0);
                found.values.push(own.iter().map(|(_, value)| value).sum());
            }
            found.starts.push(found.columns.len());
        }
        found
    }

    /// Both triangles of entries of the lower one.
    pub fn of_lower(rows: usize, entries: &Entries) -> CompressedRows {
        let across = entries.iter().filter(|e| e.row != e.col).map(|e| (e.col, e.row, e.val));
        CompressedRows::of(rows, entries.iter().map(|e| (e.row, e.col, e.val)).chain(across))
    }

    /// `K u`, `[rows]`.
    pub fn apply(&self, u: &[f64]) -> Vec<f64> {
        let row = |at: &[usize]| {
            let own = at[0]..at[1];
            self.columns[own.clone()].iter().zip(&self.values[own]).map(|(&column, k)| k * u[column as usize]).sum()
        };
        self.starts.windows(2).map(row).collect()
    }
}

fn compressed<const D: usize>(matrix: &BlockMatrix<D, D>) -> CompressedRows {
    let (pattern, values) = (matrix.pattern(), matrix.values());
    let size = pattern.len() * D * D;
    let mut found = CompressedRows {
        starts: Vec::with_capacity(pattern.rows() * D + 1),
        columns: Vec::with_capacity(size),
        values: Vec::with_capacity(size),
    };
    found.starts.push(0);
    let mut first = 0;
    for row in 0..pattern.rows() {
        let columns = pattern.row(row);
        let blocks = &values[first..first + columns.len()];
        for i in 0..D {
            found.columns.extend(columns.iter().flat_map(|&column| (0..D as u32).map(move |j| column * D as u32 + j)));
            found.values.extend(blocks.iter().flat_map(|block| block[i]));
            found.starts.push(found.columns.len());
        }
        first += columns.len();
    }
    found
}

/// The connectivity of each block of a mesh.
struct Connectivity {
    nodes: Vec<u32>,
    starts: Vec<usize>,
}

impl Connectivity {
    fn of<'a>(groups: impl Iterator<Item = &'a [usize]>) -> Connectivity {
        let (mut nodes, mut starts) = (Vec::new(), vec![0]);
        for group in groups {
            // There are fewer than 2³² points, which callers ask before they take blocks.
            nodes.extend(group.iter().map(|&point| point as u32));
            starts.push(nodes.len());
        }
        Connectivity { nodes, starts }
    }

    fn groups(&self) -> Groups<'_> {
        Groups { nodes: &self.nodes, starts: &self.starts }
    }
}

/// The cells of each block, and the places of the stiffness of finite elements.
fn places(mesh: &Mesh) -> (Vec<Connectivity>, Pattern) {
    let cells: Vec<Connectivity> = mesh.blocks.iter().map(|block| Connectivity::of(block.cells())).collect();
    let groups: Vec<Groups> = cells.iter().map(Connectivity::groups).collect();
    let pattern = Pattern::of_groups(mesh.point_count(), &groups);
    (cells, pattern)
}

fn bytes(pattern: &Pattern, d: usize, models: usize, levels: usize) -> u64 {
    let blocks = pattern.len() * models + LEVELS * pattern.rows() * levels;
    (blocks * d * d * size_of::<f64>()) as u64
}

fn require(bytes: u64) -> Result<()> {
    memory::require("the stiffness with the levels of its multigrid", bytes, ADVICE).map_err(|e| e.at_key("mesh"))
}

fn body<const D: usize>(
    mesh: &Mesh,
    moduli: &CellMap<Hooke>,
    models: usize,
    levels: usize,
) -> Result<BlockMatrix<D, D>> {
    let (cells, pattern) = places(mesh);
    require(bytes(&pattern, D, models, levels))?;
    let mut matrix = BlockMatrix::zero(Arc::new(pattern));
    for (index, (block, groups)) in mesh.blocks.iter().zip(cells.iter().map(Connectivity::groups)).enumerate() {
        let table = &block.element.tabulation;
        let n = table.nodes;
        let fill = |cells: Range<usize>, entries: &mut [f64]| {
            let first = cells.start;
            let own = &block.connectivity[cells.start * n..cells.end * n];
            let mut each = entries.chunks_exact_mut((n * D).pow(2));
            stiffness::each_cell(table, &mesh.points, own, |cell, _, geometry| {
                let mut r = geometry.stiffness(moduli.at(index, first + cell));
                if table.dimension < D {
                    // Membranes and rods have their stiffness in axes of their own.
                    r = in_space(table, &mesh.points, &own[cell * n..(cell + 1) * n], &r);
                }
                // Symmetric: by columns is by rows.
                each.next().into_iter().for_each(|entries| entries.copy_from_slice(r.as_slice()));
            })
            .expect("a mesh holds only cells with a volume");
            Ok::<(), Infallible>(())
        };
        // The error has no value, so that the pattern always matches.
        let Ok(()) = matrix.add(&groups, fill);
    }
    Ok(matrix)
}

fn springs<const D: usize>(network: &Network, points: &[f64], shared: Option<&Arc<Pattern>>) -> BlockMatrix<D, D> {
    let pairs = Connectivity::of(network.lengths.iter().map(|spring| &spring.points[..]));
    let others = Connectivity::of(network.others.iter().map(|spring| &spring.points[..]));
    let groups = [pairs.groups(), others.groups()];
    // Springs across sides, or of another network, may join points that no cell has together.
    let has_all = |pattern: &&Arc<Pattern>| {
        let has = |points: &[usize]| points.iter().all(|&i| points.iter().all(|&j| pattern.place(i, j).is_some()));
        let lengths = network.lengths.iter().all(|spring| has(&spring.points));
        lengths && network.others.iter().all(|spring| has(&spring.points))
    };
    let pattern = match shared.filter(has_all) {
        Some(shared) => shared.clone(),
        None => Arc::new(Pattern::of_groups(points.len() / D, &groups)),
    };
    let mut matrix = BlockMatrix::zero(pattern);
    let lengths = |springs: Range<usize>, entries: &mut [f64]| {
        let own = network.lengths[springs].iter().zip(entries.chunks_exact_mut(4 * D * D));
        own.for_each(|(spring, entries)| length::<D>(spring, points, entries));
        Ok::<(), Infallible>(())
    };
    let Ok(()) = matrix.add(&groups[0], lengths);
    let measures = |springs: Range<usize>, mut entries: &mut [f64]| {
        for spring in &network.others[springs] {
            let (own, rest) = entries.split_at_mut((spring.points.len() * D).pow(2));
            spring.tangent(points, D, own);
            entries = rest;
        }
        Ok::<(), Infallible>(())
    };
    let Ok(()) = matrix.add(&groups[1], measures);
    matrix
}

/// `k ((1 − L₀/ℓ) I + L₀/ℓ n nᵀ)` between two points, with its signs.
fn length<const D: usize>(spring: &LengthSpring, points: &[f64], entries: &mut [f64]) {
    let along = spring.along(points, D);
    for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let sign = if a == b { 1.0 } else { -1.0 };
        for k in 0..D {
            for l in 0..D {
                entries[(a * D + k) * 2 * D + b * D + l] = sign * spring.constant * along.entry(k, l);
            }
        }
    }
}
