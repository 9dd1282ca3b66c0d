//! Grids for ParaView.

use super::network::NetworkFile;
use crate::error::{Error, Result};
use crate::mesh::vtk::{Array, Grid};
use crate::mesh::{Mesh, Numbering};
use crate::model::{LengthSpring, MeasureSpring, Network, smoothed_pressure};
use crate::study::{BodyLoad, Outcome, Scene};
use std::collections::HashSet;

const LINE: u8 = 3;
const POINTS: u8 = 2;

/// The displacements of the finite elements in both kinds of files.
pub(super) fn body_array(load: &str) -> String {
    format!("u fem {load} (m)")
}

/// The displacements of a network beside those of others.
pub(super) fn network_array(fit: &str, load: &str) -> String {
    format!("u {fit} {load} (m)")
}

/// The displacements of a network in a file of its own.
fn own_array(load: &str) -> String {
    format!("u {load} (m)")
}

/// Checks that each array has a name of its own, before the work.
///
/// # Errors
/// The names of a fit and a load make the same name as others, or as those of the finite elements.
pub(super) fn check_arrays(scene: &Scene) -> Result<()> {
    let loads = || scene.loads().iter().map(|load| load.name.as_str());
    let bodies: HashSet<String> = loads().map(body_array).collect();
    let expected = "a name that makes no equal names of arrays in the files for ParaView";
    if let Some((i, load)) = loads().enumerate().find(|(_, load)| bodies.contains(&own_array(load))) {
        let found = format!("\"{load}\", whose array \"{}\" is that of the finite elements", own_array(load));
        return Err(scene.at(&format!("load[{i}]"), Error::expected("name", expected, found)));
    }
    let mut taken = bodies;
    for fit in scene.fits() {
        for load in loads() {
            let array = network_array(&fit.name, load);
            if taken.contains(&array) {
                let found = format!("\"{}\", whose array \"{array}\" another model has as well", fit.name);
                let place = fit.entry().map_or_else(|| format!("fit \"{}\"", fit.name), |i| format!("fit[{i}]"));
                return Err(scene.at(&place, Error::expected("name", expected, found)));
            }
            taken.insert(array);
        }
    }
    Ok(())
}

/// The solid cells, with the displacements of the finite elements and of each network.
pub fn displacement_grid(outcome: &Outcome) -> Grid {
    let mesh = &outcome.mesh;
    let mut grid = cell_grid(mesh, &mesh.points);
    grid.point_data.extend(nodes(mesh));
    for load in &outcome.loads {
        grid.point_data.extend(body_vectors(load, mesh.dimension));
    }
    for fit in &outcome.fits {
        for load in &fit.loads {
            if let Some(u) = &load.displacement {
                grid.point_data.push(vectors(network_array(&fit.fit.name, &load.name), u, mesh.dimension));
                let linear = outcome.law.is_none();
                let pressure = smoothed_pressure(mesh, &fit.network, &outcome.material, u, linear);
                let name = || format!("pressure, smoothed, {} {} (Pa)", fit.fit.name, load.name);
                grid.point_data.extend(pressure.map(|values| scalar(&name(), values)));
            }
        }
    }
    grid
}

/// The solid cells with the points at `x`.
pub(super) fn cell_grid(mesh: &Mesh, x: &[f64]) -> Grid {
    let mut grid = Grid { points: spatial(x, mesh.dimension), ..Grid::default() };
    for block in &mesh.blocks {
        let Some(vtk) = &block.element.formats.vtk else { continue };
        for nodes in block.cells() {
            let mut placed = nodes.to_vec();
            for (a, &place) in vtk.order.iter().flatten().enumerate() {
                placed[place] = nodes[a];
            }
            grid.push_cell(vtk.cell_type as u8, &placed);
        }
    }
    grid
}

/// The springs as lines with their constants and rest lengths, the points at `x`. A spring that measures something else is the
/// set of its points.
pub(super) fn spring_grid(mesh: &Mesh, network: &Network, x: &[f64]) -> Grid {
    let mut grid = Grid { points: spatial(x, mesh.dimension), ..Grid::default() };
    network.lengths.iter().for_each(|s| grid.push_cell(LINE, &s.points));
    network.others.iter().for_each(|s| grid.push_cell(POINTS, &s.points));
    let per_spring = |length: fn(&LengthSpring) -> f64, other: fn(&MeasureSpring) -> f64| {
        network.lengths.iter().map(length).chain(network.others.iter().map(other)).collect()
    };
    grid.cell_data = vec![
        scalar("k", per_spring(|s| s.constant, |s| s.constant)),
        scalar("rest", per_spring(|s| s.rest, |s| s.rest)),
        scalar("is_length", per_spring(|_| 1.0, |_| 0.0)),
    ];
    grid
}

/// The springs with the displacements of both models, and as `node` the numbers of the points in the file.
pub fn network_grid(file: &NetworkFile) -> Grid {
    let mesh = file.mesh;
    let mut grid = spring_grid(mesh, file.network, &mesh.points);
    grid.point_data.extend(nodes(mesh));
    if let Some(masses) = file.masses() {
        grid.point_data.push(scalar("mass (kg)", masses.to_vec()));
    }
    let answers = file.study.iter().flat_map(|(outcome, fit)| fit.loads.iter().zip(&outcome.loads));
    for (load, body) in answers {
        grid.point_data.extend(body_vectors(body, mesh.dimension));
        if let Some(u) = &load.displacement {
            grid.point_data.push(vectors(own_array(&load.name), u, mesh.dimension));
        }
    }
    grid
}

/// Returns the displacements of the finite elements, if they reached the whole load.
fn body_vectors(load: &BodyLoad, dimension: usize) -> Option<Array> {
    load.is_reached().then(|| vectors(body_array(&load.name), &load.fem, dimension))
}

/// The numbers of the points in the file: node tags of Gmsh, places from 0 of VTK; `None` of a mesh that is no file.
fn nodes(mesh: &Mesh) -> Option<Array> {
    let numbers = |numbering: &Numbering| numbering.nodes.iter().map(|&number| number as f64).collect();
    mesh.numbering.as_ref().map(|numbering| scalar("node", numbers(numbering)))
}

fn scalar(name: &str, values: Vec<f64>) -> Array {
    Array { name: name.into(), components: 1, values }
}

fn spatial(values: &[f64], dimension: usize) -> Vec<[f64; 3]> {
    let place = |x: &[f64]| std::array::from_fn(|k| x.get(k).copied().unwrap_or(0.0));
    values.chunks_exact(dimension).map(place).collect()
}

pub(super) fn vectors(name: String, values: &[f64], dimension: usize) -> Array {
    Array { name, components: 3, values: spatial(values, dimension).into_iter().flatten().collect() }
}
