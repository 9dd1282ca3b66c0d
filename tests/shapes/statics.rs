//! Bodies under loads, and what they do.

use super::bodies::grid;
use nalgebra::DMatrix;
use springfit_bodies::model::{Entries, Support};
use springfit_bodies::solve::System;
use springfit_mesh::mesh::Mesh;

/// The work of the load on the displacements that it causes.
pub fn compliance(entries: &Entries, support: &Support, load: &[f64]) -> f64 {
    let system = System::new(entries, support).unwrap();
    let factor = system.cholesky().unwrap().unwrap();
    let (u, residual) = system.solve(&factor, load);
    assert!(residual < 1e-6, "{residual:e}");
    u.iter().zip(load).map(|(u, f)| u * f).sum()
}

/// Cook's membrane of n × n squares.
pub fn membrane(element: &str, n: usize) -> Mesh {
    let mut mesh = grid(element, &[1.0; 2], &[n, n]);
    for x in mesh.points.chunks_exact_mut(2) {
        let (s, t) = (x[0], x[1]);
        (x[0], x[1]) = (48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s));
    }
    mesh
}

/// The symmetric matrix of entries, of which those beside the diagonal stand for two.
pub fn dense(size: usize, entries: &Entries) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(size, size);
    for entry in entries {
        matrix[(entry.row, entry.col)] += entry.val;
        if entry.row != entry.col {
            matrix[(entry.col, entry.row)] += entry.val;
        }
    }
    matrix
}

/// This matrix times a vector.
pub fn product(entries: &Entries, u: &[f64]) -> Vec<f64> {
    let mut f = vec![0.0; u.len()];
    for entry in entries {
        f[entry.row] += entry.val * u[entry.col];
        if entry.row != entry.col {
            f[entry.col] += entry.val * u[entry.row];
        }
    }
    f
}

/// Some points held in all directions.
pub fn support_at(mesh: &Mesh, points: &[usize]) -> Support {
    let mut support = Support::free(mesh);
    support.fix(points, &(0..mesh.dimension).collect::<Vec<_>>(), mesh.dimension);
    support
}
