//! The MSH format of Gmsh, versions 4.1 and 2.2, in text and in binary.

mod nodes;
mod sections;
mod types;
mod v22;
mod v41;

pub use sections::parse;
