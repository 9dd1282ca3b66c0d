//! Bodies under loads, and what they do.

use springfit_bodies::model::{Entries, Support};
use springfit_bodies::solve::System;
use springfit_element::element::Element;
use springfit_mesh::mesh::{BoxMesh, Mesh};
use std::sync::Arc;

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
    let element = Arc::new(Element::load(element).unwrap());
    let mut mesh = BoxMesh { element, size: vec![1.0; 2], cells: vec![n, n], origin: vec![0.0; 2] }.build().unwrap();
    for x in mesh.points.chunks_exact_mut(2) {
        let (s, t) = (x[0], x[1]);
        (x[0], x[1]) = (48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s));
    }
    mesh
}
