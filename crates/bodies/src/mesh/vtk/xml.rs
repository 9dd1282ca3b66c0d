//! XML `.vtu` files.

use super::piece::{Labels, Piece, PointArray};
use super::xml_arrays::{PieceArrays, checked_arrays};
use crate::error::{Error, Result};
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;
use vtkio::Vtk;
use vtkio::model::{Attribute, DataSet, IOBuffer, UnstructuredGridPiece, VertexNumbers};

/// Reads the pieces.
///
/// # Errors
/// The file is of another kind, damaged, cut short or encoded in a way that is not supported.
pub(super) fn parse(bytes: &[u8]) -> Result<Vec<Piece>> {
    let (bytes, arrays) = checked_arrays(bytes)?;
    let decoded = without_panic(|| Vtk::parse_xml(&*bytes));
    let vtk = match decoded {
        Some(Ok(vtk)) => vtk,
        Some(Err(error)) => return Err(damaged(&error.to_string())),
        None => return Err(damaged("its data do not fit its header")),
    };
    let DataSet::UnstructuredGrid { pieces, .. } = vtk.data else {
        return Err(Error::new("expected an unstructured grid, found another kind of data set"));
    };
    if pieces.len() != arrays.len() {
        return Err(Error::expected("pieces", arrays.len(), pieces.len()));
    }
    let pieces = pieces.into_iter().zip(&arrays).map(|(piece, arrays)| {
        let piece = piece.into_loaded_piece_data(None).map_err(|error| damaged(&error.to_string()))?;
        convert(piece, arrays)
    });
    pieces.collect()
}

fn damaged(problem: &str) -> Error {
    Error::new(format!("the file is damaged: {}", problem.replace(['\n', '\r'], " ")))
}

fn convert(piece: UnstructuredGridPiece, arrays: &PieceArrays) -> Result<Piece> {
    check_present(&piece.data.point, &arrays.of_points, "point")?;
    check_present(&piece.data.cell, &arrays.of_cells, "cell")?;
    let coordinates: Option<Vec<f64>> = piece.points.cast_into();
    let coordinates = coordinates.ok_or_else(|| damaged("its points are not numbers"))?;
    let VertexNumbers::XML { connectivity, offsets } = piece.cells.cell_verts else {
        return Err(damaged("its cells have no offsets"));
    };
    let types: Vec<u8> = piece.cells.types.iter().map(|&cell_type| cell_type as u8).collect();
    let mut labels = Vec::new();
    for attribute in piece.data.cell {
        let Attribute::DataArray(array) = attribute else { continue };
        if let Some(values) = whole_numbers(&array.data).filter(|values| values.len() == types.len()) {
            labels.push(Labels { name: array.name, values });
        }
    }
    let mut point_arrays = Vec::new();
    for attribute in piece.data.point {
        let Attribute::DataArray(array) = attribute else { continue };
        let components = array.num_comp() as u64;
        let is_real = matches!(array.data, IOBuffer::F32(_) | IOBuffer::F64(_));
        let vectors = if is_real && PointArray::is_vector(components) { array.data.cast_into() } else { None };
        point_arrays.push(PointArray { name: array.name, components, vectors });
    }
    let points = coordinates.as_chunks().0.to_vec();
    Ok(Piece { points, types, ends: offsets, connectivity, labels, point_arrays })
}

/// The decoder leaves out an array that it cannot decode, so the names in the file are compared.
fn check_present(decoded: &[Attribute], names: &[String], what: &str) -> Result<()> {
    if decoded.len() == names.len() {
        return Ok(());
    }
    let is_decoded = |name: &&String| {
        decoded.iter().any(|attribute| matches!(attribute, Attribute::DataArray(array) if array.name == **name))
    };
    let missing = names.iter().find(|name| !is_decoded(name)).map_or("", String::as_str);
    Err(damaged(&format!("its {what} data array \"{missing}\" cannot be decoded")))
}

fn whole_numbers(buffer: &IOBuffer) -> Option<Vec<i128>> {
    fn widened<T: Copy + Into<i128>>(values: &[T]) -> Option<Vec<i128>> {
        Some(values.iter().map(|&value| value.into()).collect())
    }
    match buffer {
        IOBuffer::I8(v) => widened(v),
        IOBuffer::U8(v) => widened(v),
        IOBuffer::I16(v) => widened(v),
        IOBuffer::U16(v) => widened(v),
        IOBuffer::I32(v) => widened(v),
        IOBuffer::U32(v) => widened(v),
        IOBuffer::I64(v) => widened(v),
        IOBuffer::U64(v) => widened(v),
        IOBuffer::Bit(_) | IOBuffer::F32(_) | IOBuffer::F64(_) => None,
    }
}

thread_local! {
    static DECODING: Cell<bool> = const { Cell::new(false) };
}

/// Runs the decoder, which panics on some damaged files; `None` if it does, and then without a message of its own.
fn without_panic<T>(decode: impl FnOnce() -> T) -> Option<T> {
    static QUIET: Once = Once::new();
    QUIET.call_once(|| {
        let report = take_hook();
        set_hook(Box::new(move |panic| {
            if !DECODING.get() {
                report(panic);
            }
        }));
    });
    DECODING.set(true);
    let decoded = catch_unwind(AssertUnwindSafe(decode)).ok();
    DECODING.set(false);
    decoded
}
