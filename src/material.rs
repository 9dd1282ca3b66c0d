//! Elastic moduli, plane states, anisotropic and hyperelastic materials, and their values by cell.

#[doc(inline)]
pub use springfit_element::material::{
    Anisotropy, BlockValues, EnergyMap, LinearMaterial, Material, MaterialMap, Plane, RegionMaterial, Relaxation,
    RelaxationTerm, SHIPPED, State, Stiffness, schema, with_moduli,
};

/// A value for each cell of a mesh, or one for all.
///
/// ```
/// use springfit::material::CellMap;
///
/// let young = CellMap::of_blocks(vec![vec![1e3, 3e3], vec![2e3]]); // Pa, of two blocks of cells
/// assert_eq!(*young.at(0, 1), 3e3);
/// assert_eq!(young.range(), [1e3, 3e3]);
/// ```
#[doc(inline)]
pub use springfit_element::material::CellMap;

/// A hyperelastic energy, by its name or from a file.
///
/// ```
/// use springfit::material::{Energy, Material, State};
///
/// let energy = Energy::load("neo-hookean", Material::new(10e3, 0.3, State::Solid)?)?;
/// assert_eq!(energy.name(), "neo-hookean");
/// assert!(!energy.has_fibres());
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_element::material::Energy;

/// The elastic moduli of a cell: isotropic or anisotropic.
///
/// ```
/// use springfit::material::{Anisotropy, Hooke, State};
///
/// let silicon = Anisotropy::cubic(165.7e9, 63.9e9, 79.6e9)?; // Pa
/// let hooke = Hooke::Anisotropic(silicon.in_state(State::Solid)?);
/// assert!(matches!(hooke, Hooke::Anisotropic(_)));
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_element::material::Hooke;

/// Lamé's moduli of an isotropic material, Pa.
///
/// ```
/// use springfit::material::{Material, State};
///
/// let moduli = Material::new(10e3, 0.25, State::Solid)?.moduli();
/// assert!((moduli.lambda - 4e3).abs() < 1e-9 && (moduli.mu - 4e3).abs() < 1e-9);
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_element::material::Moduli;
