//! The files that are part of springfit, so that the installed program works from any folder.

#![forbid(unsafe_code)]

/// An element file, known by its name and by the cell types it serves; its text is parsed when it is asked for.
#[derive(Debug)]
pub struct ElementFile {
    pub name: &'static str,
    /// The number of its type in Gmsh files.
    pub gmsh: Option<i64>,
    /// The number of its type in VTK files.
    pub vtk: Option<i64>,
    pub text: &'static str,
}

/// The files of the folder `elements`, by name.
pub static ELEMENTS: &[ElementFile] = include!(concat!(env!("OUT_DIR"), "/elements.rs"));

/// Name and text of the files of the folder `materials`, by name.
pub static MATERIALS: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/materials.rs"));

/// The index of the experiments of `scenes/paper`, the scenes and the meshes that they name: path and text.
pub static EXPERIMENTS: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/experiments.rs"));
