//! The names that most programs need, in one import: `use springfit::prelude::*;`.
//!
//! They are enough to read an element or a scene, choose a material and springs, and fit the constants of one element.

/// A finite element, which is built in or read from a file.
///
/// ```
/// use springfit::prelude::*;
///
/// let triangle = Element::linear_simplex(2)?;
/// assert_eq!((triangle.dimension(), triangle.nodes()), (2, 3));
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use crate::element::Element;

/// The choices of a fit: the objective, and whether constants may be negative or differ within a group.
///
/// ```
/// use springfit::prelude::*;
///
/// let triangle = Element::linear_simplex(2)?;
/// let springs = Springs::select(&triangle, None)?;
/// let flat = [0.0, 0.0, 1.0, 0.0, 0.5, 0.1]; // m
/// let moduli = Material::new(10e3, 0.25, State::PlaneStrain { thickness: 1.0 })?.moduli();
/// let free = Fit::new(Objective::Frobenius(Weight::OffDiagonal));
/// let bounded = Fit { nonnegative: true, ..free };
/// assert!(fit_element(&triangle, &springs, &flat, moduli, &free)?.iter().any(|k| *k < 0.0));
/// assert!(fit_element(&triangle, &springs, &flat, moduli, &bounded)?.iter().all(|k| *k >= 0.0));
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use crate::fit::Fit;

/// What a fit minimises. Where springs can have the stiffness of the element, all objectives find them: those of a regular triangle at
/// ν = 1/3 have `k = √3/4 E t`.
///
/// ```
/// use springfit::fit::{Balance, MotionWeight};
/// use springfit::prelude::*;
///
/// let triangle = Element::linear_simplex(2)?;
/// let springs = Springs::select(&triangle, None)?;
/// let regular = [0.0, 0.0, 1.0, 0.0, 0.5, 0.75_f64.sqrt()]; // m
/// let moduli = Material::new(10e3, 1.0 / 3.0, State::PlaneStress { thickness: 0.01 })?.moduli();
/// for objective in [
///     Objective::Frobenius(Weight::None),
///     Objective::Spectral(MotionWeight::None),
///     Objective::Divergence(Balance::DEFAULT),
/// ] {
///     let k = fit_element(&triangle, &springs, &regular, moduli, &Fit::new(objective))?; // N/m
///     assert!(k.iter().all(|k| (k / (3f64.sqrt() / 4.0 * 10e3 * 0.01) - 1.0).abs() < 1e-5));
/// }
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use crate::fit::Objective;

/// The entries of `R − K` that count in a norm. Files name the weights.
///
/// ```
/// use springfit::prelude::*;
///
/// assert_eq!(Weight::named("offdiag")?, Weight::OffDiagonal);
/// assert_eq!(Weight::OffDiagonal.name(), "offdiag");
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use crate::fit::Weight;

/// The spring constants of one element, N/m: of a triangle with a right angle under the weight `offdiag`,
/// `k = V (λ + μ)/ℓ² + μ/2 cot θ` with the angle θ opposite to the spring.
///
/// ```
/// use springfit::prelude::*;
///
/// let triangle = Element::linear_simplex(2)?;
/// let springs = Springs::select(&triangle, None)?;
/// let right = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0]; // m
/// let moduli = Material::new(10e3, 0.25, State::PlaneStrain { thickness: 1.0 })?.moduli(); // λ = μ = 4 kPa
/// let k = fit_element(&triangle, &springs, &right, moduli, &Fit::new(Objective::Frobenius(Weight::OffDiagonal)))?;
/// for (pair, k) in springs.pairs().iter().zip(&k) {
///     let expected = if pair.contains(&0) { 6000.0 } else { 2000.0 };
///     assert!((k - expected).abs() < 1e-6);
/// }
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use crate::fit::fit_element;

/// An isotropic elastic material by Young's modulus, Pa, and Poisson's ratio.
///
/// ```
/// use springfit::prelude::*;
///
/// let moduli = Material::new(10e3, 0.25, State::Solid)?.moduli();
/// assert!((moduli.lambda - 4e3).abs() < 1e-9 && (moduli.mu - 4e3).abs() < 1e-9); // Pa
/// assert!(Material::new(10e3, 0.5, State::Solid).is_err());
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use crate::material::Material;

/// Whether a body is a solid, a sheet in plane stress or strain, or a rod.
///
/// ```
/// use springfit::prelude::*;
///
/// let sheet = State::PlaneStress { thickness: 0.002 }; // m
/// assert_eq!((sheet.dimension(), sheet.thickness()), (2, 0.002));
/// ```
#[doc(inline)]
pub use crate::material::State;

/// A mesh, which is read, generated or put together of cells.
///
/// ```
/// use springfit::mesh::CellBlock;
/// use springfit::prelude::*;
/// use std::sync::Arc;
///
/// let element = Arc::new(Element::linear_simplex(2)?);
/// let points = vec![0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0]; // m
/// let mesh = Mesh::of_cells(2, points, vec![CellBlock { element, connectivity: vec![0, 1, 2, 0, 2, 3] }]);
/// assert_eq!((mesh.point_count(), mesh.cell_count()), (4, 2));
/// assert_eq!(mesh.point(2), [1.0, 1.0]);
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use crate::mesh::Mesh;

/// The springs of an element: between pairs of nodes, and on functions or contents where groups of these are selected.
///
/// ```
/// use springfit::prelude::*;
///
/// let tetrahedron = Element::linear_simplex(3)?;
/// let springs = Springs::select(&tetrahedron, None)?;
/// assert_eq!(springs.pairs().len(), 6);
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use crate::springs::Springs;

/// A scene: a mesh, a material, fits, supports and loads, as a file names them.
///
/// ```
/// use springfit::prelude::*;
///
/// let scene = Scene::load("scenes/square_quad.toml".as_ref())?;
/// assert_eq!(scene.loads().len(), 2);
/// assert_eq!(scene.build_mesh()?.cell_count(), 100);
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use crate::study::Scene;
