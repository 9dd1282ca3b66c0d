//! The names that most programs need: `use springfit::prelude::*;`.

pub use crate::element::Element;
pub use crate::fit::{Fit, Objective, Weight, fit_element};
pub use crate::material::{Material, State};
pub use crate::mesh::Mesh;
pub use crate::springs::Springs;
pub use crate::study::Scene;
