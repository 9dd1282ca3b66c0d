//! Reads mesh files, each in the format of its extension.

use super::formats::{Parse, parser};
use super::source::MeshSource;
use super::tetgen;
use crate::error::{Error, Result};
use std::path::{Path, PathBuf};

impl MeshSource {
    /// Reads a mesh file in the format of its extension, one of [`MESH_FORMATS`](super::MESH_FORMATS). Of TetGen, the
    /// file `.node` or `.ele` is named, the other is beside it, and a `.face` is read if it is there.
    ///
    /// # Errors
    /// The file is missing, of another kind, damaged or cut short, or has a coordinate that is not finite.
    pub fn read(path: &Path) -> Result<MeshSource> {
        let ending = crate::file::ending(path);
        let in_file = |e: Error| e.in_file(path);
        let parse = match parser(&ending) {
            Ok(parse) => parse,
            // A file that is not there is the first fault.
            Err(error) => {
                let error = std::fs::metadata(path).map_or_else(|e| Error::io("cannot be read", e), |_| error);
                return Err(in_file(error));
            }
        };
        match parse {
            Parse::Alone(_) => MeshSource::parse(&crate::file::read(path)?, &ending).map_err(in_file),
            Parse::TetGen => {
                let other = |ending: &str| path.with_extension(ending);
                let [node, ele, face] = tetgen::ENDINGS.map(other);
                let (node, ele) = (crate::file::read(&node)?, crate::file::read(&ele)?);
                let face = face.exists().then(|| crate::file::read(&face)).transpose()?;
                let source = tetgen::parse(&node, &ele, face.as_deref());
                source.and_then(checked).map_err(in_file)
            }
        }
    }

    /// All files that are read where a mesh file is named, whether they are there or not.
    pub fn files(path: &Path) -> Vec<PathBuf> {
        match parser(&crate::file::ending(path)) {
            Ok(Parse::TetGen) => tetgen::ENDINGS.map(|ending| path.with_extension(ending)).into(),
            Ok(Parse::Alone(_)) | Err(_) => vec![path.to_path_buf()],
        }
    }

    /// Reads the content of a file with this extension, given without its dot.
    ///
    /// # Errors
    /// Those of [`MeshSource::read`]; or the format needs several files.
    pub fn parse(bytes: &[u8], ending: &str) -> Result<MeshSource> {
        match parser(ending)? {
            Parse::Alone(parse) => checked(parse(bytes)?),
            Parse::TetGen => Err(tetgen::alone(ending)),
        }
    }

    /// Reads the contents of the files `.node`, `.ele` and, if it is there, `.face` of TetGen.
    ///
    /// # Errors
    /// A file is damaged or cut short, or names a point that is not there. The key of the error begins with the file's
    /// ending.
    pub fn parse_tetgen(node: &[u8], ele: &[u8], face: Option<&[u8]>) -> Result<MeshSource> {
        checked(tetgen::parse(node, ele, face)?)
    }
}

/// The source, if its coordinates are finite and its cells within its points.
fn checked(source: MeshSource) -> Result<MeshSource> {
    let count = source.points.len();
    if let Some(i) = source.points.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
        let [x, y, z] = source.points[i];
        return Err(Error::expected(format!("node {}", i + 1), "finite coordinates", format!("({x}, {y}, {z})")));
    }
    match source.blocks.iter().flat_map(|block| &block.connectivity).find(|&&i| i >= count) {
        Some(i) => Err(Error::expected("cells", format!("node indices below {count}"), i)),
        None => Ok(source),
    }
}
