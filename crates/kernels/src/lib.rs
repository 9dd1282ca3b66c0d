//! One finite element: its definition as data, its stiffness, and the springs fitted to it.

#![forbid(unsafe_code)]

pub mod element;
pub mod fit;
pub mod material;
pub mod springs;
pub mod stiffness;

// The layers below, by the same names as everywhere.
use springfit_foundation::{bound, error, file, named, range, scalar, symbolic};
