//! The MSH format of Gmsh, versions 4.1 and 2.2 in text and in binary, 4.0 and 1 in text.

mod nodes;
mod sections;
mod types;
mod v22;
mod v40;
mod v41;

pub use sections::parse;
