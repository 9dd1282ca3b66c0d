//! One finite element: its definition as data, its stiffness, and what springs between its nodes measure.
//!
//! Users of springfit need not name this crate: `springfit` names what they need of it.
//!
//! | module | what it holds |
//! |---|---|
//! | [`element`] | elements read from text: cell, shape functions, quadrature, groups of springs |
//! | [`material`] | isotropic elastic moduli, and hyperelastic energies |
//! | [`stiffness`] | the geometry of an element at its quadrature points, `R = ∫ Bᵀ D B dV`, and forces at large deformation |
//! | [`springs`] | what a spring measures, its force and its tangent |

#![forbid(unsafe_code)]

pub mod element;
pub mod material;
pub mod springs;
pub mod stiffness;

// The layers below, by the same names as everywhere.
use springfit_foundation::{error, file, named, number, range, scalar, symbolic};
