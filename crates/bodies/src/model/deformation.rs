//! Whether displacements are small enough for the linear theory.

use super::network::Network;
use super::numbering::dofs;
use super::system::each_cell;
use crate::mesh::Mesh;
use crate::stiffness::Placement;
use nalgebra::DMatrix;

/// The largest strain and rotation at the quadrature points of the cells of a body. They follow from the gradient of
/// the displacements `H = ∂u/∂X`: strain `½ (H + Hᵀ)`, rotation `½ (H − Hᵀ)`. On a surface or curve H is taken along
/// the tangents; the change of the normal counts as rotation.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Deformation {
    /// The largest absolute value of a principal strain.
    pub strain: f64,
    /// The length of the rotation vector, rad.
    pub rotation: f64,
}

impl Deformation {
    /// The bound of strains and rotations, 0.1, up to which the linear theory is taken as valid.
    ///
    /// The linear theory omits `½ Hᵀ H` in the strain `½ (H + Hᵀ + Hᵀ H)`. At this strain ε the omitted term is a
    /// twentieth of ε. At this rotation θ, in rad, a rotated part is stretched by `θ²/2`, half a percent, and its
    /// displacement has an error of `θ/2`, a twentieth.
    pub const LINEAR: f64 = 0.1;

    /// The deformation under the displacements u, `[points · dimension]`, m.
    pub fn largest(mesh: &Mesh, u: &[f64]) -> Deformation {
        let mut largest = Deformation::default();
        each_gradient(mesh, u, |frame, h, _| {
            let along = frame * h;
            let out = h - frame.transpose() * &along;
            let (strain, spin) = ((&along + along.transpose()) * 0.5, (&along - along.transpose()) * 0.5);
            // ‖spin‖ counts each component of the rotation vector twice.
            let rotation = (spin.norm_squared() / 2.0 + out.norm_squared()).sqrt();
            let strain = strain.symmetric_eigenvalues().amax();
            largest = largest.max(Deformation { strain, rotation });
        });
        largest
    }

    /// The deformation of the springs of a network under the displacements u from `points`, both `[points · dimension]`, m, where no
    /// cells are known: the strain along each spring between two points, and the angle by which it turns, shear included.
    pub fn of_springs(network: &Network, points: &[f64], u: &[f64]) -> Deformation {
        let d = network.dimension;
        let mut largest = Deformation::default();
        let lengths = network.lengths.iter().map(|spring| spring.points);
        let others = network.others.iter().filter(|spring| spring.points.len() == 2);
        for [i, j] in lengths.chain(others.map(|spring| [spring.points[0], spring.points[1]])) {
            let between = |x: &[f64], k: usize| x[j * d + k] - x[i * d + k];
            let square: f64 = (0..d).map(|k| between(points, k).powi(2)).sum();
            let along: f64 = (0..d).map(|k| between(points, k) * between(u, k)).sum::<f64>() / square;
            let across: f64 = (0..d).map(|k| (between(u, k) - along * between(points, k)).powi(2)).sum();
            // Springs of no length have no strain: the quotients above are 0/0.
            if square > 0.0 {
                largest = largest.max(Deformation { strain: along.abs(), rotation: (across / square).sqrt() });
            }
        }
        largest
    }

    /// The stretch that a share of the body has at least: in so much of its content some principal stretch, a square root of an eigenvalue
    /// of `Fᵀ F` with `F = I + H`, differs from 1 by this or more. Unlike the largest stretch it does not grow with finer cells at the
    /// ends of supports.
    pub fn stretch_of(mesh: &Mesh, u: &[f64], share: f64) -> f64 {
        let (mut all, mut content) = (Vec::new(), 0.0);
        each_gradient(mesh, u, |frame, h, volume| {
            let f = frame.transpose() + h;
            let squares = (f.transpose() * f).symmetric_eigenvalues();
            // Rounding may leave an eigenvalue of a flattened cell just below zero.
            let stretch = squares.iter().map(|square| (square.max(0.0).sqrt() - 1.0).abs()).fold(0.0, f64::max);
            // A comparison with NaN would let it pass as no stretch.
            all.push((if stretch.is_nan() { f64::INFINITY } else { stretch }, volume));
            content += volume;
        });
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut above = 0.0;
        let reached = all.iter().find(|(_, volume)| {
            above += volume;
            above >= share * content
        });
        reached.map_or(0.0, |(stretch, _)| *stretch)
    }

    /// The larger of both strains and of both rotations; NaN counts as infinite.
    pub fn max(self, other: Deformation) -> Deformation {
        let larger = |a: f64, b: f64| if a.is_nan() || b.is_nan() { f64::INFINITY } else { a.max(b) };
        Deformation { strain: larger(self.strain, other.strain), rotation: larger(self.rotation, other.rotation) }
    }

    /// Whether the strain or the rotation is larger than `bound`.
    pub fn exceeds(self, bound: f64) -> bool {
        self.strain > bound || self.rotation > bound
    }
}

/// Calls `visit(frame, H, content)` for every quadrature point, with the tangents of the cell as rows of the frame.
fn each_gradient(mesh: &Mesh, u: &[f64], mut visit: impl FnMut(&DMatrix<f64>, &DMatrix<f64>, f64)) {
    let space = mesh.dimension;
    each_cell(mesh, |cell, nodes, geometry| {
        let (table, d) = (&mesh.blocks[cell.block].element.tabulation, geometry.dimension);
        let local: Vec<f64> = dofs(nodes, space).map(|dof| u[dof]).collect();
        let frame = if d < space {
            let mut placement = Placement::new(table);
            let mut x = vec![0.0; nodes.len() * d];
            placement.place(table, &mesh.points, nodes, &mut x).expect("a mesh holds only cells with tangents");
            DMatrix::from_row_slice(d, space, &placement.frame)
        } else {
            DMatrix::identity(d, d)
        };
        for (gradients, volume, _) in geometry.each_point() {
            // ∂u_k/∂s_l = Σ_a u_ak ∂N_a/∂s_l
            let h = DMatrix::from_fn(space, d, |k, l| {
                (0..nodes.len()).map(|a| local[a * space + k] * gradients[a * d + l]).sum::<f64>()
            });
            visit(&frame, &h, *volume);
        }
    });
}
