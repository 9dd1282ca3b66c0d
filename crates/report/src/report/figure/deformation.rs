//! A body under a load at rest, with finite elements and with springs, from the files of a run.

use super::run_folder::RunFolder;
use crate::error::{Error, Result};
use crate::mesh::{Field, Mesh, MeshSource};
use crate::report::network::NetworkRecord;
use crate::report::outline::cell_edges;
use crate::report::pictures::{body_array, network_array};
use std::path::Path;

/// The largest displacement is drawn as this part of the body's size.
const SHOWN: f64 = 0.2;
/// Springs of which all are drawn; of more, those on the surface: lines of the others would cover them.
const MOST_SPRINGS: usize = 4000;

/// The shapes of a body under a load.
#[derive(Debug, Clone)]
pub struct Deformation {
    /// For readers of screens.
    pub title: String,
    /// The name of the fit.
    pub fit: String,
    /// Percent of the largest displacement.
    pub error: Option<f64>,
    /// The body at rest.
    pub mesh: Mesh,
    /// Corners of the faces on the surface, `[faces][corners]`.
    pub faces: Vec<Vec<usize>>,
    /// Edges of a body without faces.
    pub edges: Vec<[usize; 2]>,
    /// The displacements of finite elements and of the network, m, `[points × dimension]`.
    pub displacements: [Vec<f64>; 2],
    /// The springs that are drawn, and whether their constants are below zero.
    pub springs: Vec<([usize; 2], bool)>,
    /// Whether springs inside the body are left out.
    pub is_surface_only: bool,
    /// Points that are held.
    pub held: Vec<usize>,
    /// The forces on points, N.
    pub forces: Vec<(usize, Vec<f64>)>,
    /// By which displacements are multiplied.
    pub factor: f64,
}

impl Deformation {
    /// Under the load and of the fit that are named, or the first ones.
    ///
    /// # Errors
    /// The run has no such load or fit, or did not write the displacements.
    pub fn of(run: &RunFolder, fit: Option<&str>, load: Option<&str>) -> Result<Deformation> {
        let report = run.report()?;
        let place = RunFolder::place(&report, fit)?;
        let fit = &report.fits[place];
        let names: Vec<&str> = fit.loads.iter().map(|load| load.name.as_str()).collect();
        let found =
            match load {
                None => fit.loads.first(),
                Some(name) => Some(fit.loads.iter().find(|load| load.name == name).ok_or_else(|| {
                    Error::expected("--load", format!("a load of the run: {}", names.join(", ")), name)
                })?),
            };
        let load = found.ok_or_else(|| Error::new("the run has no loads, so there are no displacements to draw"))?;
        if load.error.is_none() {
            let why = format!("{} has no displacements under {}: it is {}", fit.name, load.name, fit.status);
            return Err(Error::new(format!("{why}; another fit of the run may have some")));
        }
        let advice = "[output] vtu = true of the scene writes it, or springfit run SCENE --set output.vtu=true";
        let path = run.own_file(&report, "mesh.vtu", "the displacements", advice)?;
        let source = MeshSource::read(&path)?;
        let mesh = Mesh::resolve(&source, &[], 1.0).map_err(|e| e.in_file(&path))?;
        let network = run.network(Some(&fit.name))?;
        check_same(&mesh, &network).map_err(|e| e.in_file(&path))?;
        let displacements = [body_array(&load.name), network_array(&fit.name, &load.name)];
        let displacements = displacements.map(|array| displacement(&path, &mesh, &array));
        let [body, springs] = displacements;
        let displacements = [body?, springs?];
        let faces = mesh.surface_faces();
        let edges = if faces.is_empty() { cell_edges(&mesh) } else { Vec::new() };
        let (springs, is_surface_only) = springs_drawn(&network, &faces);
        let nodal = network.loads.iter().find(|nodal| nodal.name == load.name);
        let held = nodal.map_or(&network.held, |nodal| &nodal.held);
        let factor = if report.law.is_some() { 1.0 } else { magnification(&mesh, &displacements[0]) };
        Ok(Deformation {
            title: format!("{} under {}: at rest, finite elements and {}", report.scene, load.name, fit.name),
            fit: fit.name.clone(),
            error: load.error.map(|e| e.rms),
            held: held.iter().map(|held| held.point).collect(),
            forces: nodal.map_or(Vec::new(), |n| n.forces.iter().map(|f| (f.point, f.force.clone())).collect()),
            mesh,
            faces,
            edges,
            displacements,
            springs,
            is_surface_only,
            factor,
        })
    }
}

/// The displacements of all points in an array of the file.
fn displacement(path: &Path, mesh: &Mesh, array: &str) -> Result<Vec<f64>> {
    let field = Field::read_named(path, mesh, 1.0, Some(array))?;
    let all: Option<Vec<f64>> = field.displacements.into_iter().collect();
    all.ok_or_else(|| Error::at(array, "has no displacement of some points; run the scene again").in_file(path))
}

/// Whether the file of the mesh and that of the network have the same points.
fn check_same(mesh: &Mesh, network: &NetworkRecord) -> Result<()> {
    let flat: Vec<f64> = network.points.iter().flatten().copied().collect();
    let size = flat.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
    let is_same =
        // A network file may have its points in single precision.
        flat.len() == mesh.points.len() && flat.iter().zip(&mesh.points).all(|(a, b)| (a - b).abs() <= 1e-6 * size);
    match is_same {
        true => Ok(()),
        false => Err(Error::new("has other points than the network of the run; run the scene again")),
    }
}

/// The factor by which displacements are multiplied in a picture, with two digits, so that it can be said.
pub(in crate::report) fn magnification(mesh: &Mesh, displacement: &[f64]) -> f64 {
    let d = mesh.dimension;
    let extent = |k: usize| {
        let values = || mesh.points.iter().skip(k).step_by(d);
        values().copied().fold(f64::NEG_INFINITY, f64::max) - values().copied().fold(f64::INFINITY, f64::min)
    };
    let size = (0..d).map(extent).fold(0.0, f64::max);
    let largest = displacement.chunks_exact(d).map(crate::springs::norm).fold(0.0, f64::max);
    // Two digits of the factor are told in the key; the drawing takes the factor with the same digits.
    if largest == 0.0 { 1.0 } else { format!("{:.1e}", SHOWN * size / largest).parse().unwrap_or(1.0) }
}

/// The springs on lengths, of many those on the surface; and whether any are left out.
fn springs_drawn(network: &NetworkRecord, faces: &[Vec<usize>]) -> (Vec<([usize; 2], bool)>, bool) {
    let lengths = network.springs.iter().filter(|spring| spring.kind == "length" && spring.points.len() == 2);
    let all: Vec<_> = lengths.map(|spring| ([spring.points[0], spring.points[1]], spring.constant < 0.0)).collect();
    if all.len() <= MOST_SPRINGS {
        return (all, false);
    }
    let mut on_surface = vec![false; network.points.len()];
    faces.iter().flatten().for_each(|&p| on_surface[p] = true);
    let seen: Vec<_> = all.iter().filter(|(ends, _)| ends.iter().all(|&p| on_surface[p])).copied().collect();
    let is_less = seen.len() < all.len();
    (seen, is_less)
}
