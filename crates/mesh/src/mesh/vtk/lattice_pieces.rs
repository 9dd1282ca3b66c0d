//! Pieces of a lattice, put together by their places. Neighbours share points, and no cells.

use super::grid_kind::Extent;
use super::piece::{DataArray, Labels, Piece};
use crate::error::{Error, Result};

/// Coordinates of a shared point in two pieces may differ by this share of the largest coordinate of the grid.
// Pieces are often written in single precision, which rounds by 6e-8, by processes that have computed the point on their own.
const SAME: f64 = 1e-6;

/// The place of a piece in the whole lattice.
pub(super) struct Part<'a> {
    pub whole: &'a Extent,
    pub piece: &'a Extent,
    /// Whether it is the first piece, whose arrays all others have.
    pub is_first: bool,
}

impl Part<'_> {
    /// The number of cells or points of the whole lattice.
    fn size(&self, is_of_cells: bool) -> usize {
        if is_of_cells { self.whole.lattice.cell_count() } else { self.whole.lattice.point_count() }
    }

    /// Puts values of the piece, so many for each cell or point, among those of the whole.
    fn put<T: Copy>(&self, all: &mut [T], values: &[T], each: usize, is_of_cells: bool) {
        let places = self.whole.places_of(self.piece, is_of_cells);
        for (place, values) in places.zip(values.chunks_exact(each)) {
            all[each * place..][..each].copy_from_slice(values);
        }
    }

    /// Puts arrays of labels of the piece among those of the whole.
    ///
    /// # Errors
    /// The piece has other arrays than the first.
    pub fn put_labels(&self, all: &mut Vec<Labels>, found: Vec<Labels>, is_of_cells: bool) -> Result<()> {
        if self.is_first {
            let values = || vec![0; self.size(is_of_cells)];
            all.extend(found.iter().map(|labels| Labels { name: labels.name.clone(), values: values() }));
        }
        let names = |all: &[Labels]| all.iter().map(|labels| labels.name.clone()).collect();
        same(names(all), names(&found), is_of_cells)?;
        for (all, found) in all.iter_mut().zip(found) {
            self.put(&mut all.values, &found.values, 1, is_of_cells);
        }
        Ok(())
    }

    /// Puts arrays of numbers of the piece among those of the whole.
    ///
    /// # Errors
    /// The piece has other arrays than the first.
    fn put_arrays(&self, all: &mut Vec<DataArray>, found: &[DataArray], is_of_cells: bool) -> Result<()> {
        if self.is_first {
            let size = self.size(is_of_cells);
            all.extend(found.iter().map(|array| DataArray {
                name: array.name.clone(),
                components: array.components,
                values: array.values.as_ref().map(|_| vec![0.0; size * array.components as usize]),
            }));
        }
        let name = |array: &DataArray| match array.values {
            Some(_) => format!("{} of {} numbers", array.name, array.components),
            None => array.name.clone(),
        };
        let names = |all: &[DataArray]| all.iter().map(name).collect();
        same(names(all), names(found), is_of_cells)?;
        for (all, found) in all.iter_mut().zip(found) {
            if let (Some(all), Some(values)) = (&mut all.values, &found.values) {
                self.put(all, values, found.components as usize, is_of_cells);
            }
        }
        Ok(())
    }

    /// Puts the points of the piece among those of the whole, of which `known` have been there before.
    ///
    /// # Errors
    /// A point that another piece has too is at another place.
    fn put_points(&self, all: &mut [[f64; 3]], found: &[[f64; 3]], known: &mut [bool]) -> Result<()> {
        let largest = found.iter().flatten().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        for (place, point) in self.whole.places_of(self.piece, false).zip(found) {
            let other = all[place];
            if known[place] && (0..3).any(|k| (other[k] - point[k]).abs() > SAME * largest) {
                let expected = format!("pieces that share their points, such as that at {other:?}");
                return Err(Error::expected("Points", expected, format!("{point:?} in another piece")));
            }
            (all[place], known[place]) = (*point, true);
        }
        Ok(())
    }
}

/// The grid that pieces form.
///
/// # Errors
/// The pieces do not fill it, or have other arrays than the first, or other places of the points that they share.
pub(super) fn joined(whole: &Extent, extents: &[Extent], pieces: Vec<Piece>) -> Result<Piece> {
    let mut all = whole.lattice.piece(|_| true, false, |_| [0.0; 3])?;
    let mut known = vec![false; all.points.len()];
    for (n, (extent, piece)) in extents.iter().zip(pieces).enumerate() {
        let part = Part { whole, piece: extent, is_first: n == 0 };
        part.put_points(&mut all.points, &piece.points, &mut known)?;
        part.put_arrays(&mut all.point_arrays, &piece.point_arrays, false)?;
        part.put_arrays(&mut all.cell_arrays, &piece.cell_arrays, true)?;
        part.put_labels(&mut all.labels, piece.labels, true)?;
    }
    // Pieces with as many cells as places may overlap and leave others free.
    match known.iter().position(|known| !known) {
        Some(point) => {
            Err(Error::expected("Piece.Extent", "pieces that fill the grid", format!("none at point {point}")))
        }
        None => Ok(all),
    }
}

/// Whether a piece has the arrays of the first.
fn same(expected: Vec<String>, found: Vec<String>, is_of_cells: bool) -> Result<()> {
    let shown = |names: Vec<String>| if names.is_empty() { "none".to_string() } else { names.join(", ") };
    match expected == found {
        true => Ok(()),
        false => {
            let key = if is_of_cells { "CellData" } else { "PointData" };
            let expected = format!("the arrays {} of the first piece in each", shown(expected));
            Err(Error::expected(key, expected, shown(found)))
        }
    }
}
