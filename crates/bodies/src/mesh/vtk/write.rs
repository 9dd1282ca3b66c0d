//! Writes pictures for ParaView.

use super::cells::shape;
use crate::error::{Error, Result};
use crate::file::write_whole;
use num_traits::FromPrimitive;
use std::path::Path;
use vtkio::model::{
    Attribute, Attributes, ByteOrder, CellType, Cells, DataArray, DataSet, ElementType, IOBuffer,
    UnstructuredGridPiece, Version, VertexNumbers, Vtk,
};
use vtkio::xml::{Compressor, VTKFile};

/// Points, cells and arrays of a picture in ParaView.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Grid {
    /// Coordinates in mesh units.
    pub points: Vec<[f64; 3]>,
    /// VTK's number of the type of each cell.
    pub cell_types: Vec<u8>,
    /// Where each cell ends in `connectivity`.
    pub ends: Vec<usize>,
    /// Indices into `points`, cell after cell, in VTK's node order.
    pub connectivity: Vec<usize>,
    pub point_data: Vec<Array>,
    pub cell_data: Vec<Array>,
}

/// A scalar or a vector for each point or each cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    pub name: String,
    /// 1 or 3.
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
/// The grid has no cells, a cell is of no type that VTK has, has the wrong number of points for its type or names a
/// point that is not there, an array has no name of its own or too few or many values, or the file cannot be written.
pub fn write(path: &Path, grid: &Grid) -> Result<()> {
    write_whole(path, &encoded(grid).map_err(|error| error.in_file(path))?)
}

fn encoded(grid: &Grid) -> Result<Vec<u8>> {
    grid.check()?;
    let cell_type =
        |&number| CellType::from_u8(number).ok_or_else(|| Error::expected("cells", "a VTK cell type", number));
    let piece = UnstructuredGridPiece {
        points: IOBuffer::F64(grid.points.as_flattened().to_vec()),
        cells: Cells {
            cell_verts: VertexNumbers::XML {
                connectivity: grid.connectivity.iter().map(|&node| node as u64).collect(),
                offsets: grid.ends.iter().map(|&end| end as u64).collect(),
            },
            types: grid.cell_types.iter().map(cell_type).collect::<Result<_>>()?,
        },
        data: Attributes { point: attributes(&grid.point_data), cell: attributes(&grid.cell_data) },
    };
    let vtk = Vtk {
        version: Version::Auto,
        title: String::new(),
        byte_order: ByteOrder::LittleEndian,
        data: DataSet::inline(piece),
        file_path: None,
    };
    let failed = |error: &dyn std::error::Error| Error::new(format!("the grid cannot be encoded: {error}"));
    // the encoder's compressed blocks are wrong for arrays that fill the last block
    let file = vtk.try_into_xml_format(Compressor::None, 0).map_err(|error| failed(&error))?;
    let mut bytes = Vec::new();
    VTKFile::write(&file, &mut bytes).map_err(|error| failed(&error))?;
    Ok(bytes)
}

fn attributes(arrays: &[Array]) -> Vec<Attribute> {
    let attribute = |array: &Array| {
        Attribute::DataArray(DataArray {
            name: array.name.clone(),
            // 1 or 3, as checked
            elem: ElementType::Generic(array.components as u32),
            data: IOBuffer::F64(array.values.clone()),
        })
    };
    arrays.iter().map(attribute).collect()
}
