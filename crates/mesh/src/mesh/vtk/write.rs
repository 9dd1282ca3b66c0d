//! Writes unstructured grids that ParaView shows.

use super::cells::{is_known, shape};
use super::storage::base64;
use crate::error::{Error, Result};
use crate::file::write_with;
use crate::text::xml;
use std::io::{self, Write};
use std::path::Path;

/// The points, cells and arrays of an unstructured grid.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Grid {
    /// The coordinates.
    pub points: Vec<[f64; 3]>,
    /// VTK's number of the type of each cell.
    pub cell_types: Vec<u8>,
    /// The index in `connectivity` at which each cell ends.
    pub ends: Vec<usize>,
    /// Indices into `points`, cell after cell, in VTK's node order.
    pub connectivity: Vec<usize>,
    /// The arrays with a value for each point.
    pub point_data: Vec<Array>,
    /// The arrays with a value for each cell.
    pub cell_data: Vec<Array>,
}

/// A scalar or a vector for each point or each cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// The name of the array.
    pub name: String,
    /// The number of components, 1 or 3.
    pub components: usize,
    /// All components of the first point or cell, then of the next.
    pub values: Vec<f64>,
}

impl Grid {
    /// Appends a cell of VTK's type `cell_type` with these points, in VTK's node order.
    pub fn push_cell(&mut self, cell_type: u8, nodes: &[usize]) {
        self.cell_types.push(cell_type);
        self.connectivity.extend_from_slice(nodes);
        self.ends.push(self.connectivity.len());
    }

    fn check(&self) -> Result<()> {
        if self.points.is_empty() || self.cell_types.is_empty() {
            return Err(Error::new("a grid without points or cells cannot be written"));
        }
        self.check_cells()?;
        check_arrays(&self.point_data, self.points.len())?;
        check_arrays(&self.cell_data, self.cell_types.len())
    }

    fn check_cells(&self) -> Result<()> {
        let cells = self.cell_types.len();
        let rising = self.ends.is_sorted() && self.ends.last() == Some(&self.connectivity.len());
        if self.ends.len() != cells || !rising {
            return Err(Error::at("cells", format!("expected {cells} rising ends up to {}", self.connectivity.len())));
        }
        if let Some(node) = self.connectivity.iter().find(|&&node| node >= self.points.len()) {
            return Err(Error::expected("cells", format!("point indices below {}", self.points.len()), node));
        }
        if let Some(unknown) = self.cell_types.iter().find(|&&cell_type| !is_known(cell_type)) {
            return Err(Error::expected("cells", "a VTK cell type", unknown));
        }
        let mut start = 0;
        for (&cell_type, &end) in self.cell_types.iter().zip(&self.ends) {
            if let Some(count) = shape(cell_type).and_then(|(_, count)| count).filter(|&count| count != end - start) {
                return Err(Error::expected(
                    "cells",
                    format!("{count} points for VTK cell type {cell_type}"),
                    end - start,
                ));
            }
            start = end;
        }
        Ok(())
    }
}

fn check_arrays(arrays: &[Array], count: usize) -> Result<()> {
    for (i, array) in arrays.iter().enumerate() {
        if array.name.is_empty() || arrays[..i].iter().any(|other| other.name == array.name) {
            return Err(Error::at(&array.name, "expected a name of its own for each array"));
        }
        if array.components != 1 && array.components != 3 {
            return Err(Error::expected(&array.name, "1 or 3 components", array.components));
        }
        if array.values.len() != count * array.components {
            let expected = format!("{} values", count * array.components);
            return Err(Error::expected(&array.name, expected, array.values.len()));
        }
    }
    Ok(())
}

/// Writes `grid` as a `.vtu`, in binary.
///
/// # Errors
/// The grid has no cells; a cell has a type that VTK does not have, has the wrong number of points for its type or
/// names a point that does not exist; an array has no name or that of another one, or too few or many values; or the
/// file cannot be written.
pub fn write(path: &Path, grid: &Grid) -> Result<()> {
    grid.check().map_err(|error| error.in_file(path))?;
    write_with(path, |to| encode(grid, &mut Text(to)))
}

fn encode(grid: &Grid, file: &mut Text) -> io::Result<()> {
    file.line("<?xml version=\"1.0\"?>")?;
    file.line(
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">",
    )?;
    file.line("<UnstructuredGrid>")?;
    let (points, cells) = (grid.points.len(), grid.cell_types.len());
    file.line(&format!("<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">"))?;
    for (section, arrays) in [("PointData", &grid.point_data), ("CellData", &grid.cell_data)] {
        file.line(&format!("<{section}>"))?;
        for Array { name, components, values } in arrays {
            file.array("Float64", name, *components, values.iter().copied().map(f64::to_le_bytes))?;
        }
        file.line(&format!("</{section}>"))?;
    }
    file.line("<Points>")?;
    file.array("Float64", "Points", 3, grid.points.as_flattened().iter().copied().map(f64::to_le_bytes))?;
    file.line("</Points>")?;
    file.line("<Cells>")?;
    for (name, values) in [("connectivity", &grid.connectivity), ("offsets", &grid.ends)] {
        file.array("Int64", name, 1, values.iter().map(|&value| (value as u64).to_le_bytes()))?;
    }
    file.array("UInt8", "types", 1, grid.cell_types.iter().map(|&cell_type| [cell_type]))?;
    for end in ["Cells", "Piece", "UnstructuredGrid", "VTKFile"] {
        file.line(&format!("</{end}>"))?;
    }
    Ok(())
}

/// The number of bytes that are encoded at a time: a multiple of three, of which base64 makes whole groups of letters, and of the size of any
/// value.
const PIECE: usize = 3 << 12;

/// The file that is written.
struct Text<'a>(&'a mut dyn Write);

impl Text<'_> {
    fn line(&mut self, line: &str) -> io::Result<()> {
        writeln!(self.0, "{line}")
    }

    /// Appends an array in base64, uncompressed: the number of its bytes, and the bytes of its values. Only a piece of it is in memory.
    fn array<const SIZE: usize>(
        &mut self,
        scalar: &str,
        name: &str,
        components: usize,
        mut values: impl ExactSizeIterator<Item = [u8; SIZE]>,
    ) -> io::Result<()> {
        let size = values.len() * SIZE;
        let name = xml(name);
        // meshio makes a matrix of an array whose attribute says that it has one component.
        let components = if components == 1 { String::new() } else { format!(" NumberOfComponents=\"{components}\"") };
        self.line(&format!("<DataArray type=\"{scalar}\" Name=\"{name}\"{components} format=\"binary\">"))?;
        let mut piece = Vec::with_capacity(PIECE);
        piece.extend_from_slice(&(size as u64).to_le_bytes());
        loop {
            let room = (PIECE - piece.len()) / SIZE;
            values.by_ref().take(room).for_each(|value| piece.extend_from_slice(&value));
            self.0.write_all(base64(&piece).as_bytes())?;
            if piece.len() < PIECE {
                break;
            }
            piece.clear();
        }
        self.line("")?;
        self.line("</DataArray>")
    }
}
