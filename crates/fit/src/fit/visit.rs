//! Visits cells in order, with errors that name the cell.

use crate::element::Element;
use crate::error::{Error, Result};
use crate::stiffness::{self, Fault, Geometry};

/// [`stiffness::each_cell`] with an error that names the cell; `first` is the number (from 0) of the first cell of the
/// block.
pub fn each_cell(
    element: &Element,
    points: &[f64],
    connectivity: &[usize],
    first: usize,
    visit: impl FnMut(usize, &[f64], &Geometry),
) -> Result<()> {
    stiffness::each_cell(&element.tabulation, points, connectivity, visit)
        .map_err(|(cell, fault)| cell_fault(element, first + cell, fault))
}

/// The error for `cell`, which is counted from 0 and named from 1.
pub fn cell_fault(element: &Element, cell: usize, fault: Fault) -> Error {
    Error::at(cell_name(element, cell), fault.to_string())
}

/// What errors call a cell; `cell` is counted from 0, and named from 1.
pub fn cell_name(element: &Element, cell: usize) -> String {
    format!("{} cell {}", element.name, cell + 1)
}
