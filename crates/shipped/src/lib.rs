//! The files that are part of springfit: elements, materials, and the scenes and meshes of the paper. They are
//! embedded, so that the installed program works from any folder.
//!
//! The build script lists the folders; the crates above parse the texts. Users of springfit need not name this crate.

#![forbid(unsafe_code)]

/// An element file, known by its name and by the cell types that it serves. Its text is parsed only when it is used.
#[derive(Debug)]
pub struct ElementFile {
    /// The name of the element, which is that of its file.
    pub name: &'static str,
    /// The number of its cell type in Gmsh files, if there is one.
    pub gmsh: Option<i64>,
    /// The number of its cell type in VTK files, if there is one.
    pub vtk: Option<i64>,
    /// The TOML text of the file.
    pub text: &'static str,
}

/// The files of the folder `elements`, sorted by name.
pub static ELEMENTS: &[ElementFile] = include!(concat!(env!("OUT_DIR"), "/elements.rs"));

/// The name and text of each file of the folder `materials`, sorted by name.
pub static MATERIALS: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/materials.rs"));

/// The path and text of the index of the experiments in `scenes/paper`, of the scenes that it names, and of their
/// meshes.
pub static EXPERIMENTS: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/experiments.rs"));
