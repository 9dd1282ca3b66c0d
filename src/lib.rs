pub mod element;
pub mod error;
mod file;
pub mod fit;
pub mod material;
pub mod springs;
pub mod stiffness;
pub mod symbolic;
