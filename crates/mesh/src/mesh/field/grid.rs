//! Displacements in a point array of a grid.

use super::reading::{Reading, listed};
use crate::error::{Error, Result};
use crate::mesh::reader::quoted;
use crate::mesh::vtk::{DataArray, Piece};

/// The names of arrays of displacements, in lower case.
const NAMES: [&str; 4] = ["displacement", "displacements", "u", "disp"];

/// Reads the point array called `array`, or the only one that can hold displacements.
///
/// # Errors
/// The grid has no such array or several; or it has values that are not finite, points that are not in the mesh, or one
/// point with two displacements.
pub(super) fn read(mut pieces: Vec<Piece>, array: Option<&str>, reading: &mut Reading) -> Result<()> {
    pieces.retain(|piece| !piece.points.is_empty());
    let name = name_of_array(&pieces, array)?;
    read_array(&pieces, name, reading)
}

/// Reads the point array with this name.
///
/// # Errors
/// Those of [`read`].
pub(super) fn read_array(pieces: &[Piece], name: &str, reading: &mut Reading) -> Result<()> {
    let mut first = 0;
    for piece in pieces.iter().filter(|piece| !piece.points.is_empty()) {
        let named = piece.point_arrays.iter().find(|array| array.name == name);
        let vectors = named.and_then(|array| Some((array.components as usize, array.vectors()?)));
        let Some((components, vectors)) = vectors.filter(|(n, values)| values.len() == n * piece.points.len()) else {
            let found = format!("a piece of {} points without", piece.points.len());
            return Err(Error::expected("pieces", format!("{} in every one", quoted(name.as_bytes())), found));
        };
        let held = points_of_cells(piece);
        for ((i, x), vector) in piece.points.iter().enumerate().zip(vectors.chunks_exact(components)) {
            let placed = |error: Error| error.under(format!("points[{}]", first + i));
            displace(first + i, x, vector, held[i], reading).map_err(placed)?;
        }
        first += piece.points.len();
    }
    Ok(())
}

/// The names of all point arrays that can hold displacements.
pub(super) fn names(pieces: &[Piece]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for array in pieces.iter().flat_map(|piece| &piece.point_arrays) {
        let is_normals = array.name.eq_ignore_ascii_case("normals");
        if array.components == 3 && array.vectors().is_some() && !is_normals && !names.contains(&array.name) {
            names.push(array.name.clone());
        }
    }
    names
}

/// Takes the displacements of an array from the points, and returns where they were.
pub(super) fn moved_back(pieces: &mut [Piece], name: &str) -> Vec<Vec<[f64; 3]>> {
    let back = |piece: &mut Piece| {
        let points = piece.points.clone();
        let named = piece.point_arrays.iter().find(|array| array.name == name);
        if let Some(vectors) = named.and_then(DataArray::vectors) {
            for (x, u) in piece.points.iter_mut().zip(vectors.as_chunks::<3>().0) {
                x.iter_mut().zip(u).for_each(|(x, u)| *x -= u);
            }
        }
        points
    };
    pieces.iter_mut().map(back).collect()
}

/// `number` is the number of the point in the file, from 0.
fn displace(number: usize, x: &[f64; 3], vector: &[f64], is_held: bool, reading: &mut Reading) -> Result<()> {
    let d = reading.mesh.dimension;
    let lengths = |values: &[f64]| values.iter().take(d).map(|&v| reading.length(v)).collect::<Result<Vec<_>>>();
    let position: Option<Vec<f64>> = lengths(x)?.into_iter().collect();
    let position = position.ok_or_else(|| Error::expected("position", "finite coordinates", listed(x)))?;
    let mut displacement = lengths(vector)?;
    displacement.resize(d, None);
    // Points of no cell, such as centres of arcs, need not be in the mesh.
    if !is_held && reading.locator.at(&position).is_empty() {
        return Ok(());
    }
    let point = reading.point_at(&position, Some(number))?;
    let places = point * d..(point + 1) * d;
    match reading.claim(point, number) {
        // Pieces repeat the points at which they meet: there they must agree.
        Some(before) if reading.displacements[places.clone()] != displacement[..] => {
            let expected = format!("the displacement of points[{before}], which is in the same place");
            Err(Error::at("displacement", format!("expected {expected}, found another")))
        }
        _ => {
            reading.displacements[places].copy_from_slice(&displacement);
            Ok(())
        }
    }
}

/// Whether each point belongs to a cell; all do if there are no cells.
fn points_of_cells(piece: &Piece) -> Vec<bool> {
    let mut held = vec![piece.connectivity.is_empty(); piece.points.len()];
    for &node in &piece.connectivity {
        if let Some(held) = usize::try_from(node).ok().and_then(|node| held.get_mut(node)) {
            *held = true;
        }
    }
    held
}

fn name_of_array<'a>(pieces: &'a [Piece], wanted: Option<&str>) -> Result<&'a str> {
    let mut arrays: Vec<&DataArray> = Vec::new();
    for array in pieces.iter().flat_map(|piece| &piece.point_arrays) {
        if !arrays.iter().any(|other| other.name == array.name) {
            arrays.push(array);
        }
    }
    let vectors: Vec<&DataArray> = arrays.iter().filter(|array| array.vectors().is_some()).copied().collect();
    let called = |names: &[&str]| -> Vec<&DataArray> {
        let is_called = |array: &&&DataArray| names.iter().any(|name| array.name.eq_ignore_ascii_case(name));
        vectors.iter().filter(is_called).copied().collect()
    };
    let (candidates, expected) = match wanted {
        Some(wanted) => {
            let exact = vectors.iter().find(|array| array.name == wanted);
            let candidates = exact.map_or_else(|| called(&[wanted]), |&array| vec![array]);
            (candidates, format!("an array {} of 2 or 3 real components", quoted(wanted.as_bytes())))
        }
        None => {
            let mut candidates = called(&NAMES);
            if candidates.is_empty() {
                candidates = vectors.iter().filter(|array| array.components == 3).copied().collect();
                candidates.retain(|array| !array.name.eq_ignore_ascii_case("normals"));
            }
            let names = NAMES.map(|name| format!("\"{name}\"")).join(", ");
            (candidates, format!("one array called {names}, or else a single one of 3 real components"))
        }
    };
    match candidates[..] {
        [array] => Ok(&array.name),
        _ => {
            let about = |array: &&DataArray| {
                let real = !DataArray::is_vector(array.components) || array.vectors().is_some();
                let kind = if real { "" } else { ", not real" };
                format!("{} (components: {}{kind})", quoted(array.name.as_bytes()), array.components)
            };
            let found = arrays.iter().map(about).collect::<Vec<_>>().join(", ");
            Err(Error::expected("point data", expected, if found.is_empty() { "none" } else { &found }))
        }
    }
}
