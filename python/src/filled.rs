//! Meshes that fill surfaces, and those of voxels.

use crate::arrays::{places, rows};
use crate::element::Element;
use crate::error::{invalid, raised, unwritten};
use crate::mesh::Mesh;
use crate::progress::alone;
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use springfit_foundation::error::{Error, Result};
use springfit_mesh::mesh::{self, Format, Group, MeshSource, NumberOrigin, SourceBlock, VoxelMesh};
use springfit_studies::study::{FillEntry, MeshLength};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Points in space and polygons on them, `[cells, corners]`.
type Surface<'py> = (PyReadonlyArray2<'py, f64>, Vec<PyReadonlyArray2<'py, i64>>);

/// VTK's numbers of triangles and quadrangles.
const POLYGONS: [(usize, u32); 2] = [(3, 5), (4, 9)];

/// The boundary of the cells, how a surface that crosses itself is taken, and whether it is mended.
type Options = (Option<String>, Option<String>, bool);

fn source(py: Python, (points, polygons): Surface) -> PyResult<MeshSource> {
    if points.shape()[1] != 3 {
        return Err(invalid(py, "surface", "points in space, of shape (points, 3)", format!("{:?}", points.shape())));
    }
    let block = |cells: &PyReadonlyArray2<i64>| {
        let nodes_per_cell = cells.shape()[1];
        let known = POLYGONS.into_iter().find(|(corners, _)| *corners == nodes_per_cell);
        let (_, cell_type) = known.ok_or_else(|| invalid(py, "surface", "triangles or quadrangles", nodes_per_cell))?;
        let connectivity = places(py, "surface", cells.as_array())?;
        if let Some(outside) = connectivity.iter().find(|&&p| p >= points.shape()[0]) {
            return Err(invalid(py, "surface", &format!("places of {} points", points.shape()[0]), outside));
        }
        let groups = Vec::new();
        Ok(SourceBlock {
            dimension: 2,
            cell_type,
            nodes_per_cell,
            connectivity,
            groups,
            is_marker: false,
            runs: Vec::new(),
        })
    };
    Ok(MeshSource {
        format: Format::Vtk,
        origin: NumberOrigin::ArrayPlace,
        points: rows(&points).as_chunks::<3>().0.to_vec(),
        numbers: Vec::new(),
        blocks: polygons.iter().map(block).collect::<PyResult<_>>()?,
        space: Some(3),
        annotations: Default::default(),
    })
}

/// A closed surface, of a file or of arrays, filled with cells of this element.
#[pyfunction]
#[pyo3(signature = (path, surface, element, cell, points, options, scale))]
#[allow(clippy::too_many_arguments)]
pub fn filled_mesh(
    py: Python,
    path: Option<PathBuf>,
    surface: Option<Surface>,
    element: &Element,
    cell: Option<f64>,
    points: Option<usize>,
    options: Options,
    scale: f64,
) -> PyResult<Mesh> {
    let given = surface.map(|surface| source(py, surface)).transpose()?;
    let own = element.clone();
    let (boundary, layers, repair) = options;
    let mesh = alone(py, move || {
        let path = path.unwrap_or_default();
        let mut entry = FillEntry::new(&path);
        (entry.cell, entry.points, entry.layers, entry.repair) = (cell.map(MeshLength::Units), points, layers, repair);
        entry.boundary = boundary.unwrap_or(entry.boundary);
        let source = given.map_or_else(|| MeshSource::read(&path), Ok)?;
        entry.of_source(&source, own.0, scale, Path::new("")).map_err(|error| unwritten(error, Some(Path::new(""))))
    })?;
    Mesh::of_library(Arc::new(mesh), std::slice::from_ref(element)).map_err(|error| raised(py, error))
}

/// The voxels in an `.npy` file, of these lengths along the axes from this place, m; groups have names in place of labels.
#[pyfunction]
pub fn voxel_mesh(
    py: Python,
    path: PathBuf,
    element: &Element,
    spacing: [f64; 3],
    origin: [f64; 3],
    names: Option<Vec<(String, Vec<i64>)>>,
) -> PyResult<Mesh> {
    let own = element.clone();
    let mesh = alone(py, move || {
        let mut source = MeshSource::read(&path)?;
        for point in &mut source.points {
            *point = std::array::from_fn(|k| origin[k] + spacing[k] * point[k]);
        }
        source.numbers = Vec::new();
        let mut mesh = match source.is_solid() {
            true => VoxelMesh { element: own.0.clone() }.build(&source, 1.0)?,
            false => mesh::Mesh::resolve(&source, std::slice::from_ref(&own.0), 1.0)?,
        };
        mesh.numbering = None;
        if let Some(name) = mesh.blocks.iter().map(|block| &block.element.name).find(|name| **name != own.0.name) {
            return Err(Error::expected("element", format!("{name}, whose cells these voxels are"), &own.0.name));
        }
        if let Some(names) = names {
            name_labels(&mut mesh, names)?;
        }
        Ok(mesh)
    })?;
    Mesh::of_library(Arc::new(mesh), std::slice::from_ref(element)).map_err(|error| raised(py, error))
}

/// Gives the cells of labels these names.
fn name_labels(mesh: &mut mesh::Mesh, names: Vec<(String, Vec<i64>)>) -> Result<()> {
    let labelled = std::mem::take(&mut mesh.groups);
    for (name, labels) in names {
        let mut group = Group::default();
        for label in labels {
            let Some(own) = labelled.get(&format!("label={label}")) else {
                let expected = format!("labels of voxels: {}", labelled.keys().cloned().collect::<Vec<_>>().join(", "));
                return Err(Error::expected(format!("labels.{name}"), expected, label));
            };
            group.cells.extend(&own.cells);
            group.points.extend(&own.points);
        }
        group.cells.sort_unstable_by_key(|cell| (cell.block, cell.cell));
        group.cells.dedup();
        group.points.sort_unstable();
        group.points.dedup();
        mesh.groups.insert(name, group);
    }
    Ok(())
}
