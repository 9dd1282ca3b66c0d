//! What pickles of meshes have beside points, cells and groups, of which the mesh is proved again where it is read.

use crate::arrays::list;
use crate::error::invalid;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use springfit_mesh::mesh::{Mesh, NumberOrigin, Numbering};

/// What the numbers of points mean, and the numbers.
pub type Numbers<'py> = (String, Bound<'py, PyArray1<u64>>);

/// As [`Numbers`], read.
pub type ReadNumbers<'py> = (String, PyReadonlyArray1<'py, u64>);

/// The least quality; the numbers of cells that were skipped, repeated, folded and turned, and of points without a cell; those of points at
/// the place of another, of hanging points and of pieces, where they were counted; whether the worst cell is known; which cells were turned.
pub type Counts = (f64, [usize; 5], [Option<usize>; 3], bool, Option<String>);

const ORIGINS: [NumberOrigin; 5] = [
    NumberOrigin::GmshTag,
    NumberOrigin::VtkPlace,
    NumberOrigin::NodeNumber,
    NumberOrigin::FilePlace,
    NumberOrigin::ArrayPlace,
];

pub fn numbers<'py>(py: Python<'py>, mesh: &Mesh) -> Option<Numbers<'py>> {
    mesh.numbering.as_ref().map(|numbering| (numbering.title().into(), list(py, numbering.nodes.clone())))
}

pub fn counts(mesh: &Mesh) -> Counts {
    let quality = &mesh.quality;
    let counts = [quality.skipped, quality.duplicates, quality.folded, mesh.reversed, mesh.unused_points];
    let tests = [quality.coincident, quality.hanging, quality.pieces];
    (quality.least, counts, tests, quality.worst.is_some(), quality.turned.clone())
}

/// Gives a mesh that is built again the numbers and the counts of the one that was pickled.
pub fn restore(py: Python, mesh: &mut Mesh, numbers: Option<ReadNumbers>, counts: Counts) -> PyResult<()> {
    let (least, [skipped, duplicates, folded, turned, unused], tests, has_worst, which) = counts;
    mesh.quality.least = least;
    [mesh.quality.coincident, mesh.quality.hanging, mesh.quality.pieces] = tests;
    if !has_worst {
        (mesh.quality.worst, mesh.quality.worst_cell, mesh.quality.poor) = (None, None, None);
    }
    (mesh.quality.skipped, mesh.quality.duplicates, mesh.quality.folded) = (skipped, duplicates, folded);
    (mesh.reversed, mesh.unused_points, mesh.quality.turned) = (turned, unused, which);
    mesh.numbering = match numbers {
        None => None,
        Some((title, nodes)) => {
            let nodes: Vec<u64> = nodes.as_array().iter().copied().collect();
            if nodes.len() != mesh.point_count() {
                return Err(invalid(py, "numbers", &format!("{} numbers", mesh.point_count()), nodes.len()));
            }
            let titled = |origin| Numbering { origin, nodes: Vec::new() }.title() == title;
            let origin = ORIGINS.into_iter().find(|&origin| titled(origin));
            let origin = origin.ok_or_else(|| invalid(py, "numbers", "a meaning of numbers of points", &title))?;
            Some(Numbering { origin, nodes })
        }
    };
    Ok(())
}
