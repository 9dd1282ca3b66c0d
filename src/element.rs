//! Elements, read from TOML files: cell, shape functions, quadrature, groups of springs. The page *Element files* of the book has the keys.

#[doc(inline)]
pub use springfit_element::element::{
    Cell, Element, JacobianBounds, Kind, Quadrature, SHIPPED, ShapeFunctions, Side, SideTable, SpringGroup, Tabulation,
    schema,
};

/// What a group of springs measures.
///
/// ```
/// use springfit::element::{Element, SpringKind};
///
/// let tetrahedron = Element::load("tet4")?;
/// let kinds: Vec<SpringKind> = tetrahedron.springs.iter().map(|group| group.kind).collect();
/// assert!(kinds.contains(&SpringKind::Length) && kinds.contains(&SpringKind::Volume));
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_element::element::SpringKind;

/// The names by which formulas of measures know the coordinates of nodes.
///
/// ```
/// assert_eq!(springfit::element::coordinate_names(2, 2), ["x0", "y0", "x1", "y1"]);
/// ```
#[doc(inline)]
pub use springfit_element::element::coordinate_names;
