//! The loads of a scene on its mesh.

use super::scene::Scene;
use crate::error::{Error, Result};
use crate::material::Material;
use crate::mesh::{Mesh, Selection};
use crate::model::{Action, Support, nodal_forces, unheld_bodies};

/// A load on this mesh: what is held, and the nodal forces.
pub struct Case {
    pub name: String,
    pub support: Support,
    pub forces: Vec<f64>,
}

/// # Errors
/// A part of the mesh is empty or unknown, a load has the wrong number of entries, or a body is not held.
pub fn load_cases(scene: &Scene, mesh: &Mesh, material: Material) -> Result<Vec<Case>> {
    let d = mesh.dimension;
    let mut fixed = Support::free(mesh);
    for (i, (part, axes)) in scene.supports.iter().enumerate() {
        let at = |e| scene.at(&format!("fix[{i}]"), e);
        let points = part.selection(d).and_then(|s| s.points(mesh)).map_err(at)?;
        if points.is_empty() {
            return Err(at(Error::new("holds nothing: the selected part has no points")));
        }
        let all: Vec<usize> = (0..d).collect();
        let directions = axes.as_ref().unwrap_or(&all);
        if directions.iter().any(|&k| k >= d) {
            return Err(at(Error::expected("axes", "\"x\" and \"y\" in a plane mesh", "\"z\"")));
        }
        fixed.fix(&points, directions, d);
    }
    let mut cases = Vec::new();
    for (i, load) in scene.loads.iter().enumerate() {
        let at = |e| scene.at(&format!("load[{i}]"), e);
        let (key, entries) = match &load.action {
            Action::Traction(v) => ("traction", v.len()),
            Action::Force(v) => ("force", v.len()),
            Action::Body(v) => ("body", v.len()),
            Action::Displacement(v) => ("displacement", v.len()),
        };
        if entries != d {
            return Err(at(Error::expected(key, format!("{d} entries for a mesh of dimension {d}"), entries)));
        }
        let selection: Selection = load.part.selection(d).map_err(at)?;
        let forces = nodal_forces(mesh, &selection, &load.action, material.thickness()).map_err(|e| match e.key() {
            Some("load") => at(Error::new(e.problem())),
            _ => at(e),
        })?;
        let mut support = fixed.clone();
        if let Action::Displacement(given) = &load.action {
            for p in selection.points(mesh).map_err(at)? {
                for (k, u) in given.iter().enumerate().filter(|(_, u)| u.is_some()) {
                    support.prescribed[p * d + k] = *u;
                }
            }
        }
        if let Some(body) = unheld_bodies(mesh, &support).first() {
            let expected = "supports that hold every body";
            let place = mesh.point(body.first_point);
            let motions = if body.motions == 1 { "motion" } else { "motions" };
            let found = format!(
                "{} rigid {motions} left to the body of {} points at {place:?} m under load \"{}\"",
                body.motions, body.points, load.name
            );
            return Err(Error::expected("fix", expected, found).in_file(&scene.path));
        }
        cases.push(Case { name: load.name.clone(), support, forces });
    }
    Ok(cases)
}
