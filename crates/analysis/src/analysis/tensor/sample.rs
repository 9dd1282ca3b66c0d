//! Samples of a mesh: the cells around some neighbouring points.

use crate::mesh::{CellBlock, Mesh};
use std::collections::{HashMap, VecDeque};

/// The number of points of a sample at which no further cells are added, because its equations are solved densely.
// The 450 unknowns of as many points in space have a matrix of 1.6 MB, whose factor takes `450³/3 = 3e7` operations.
const ENOUGH: usize = 150;

/// The cells of each point.
pub(super) struct Stars<'a> {
    mesh: &'a Mesh,
    /// The index at which the cells of each point begin, `[points + 1]`.
    starts: Vec<usize>,
    /// Cells, numbered through all blocks, grouped by point; of 32 bits, because this list is there when most memory is used.
    cells: Vec<u32>,
    /// The number of the first cell of each block.
    firsts: Vec<usize>,
}

/// Some cells of a mesh.
pub(super) struct Sample {
    /// The cells as a mesh with points of its own.
    pub(super) mesh: Mesh,
    /// The index of each of its points in the whole mesh.
    pub(super) points: Vec<usize>,
    /// The index in the sample of each of these points.
    pub(super) places: HashMap<usize, usize>,
    /// Its cells, by block.
    pub(super) cells: Vec<Vec<usize>>,
    /// The points that are not on the surface of the body and whose cells are all in the sample.
    pub(super) interior: Vec<usize>,
    /// Whether three cells or more share a side, as where sheets meet or cells lie over others. Cells of one material are then not in
    /// equilibrium under an affine strain.
    pub(super) is_joined: bool,
}

impl<'a> Stars<'a> {
    pub(super) fn of(mesh: &'a Mesh) -> Stars<'a> {
        // What is attached to the body is another material.
        let mut starts = vec![0; mesh.point_count() + 1];
        mesh.body_blocks().flat_map(|(_, block)| &block.connectivity).for_each(|&point| starts[point + 1] += 1);
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut cells = vec![0_u32; starts[starts.len() - 1]];
        let (mut firsts, mut cell) = (Vec::new(), 0);
        for block in &mesh.blocks {
            firsts.push(cell);
            // Membranes and rods on a solid are no cells of its samples.
            if block.element.dimension() < mesh.cell_dimension() {
                continue;
            }
            for nodes in block.cells() {
                for &point in nodes {
                    cells[next[point]] = cell as u32;
                    next[point] += 1;
                }
                cell += 1;
            }
        }
        Stars { mesh, starts, cells, firsts }
    }

    /// The cells of a point.
    pub(super) fn around(&self, point: usize) -> impl Iterator<Item = usize> {
        self.cells[self.starts[point]..self.starts[point + 1]].iter().map(|&cell| cell as usize)
    }

    /// The points of a cell.
    pub(super) fn points(&self, cell: usize) -> &[usize] {
        let (block, cell) = self.place(cell);
        self.mesh.blocks[block].cell(cell)
    }

    /// The block of a cell, and its index there.
    fn place(&self, cell: usize) -> (usize, usize) {
        let block = self.firsts.partition_point(|first| *first <= cell) - 1;
        (block, cell - self.firsts[block])
    }

    /// Whether the sample has a cell.
    pub(super) fn is_in(&self, cell: usize, sample: &Sample) -> bool {
        let (block, cell) = self.place(cell);
        sample.cells[block].binary_search(&cell).is_ok()
    }

    /// All cells around `count` points, those nearest to `seed` by the number of cells between them; fewer if cells
    /// have many nodes.
    pub(super) fn sample(&self, seed: usize, count: usize) -> Sample {
        let mut queue = VecDeque::from([seed]);
        let (mut places, mut points) = (HashMap::from([(seed, 0)]), vec![seed]);
        let mut cells: Vec<usize> = Vec::new();
        let mut closed = 0;
        // The cells around the seed are taken in any case, however many points they have: without them there is no
        // sample.
        while let Some(point) = queue.pop_front().filter(|_| closed < count && (closed == 0 || points.len() < ENOUGH)) {
            closed += 1;
            for cell in self.around(point) {
                cells.push(cell);
                for &p in self.points(cell) {
                    places.entry(p).or_insert_with(|| {
                        queue.push_back(p);
                        points.push(p);
                        points.len() - 1
                    });
                }
            }
        }
        self.gather(cells, points, places)
    }

    /// A sample of one cell.
    pub(super) fn single(&self, cell: usize) -> Sample {
        let points = self.points(cell).to_vec();
        let places = points.iter().enumerate().map(|(place, &point)| (point, place)).collect();
        self.gather(vec![cell], points, places)
    }

    fn gather(&self, mut cells: Vec<usize>, points: Vec<usize>, places: HashMap<usize, usize>) -> Sample {
        // A cell is found once for each of its points, and in an order that depends on the seed.
        cells.sort_unstable();
        cells.dedup();
        let mut own = vec![Vec::new(); self.mesh.blocks.len()];
        cells.iter().map(|&cell| self.place(cell)).for_each(|(block, cell)| own[block].push(cell));
        let block = |(block, cells): (&CellBlock, &Vec<usize>)| {
            let connectivity = cells.iter().flat_map(|cell| block.cell(*cell)).map(|point| places[point]).collect();
            CellBlock { element: block.element.clone(), connectivity }
        };
        let mesh = Mesh::of_cells(
            self.mesh.dimension,
            points.iter().flat_map(|&point| self.mesh.point(point)).copied().collect(),
            self.mesh.blocks.iter().zip(&own).map(block).collect(),
        );
        // A point with a cell outside of the sample lacks the forces of that cell, and is no free one.
        let mut is_held: Vec<bool> =
            points.iter().map(|&p| self.around(p).any(|cell| cells.binary_search(&cell).is_err())).collect();
        is_held.iter_mut().zip(mesh.outer_points()).for_each(|(held, outer)| *held |= outer);
        for (end, is_single) in ends(&mesh) {
            is_held[end] |= is_single;
        }
        let interior = (0..points.len()).filter(|&place| !is_held[place]).collect();
        let is_joined = is_joined(&mesh);
        Sample { mesh, points, places, cells: own, interior, is_joined }
    }
}

/// Whether three cells or more share a side.
fn is_joined(mesh: &Mesh) -> bool {
    let mut is_joined = false;
    mesh.each_side_set(|sides| is_joined |= sides.len() > 2);
    is_joined
}

/// The end points of cells that are lines, which have no sides, and whether only one cell ends there.
fn ends(mesh: &Mesh) -> HashMap<usize, bool> {
    let mut ends = HashMap::new();
    for block in mesh.blocks.iter().filter(|block| block.element.dimension() == 1) {
        for (nodes, corner) in block.cells().flat_map(|nodes| [(nodes, 0), (nodes, 1)]) {
            // A line has no sides. Its boundary is the points that a single cell has as an end.
            if let Some(node) = block.element.corner_node(corner) {
                ends.entry(nodes[node]).and_modify(|is_single| *is_single = false).or_insert(true);
            }
        }
    }
    ends
}
