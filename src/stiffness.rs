//! The geometry of an element at its quadrature points, `R = ∫ Bᵀ D B dV`, and forces at large deformation.

#[doc(inline)]
pub use springfit_element::stiffness::{EnergyFunction, Geometry, Hyperelastic, StressFunction};
