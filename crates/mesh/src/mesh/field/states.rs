//! Displacements of all points of a mesh in every array of a file: the states that another run, or another program, has found.

use super::displacements::Field;
use super::grid;
use super::reading::{AXES, Reading};
use crate::error::{Error, ErrorKind, Result};
use crate::file::{ending, read, read_text};
use crate::mesh::mesh::Mesh;
use crate::mesh::vtk::{self, Piece};
use crate::range;
use std::path::{Path, PathBuf};

/// How a collection of ParaView begins, and where it names a file.
const COLLECTION: [&str; 2] = ["type=\"Collection\"", "file=\""];

/// Displacements of all points of a mesh, with the name of their array.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedState {
    /// The name of the array; empty of a table.
    pub name: String,
    /// The displacements, `[points · dimension]`, m.
    pub displacements: Vec<f64>,
}

impl NamedState {
    /// The endings of files that are read.
    pub const ENDINGS: [&str; 4] = ["vtu", "vtk", "pvd", "csv"];

    /// Reads the states of a file: those of every array of displacements of a `.vtu` or `.vtk` whose name is wanted, the one of a table
    /// `.csv`, and of a collection `.pvd` those of its files. Points of a grid are where they are at rest, or where the displacements have
    /// moved them.
    ///
    /// # Errors
    /// Those of [`Field::read`]; or no array is wanted, or a point has no displacement.
    pub fn read(path: &Path, mesh: &Mesh, scale: f64, is_wanted: &dyn Fn(&str) -> bool) -> Result<Vec<NamedState>> {
        range::positive("scale", scale, "metres per unit of the file")?;
        let found: Result<Vec<Piece>> = match ending(path).as_str() {
            "csv" => return Ok(vec![of_field(String::new(), Field::read(path, mesh, scale)?, path, mesh.dimension)?]),
            "pvd" => {
                let mut all = Vec::new();
                for file in collected(path)? {
                    all.extend(NamedState::read(&file, mesh, scale, is_wanted)?);
                }
                return Ok(all);
            }
            "vtu" => vtk::xml_pieces(&read(path)?),
            "vtk" => vtk::legacy_piece(&read(path)?).map(|piece| vec![piece]),
            _ => {
                let error =
                    Error::new("expected states ending in .vtu, .vtk, .pvd or .csv").of_kind(ErrorKind::Unsupported);
                return Err(error.in_file(path));
            }
        };
        let mut pieces = found.map_err(|e| e.in_file(path))?;
        let names = grid::names(&pieces);
        let wanted: Vec<&String> = names.iter().filter(|name| is_wanted(name)).collect();
        if wanted.is_empty() {
            let found = if names.is_empty() { "none".into() } else { names.join(", ") };
            return Err(
                Error::expected("point data", "an array of displacements that is asked for", found).in_file(path)
            );
        }
        let state = |name: &&String| {
            let field = Reading::of(mesh, scale, |reading| grid::read_array(&pieces, name, reading));
            let field = field.or_else(|error| {
                // In a picture of a motion the points are where they have moved to.
                let rest = grid::moved_back(&mut pieces, name);
                let moved = Reading::of(mesh, scale, |reading| grid::read_array(&pieces, name, reading));
                pieces.iter_mut().zip(rest).for_each(|(piece, points)| piece.points = points);
                moved.map_err(|_| error)
            });
            of_field(
                name.to_string(),
                Field { displacements: field.map_err(|e| e.in_file(path))? },
                path,
                mesh.dimension,
            )
        };
        wanted.iter().map(state).collect()
    }
}

fn of_field(name: String, field: Field, path: &Path, d: usize) -> Result<NamedState> {
    let known: Option<Vec<f64>> = field.displacements.iter().copied().collect();
    let displacements = known.ok_or_else(|| {
        let array = if name.is_empty() { String::new() } else { format!(" in \"{name}\"") };
        let missing = field.displacements.iter().position(Option::is_none).unwrap_or(0);
        let found = format!("none of point {} along {}{array}", missing / d, AXES[missing % d]);
        Error::expected("displacement", "one in every direction of every point of the mesh", found).in_file(path)
    })?;
    Ok(NamedState { name, displacements })
}

/// The files of a collection, beside it.
fn collected(path: &Path) -> Result<Vec<PathBuf>> {
    let text = read_text(path)?;
    let [kind, file] = COLLECTION;
    let folder = path.parent().unwrap_or(Path::new(""));
    let name = |rest: &str| rest.split('"').next().map(|name| folder.join(name));
    let files: Vec<PathBuf> = text.split(file).skip(1).filter_map(name).collect();
    if !text.contains(kind) || files.is_empty() {
        return Err(Error::new("expected a collection of ParaView with files, found none").in_file(path));
    }
    if files.iter().any(|file| ending(file) == "pvd") {
        return Err(Error::new("expected files of grids in the collection, found another collection").in_file(path));
    }
    Ok(files)
}
