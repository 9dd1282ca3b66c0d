//! `Mesh`.

use crate::arrays::{list, matrix, place_list, places, rows};
use crate::element::Element;
use crate::error::{invalid, raised};
use crate::progress::apart;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springfit::mesh::{self, BoxMesh, Gate, MeshArrays, MeshSource};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// A mesh whose cells are proved: each has a volume, and none is there twice.
#[pyclass(frozen, module = "springfit._core")]
pub struct Mesh(pub Arc<mesh::Mesh>);

/// `(element, nodes)` of the cells of one type, `nodes` of shape `[cells, nodes of the element]`.
type Block<'py> = (PyRef<'py, Element>, PyReadonlyArray2<'py, i64>);

#[pymethods]
impl Mesh {
    /// `points` in metres, `[points, dimension]`; the nodes of cells are places in them, in the order of the element.
    #[staticmethod]
    #[pyo3(signature = (points, blocks, groups, below=None, least=None))]
    fn of_arrays(
        py: Python,
        points: PyReadonlyArray2<f64>,
        blocks: Vec<Block>,
        groups: BTreeMap<String, PyReadonlyArray1<i64>>,
        below: Option<&str>,
        least: Option<f64>,
    ) -> PyResult<Mesh> {
        let gate = Gate::named(below, least).map_err(|error| raised(py, error))?;
        let dimension = points.shape()[1];
        let block = |(element, nodes): &Block| {
            let (key, n) = (format!("cells of {}", element.0.name), element.0.nodes());
            if nodes.shape()[1] != n {
                return Err(invalid(
                    py,
                    &key,
                    &format!("an array of shape (cells, {n})"),
                    format!("{:?}", nodes.shape()),
                ));
            }
            Ok((element.0.clone(), places(py, &key, nodes.as_array().iter())?))
        };
        let group = |(name, points): (&String, &PyReadonlyArray1<i64>)| {
            Ok((name.clone(), place_list(py, &format!("groups.{name}"), points)?))
        };
        let arrays = MeshArrays {
            dimension,
            points: rows(&points),
            blocks: blocks.iter().map(block).collect::<PyResult<_>>()?,
            groups: groups.iter().map(group).collect::<PyResult<_>>()?,
        };
        let mesh = apart(py, || arrays.build(gate)).map_err(|error| raised(py, error))?;
        Ok(Mesh(Arc::new(mesh)))
    }

    /// The mesh of a file in one of the formats that are read, such as .msh, .vtu, .inp, .bdf or .stl; `scale` is the length of one of its units in metres.
    #[staticmethod]
    #[pyo3(signature = (path, scale=1.0, elements=Vec::new(), below=None, least=None))]
    fn read(
        py: Python,
        path: PathBuf,
        scale: f64,
        elements: Vec<PyRef<Element>>,
        below: Option<&str>,
        least: Option<f64>,
    ) -> PyResult<Mesh> {
        let own: Vec<_> = elements.iter().map(|element| element.0.clone()).collect();
        let mesh = apart(py, || {
            springfit::range::positive("scale", scale, "metres per mesh unit")?;
            let gate = Gate::named(below, least)?;
            let source = MeshSource::read(&path)?;
            mesh::Mesh::resolve_within(&source, &own, scale, Some(gate)).map_err(|error| error.in_file(&path))
        });
        Ok(Mesh(Arc::new(mesh.map_err(|error| raised(py, error))?)))
    }

    /// A rectangle or brick of `cells` equal cells along each axis, `size` metres long, from `origin`.
    #[staticmethod]
    fn of_box(py: Python, element: &Element, size: Vec<f64>, cells: Vec<usize>, origin: Vec<f64>) -> PyResult<Mesh> {
        let spec = BoxMesh { element: element.0.clone(), size, cells, origin };
        let mesh = apart(py, || spec.build()).map_err(|error| raised(py, error))?;
        Ok(Mesh(Arc::new(mesh)))
    }

    #[getter]
    fn dimension(&self) -> usize {
        self.0.dimension
    }

    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        matrix(py, self.0.points.clone(), self.0.dimension)
    }

    #[getter]
    fn blocks<'py>(&self, py: Python<'py>) -> Vec<(String, Bound<'py, PyArray2<i64>>)> {
        let block = |block: &mesh::CellBlock| {
            let nodes = block.connectivity.iter().map(|&p| p as i64).collect();
            (block.element.name.clone(), matrix(py, nodes, block.element.nodes()))
        };
        self.0.blocks.iter().map(block).collect()
    }

    #[getter]
    fn groups<'py>(&self, py: Python<'py>) -> BTreeMap<String, Bound<'py, PyArray1<i64>>> {
        let points = |group: &mesh::Group| list(py, group.points.iter().map(|&p| p as i64).collect());
        self.0.groups.iter().map(|(name, group)| (name.clone(), points(group))).collect()
    }

    #[getter]
    fn numbers<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<i64>>> {
        let numbering = self.0.numbering.as_ref()?;
        Some(list(py, numbering.nodes.iter().map(|&number| number as i64).collect()))
    }

    /// CRC-32 of points and cells, as files of networks have it.
    #[getter]
    fn checksum(&self) -> String {
        format!("{:08x}", self.0.checksum())
    }

    #[getter]
    fn quality<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (quality, record) = (&self.0.quality, PyDict::new(py));
        record.set_item("worst", quality.worst.as_ref().map(|worst| worst.quality))?;
        record.set_item("worst_cell", quality.worst.as_ref().map(|worst| &worst.cell))?;
        record.set_item("poor", quality.poor)?;
        record.set_item("skipped", quality.skipped)?;
        record.set_item("duplicates", quality.duplicates)?;
        record.set_item("folded", quality.folded)?;
        record.set_item("turned", self.0.reversed)?;
        record.set_item("coincident", quality.coincident)?;
        record.set_item("hanging", quality.hanging)?;
        record.set_item("pieces", quality.pieces)?;
        record.set_item("unused_points", self.0.unused_points)?;
        Ok(record)
    }
}
