//! Bodies whose cells are shared among the ranks of an MPI program; `springfit.petsc` has the program.

use crate::arrays::{list, matrix, place_list, places, rows};
use crate::error::{invalid, raised, unwritten};
use crate::progress::{self, alone, apart};
use crate::study::{dictionary_path, keyless, settings_of, text_of};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springfit_bodies::model::{BlockStiffness, is_exact, length_shares};
use springfit_element::element::SpringKind;
use springfit_mesh::mesh;
use springfit_report::report::{NetworkShard, Shard, ShardRun};
use springfit_studies::study::{self, Scene, distributed_body};
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

/// Where the blocks of each point begin, the other point of each, and the blocks, `[blocks, dimension²]`.
type Blocks<'py> = (Bound<'py, PyArray1<i32>>, Bound<'py, PyArray1<i32>>, Bound<'py, PyArray1<f64>>);

/// Nodal forces, what is held, and prescribed displacements of some points.
type Load<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<bool>>, Bound<'py, PyArray2<f64>>);

/// What is worked out once for all ranks, of which slices are shared out.
#[pyclass(frozen, module = "springfit._core")]
pub struct DistributedBody {
    source: (String, PathBuf),
    title: String,
    fits: Vec<String>,
    mesh: mesh::Mesh,
    loads: Vec<study::Case>,
}

#[pymethods]
impl DistributedBody {
    #[new]
    fn new(py: Python, scene: &Bound<PyAny>, folder: PathBuf, settings: &Bound<PyDict>) -> PyResult<DistributedBody> {
        let source = text_of(py, scene, &folder)?;
        let own = dictionary_path(scene, &source.1);
        let scene = Scene::parse_with(&source.0, &source.1, &settings_of(py, settings)?);
        let scene = scene.map_err(|error| raised(py, unwritten(keyless(error), own.as_deref())))?;
        let fits = scene.fits().iter().map(|fit| fit.name.clone()).collect();
        let title = scene.title().into();
        let (mesh, loads) =
            alone(py, move || distributed_body(&scene).map_err(|error| unwritten(error, own.as_deref())))?;
        Ok(DistributedBody { source, title, fits, mesh, loads })
    }

    /// The text of the scene and its path.
    #[getter]
    fn source(&self) -> (&str, &PathBuf) {
        (&self.source.0, &self.source.1)
    }

    #[getter]
    fn title(&self) -> &str {
        &self.title
    }

    /// The names of the fits.
    #[getter]
    fn fits(&self) -> Vec<&str> {
        self.fits.iter().map(String::as_str).collect()
    }

    /// The names of the loads.
    #[getter]
    fn loads(&self) -> Vec<&str> {
        self.loads.iter().map(|load| &load.name[..]).collect()
    }

    /// The numbers of points and of cells.
    #[getter]
    fn counts(&self) -> (usize, usize) {
        (self.mesh.point_count(), self.mesh.cell_count())
    }

    /// The element of each block of cells.
    #[getter]
    fn elements(&self) -> Vec<&str> {
        self.mesh.blocks.iter().map(|block| &block.element.name[..]).collect()
    }

    /// The number of cells of each block.
    #[getter]
    fn sizes(&self) -> Vec<usize> {
        self.mesh.blocks.iter().map(|block| block.cells().len()).collect()
    }

    #[getter]
    fn checksum(&self) -> String {
        format!("{:08x}", self.mesh.checksum())
    }

    /// Whether the file of the mesh numbers its points.
    #[getter]
    fn is_numbered(&self) -> bool {
        self.mesh.numbering.is_some()
    }

    /// Of `count` points from `first` on, `[count, dimension]`, m.
    fn points<'py>(&self, py: Python<'py>, first: usize, count: usize) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let d = self.mesh.dimension;
        let range = self.range(py, first, count)?;
        Ok(matrix(py, self.mesh.points[range.start * d..range.end * d].to_vec(), d))
    }

    /// Of these points in the file of the mesh.
    fn numbers<'py>(&self, py: Python<'py>, first: usize, count: usize) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let range = self.range(py, first, count)?;
        let numbers = self.mesh.numbering.as_ref().map_or(&[][..], |numbering| &numbering.nodes[range]);
        Ok(list(py, numbers.iter().map(|&number| number as i64).collect()))
    }

    /// The nodes of `count` cells of a block from `first` on.
    fn cells<'py>(
        &self,
        py: Python<'py>,
        block: usize,
        first: usize,
        count: usize,
    ) -> PyResult<Bound<'py, PyArray2<i64>>> {
        let blocks = &self.mesh.blocks;
        let expected = || invalid(py, "block", "cells of the mesh", format!("{count} from {first} of block {block}"));
        let block = blocks.get(block).ok_or_else(expected)?;
        let n = block.element.nodes();
        let nodes = first.checked_add(count).and_then(|end| block.connectivity.get(first * n..end * n));
        Ok(matrix(py, nodes.ok_or_else(expected)?.iter().map(|&p| p as i64).collect(), n))
    }

    /// A load on `count` points from `first` on.
    fn load<'py>(&self, py: Python<'py>, load: usize, first: usize, count: usize) -> PyResult<Load<'py>> {
        let expected = || invalid(py, "load", &format!("a number below {}", self.loads.len()), load);
        let case = self.loads.get(load).ok_or_else(expected)?;
        let d = self.mesh.dimension;
        let range = self.range(py, first, count)?;
        let given = &case.support.prescribed[range.start * d..range.end * d];
        Ok((
            matrix(py, case.forces[range.start * d..range.end * d].to_vec(), d),
            matrix(py, given.iter().map(Option::is_some).collect(), d),
            matrix(py, given.iter().map(|u| u.unwrap_or(0.0)).collect(), d),
        ))
    }
}

impl DistributedBody {
    fn range(&self, py: Python, first: usize, count: usize) -> PyResult<Range<usize>> {
        let points = self.mesh.point_count();
        match first.checked_add(count).filter(|end| *end <= points) {
            Some(end) => Ok(first..end),
            None => Err(invalid(py, "count", &format!("a part of {points} points"), format!("{count} from {first}"))),
        }
    }
}

/// The cells of one rank.
#[pyclass(frozen, module = "springfit._core")]
pub struct BodyShare(Arc<study::BodyShare>);

#[pymethods]
impl BodyShare {
    #[new]
    fn new(
        py: Python,
        text: String,
        path: PathBuf,
        settings: &Bound<PyDict>,
        points: PyReadonlyArray2<f64>,
        blocks: Vec<(String, PyReadonlyArray2<i64>)>,
    ) -> PyResult<BodyShare> {
        let settings = settings_of(py, settings)?;
        let block = |(name, nodes): &(String, PyReadonlyArray2<i64>)| {
            Ok((name.clone(), places(py, &format!("cells of {name}"), nodes.as_array())?))
        };
        let blocks = blocks.iter().map(block).collect::<PyResult<Vec<_>>>()?;
        let (d, points) = (points.as_array().ncols(), rows(&points));
        let share = alone(py, move || {
            let scene = Scene::parse_with(&text, &path, &settings)?;
            study::BodyShare::new(scene, d, points, blocks)
        });
        share.map(|share| BodyShare(Arc::new(share)))
    }

    /// The stiffness of the finite elements of these cells.
    fn stiffness<'py>(&self, py: Python<'py>) -> PyResult<Blocks<'py>> {
        blocks(py, &self.0.stiffness)
    }

    /// The springs of these cells by one fit: the stiffness of their network, the seconds, and the springs themselves.
    fn fit<'py>(&self, py: Python<'py>, fit: usize) -> PyResult<(Blocks<'py>, f64, Py<NetworkShare>)> {
        let share = self.0.clone();
        let fitted = progress::run(py, None, move |told| share.fit(fit, told))?;
        let stiffness = blocks(py, &fitted.stiffness)?;
        Ok((stiffness, fitted.seconds, Py::new(py, NetworkShare(fitted))?))
    }

    /// Writes the springs of these cells as a shard of the network: `place` is its number and that of all. `run` is the checksum of the mesh, its numbers of points and cells,
    /// and the words that tell the fit from others; `places` are those of the points in it, `numbers` those in its file, and `is_inside`
    /// tells which points belong to these cells alone.
    #[expect(clippy::too_many_arguments, reason = "what a shard has")]
    fn write(
        &self,
        py: Python,
        share: &NetworkShare,
        path: PathBuf,
        place: (usize, usize),
        run: (String, usize, usize, String),
        places: PyReadonlyArray1<i64>,
        numbers: Option<PyReadonlyArray1<i64>>,
        is_inside: PyReadonlyArray1<bool>,
    ) -> PyResult<()> {
        let places = place_list(py, "places", &places)?;
        let numbers = numbers.map(|numbers| numbers.as_array().iter().map(|&number| number as u64).collect::<Vec<_>>());
        let is_inside: Vec<bool> = is_inside.as_array().iter().copied().collect();
        let mesh = self.0.mesh();
        let expected = mesh.point_count();
        if places.len() != expected
            || is_inside.len() != expected
            || numbers.as_ref().is_some_and(|n| n.len() != expected)
        {
            return Err(invalid(py, "places", &format!("arrays of {expected} points"), places.len()));
        }
        let ((number, count), (checksum, points, cells, fit)) = (place, run);
        let written = apart(py, || {
            let (cells_of, others) = (&share.0.cells, &share.0.network.others);
            let others: Vec<_> = others.iter().filter(|spring| spring.kind != SpringKind::Length).collect();
            NetworkShard {
                shard: Shard { number, count },
                run: ShardRun {
                    program: concat!("springfit ", env!("CARGO_PKG_VERSION")).into(),
                    mesh: checksum,
                    points,
                    cells,
                    fit,
                    is_exact: is_exact(cells_of),
                    is_numbered: numbers.is_some(),
                },
                points: &mesh.points,
                dimension: mesh.dimension,
                places: Some(&places),
                numbers: numbers.as_deref(),
                shares: &length_shares(mesh, cells_of, |point| is_inside[point]),
                others: &others,
            }
            .write(&path)
        });
        written.map_err(|error| raised(py, error))
    }
}

/// The springs of the cells of one rank.
#[pyclass(frozen, module = "springfit._core")]
pub struct NetworkShare(pub study::FittedShare);

fn blocks<'py>(py: Python<'py>, stiffness: &BlockStiffness) -> PyResult<Blocks<'py>> {
    let (starts, columns, values) = apart(py, || stiffness.parts());
    let small = |number: usize| {
        i32::try_from(number).map_err(|_| invalid(py, "mpirun", "ranks with fewer than 2³¹ blocks each", number))
    };
    let starts = starts.into_iter().map(small).collect::<PyResult<Vec<_>>>()?;
    let columns = columns.into_iter().map(|column| small(column as usize)).collect::<PyResult<Vec<_>>>()?;
    Ok((list(py, starts), list(py, columns), list(py, values)))
}
