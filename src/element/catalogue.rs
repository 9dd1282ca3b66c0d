//! The element files that are shipped inside the library.

/// A shipped file, known by name and by the cell types it serves; its text is parsed when it is asked for.
#[derive(Debug)]
pub struct Shipped {
    pub name: &'static str,
    pub gmsh: Option<i64>,
    pub vtk: Option<i64>,
    pub text: &'static str,
}

/// All files of the folder `elements`, by name.
pub static SHIPPED: &[Shipped] = include!(concat!(env!("OUT_DIR"), "/elements.rs"));
