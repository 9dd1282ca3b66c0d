//! The published methods by name, with the cells that each covers and what it assumes.

use super::corners::Joint;
use super::shape::Shape;
use crate::element::{Cell, Element};
use crate::error::{Error, ErrorKind, Result};

/// A published way to choose spring constants; [`Method::reference`] cites the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Van Gelder (1998), with Poisson's ratio.
    VanGelder,
    /// Van Gelder (1998) without Poisson's ratio, for triangles and tetrahedra.
    VanGelderSimple,
    /// Lloyd, Székely and Harders (2007).
    Lloyd,
    /// Lloyd, Székely and Harders (2007), with forces that preserve the content.
    LloydPreserving,
    /// Baudet et al. (2007, 2009).
    Baudet,
    /// Baudet et al. (2007, 2009), with forces that correct Poisson's ratio.
    BaudetCorrected,
    /// Delingette (2008), quadratic springs of triangles and tetrahedra.
    DelingetteQuadratic,
    /// Delingette (2008), biquadratic springs of triangles and tetrahedra.
    DelingetteBiquadratic,
    /// Maciel, Boulic and Thalmann (2003), one constant for all springs.
    MacielUniform,
}

crate::named!(Method {
    "van-gelder" => VanGelder,
    "van-gelder-simple" => VanGelderSimple,
    "lloyd" => Lloyd,
    "lloyd-preserving" => LloydPreserving,
    "baudet" => Baudet,
    "baudet-corrected" => BaudetCorrected,
    "delingette-quadratic" => DelingetteQuadratic,
    "delingette-biquadratic" => DelingetteBiquadratic,
    "maciel-uniform" => MacielUniform,
});

/// What a method requires and assumes for one kind of cell.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Cover {
    /// The cell.
    pub cell: Cell,
    /// The pairs of corners between which it requires springs.
    pub joints: &'static [Joint],
    /// The Poisson's ratios for which the formula holds.
    pub poisson: Ratio,
    /// The shape for which the formula is made. Another shape is treated like the nearest one of this kind, see
    /// [`unmet`](super::unmet).
    pub shape: Option<Shape>,
}

/// The Poisson's ratios for which a method has the properties that it claims.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ratio {
    /// The formula contains Poisson's ratio.
    Any,
    /// The formula is made for this ratio. Another ratio of the material is reported, and is not an error.
    Only(f64),
    /// Below this ratio the springs do not exist.
    AtLeast(f64),
}

/// The springs along the edges.
const EDGES: &[Joint] = &[Joint::Edge];
/// The springs along the edges and through the inside.
const CROSSED: &[Joint] = &[Joint::Edge, Joint::Diagonal];
/// Poisson's ratio of springs with a centre of symmetry (Cauchy's relation λ = μ), in the plane.
const PLANE: f64 = 1.0 / 3.0;
/// Poisson's ratio of springs with a centre of symmetry (Cauchy's relation λ = μ), in space.
const SOLID: f64 = 1.0 / 4.0;

const fn cover(cell: Cell, joints: &'static [Joint], poisson: Ratio, shape: Option<Shape>) -> Cover {
    Cover { cell, joints, poisson, shape }
}

impl Method {
    /// The paper in which the method is published.
    pub fn reference(self) -> &'static str {
        match self {
            Method::VanGelder | Method::VanGelderSimple => {
                "A. Van Gelder, Approximate simulation of elastic membranes by triangulated spring meshes, Journal of \
                 Graphics Tools 3 (1998) 21-41"
            }
            Method::Lloyd | Method::LloydPreserving => {
                "B. A. Lloyd, G. Székely, M. Harders, Identification of spring parameters for deformable object \
                 simulation, IEEE Transactions on Visualization and Computer Graphics 13 (2007) 1081-1094"
            }
            Method::Baudet | Method::BaudetCorrected => {
                "V. Baudet, M. Beuve, F. Jaillet, B. Shariat, F. Zara, Integrating tensile parameters in hexahedral \
                 mass-spring system for simulation, WSCG 2009; in the plane: New mass-spring system integrating \
                 elasticity parameters in 2D, LIRIS research report, 2007"
            }
            Method::DelingetteQuadratic | Method::DelingetteBiquadratic => {
                "H. Delingette, Triangular springs for modeling nonlinear membranes, IEEE Transactions on \
                 Visualization and Computer Graphics 14 (2008) 329-341; tetrahedra: Biquadratic and quadratic springs for \
                 modeling St Venant Kirchhoff materials, ISBMS 2008, LNCS 5104, 40-48"
            }
            Method::MacielUniform => {
                "A. Maciel, R. Boulic, D. Thalmann, Deformable tissue parameterized by properties of real biological \
                 tissue, Surgery Simulation and Soft Tissue Modeling, LNCS 2673 (2003) 74-87"
            }
        }
    }

    /// The cells for which the method has a formula.
    pub fn covers(self) -> &'static [Cover] {
        use Cell::{Hexahedron, Pentagon, Pyramid, Quadrilateral, Tetrahedron, Triangle, Wedge};
        use Ratio::{Any, AtLeast, Only};
        const REGULAR: Option<Shape> = Some(Shape::Regular);
        match self {
            Method::VanGelder => {
                const { &[cover(Triangle, EDGES, Any, None), cover(Tetrahedron, EDGES, Only(SOLID), None)] }
            }
            Method::VanGelderSimple => const { &[cover(Triangle, EDGES, Only(0.0), None)] },
            Method::Lloyd => {
                const {
                    &[
                        cover(Triangle, EDGES, Only(PLANE), REGULAR),
                        cover(Quadrilateral, CROSSED, Only(PLANE), REGULAR),
                        cover(Tetrahedron, EDGES, Only(SOLID), REGULAR),
                    ]
                }
            }
            Method::LloydPreserving => {
                const {
                    &[
                        cover(Triangle, EDGES, AtLeast(PLANE), REGULAR),
                        cover(Quadrilateral, CROSSED, AtLeast(PLANE), REGULAR),
                        cover(Tetrahedron, EDGES, AtLeast(SOLID), REGULAR),
                    ]
                }
            }
            Method::Baudet => {
                const {
                    &[
                        cover(Quadrilateral, CROSSED, Only(PLANE), Some(Shape::Rectangle)),
                        cover(Hexahedron, CROSSED, Only(SOLID), REGULAR),
                    ]
                }
            }
            Method::BaudetCorrected => {
                const {
                    &[
                        cover(Quadrilateral, CROSSED, Any, Some(Shape::Rectangle)),
                        cover(Hexahedron, CROSSED, Any, REGULAR),
                    ]
                }
            }
            Method::DelingetteQuadratic | Method::DelingetteBiquadratic => {
                const { &[cover(Triangle, EDGES, Any, None), cover(Tetrahedron, EDGES, Any, None)] }
            }
            Method::MacielUniform => {
                const {
                    &[
                        cover(Triangle, EDGES, Only(PLANE), None),
                        cover(Quadrilateral, EDGES, Only(PLANE), None),
                        cover(Pentagon, EDGES, Only(PLANE), None),
                        cover(Tetrahedron, EDGES, Only(SOLID), None),
                        cover(Hexahedron, EDGES, Only(SOLID), None),
                        cover(Wedge, EDGES, Only(SOLID), None),
                        cover(Pyramid, EDGES, Only(SOLID), None),
                    ]
                }
            }
        }
    }

    /// What the method requires and assumes for the cell of this element.
    ///
    /// # Errors
    /// It has no formula for this cell.
    pub fn cover(self, element: &Element) -> Result<&'static Cover> {
        self.covers().iter().find(|cover| cover.cell == element.cell).ok_or_else(|| {
            let cells: Vec<String> = self.covers().iter().map(|cover| word(cover.cell)).collect();
            let found = format!("{}, a {}", element.name, word(element.cell));
            Error::expected(self.name(), format!("an element of the cell {}", cells.join(", ")), found)
                .of_kind(ErrorKind::Unsupported)
        })
    }
}

fn word(cell: Cell) -> String {
    format!("{cell:?}").to_lowercase()
}
