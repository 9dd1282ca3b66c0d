//! How much energy the linear cells of a body lack, estimated from the jumps of its strains between cells.
//!
//! Source: Zienkiewicz and Zhu, A simple error estimator and adaptive procedure for practical engineering analysis, Int. J. Numer. Meth. Eng. 24, 337
//! (1987).

use super::system::each_cell;
use crate::element::Element;
use crate::material::{MaterialMap, strains, voigt};
use crate::mesh::{CellIndex, Mesh};
use crate::stiffness::Geometry;
use nalgebra::{DMatrix, DVector};
use springfit_numerics::dense::singular;
use std::collections::HashMap;

/// The share of its energy that a body lacks because its cells are linear, under displacements `u`, `[points × dimension]`, m, that its finite
/// elements have: about `1 − U_h/U`, with the energy U_h of these and U of the continuous body under the same forces. 0 where nothing is
/// strained, and NaN where `u` is not finite. Strains are Green's if `is_large`.
///
/// Smooth strains `ε* = Σ_a N_a ε_a` have at each node the mean of those of its cells by volume, and the share is
/// `Σ ∫ (ε* − ε)·C (ε* − ε) / Σ ∫ ε·C ε`. Strains may jump between regions of different material, so that each of them has means of its own.
pub fn lacking_energy(mesh: &Mesh, material: &MaterialMap, u: &[f64], is_large: bool) -> f64 {
    let recovery = Recovery { mesh, material, u, is_large };
    let means = recovery.means();
    let moduli = material.moduli();
    let [mut lacking, mut all] = [0.0; 2];
    recovery.each(|cell, nodes, of_cell| {
        let (law, _) = moduli.at(cell.block, cell.cell).entries(mesh.dimension);
        let law = DMatrix::from_row_slice(of_cell.corners.ncols(), of_cell.corners.ncols(), &law);
        let energy = |strain: &DVector<f64>| strain.dot(&(&law * strain));
        let region = recovery.region(cell);
        let smooth = DMatrix::from_fn(nodes.len(), law.nrows(), |a, k| means[&(region, nodes[a])][k]);
        let rows =
            |matrix: &DMatrix<f64>| -> Vec<DVector<f64>> { matrix.row_iter().map(|row| row.transpose()).collect() };
        all += rows(&of_cell.at_points).iter().zip(&of_cell.volumes).map(|(strain, v)| v * energy(strain)).sum::<f64>();
        lacking += match mesh.blocks[cell.block].element.cell.is_simplex() {
            // `∫ N_a N_b = V (1 + δ_ab)/(n (n + 1))` with n nodes. The cell's own rule often has one point, at which a linear difference is not seen.
            true => {
                let apart = rows(&(smooth - &of_cell.corners));
                let (n, volume) = (nodes.len() as f64, of_cell.volumes.iter().sum::<f64>());
                let sum: DVector<f64> = apart.iter().sum();
                volume / (n * (n + 1.0)) * (energy(&sum) + apart.iter().map(energy).sum::<f64>())
            }
            false => {
                let apart = rows(&(of_cell.values * smooth - &of_cell.at_points));
                apart.iter().zip(&of_cell.volumes).map(|(strain, v)| v * energy(strain)).sum()
            }
        };
    });
    if all == 0.0 { 0.0 } else { lacking / all }
}

/// Displacements of a body, whose strains are recovered at its nodes.
struct Recovery<'a> {
    mesh: &'a Mesh,
    material: &'a MaterialMap,
    u: &'a [f64],
    is_large: bool,
}

/// The strains of a cell, in Voigt's order.
struct CellStrains<'a> {
    /// `N_a` at the quadrature points, `[points × nodes]`.
    values: &'a DMatrix<f64>,
    /// The strains at the quadrature points, `[points × strains]`.
    at_points: DMatrix<f64>,
    /// The strains at the nodes, `[nodes × strains]`, from which the shape functions come nearest to those at the points.
    corners: DMatrix<f64>,
    /// The contents of the points.
    volumes: Vec<f64>,
}

impl Recovery<'_> {
    fn region(&self, cell: CellIndex) -> usize {
        *self.material.region().at(cell.block, cell.cell)
    }

    /// Calls `visit` for each cell that fills the space of the body; membranes and rods in it have no strain in all directions.
    fn each(&self, mut visit: impl FnMut(CellIndex, &[usize], CellStrains)) {
        let carried: Vec<_> = self.mesh.blocks.iter().map(|block| carried(&block.element)).collect();
        each_cell(self.mesh, |cell, nodes, geometry| {
            if geometry.dimension == self.mesh.dimension {
                let (values, to_nodes) = &carried[cell.block];
                let at_points = self.strains(nodes, geometry);
                let corners = to_nodes * &at_points;
                let volumes = geometry.each_point().map(|(_, volume, _)| *volume).collect();
                visit(cell, nodes, CellStrains { values, at_points, corners, volumes });
            }
        });
    }

    /// The strains at the quadrature points of a cell: `½ (H + Hᵀ)` with `H = ∂u/∂X`, or Green's `½ (H + Hᵀ + Hᵀ H)`; shears are twice these.
    fn strains(&self, nodes: &[usize], geometry: &Geometry) -> DMatrix<f64> {
        let d = geometry.dimension;
        let mut found = DMatrix::zeros(geometry.each_point().count(), strains(d));
        for (q, (gradients, ..)) in geometry.each_point().enumerate() {
            let mut h = [[0.0; 3]; 3];
            for (gradient, &p) in gradients.chunks_exact(d).zip(nodes) {
                for k in 0..d {
                    (0..d).for_each(|l| h[k][l] += self.u[p * d + k] * gradient[l]);
                }
            }
            for k in 0..d {
                for l in 0..=k {
                    let square: f64 = (0..d).map(|m| h[m][k] * h[m][l]).sum();
                    let twice = h[k][l] + h[l][k] + if self.is_large { square } else { 0.0 };
                    found[(q, voigt(d, k, l))] = if k == l { twice / 2.0 } else { twice };
                }
            }
        }
        found
    }

    /// The mean strains of the cells at each node, by region and point.
    fn means(&self) -> HashMap<(usize, usize), DVector<f64>> {
        let mut sums: HashMap<(usize, usize), (f64, DVector<f64>)> = HashMap::new();
        self.each(|cell, nodes, of_cell| {
            let volume: f64 = of_cell.volumes.iter().sum();
            let region = self.region(cell);
            for (&p, strain) in nodes.iter().zip(of_cell.corners.row_iter()) {
                let zero = || (0.0, DVector::zeros(strain.len()));
                let (weight, sum) = sums.entry((region, p)).or_insert_with(zero);
                *weight += volume;
                sum.axpy(volume, &strain.transpose(), 1.0);
            }
        });
        sums.into_iter().map(|(key, (weight, sum))| (key, sum / weight)).collect()
    }
}

/// The shape functions at the quadrature points, `[points × nodes]`, and what takes values at these points to the nodes: the pseudoinverse. With one
/// point all nodes have its value; with as many points as nodes the values are continued by the shape functions.
fn carried(element: &Element) -> (DMatrix<f64>, DMatrix<f64>) {
    let table = &element.tabulation;
    let values = DMatrix::from_row_slice(table.points(), table.nodes, &table.values);
    // Singular values of shape functions that points tell apart are far above rounding; the others are zero up to it.
    let inverse =
        singular(values.clone()).expect("shape functions are finite at quadrature points").pseudo_inverse(1e-10);
    (values, inverse)
}
