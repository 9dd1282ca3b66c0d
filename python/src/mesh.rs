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
use springfit_bodies::model::masses;
use springfit_foundation::error::Result;
use springfit_mesh::mesh::{self, BoxMesh, Gate, MeshArrays, MeshSource};
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

/// Places of points or cells, by the name of their group.
type Places<'py> = BTreeMap<String, PyReadonlyArray1<'py, i64>>;

/// The arguments of [`restored_mesh`].
type State<'py> = (
    Bound<'py, PyArray2<f64>>,
    Vec<(Element, Bound<'py, PyArray2<i64>>)>,
    BTreeMap<String, Bound<'py, PyArray1<i64>>>,
    Option<Numbers<'py>>,
    Counts,
    BTreeMap<String, Bound<'py, PyArray1<i64>>>,
);

/// The arrays of a mesh: places from 0 in `points`.
fn arrays_of(
    py: Python,
    points: &PyReadonlyArray2<f64>,
    blocks: &[Block],
    groups: &Places,
    cell_groups: &Places,
) -> PyResult<MeshArrays> {
    let block = |(element, nodes): &Block| {
        let (key, n) = (format!("cells of {}", element.0.name), element.0.nodes());
        if nodes.shape()[1] != n {
            let expected = format!("an array of shape (cells, {n})");
            return Err(invalid(py, &key, &expected, format!("{:?}", nodes.shape())));
        }
        Ok((element.0.clone(), places(py, &key, nodes.as_array())?))
    };
    let listed = |key: &str, lists: &Places| {
        let list = |(name, places): (&String, &PyReadonlyArray1<i64>)| {
            Ok((name.clone(), place_list(py, &format!("{key}.{name}"), places)?))
        };
        lists.iter().map(list).collect::<PyResult<BTreeMap<String, Vec<usize>>>>()
    };
    Ok(MeshArrays {
        dimension: points.shape()[1],
        points: rows(points),
        blocks: blocks.iter().map(block).collect::<PyResult<_>>()?,
        groups: listed("groups", groups)?,
        cell_groups: listed("cell_groups", cell_groups)?,
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

/// The name of an element, its cells on the boundary, and the cells behind them.
type Outside<'py> = (String, Bound<'py, PyArray2<i64>>, Bound<'py, PyArray1<i64>>);

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

    /// The elements of its blocks.
    pub fn own_elements(&self) -> &[Element] {
        &self.elements
    }
}

/// The mesh of a pickle.
#[pyfunction]
#[pyo3(signature = (points, blocks, groups, numbers, counts, cell_groups))]
pub fn restored_mesh(
    py: Python,
    points: PyReadonlyArray2<f64>,
    blocks: Vec<Block>,
    groups: Places,
    numbers: Option<ReadNumbers>,
    counts: Counts,
    cell_groups: Places,
) -> PyResult<Mesh> {
    let gate = Gate::named(None, Some(counts.0)).map_err(|error| raised(py, error))?;
    let arrays = arrays_of(py, &points, &blocks, &groups, &cell_groups)?;
    let mut mesh = alone(py, move || arrays.build(gate))?;
    pickled::restore(py, &mut mesh, numbers, counts)?;
    Ok(Mesh { mesh: Arc::new(mesh), elements: elements_of(&blocks) })
}

#[pymethods]
impl Mesh {
    /// `points` in metres, `[points, dimension]`; the nodes of cells are places in them, in the order of the element.
    #[staticmethod]
    #[pyo3(signature = (points, blocks, groups, cell_groups, below=None, least=None))]
    fn of_arrays(
        py: Python,
        points: PyReadonlyArray2<f64>,
        blocks: Vec<Block>,
        groups: Places,
        cell_groups: Places,
        below: Option<&Bound<PyAny>>,
        least: Option<&Bound<PyAny>>,
    ) -> PyResult<Mesh> {
        let gate = gate(py, below, least)?;
        let arrays = arrays_of(py, &points, &blocks, &groups, &cell_groups)?;
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
            springfit_foundation::range::positive("scale", scale, "metres per mesh unit")?;
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
        Ok((restored, (self.points(py), blocks, self.groups(py), numbers, counts, self.cell_groups(py))))
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

    /// The elements of the blocks.
    #[getter]
    fn elements(&self) -> Vec<Element> {
        self.elements.clone()
    }

    #[getter]
    fn groups<'py>(&self, py: Python<'py>) -> BTreeMap<String, Bound<'py, PyArray1<i64>>> {
        let points = |group: &mesh::Group| list(py, group.points.iter().map(|&p| p as i64).collect());
        self.mesh.groups.iter().map(|(name, group)| (name.clone(), points(group))).collect()
    }

    /// The cells of each group, counted block after block.
    #[getter]
    fn cell_groups<'py>(&self, py: Python<'py>) -> BTreeMap<String, Bound<'py, PyArray1<i64>>> {
        let mut first = vec![0];
        self.mesh.blocks.iter().for_each(|block| first.push(first[first.len() - 1] + block.cells().len()));
        let places = |group: &mesh::Group| {
            let mut places: Vec<i64> = group.cells.iter().map(|cell| (first[cell.block] + cell.cell) as i64).collect();
            places.sort_unstable();
            list(py, places)
        };
        let groups = self.mesh.groups.iter().filter(|(_, group)| !group.cells.is_empty());
        groups.map(|(name, group)| (name.clone(), places(group))).collect()
    }

    /// The content of all cells: m³, m² of surfaces, m of curves.
    #[getter]
    fn content(&self) -> f64 {
        masses(&self.mesh, 1.0, 1.0).iter().sum()
    }

    /// The mesh with the edges of all cells halved.
    fn refined(&self, py: Python) -> PyResult<Mesh> {
        let mesh = self.mesh.clone();
        let refined = alone(py, move || mesh.refined())?;
        Ok(Mesh { mesh: Arc::new(refined), elements: self.elements.clone() })
    }

    /// The sides on the boundary: for each element of theirs its name, its cells on the points of this mesh, and the cells behind them.
    fn boundary<'py>(&self, py: Python<'py>) -> PyResult<Vec<Outside<'py>>> {
        let mesh = self.mesh.clone();
        let found = alone(py, move || mesh.boundary_cells())?;
        let mut first = vec![0];
        self.mesh.blocks.iter().for_each(|block| first.push(first[first.len() - 1] + block.cells().len()));
        let place = |cell: &mesh::CellIndex| (first[cell.block] + cell.cell) as i64;
        let block = |(block, behind): (mesh::CellBlock, Vec<mesh::CellIndex>)| {
            let nodes = block.connectivity.iter().map(|&p| p as i64).collect();
            let cells = matrix(py, nodes, block.element.nodes());
            (block.element.name.clone(), cells, list(py, behind.iter().map(place).collect()))
        };
        Ok(found.into_iter().map(block).collect())
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
        let known = quality.worst.zip(quality.worst_cell.clone());
        let worst = known.or_else(|| self.mesh.worst_cell().map(|worst| (worst.quality, worst.cell)));
        record.set_item("worst", worst.as_ref().map(|(quality, _)| quality))?;
        record.set_item("worst_cell", worst.as_ref().map(|(_, cell)| cell))?;
        record.set_item("poor", quality.poor.unwrap_or(0))?;
        record.set_item("skipped", quality.skipped)?;
        record.set_item("duplicates", quality.duplicates)?;
        record.set_item("folded", quality.folded)?;
        record.set_item("turned", self.mesh.reversed)?;
        let (folding, cells) = quality.folding.clone().unwrap_or_default();
        record.set_item("folding", folding)?;
        record.set_item("folding_cells", cells)?;
        record.set_item("coincident", quality.coincident)?;
        record.set_item("hanging", quality.hanging)?;
        record.set_item("pieces", quality.pieces)?;
        record.set_item("unused_points", self.mesh.unused_points)?;
        Ok(record)
    }
}
