#![doc = include_str!("../README.md")]

pub mod dynamics;
pub mod element;
pub mod error;
mod file;
pub mod fit;
pub mod material;
pub mod mesh;
pub mod model;
pub mod report;
pub mod scalar;
pub mod solve;
pub mod springs;
pub mod stiffness;
pub mod study;
pub mod symbolic;
pub mod whole;

pub use file::{check_file, check_folder, files_in, write_whole};
