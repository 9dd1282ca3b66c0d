//! Bodies whose cells are shared among the ranks of an MPI program; `springfit.petsc` has the program.

use crate::arrays::{list, matrix, place_list, places, rows};
use crate::error::{invalid, raised};
use crate::mesh::Mesh;
use crate::progress::{self, apart};
use crate::study::{keyless, settings_of, text_of};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springfit::element::SpringKind;
use springfit::model::{BlockStiffness, is_exact, length_shares};
use springfit::report::{NetworkShard, Shard, ShardRun};
use springfit::study::{self, Scene, distributed_body};
use std::path::PathBuf;
use std::sync::Arc;

/// Where the blocks of each point begin, the other point of each, and the blocks, `[blocks, dimension²]`.
type Blocks<'py> = (Bound<'py, PyArray1<i32>>, Bound<'py, PyArray1<i32>>, Bound<'py, PyArray1<f64>>);

/// Name, nodal forces, what is held, and prescribed displacements.
type Load<'py> = (String, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<bool>>, Bound<'py, PyArray2<f64>>);

/// The text of the scene and its path, its title, its fits, its mesh and its loads.
type Body<'py> = ((String, PathBuf), String, Vec<String>, Mesh, Vec<Load<'py>>);

/// What is worked out once for all ranks.
#[pyfunction]
pub fn distributed<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyAny>,
    folder: PathBuf,
    settings: &Bound<'py, PyDict>,
) -> PyResult<Body<'py>> {
    let (text, path) = text_of(py, scene, &folder)?;
    let scene = Scene::parse_with(&text, &path, &settings_of(py, settings)?);
    let scene = scene.map_err(|error| raised(py, keyless(error)))?;
    let (mesh, cases) = progress::run(py, None, |_| distributed_body(&scene))?;
    let d = mesh.dimension;
    let load = |case: study::Case| {
        let held = case.support.prescribed.iter().map(Option::is_some).collect();
        let given = case.support.prescribed.iter().map(|u| u.unwrap_or(0.0)).collect();
        (case.name, matrix(py, case.forces, d), matrix(py, held, d), matrix(py, given, d))
    };
    let fits = scene.fits().iter().map(|fit| fit.name.clone()).collect();
    let loads = cases.into_iter().map(load).collect();
    Ok(((text, path), scene.title().into(), fits, Mesh(Arc::new(mesh)), loads))
}

/// The cells of one rank.
#[pyclass(frozen, module = "springfit._core")]
pub struct BodyShare(study::BodyShare);

#[pymethods]
impl BodyShare {
    #[new]
    fn new(
        py: Python,
        text: &str,
        path: PathBuf,
        settings: &Bound<PyDict>,
        points: PyReadonlyArray2<f64>,
        blocks: Vec<(String, PyReadonlyArray2<i64>)>,
    ) -> PyResult<BodyShare> {
        let settings = settings_of(py, settings)?;
        let block = |(name, nodes): &(String, PyReadonlyArray2<i64>)| {
            Ok((name.clone(), places(py, &format!("cells of {name}"), nodes.as_array().iter())?))
        };
        let blocks = blocks.iter().map(block).collect::<PyResult<Vec<_>>>()?;
        let (d, points) = (points.as_array().ncols(), rows(&points));
        let share = apart(py, || {
            let scene = Scene::parse_with(text, &path, &settings)?;
            study::BodyShare::new(scene, d, points, blocks)
        });
        share.map(BodyShare).map_err(|error| raised(py, error))
    }

    /// The stiffness of the finite elements of these cells.
    fn stiffness<'py>(&self, py: Python<'py>) -> PyResult<Blocks<'py>> {
        blocks(py, &self.0.stiffness)
    }

    /// The springs of these cells by one fit: the stiffness of their network, the seconds, and the springs themselves.
    fn fit<'py>(&self, py: Python<'py>, fit: usize) -> PyResult<(Blocks<'py>, f64, Py<NetworkShare>)> {
        let fitted = progress::run(py, None, |told| self.0.fit(fit, told))?;
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
