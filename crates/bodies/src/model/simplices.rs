//! Meshes of linear triangles or tetrahedra, the only ones that springs on several cells are made for.

use crate::error::{Error, ErrorKind, Result};
use crate::mesh::{CellBlock, Mesh};

/// The cells of a mesh of linear simplices in a space of their own dimension, for the key with this value; `others` says
/// what serves other meshes, and what does not.
///
/// # Errors
/// The mesh has other cells, or cells of several kinds; the kind is `Unsupported`.
pub fn linear_simplices<'a>(mesh: &'a Mesh, key: &str, others: &str, value: &str) -> Result<&'a CellBlock> {
    let unsupported = |found: String| {
        let expected = format!("{others} are for meshes of linear triangles or linear tetrahedra in their own space");
        let found = format!("\"{value}\" with {found}");
        Err(Error::expected(key, expected, found).of_kind(ErrorKind::Unsupported))
    };
    // What is attached to the body is on cells of its own.
    let blocks: Vec<&CellBlock> = mesh.body_blocks().map(|(_, block)| block).collect();
    let [block] = blocks[..] else {
        let names: Vec<&str> = blocks.iter().map(|block| block.element.name.as_str()).collect();
        return unsupported(format!("cells of {}", names.join(", ")));
    };
    let (element, d) = (&block.element, mesh.dimension);
    let is_simplex = element.nodes() == d + 1 && element.tabulation.points() == 1;
    if !is_simplex || mesh.cell_dimension() != d || d < 2 {
        return unsupported(element.name.clone());
    }
    Ok(block)
}
