//! What is measured of a network, whoever made it.

use crate::arrays::{place_list, places, rows};
use crate::error::{invalid, raised};
use crate::mesh::Mesh;
use crate::progress::alone;
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use springfit_bodies::model::{LengthSpring, Network, Specimen, Support};
use springfit_element::material::Plane;
use springfit_element::springs::distance;
use springfit_foundation::error::{Error, Result};
use springfit_foundation::number::first_not_finite;
use springfit_report::report::{ContentPart, Parts, SpecimenOptions, read_specimen};
use springfit_studies::study::{EngineEntry, MeasureOptions, measure};
use std::path::PathBuf;

/// Springs on the contents of simplices: their points, constants and rest contents.
type Contents<'py> = (PyReadonlyArray2<'py, i64>, PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>);

/// A network of arrays.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct GivenNetwork<'py> {
    points: PyReadonlyArray2<'py, f64>,
    springs: PyReadonlyArray2<'py, i64>,
    constants: PyReadonlyArray1<'py, f64>,
    rest: Option<PyReadonlyArray1<'py, f64>>,
    contents: Option<Contents<'py>>,
    masses: Option<PyReadonlyArray1<'py, f64>>,
    cell: Option<PyReadonlyArray2<'py, f64>>,
    held: Option<PyReadonlyArray1<'py, i64>>,
}

/// How it is measured.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct GivenOptions<'py> {
    volume: Option<f64>,
    hull: bool,
    volumes: Option<PyReadonlyArray1<'py, f64>>,
    plane: Option<String>,
    thickness: Option<f64>,
    density: Option<f64>,
    regions: Vec<(String, Vec<usize>)>,
    frequencies: usize,
    engine: Option<String>,
}

fn values(py: Python, key: &str, array: &PyReadonlyArray1<f64>, count: usize) -> PyResult<Vec<f64>> {
    let values: Vec<f64> = array.as_array().iter().copied().collect();
    if values.len() != count {
        return Err(invalid(py, key, &format!("an array of {count} numbers"), values.len()));
    }
    match first_not_finite(&values) {
        Some(at) => Err(invalid(py, &format!("{key}[{at}]"), "a finite number", values[at])),
        None => Ok(values),
    }
}

fn place_rows(
    py: Python,
    key: &str,
    array: &PyReadonlyArray2<i64>,
    width: usize,
    count: usize,
) -> PyResult<Vec<usize>> {
    if array.shape()[1] != width {
        return Err(invalid(py, key, &format!("an array of shape (n, {width})"), format!("{:?}", array.shape())));
    }
    let nodes = places(py, key, array.as_array())?;
    match nodes.iter().position(|node| *node >= count) {
        Some(at) => {
            let hint = if nodes[at] == count { "; are points numbered from 1?" } else { "" };
            let expected = format!("places of points from 0 to {}", count.saturating_sub(1));
            Err(invalid(py, &format!("{key}[{}]", at / width), &expected, format!("{}{hint}", nodes[at])))
        }
        None => Ok(nodes),
    }
}

impl GivenNetwork<'_> {
    fn specimen(&self, py: Python, mesh: Option<&Mesh>) -> PyResult<Specimen> {
        let (count, d) = (self.points.shape()[0], self.points.shape()[1]);
        let points = rows(&self.points);
        if !(1..=3).contains(&d) || count == 0 {
            let hint = if (1..=3).contains(&count) { "; are points and coordinates exchanged?" } else { "" };
            let found = format!("{:?}{hint}", self.points.shape());
            return Err(invalid(py, "points", "an array of shape (points, 1 to 3)", found));
        }
        if let Some(at) = points.iter().position(|x| !x.is_finite()) {
            return Err(invalid(py, &format!("points[{}]", at / d), "finite numbers", points[at]));
        }
        let ends = place_rows(py, "springs", &self.springs, 2, count)?;
        let constants = values(py, "constants", &self.constants, ends.len() / 2)?;
        let rest = self.rest.as_ref().map(|rest| values(py, "rest", rest, constants.len())).transpose()?;
        let mut lengths = Vec::with_capacity(constants.len());
        for (s, (pair, &constant)) in ends.as_chunks::<2>().0.iter().zip(&constants).enumerate() {
            let [i, j] = *pair;
            let at = |p: usize| &points[p * d..(p + 1) * d];
            let is_point = i == j || (distance(at(i), at(j)) == 0.0 && self.cell.is_none());
            if is_point && (i == j || rest.as_ref().is_none_or(|rest| rest[s] > 0.0)) {
                return Err(invalid(
                    py,
                    &format!("springs[{s}]"),
                    "two points at different places",
                    format!("{i} and {j}"),
                ));
            }
            let rest = rest.as_ref().map_or(f64::NAN, |rest| rest[s]);
            lengths.push(LengthSpring { points: [i.min(j), i.max(j)], constant, rest });
        }
        let mut network = Network { dimension: d, lengths, others: Vec::new() };
        if let Some((nodes, constants, rest)) = &self.contents {
            let nodes = place_rows(py, "contents", nodes, d + 1, count)?;
            let size = nodes.len() / (d + 1);
            let constants = values(py, "contents constants", constants, size)?;
            let rest = values(py, "contents rest", rest, size)?;
            let part = |(s, nodes): (usize, &[usize])| ContentPart {
                points: nodes.into(),
                constant: constants[s],
                rest: rest[s],
            };
            let contents = nodes.chunks_exact(d + 1).enumerate().map(part).collect();
            network.others = Parts { contents, ..Parts::default() }.network(d).others;
        }
        let mut specimen = Specimen::new(network, points);
        if let Some(cell) = &self.cell {
            let vectors = nalgebra::DMatrix::from_row_slice(cell.shape()[0], cell.shape()[1], &rows(cell));
            specimen = specimen.repeated(vectors).map_err(|error| raised(py, error))?;
        }
        // Without a rest length a spring does not pull, also one that reaches an image.
        let Specimen { network, points, .. } = &mut specimen;
        for spring in network.lengths.iter_mut().filter(|spring| spring.rest.is_nan()) {
            let [a, b] = spring.points.map(|p| &points[p * d..(p + 1) * d]);
            spring.rest = distance(a, b);
        }
        specimen.masses = self.masses.as_ref().map(|masses| values(py, "masses", masses, count)).transpose()?;
        if let Some(held) = &self.held {
            let held = place_list(py, "fix", held)?;
            let mut support = Support { prescribed: vec![None; count * d] };
            support.fix(&held, &(0..d).collect::<Vec<_>>(), d);
            specimen.support = Some(support);
        }
        if let Some(mesh) = mesh {
            let own = &mesh.mesh;
            if own.dimension != d || own.points != specimen.points[..count * d] {
                return Err(invalid(
                    py,
                    "mesh",
                    "a mesh on the same points",
                    format!("one of {} points", own.point_count()),
                ));
            }
            specimen.mesh = Some(springfit_mesh::mesh::Mesh::clone(own));
        }
        Ok(specimen)
    }
}

impl GivenOptions<'_> {
    fn read(&self, py: Python, specimen: &Specimen, own: Option<(Plane, f64)>) -> PyResult<MeasureOptions> {
        let (count, d) = (specimen.count(), specimen.network.dimension);
        let engine = self.engine.as_deref().map(|text| {
            let entry: EngineEntry =
                serde_json::from_str(text).map_err(|e| invalid(py, "engine", "the settings of an engine", e))?;
            entry.setting().map_err(|e| raised(py, e.under("engine")))
        });
        let thickness = self.thickness.unwrap_or(1.0);
        if !(thickness > 0.0 && thickness.is_finite()) {
            return Err(invalid(py, "thickness", "a length above zero, m", thickness));
        }
        let plane = self.plane.as_deref().map(Plane::named).transpose().map_err(|error| raised(py, error))?;
        if d != 2 && (plane.is_some() || self.thickness.is_some()) {
            return Err(invalid(py, "plane", "a plane network", format!("one of {d} dimensions")));
        }
        let state = MeasureOptions::plane_state(plane, self.thickness, own).filter(|_| d == 2);
        let region = |(name, points): &(String, Vec<usize>)| {
            let mut part = vec![false; count];
            for &p in points {
                *part.get_mut(p).ok_or_else(|| {
                    invalid(py, &format!("regions[\"{name}\"]"), &format!("points from 0 to {}", count - 1), p)
                })? = true;
            }
            Ok((name.clone(), part))
        };
        Ok(MeasureOptions {
            volume: self.volume,
            hull: self.hull,
            point_volumes: self.volumes.as_ref().map(|volumes| values(py, "volumes", volumes, count)).transpose()?,
            state,
            regions: self.regions.iter().map(region).collect::<PyResult<_>>()?,
            frequencies: self.frequencies,
            engine: engine.transpose()?,
            of_engine: None,
            density: self.density,
        })
    }
}

fn measured(py: Python, specimen: Specimen, options: MeasureOptions) -> PyResult<String> {
    alone(py, move || -> Result<String> {
        let found = measure(&specimen, &options)?;
        serde_json::to_string(&found).map_err(|e| Error::new(format!("the result cannot be written: {e}")))
    })
}

/// Measures a network of arrays; the result is its record in JSON.
#[pyfunction]
pub fn measure_arrays(
    py: Python,
    network: GivenNetwork,
    mesh: Option<PyRef<Mesh>>,
    options: GivenOptions,
) -> PyResult<String> {
    let specimen = network.specimen(py, mesh.as_deref())?;
    let options = options.read(py, &specimen, None)?;
    measured(py, specimen, options)
}

/// Measures the network of a file.
#[pyfunction]
pub fn measure_file(
    py: Python,
    path: PathBuf,
    points: Option<PathBuf>,
    cell: Option<PyReadonlyArray2<f64>>,
    periodic: Option<bool>,
    options: GivenOptions,
) -> PyResult<String> {
    let vectors =
        |cell: PyReadonlyArray2<f64>| nalgebra::DMatrix::from_row_slice(cell.shape()[0], cell.shape()[1], &rows(&cell));
    let reading = SpecimenOptions { points, cell: cell.map(vectors), is_periodic: periodic, elements: Vec::new() };
    let mut file = read_specimen(&path, &reading).map_err(|error| raised(py, error))?;
    let mut options = options.read(py, &file.specimen, file.state)?;
    options.of_engine = file.engine;
    options.engine = options.engine.or(file.engine.take());
    measured(py, file.specimen, options)
}
