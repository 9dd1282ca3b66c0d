//! What a mesh file gives is sound, as a source and as a mesh of the shipped elements.

use springfit_element::element::{Element, SHIPPED};
use springfit_mesh::mesh::{Mesh, MeshSource};
use std::sync::{Arc, OnceLock};

pub fn check(bytes: &[u8], ending: &str) {
    check_result(MeshSource::parse(bytes, ending));
}

pub fn check_result(result: springfit_foundation::error::Result<MeshSource>) {
    match result {
        Ok(source) => {
            check_source(&source);
            if let Ok(mesh) = Mesh::resolve(&source, shipped(), 1e-3) {
                check_mesh(&mesh);
            }
        }
        Err(error) => assert_eq!(error.to_string().lines().count(), 1, "{error:?}"),
    }
}

/// Parsed and proved once, not for every file.
fn shipped() -> &'static [Arc<Element>] {
    static ELEMENTS: OnceLock<Vec<Arc<Element>>> = OnceLock::new();
    ELEMENTS.get_or_init(|| SHIPPED.iter().map(|s| Arc::new(Element::shipped(s).expect("it is tested"))).collect())
}

fn check_source(source: &MeshSource) {
    assert!(source.points.iter().flatten().all(|x| x.is_finite()));
    for block in &source.blocks {
        assert!(block.dimension <= 3 && block.nodes_per_cell > 0 && !block.connectivity.is_empty());
        assert_eq!(block.connectivity.len() % block.nodes_per_cell, 0);
        assert!(block.connectivity.iter().all(|&node| node < source.points.len()));
    }
}

fn check_mesh(mesh: &Mesh) {
    assert!(mesh.cell_count() > 0 && mesh.points.iter().all(|x| x.is_finite()));
    let count = mesh.point_count();
    let mut used = vec![false; count];
    mesh.blocks.iter().flat_map(|block| &block.connectivity).for_each(|&point| used[point] = true);
    assert!(used.iter().all(|used| *used), "a point without a cell");
    for group in mesh.groups.values() {
        assert!(group.points.is_sorted() && group.points.iter().all(|&point| point < count));
        assert!(group.sides.iter().flatten().all(|&point| point < count));
        assert!(group.cells.iter().all(|at| at.cell < mesh.blocks[at.block].cells().len()));
    }
}
