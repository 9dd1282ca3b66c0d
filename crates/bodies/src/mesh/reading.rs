//! The formats of mesh files, chosen by the extension of the file.

use super::source::MeshSource;
use super::{gmsh, vtk};
use crate::error::{Error, ErrorKind, Result};
use std::path::Path;

type Parse = fn(&[u8]) -> Result<MeshSource>;

/// Each extension, in lower case, and the reader of such files.
const FORMATS: [(&str, Parse); 3] = [("msh", gmsh::parse), ("vtu", vtk::parse_xml), ("vtk", vtk::parse_legacy)];

impl MeshSource {
    /// Reads a mesh file in the format of its extension: `.msh`, `.vtu` or `.vtk`.
    ///
    /// # Errors
    /// The file is missing, of another kind, damaged or cut short, or has a coordinate that is not finite.
    pub fn read(path: &Path) -> Result<MeshSource> {
        let bytes = crate::file::read(path)?;
        MeshSource::parse(&bytes, &crate::file::ending(path)).map_err(|e| e.in_file(path))
    }

    /// Reads the content of a file with this extension, given without its dot.
    ///
    /// # Errors
    /// Those of [`MeshSource::read`].
    pub fn parse(bytes: &[u8], ending: &str) -> Result<MeshSource> {
        let Some((_, parse)) = FORMATS.iter().find(|(known, _)| *known == ending) else {
            return Err(
                Error::new(format!("expected a mesh ending in {}", listed_endings())).of_kind(ErrorKind::Unsupported)
            );
        };
        let source = parse(bytes)?;
        check(&source)?;
        Ok(source)
    }
}

/// `.a, .b or .c`.
fn listed_endings() -> String {
    let [others @ .., last] = FORMATS.map(|(ending, _)| format!(".{ending}"));
    format!("{} or {last}", others.join(", "))
}

fn check(source: &MeshSource) -> Result<()> {
    let count = source.points.len();
    if let Some(i) = source.points.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
        let [x, y, z] = source.points[i];
        return Err(Error::expected(format!("node {}", i + 1), "finite coordinates", format!("({x}, {y}, {z})")));
    }
    match source.blocks.iter().flat_map(|block| &block.connectivity).find(|&&i| i >= count) {
        Some(i) => Err(Error::expected("cells", format!("node indices below {count}"), i)),
        None => Ok(()),
    }
}
