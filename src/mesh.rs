//! Meshes: read from files of many programs, generated, refined, filled, checked.

/// Grids of VTK.
pub mod vtk {
    #[doc(inline)]
    pub use springfit_mesh::mesh::vtk::{Array, Grid, write};
}

#[doc(inline)]
pub use springfit_mesh::mesh::{
    CellBlock, CellIndex, Field, FillBoundary, FillLayers, FillMesh, FillSpacing, Filled, Format, Gate, Group,
    MESH_FORMATS, Mesh, MeshArrays, MeshFormat, NumberOrigin, Numbering, Quality, Scattered, SourceBlock, VoxelMesh,
    listed_endings,
};

/// A rectangle or a box of cells in rows, with groups on its sides.
///
/// ```
/// use springfit::element::Element;
/// use springfit::mesh::BoxMesh;
///
/// let element = std::sync::Arc::new(Element::load("hex8")?);
/// let mesh = BoxMesh { element, size: vec![0.04, 0.02, 0.02], cells: vec![4, 2, 2], origin: vec![0.0; 3] }.build()?;
/// assert_eq!((mesh.point_count(), mesh.cell_count()), (45, 16));
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_mesh::mesh::BoxMesh;

/// A plane disc or a dome of triangles in rings.
///
/// ```
/// use springfit::element::Element;
/// use springfit::mesh::DiscMesh;
///
/// let element = std::sync::Arc::new(Element::load("tri3")?);
/// let mesh = DiscMesh { element, radius: 0.1, height: 0.0, rings: DiscMesh::even(3) }.build()?;
/// assert_eq!(mesh.point_count(), 1 + 6 + 12 + 18);
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_mesh::mesh::DiscMesh;

/// A mesh as its file has it, before its cells get elements.
///
/// ```
/// use springfit::mesh::MeshSource;
///
/// let source = MeshSource::read("scenes/meshes/cube_tet.msh".as_ref())?;
/// assert!(source.blocks.iter().any(|block| block.groups.contains(&"load".to_string())));
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_mesh::mesh::MeshSource;

/// A part of a mesh, by a group or a condition.
///
/// ```
/// use springfit::element::Element;
/// use springfit::mesh::{BoxMesh, Selection};
///
/// let element = std::sync::Arc::new(Element::load("quad4")?);
/// let mesh = BoxMesh { element, size: vec![1.0; 2], cells: vec![4; 2], origin: vec![0.0; 2] }.build()?;
/// assert_eq!(Selection::Group("xmin".into()).points(&mesh)?.len(), 5);
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_mesh::mesh::Selection;
