//! `Mesh`.

use crate::arguments::{counts, number, numbers, optional, text};
use crate::arrays::{list, matrix, place_list, places, rows};
use crate::element::Element;
use crate::error::{invalid, raised};
use crate::pickled::{self, Counts, Numbers, ReadNumbers};
use crate::progress::alone;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springfit::error::Result;
use springfit::mesh::{self, BoxMesh, Gate, MeshArrays, MeshSource};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// A mesh whose cells are proved: each has a volume, and none is there twice.
#[pyclass(frozen, module = "springfit._core")]
pub struct Mesh {
    pub mesh: Arc<mesh::Mesh>,
    /// Of its blocks.
    elements: Vec<Element>,
}

/// `(element, nodes)` of the cells of one type, `nodes` of shape `[cells, nodes of the element]`.
type Block<'py> = (PyRef<'py, Element>, PyReadonlyArray2<'py, i64>);

/// The arguments of [`restored_mesh`].
type State<'py> = (
    Bound<'py, PyArray2<f64>>,
    Vec<(Element, Bound<'py, PyArray2<i64>>)>,
    BTreeMap<String, Bound<'py, PyArray1<i64>>>,
    Option<Numbers<'py>>,
    Counts,
);

/// The arrays of a mesh: places from 0 in `points`.
fn arrays_of(
    py: Python,
    points: &PyReadonlyArray2<f64>,
    blocks: &[Block],
    groups: &BTreeMap<String, PyReadonlyArray1<i64>>,
) -> PyResult<MeshArrays> {
    let block = |(element, nodes): &Block| {
        let (key, n) = (format!("cells of {}", element.0.name), element.0.nodes());
        if nodes.shape()[1] != n {
            let expected = format!("an array of shape (cells, {n})");
            return Err(invalid(py, &key, &expected, format!("{:?}", nodes.shape())));
        }
        Ok((element.0.clone(), places(py, &key, nodes.as_array().iter())?))
    };
    let group = |(name, points): (&String, &PyReadonlyArray1<i64>)| {
        Ok((name.clone(), place_list(py, &format!("groups.{name}"), points)?))
    };
    Ok(MeshArrays {
        dimension: points.shape()[1],
        points: rows(points),
        blocks: blocks.iter().map(block).collect::<PyResult<_>>()?,
        groups: groups.iter().map(group).collect::<PyResult<_>>()?,
    })
}

/// What becomes of cells of less than the least quality.
fn gate(py: Python, below: Option<&Bound<PyAny>>, least: Option<&Bound<PyAny>>) -> PyResult<Gate> {
    let (below, least) = (optional("below", below, text)?, optional("least", least, number)?);
    Gate::named(below.as_deref(), least).map_err(|error| raised(py, error))
}

fn elements_of(blocks: &[Block]) -> Vec<Element> {
    blocks.iter().map(|(element, _)| Element::clone(element)).collect()
}

/// The mesh of a pickle.
#[pyfunction]
#[pyo3(signature = (points, blocks, groups, numbers, counts))]
pub fn restored_mesh(
    py: Python,
    points: PyReadonlyArray2<f64>,
    blocks: Vec<Block>,
    groups: BTreeMap<String, PyReadonlyArray1<i64>>,
    numbers: Option<ReadNumbers>,
    counts: Counts,
) -> PyResult<Mesh> {
    let gate = Gate::named(None, Some(counts.0)).map_err(|error| raised(py, error))?;
    let arrays = arrays_of(py, &points, &blocks, &groups)?;
    let mut mesh = alone(py, move || arrays.build(gate))?;
    pickled::restore(py, &mut mesh, numbers, counts)?;
    Ok(Mesh { mesh: Arc::new(mesh), elements: elements_of(&blocks) })
}

impl Mesh {
    /// Of the library, some of whose elements are these; others are shipped.
    ///
    /// # Errors
    /// An element is neither.
    pub fn of_library(mesh: Arc<mesh::Mesh>, own: &[Element]) -> Result<Mesh> {
        let element = |block: &mesh::CellBlock| match own.iter().find(|own| own.0.name == block.element.name) {
            Some(own) => Ok(own.clone()),
            None => Element::named(&block.element.name),
        };
        let elements = mesh.blocks.iter().map(element).collect::<Result<_>>()?;
        Ok(Mesh { mesh, elements })
    }
}

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
        below: Option<&Bound<PyAny>>,
        least: Option<&Bound<PyAny>>,
    ) -> PyResult<Mesh> {
        let gate = gate(py, below, least)?;
        let arrays = arrays_of(py, &points, &blocks, &groups)?;
        let mesh = Arc::new(alone(py, move || arrays.build(gate))?);
        Ok(Mesh { mesh, elements: elements_of(&blocks) })
    }

    /// The mesh of a file in one of the formats that are read, such as .msh, .vtu, .inp, .bdf or .stl; `scale` is the length of one of its units in metres.
    #[staticmethod]
    #[pyo3(signature = (path, scale=1.0, elements=Vec::new(), below=None, least=None, space=None))]
    #[allow(clippy::too_many_arguments)]
    fn read(
        py: Python,
        path: PathBuf,
        scale: f64,
        elements: Vec<PyRef<Element>>,
        below: Option<&Bound<PyAny>>,
        least: Option<&Bound<PyAny>>,
        space: Option<usize>,
    ) -> PyResult<Mesh> {
        let gate = gate(py, below, least)?;
        let own: Vec<Element> = elements.iter().map(|element| Element::clone(element)).collect();
        let asked: Vec<_> = own.iter().map(|element| element.0.clone()).collect();
        let mesh = alone(py, move || {
            springfit::range::positive("scale", scale, "metres per mesh unit")?;
            let mut source = MeshSource::read(&path)?;
            source.space = space.or(source.space);
            mesh::Mesh::resolve_within(&source, &asked, scale, Some(gate)).map_err(|error| error.in_file(&path))
        })?;
        Mesh::of_library(Arc::new(mesh), &own).map_err(|error| raised(py, error))
    }

    /// What the file says besides the body, one sentence each.
    #[getter]
    fn annotations(&self) -> Vec<String> {
        self.mesh.annotations.notes()
    }

    /// A rectangle or brick of `cells` equal cells along each axis, `size` metres long, from `origin`.
    #[staticmethod]
    fn of_box(
        py: Python,
        element: &Element,
        size: &Bound<PyAny>,
        cells: &Bound<PyAny>,
        origin: &Bound<PyAny>,
    ) -> PyResult<Mesh> {
        let (size, cells, origin) = (numbers("size", size)?, counts("cells", cells)?, numbers("origin", origin)?);
        let spec = BoxMesh { element: element.0.clone(), size, cells, origin };
        let mesh = Arc::new(alone(py, move || spec.build())?);
        Ok(Mesh { mesh, elements: vec![element.clone()] })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, State<'py>)> {
        let blocks = self.elements.iter().cloned().zip(self.blocks(py).into_iter().map(|(_, nodes)| nodes)).collect();
        let (numbers, counts) = (pickled::numbers(py, &self.mesh), pickled::counts(&self.mesh));
        let restored = py.import("springfit._core")?.getattr("restored_mesh")?;
        Ok((restored, (self.points(py), blocks, self.groups(py), numbers, counts)))
    }

    /// It never changes.
    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<PyAny>) -> Py<Self> {
        slf
    }

    #[getter]
    fn dimension(&self) -> usize {
        self.mesh.dimension
    }

    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        matrix(py, self.mesh.points.clone(), self.mesh.dimension)
    }

    #[getter]
    fn blocks<'py>(&self, py: Python<'py>) -> Vec<(String, Bound<'py, PyArray2<i64>>)> {
        let block = |block: &mesh::CellBlock| {
            let nodes = block.connectivity.iter().map(|&p| p as i64).collect();
            (block.element.name.clone(), matrix(py, nodes, block.element.nodes()))
        };
        self.mesh.blocks.iter().map(block).collect()
    }

    #[getter]
    fn groups<'py>(&self, py: Python<'py>) -> BTreeMap<String, Bound<'py, PyArray1<i64>>> {
        let points = |group: &mesh::Group| list(py, group.points.iter().map(|&p| p as i64).collect());
        self.mesh.groups.iter().map(|(name, group)| (name.clone(), points(group))).collect()
    }

    #[getter]
    fn numbers<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<i64>>> {
        let numbering = self.mesh.numbering.as_ref()?;
        Some(list(py, numbering.nodes.iter().map(|&number| number as i64).collect()))
    }

    /// CRC-32 of points and cells, as files of networks have it.
    #[getter]
    fn checksum(&self) -> String {
        format!("{:08x}", self.mesh.checksum())
    }

    #[getter]
    fn quality<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (quality, record) = (&self.mesh.quality, PyDict::new(py));
        record.set_item("worst", quality.worst.as_ref().map(|worst| worst.quality))?;
        record.set_item("worst_cell", quality.worst.as_ref().map(|worst| &worst.cell))?;
        record.set_item("poor", quality.poor)?;
        record.set_item("skipped", quality.skipped)?;
        record.set_item("duplicates", quality.duplicates)?;
        record.set_item("folded", quality.folded)?;
        record.set_item("turned", self.mesh.reversed)?;
        record.set_item("coincident", quality.coincident)?;
        record.set_item("hanging", quality.hanging)?;
        record.set_item("pieces", quality.pieces)?;
        record.set_item("unused_points", self.mesh.unused_points)?;
        Ok(record)
    }
}
