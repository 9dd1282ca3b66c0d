//! The quadratic programme of the nearest network.
//!
//! Theory: page *Exact networks and patches* of the book.

use super::contents::Contents;
use super::edges::Edges;
use super::quadratic::{Quadratic, SearchProgress};
use super::{dual, interior};
use crate::error::Result;
use crate::mesh::Mesh;
use crate::model::Network;
use crate::springs::norm;

/// The weight of the squared relative error of a mode's energy against squared relative changes of constants: a change
/// of every constant by a tenth costs as much as an energy error of 0.1 %.
const MODES: f64 = 1e4;
/// The weight of squared relative changes of tensions against those of constants. Each change of a tension causes a
/// force inside the body under homogeneous strain.
const TENSIONS: f64 = 100.0;

/// What may change, and what should be kept.
pub(super) struct Programme<'a> {
    pub mesh: &'a Mesh,
    pub network: &'a Network,
    pub edges: &'a Edges,
    /// The springs on content whose tension may change; none if all are fixed.
    pub contents: &'a Contents,
    /// A typical modulus of the network, Pa.
    pub modulus: f64,
    /// For each mode the relative change of its energy per change of each constant and then of each tension.
    pub modes: Vec<Vec<f64>>,
}

/// The changes of the constants and of the tensions.
#[derive(Debug, Clone)]
pub(super) struct Changes {
    pub constants: Vec<f64>,
    pub tensions: Vec<f64>,
    pub iterations: u32,
}

impl Programme<'_> {
    /// A typical constant of an edge, `m V_e/ℓ²`, N/m.
    pub fn scale(&self, edge: usize) -> f64 {
        let Edges { lengths, volumes, .. } = self.edges;
        self.modulus * volumes[edge] / (lengths[edge] * lengths[edge])
    }

    /// Solves, with `z_e = δk_e/(m V_e/ℓ_e²)` and `z_c = δT_c/m`,
    ///
    /// ```text
    /// min Σ_e (V_e/V) (h²/ℓ_e²) z_e² + w_T Σ_c (c/V) z_c² + w_M Σ_m (δE_m/E_m)²
    /// Σ_e δk_e (X_j − X_i) + Σ_c δT_c ∇c = 0 at each point,   Σ_c c δT_c = 0,   k_e + δk_e ≥ 0
    /// ```
    ///
    /// The mean of the tensions, which is the shear modulus, is kept; otherwise a network with all springs zero would
    /// be a solution. `None` if there is no solution.
    ///
    /// # Errors
    /// The solver stops without a solution and without a proof that there is none.
    pub fn solve(&self, watch: &mut SearchProgress) -> Result<Option<Changes>> {
        let programme = self.quadratic();
        let minimum = match dual::minimum(&programme, watch)? {
            Some(minimum) => minimum,
            // Its method also proves that there is no solution.
            None => match interior::minimum(&programme, watch)? {
                Some(minimum) => minimum,
                None => return Ok(None),
            },
        };
        let (constants, tensions) = minimum.variables.split_at(self.edges.len());
        let constants = constants.iter().enumerate().map(|(edge, z)| z * self.scale(edge)).collect();
        let tensions = tensions.iter().map(|z| z * self.modulus).collect();
        Ok(Some(Changes { constants, tensions, iterations: minimum.steps }))
    }

    /// The programme in the changes z.
    fn quadratic(&self) -> Quadratic {
        let (mesh, edges, contents) = (self.mesh, self.edges, self.contents);
        let d = mesh.dimension;
        let scales: Vec<f64> = (0..edges.len()).map(|edge| self.scale(edge)).collect();
        let volume: f64 = edges.volumes.iter().sum();
        let square = edges.lengths.iter().map(|l| l * l).sum::<f64>() / edges.len() as f64;
        let mut programme = Quadratic::new(&mesh.points, d);
        for (edge, scale) in scales.iter().enumerate() {
            // The weights sum to about one: with larger ones the proof that there is no solution is not found.
            let weight = edges.volumes[edge] / volume * square / (edges.lengths[edge] * edges.lengths[edge]);
            let [i, j] = edges.pairs[edge];
            let vector = edges.vector(mesh, edge);
            let ends = [(i, -scale), (j, *scale)];
            let column =
                ends.into_iter().flat_map(|(p, by)| vector.iter().enumerate().map(move |(k, r)| (p * d + k, by * r)));
            programme.push(weight, -edges.constants[edge] / scale, column);
        }
        let content: f64 = contents.rests.iter().sum();
        for ((place, gradient), rest) in contents.places.iter().zip(&contents.gradients).zip(&contents.rests) {
            let rows = self.network.others[*place].points.iter().flat_map(|p| p * d..(p + 1) * d);
            let column = rows.zip(gradient).map(|(row, g)| (row, self.modulus * g));
            programme.push(TENSIONS * rest / content, f64::NEG_INFINITY, column);
        }
        programme.normalise();
        if !contents.rests.is_empty() {
            let size = norm(&contents.rests);
            // A row of unit size, like those of A, so that one limit of residuals serves all equations.
            let mean = std::iter::repeat_n(0.0, edges.len()).chain(contents.rests.iter().map(|rest| rest / size));
            programme.dense.push((mean.collect(), f64::INFINITY));
        }
        for mode in &self.modes {
            let units = scales.iter().copied().chain(std::iter::repeat_n(self.modulus, contents.rests.len()));
            let row: Vec<f64> = mode.iter().zip(units).map(|(share, unit)| share * unit).collect();
            let size = norm(&row);
            // The row has unit size; its weight takes the square of the size.
            programme.dense.push((row.iter().map(|x| x / size).collect(), MODES * size * size));
        }
        programme
    }
}
