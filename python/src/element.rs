//! `Element`.

use crate::arrays::matrix;
use crate::error::raised;
use numpy::PyArray2;
use pyo3::prelude::*;
use springfit::element;
use std::collections::BTreeMap;
use std::sync::Arc;

/// An element type: a shipped one by its name, or the one of a TOML file by its path.
#[pyclass(frozen, module = "springfit")]
pub struct Element(pub Arc<element::Element>);

#[pymethods]
impl Element {
    /// The shipped element of this name, or the element in the file of this path.
    #[new]
    fn new(py: Python, name_or_path: &str) -> PyResult<Element> {
        let element = element::Element::load(name_or_path).map_err(|error| raised(py, error))?;
        Ok(Element(Arc::new(element)))
    }

    /// The element that a TOML text describes.
    #[staticmethod]
    fn parse(py: Python, text: &str) -> PyResult<Element> {
        let element = element::Element::parse(text).map_err(|error| raised(py, error))?;
        Ok(Element(Arc::new(element)))
    }

    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    #[getter]
    fn title(&self) -> &str {
        &self.0.title
    }

    /// Of its cells: 1, 2 or 3.
    #[getter]
    fn dimension(&self) -> usize {
        self.0.dimension()
    }

    /// The number of nodes.
    #[getter]
    fn nodes(&self) -> usize {
        self.0.nodes()
    }

    /// Reference positions of the nodes, `[nodes, dimension]`.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        matrix(py, self.0.positions.clone(), self.0.dimension())
    }

    /// The nodes of the springs of each group; none where the whole cell is measured.
    #[getter]
    fn springs(&self) -> BTreeMap<&str, &Vec<Vec<usize>>> {
        self.0.springs.iter().map(|group| (&group.name[..], &group.nodes)).collect()
    }

    /// The number of VTK's cell type, and the place in VTK's list of each node; None where VTK has no such cell.
    #[getter]
    fn vtk(&self) -> Option<(u32, Vec<usize>)> {
        let entry = self.0.formats.vtk.as_ref()?;
        Some((entry.cell_type, entry.order.clone().unwrap_or_else(|| (0..self.0.nodes()).collect())))
    }

    fn __repr__(&self) -> String {
        format!("<springfit.Element {}: {}>", self.0.name, self.0.title)
    }
}

/// The names of the shipped elements.
#[pyfunction]
pub fn shipped_elements() -> Vec<&'static str> {
    element::SHIPPED.iter().map(|file| file.name).collect()
}
