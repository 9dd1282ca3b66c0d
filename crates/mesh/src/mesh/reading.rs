//! Reads mesh files, each in the format of its extension.

use super::content::{BEGINNING, Content, content};
use super::formats::{MeshFormat, Parse, format};
use super::include::Included;
use super::source::MeshSource;
use super::tetgen;
use crate::error::{Error, ErrorKind, Result};
use std::io::Read;
use std::path::{Path, PathBuf};

impl MeshSource {
    /// Reads a mesh file in the format of its content or, if that says none, of its extension, one of [`MESH_FORMATS`](super::MESH_FORMATS). Of TetGen,
    /// the file `.node` or `.ele` is named, the other is beside it, and a `.face` is read if it is there. A deck is read with all that it includes.
    ///
    /// # Errors
    /// The file is missing, of another kind, damaged or cut short, or has a coordinate that is not finite.
    pub fn read(path: &Path) -> Result<MeshSource> {
        let in_file = |e: Error| e.in_file(path);
        match format_of(path).map_err(in_file)?.parse {
            Parse::Alone(parse) => parse(&crate::file::read(path)?).and_then(checked).map_err(in_file),
            Parse::Deck(parse, find) => {
                let deck = Included::read(path, find).map_err(in_file)?;
                parse(&deck.text).and_then(checked).map_err(|error| deck.placed(error))
            }
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
        match format_of(path).map(|format| format.parse) {
            Ok(Parse::TetGen) => tetgen::ENDINGS.map(|ending| path.with_extension(ending)).into(),
            Ok(Parse::Deck(_, find)) => {
                Included::read(path, find).map_or_else(|_| vec![path.into()], |deck| deck.files)
            }
            Ok(Parse::Alone(_)) | Err(_) => vec![path.to_path_buf()],
        }
    }

    /// Reads the content of a file, in the format of the content or, if that says none, of this extension, given without its dot.
    ///
    /// # Errors
    /// Those of [`MeshSource::read`]; or the format needs several files.
    pub fn parse(bytes: &[u8], ending: &str) -> Result<MeshSource> {
        match format_in(bytes, ending)?.parse {
            Parse::Alone(parse) | Parse::Deck(parse, _) => checked(parse(bytes)?),
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

/// The format of a file: that of its content, or else that of its ending.
fn format_of(path: &Path) -> Result<&'static MeshFormat> {
    let mut beginning = Vec::new();
    let file = std::fs::File::open(path).map_err(|e| Error::io("cannot be read", e))?;
    // A folder can be opened; that it cannot be read is said where it is.
    let _ = file.take(BEGINNING as u64).read_to_end(&mut beginning);
    format_in(&beginning, &crate::file::ending(path))
}

fn format_in(bytes: &[u8], ending: &str) -> Result<&'static MeshFormat> {
    match content(bytes) {
        // A file of points alone says nothing of its format.
        Some(Content::Known(format)) => Ok(format),
        Some(Content::Other(name, way)) => {
            let found = format!("{name}; what converts it: {way}");
            Err(Error::new(format!("expected a mesh that is read, found {found}")).of_kind(ErrorKind::Unsupported))
        }
        None => format(ending),
    }
}
