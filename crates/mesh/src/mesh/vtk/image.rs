//! Images: voxels at regular distances, of which those with a label other than zero are cells.

use super::lattice::Lattice;
use super::piece::{Labels, Piece};
use crate::error::{Error, ErrorKind, Result};
use std::collections::BTreeSet;

/// The largest number of different labels; images of grey values have more.
const MOST_LABELS: usize = 1000;

/// A lattice of points in space.
#[derive(Debug, Clone, Copy)]
pub(in crate::mesh) struct Image {
    pub lattice: Lattice,
    /// The place of the first point.
    pub origin: [f64; 3],
    /// The steps to the next point along each axis.
    pub steps: [[f64; 3]; 3],
}

impl Image {
    /// The mesh of the voxels whose label is not zero: one label for each cell, or else for each point, around which a voxel is. Without labels all
    /// cells of the lattice are the body, and a remark says so.
    ///
    /// # Errors
    /// There are several such arrays and the file does not mark one of them as active; all labels are zero, or they are grey values.
    pub fn piece(mut self, of_cells: Vec<Labels>, of_points: Vec<Labels>, active: Option<&str>) -> Result<Piece> {
        if of_cells.is_empty() && of_points.is_empty() {
            let place = |at: [usize; 3]| {
                std::array::from_fn(|axis| {
                    (0..3).fold(self.origin[axis], |x, k| x + at[k] as f64 * self.steps[k][axis])
                })
            };
            let mut piece = self.lattice.limited()?.piece(|_| true, true, place)?;
            piece
                .remarks
                .push("the image has no labels, no array of whole numbers: all its voxels are the body".into());
            return Ok(piece);
        }
        let around_points = of_cells.is_empty();
        // An array of zeros alone says nothing of the body.
        let has_labels = |labels: &Labels| labels.values.iter().any(|label| *label != 0);
        let is_active = |labels: &Labels| active == Some(labels.name.as_str());
        let (of_cells, of_points): (Vec<Labels>, Vec<Labels>) = {
            let kept = |all: Vec<Labels>| match all.len() > 1 && all.iter().any(has_labels) {
                true => all.into_iter().filter(|labels| has_labels(labels) || is_active(labels)).collect(),
                false => all,
            };
            (kept(of_cells), kept(of_points))
        };
        let mut arrays = if around_points { of_points } else { of_cells };
        let mask = match (&arrays[..], active.and_then(|name| arrays.iter().position(|labels| labels.name == name))) {
            (_, Some(place)) => place,
            ([_], None) => 0,
            // Several with the same background mean the same body.
            ([first, others @ ..], None)
                if !others.is_empty() && others.iter().all(|other| same_background(first, other)) =>
            {
                0
            }
            (several, None) => {
                let names: Vec<String> = several.iter().map(|labels| format!("\"{}\"", labels.name)).collect();
                let found = if names.is_empty() { "none".to_string() } else { names.join(", ") };
                let expected = "one array of whole numbers of cells or points, whose zeros are background";
                return Err(Error::expected("image", expected, found).of_kind(ErrorKind::Unsupported));
            }
        };
        let mut places: Vec<f64> = vec![0.0; 3];
        if around_points {
            self.lattice = self.lattice.around_points();
            // Voxels are centred on their points. Along an axis with one layer of points the image has no thickness.
            for k in (0..3).filter(|&k| self.lattice.0[k] > 1) {
                places[k] = -0.5;
            }
        }
        let labels = &arrays[mask];
        let count = self.lattice.cell_count();
        if labels.values.len() != count {
            return Err(Error::expected(&labels.name, format!("{count} labels"), labels.values.len()));
        }
        check(labels)?;
        let place = |at: [usize; 3]| {
            std::array::from_fn(|axis| {
                (0..3).fold(self.origin[axis], |x, k| x + (at[k] as f64 + places[k]) * self.steps[k][axis])
            })
        };
        let mut piece = self.lattice.piece(|cell| labels.values[cell] != 0, true, place)?;
        let kept: Vec<bool> = labels.values.iter().map(|label| *label != 0).collect();
        for labels in &mut arrays {
            let mut kept = kept.iter();
            labels.values.retain(|_| *kept.next().unwrap_or(&false));
        }
        piece.labels = arrays;
        Ok(piece)
    }
}

fn same_background(a: &Labels, b: &Labels) -> bool {
    a.values.iter().map(|label| *label == 0).eq(b.values.iter().map(|label| *label == 0))
}

fn check(labels: &Labels) -> Result<()> {
    let mut different = BTreeSet::new();
    for &label in labels.values.iter().filter(|label| **label != 0) {
        if different.insert(label) && different.len() > MOST_LABELS {
            let expected = format!("at most {MOST_LABELS} different labels");
            let error = Error::expected(&labels.name, expected, "more: is it an image of grey values?");
            return Err(error.of_kind(ErrorKind::Limit));
        }
    }
    match different.is_empty() {
        true => Err(Error::expected(&labels.name, "a label other than zero, which is background", "zeros alone")),
        false => Ok(()),
    }
}
