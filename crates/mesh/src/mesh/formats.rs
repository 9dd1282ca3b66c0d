//! The formats of mesh files: one row for each, which reading, errors and help texts ask.

use super::include::FindInclusion;
use super::source::MeshSource;
use super::{abaqus, gmsh, nastran, numpy, surfaces, vtk};
use crate::error::{Error, ErrorKind, Result};

/// A format of mesh files.
#[derive(Debug)]
pub struct MeshFormat {
    /// The program or standard that it comes from.
    pub name: &'static str,
    /// The endings of its files, in lower case and without a dot.
    pub endings: &'static [&'static str],
    pub(super) parse: Parse,
}

/// How a file is read.
#[derive(Debug, Clone, Copy)]
pub(super) enum Parse {
    /// By itself.
    Alone(fn(&[u8]) -> Result<MeshSource>),
    /// From its own lines and those of the files that it includes.
    Deck(fn(&[u8]) -> Result<MeshSource>, FindInclusion),
    /// With the other files of TetGen beside it.
    TetGen,
}

/// The formats that are read.
pub static MESH_FORMATS: [MeshFormat; 11] = [
    MeshFormat { name: "Gmsh", endings: &["msh"], parse: Parse::Alone(gmsh::parse) },
    MeshFormat { name: "VTK XML", endings: &["vtu", "vtp", "vti", "vts", "vtr"], parse: Parse::Alone(vtk::parse_xml) },
    MeshFormat { name: "legacy VTK", endings: &["vtk"], parse: Parse::Alone(vtk::parse_legacy) },
    MeshFormat { name: "Abaqus and CalculiX", endings: &["inp"], parse: Parse::Deck(abaqus::parse, abaqus::inclusion) },
    MeshFormat {
        name: "Nastran",
        endings: &["bdf", "nas", "dat", "fem"],
        parse: Parse::Deck(nastran::parse, nastran::inclusion),
    },
    MeshFormat { name: "TetGen", endings: &["node", "ele"], parse: Parse::TetGen },
    MeshFormat { name: "STL", endings: &["stl"], parse: Parse::Alone(surfaces::parse_stl) },
    MeshFormat { name: "OBJ", endings: &["obj"], parse: Parse::Alone(surfaces::parse_obj) },
    MeshFormat { name: "PLY", endings: &["ply"], parse: Parse::Alone(surfaces::parse_ply) },
    MeshFormat { name: "OFF", endings: &["off"], parse: Parse::Alone(surfaces::parse_off) },
    MeshFormat { name: "NumPy, labels of voxels", endings: &["npy"], parse: Parse::Alone(numpy::parse) },
];

/// Endings of formats that are not read, and the command that turns such a FILE into one that is.
const CONVERTED: [(&[&str], &str); 12] = [
    (&["med"], "gmsh FILE -save -format msh41 -o mesh.msh"),
    (&["unv"], "gmsh FILE -save -format msh41 -o mesh.msh"),
    (&["cgns"], "gmsh FILE -save -format msh41 -o mesh.msh"),
    (&["step", "stp", "iges", "igs", "brep"], "gmsh FILE -3 -format msh41 -o mesh.msh, which makes a mesh of a shape"),
    (&["geo"], "gmsh FILE -3 -format msh41 -o mesh.msh"),
    (&["xdmf", "xmf"], "meshio convert FILE mesh.vtu"),
    (&["e", "exo", "ex2"], "meshio convert FILE mesh.vtu"),
    (&["mesh", "meshb", "vol", "h5m", "su2", "avs", "f3grid", "ugrid"], "meshio convert FILE mesh.vtu"),
    (&["pvd"], "none is needed: it lists files, and one of those is named instead"),
    (&["blend", "glb", "gltf", "fbx", "dae", "3ds", "usd"], "Blender's export to .stl, .obj or .ply"),
    (
        &["pvtu", "pvtp", "pvti", "pvts", "pvtr", "vtm"],
        "pyvista: pyvista.read(\"FILE\").cast_to_unstructured_grid().save(\"mesh.vtu\")",
    ),
    (
        &["nrrd", "nhdr", "mha", "mhd", "nii", "dcm", "tif", "tiff"],
        "SimpleITK and NumPy: numpy.save(\"labels.npy\", SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(\"FILE\")).T)",
    ),
];

/// `.a, .b or .c`: the endings that are read.
pub fn listed_endings() -> String {
    let endings: Vec<String> =
        MESH_FORMATS.iter().flat_map(|format| format.endings).map(|ending| format!(".{ending}")).collect();
    match &endings[..] {
        [others @ .., last] if !others.is_empty() => format!("{} or {last}", others.join(", ")),
        _ => endings.concat(),
    }
}

/// The format of files with this ending.
///
/// # Errors
/// They are not read. The error says what converts them, where that is known.
pub(super) fn format(ending: &str) -> Result<&'static MeshFormat> {
    if let Some(format) = MESH_FORMATS.iter().find(|format| format.endings.contains(&ending)) {
        return Ok(format);
    }
    let error = Error::new(format!("expected a mesh ending in {}", listed_endings())).of_kind(ErrorKind::Unsupported);
    Err(match CONVERTED.iter().find(|(endings, _)| endings.contains(&ending)) {
        Some((_, way)) => {
            let way = way.replace("FILE", &format!("mesh.{ending}"));
            error.followed_by(format!(", found .{ending}; what converts it: {way}"))
        }
        None if ending.is_empty() => error.followed_by(", found none"),
        None => error.followed_by(format!(", found .{ending}; Gmsh and meshio convert many others")),
    })
}
