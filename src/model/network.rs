//! The mass-spring model: the springs of all cells, those between the same two points added up.

use super::Entries;
use super::system::{dofs, each_cell};
use crate::fit::CellFits;
use crate::mesh::Mesh;
use crate::springs::distance;
use faer::sparse::Triplet;

/// A spring between two points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LengthSpring {
    /// The lower index first.
    pub points: [usize; 2],
    /// N/m.
    pub constant: f64,
    /// Length at rest, m.
    pub rest: f64,
}

/// A spring on the area or volume of one cell.
#[derive(Debug, Clone, PartialEq)]
pub struct ContentSpring {
    pub points: Vec<usize>,
    /// N/m⁵; in two dimensions N/m³.
    pub constant: f64,
    /// Volume at rest, m³; in two dimensions the area, m².
    pub rest: f64,
    /// Gradient of the volume with respect to the points, `[points × dimension]`, m² (m).
    pub gradient: Vec<f64>,
}

/// Springs on the points of a mesh. Springs whose constant is zero are not in it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Network {
    pub dimension: usize,
    /// Sorted by their points.
    pub lengths: Vec<LengthSpring>,
    pub contents: Vec<ContentSpring>,
}

impl Network {
    /// Adds up the springs of all cells; `fits` has one entry per block of the mesh.
    pub fn assemble(mesh: &Mesh, fits: &[CellFits]) -> Network {
        let mut network = Network { dimension: mesh.dimension, ..Network::default() };
        network.lengths = merge(mesh, fits);
        if fits.iter().any(|f| f.springs.content.is_some()) {
            each_cell(mesh, |cell, nodes, geometry| {
                let springs = &fits[cell.block].springs;
                if springs.content.is_none() {
                    return;
                }
                let constant = fits[cell.block].constants[(cell.cell + 1) * springs.len() - 1];
                if constant != 0.0 {
                    let (rest, gradient) = (geometry.content(), geometry.content_gradient());
                    network.contents.push(ContentSpring { points: nodes.to_vec(), constant, rest, gradient });
                }
            });
        }
        network
    }

    /// The tangent stiffness at rest, `Σ_s k_s g_s g_sᵀ`, N/m; `points` as in the mesh, `[points × dimension]`.
    pub fn stiffness(&self, points: &[f64]) -> Entries {
        let d = self.dimension;
        let mut entries = Entries::new();
        for spring in &self.lengths {
            let [i, j] = spring.points;
            let n: Vec<f64> = (0..d).map(|k| (points[j * d + k] - points[i * d + k]) / spring.rest).collect();
            for k in 0..d {
                for l in 0..d {
                    let value = spring.constant * n[k] * n[l];
                    if l <= k {
                        entries.push(Triplet::new(i * d + k, i * d + l, value));
                        entries.push(Triplet::new(j * d + k, j * d + l, value));
                    }
                    entries.push(Triplet::new(j * d + k, i * d + l, -value));
                }
            }
        }
        for spring in &self.contents {
            for (row, g) in dofs(&spring.points, d).zip(&spring.gradient) {
                for (column, h) in dofs(&spring.points, d).zip(&spring.gradient) {
                    if row >= column {
                        entries.push(Triplet::new(row, column, spring.constant * g * h));
                    }
                }
            }
        }
        entries
    }

    pub fn len(&self) -> usize {
        self.lengths.len() + self.contents.len()
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many constants are below zero.
    pub fn negative(&self) -> usize {
        let lengths = self.lengths.iter().map(|s| s.constant);
        lengths.chain(self.contents.iter().map(|s| s.constant)).filter(|k| *k < 0.0).count()
    }
}

/// Gathers the length springs of each point's higher neighbours in one counted list, then adds equal ones within it.
fn merge(mesh: &Mesh, fits: &[CellFits]) -> Vec<LengthSpring> {
    let springs_of_cells = || {
        mesh.blocks.iter().zip(fits).flat_map(|(block, fit)| {
            let constants = fit.constants.chunks_exact(fit.springs.len().max(1));
            block.cells().zip(constants).flat_map(move |(nodes, k)| {
                fit.springs.pairs.iter().zip(k).map(move |(&[a, b], &k)| {
                    let (i, j) = (nodes[a], nodes[b]);
                    (i.min(j), i.max(j), k)
                })
            })
        })
    };
    let mut starts = vec![0; mesh.point_count() + 1];
    springs_of_cells().for_each(|(i, ..)| starts[i + 1] += 1);
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut next = starts.clone();
    let mut neighbours = vec![(0, 0.0); starts[mesh.point_count()]];
    for (i, j, k) in springs_of_cells() {
        neighbours[next[i]] = (j, k);
        next[i] += 1;
    }
    let mut merged = Vec::new();
    for i in 0..mesh.point_count() {
        let list = &mut neighbours[starts[i]..starts[i + 1]];
        list.sort_by_key(|(j, _)| *j);
        for same in list.chunk_by(|a, b| a.0 == b.0) {
            let constant: f64 = same.iter().map(|(_, k)| k).sum();
            let j = same[0].0;
            if constant != 0.0 {
                let rest = distance(mesh.point(i), mesh.point(j));
                merged.push(LengthSpring { points: [i, j], constant, rest });
            }
        }
    }
    merged
}
