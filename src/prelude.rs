//! The names that most programs need, in one import: `use springfit::prelude::*;`.
//!
//! They are enough to read an element or a scene, choose a material and springs, and fit the constants of one element.

pub use crate::element::Element;
pub use crate::fit::{Fit, Objective, Weight, fit_element};
pub use crate::material::{Material, State};
pub use crate::mesh::Mesh;
pub use crate::springs::Springs;
pub use crate::study::Scene;
