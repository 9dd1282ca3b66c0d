//! `Element`.

use crate::arguments::{self, text};
use crate::arrays::matrix;
use crate::error::raised;
use numpy::PyArray2;
use pyo3::prelude::*;
use springfit_element::element;
use springfit_foundation::error::{Error, Result};
use std::collections::BTreeMap;
use std::fs;
use std::hash::{Hash, Hasher};
use std::path::Path;
use std::sync::Arc;

/// An element type: a shipped one by its name, or the one of a TOML file by its path. Elements of equal texts are equal.
#[pyclass(frozen, eq, hash, module = "springfit")]
#[derive(Clone)]
pub struct Element(pub Arc<element::Element>, Arc<str>);

impl PartialEq for Element {
    fn eq(&self, other: &Element) -> bool {
        self.1 == other.1
    }
}

impl Hash for Element {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.1.hash(state);
    }
}

impl Element {
    /// The shipped element of this name, or the element in the file of this path.
    ///
    /// # Errors
    /// No element has this name, no file has this path, or the file is wrong.
    pub fn named(name: &str) -> Result<Element> {
        if let Some(file) = element::SHIPPED.iter().find(|file| file.name == name) {
            return Element::of_text(file.text);
        }
        let element = element::Element::load(name)?;
        let path = Path::new(name);
        let text = fs::read_to_string(path).map_err(|e| Error::io("cannot be read", e).in_file(path))?;
        Ok(Element(Arc::new(element), text.into()))
    }

    /// The element that a TOML text describes.
    fn of_text(text: &str) -> Result<Element> {
        Ok(Element(Arc::new(element::Element::parse(text)?), text.into()))
    }
}

#[pymethods]
impl Element {
    /// The shipped element of this name, or the element in the file of this path.
    #[new]
    fn new(py: Python, name_or_path: &Bound<PyAny>) -> PyResult<Element> {
        let path = name_or_path.call_method0("__fspath__");
        let name = text("element", path.as_ref().unwrap_or(name_or_path))?;
        Element::named(&name).map_err(|error| raised(py, error))
    }

    /// The element that a TOML text describes.
    #[staticmethod]
    #[pyo3(name = "parse")]
    fn parsed(py: Python, text: &Bound<PyAny>) -> PyResult<Element> {
        parsed_element(py, &arguments::text("text", text)?)
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

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (&str,))> {
        Ok((py.import("springfit._core")?.getattr("parsed_element")?, (&self.1,)))
    }

    /// It never changes.
    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<PyAny>) -> Py<Self> {
        slf
    }

    fn __repr__(&self) -> String {
        format!("<springfit.Element {}: {}>", self.0.name, self.0.title)
    }
}

/// The element that a TOML text describes, as pickles have it.
#[pyfunction]
pub fn parsed_element(py: Python, text: &str) -> PyResult<Element> {
    Element::of_text(text).map_err(|error| raised(py, error))
}

/// The names of the shipped elements.
#[pyfunction]
pub fn shipped_elements() -> Vec<&'static str> {
    element::SHIPPED.iter().map(|file| file.name).collect()
}
