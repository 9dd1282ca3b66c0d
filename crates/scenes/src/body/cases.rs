//! The load cases of a scene on its mesh.

use super::case::Case;
use crate::error::{Error, ErrorKind, Result};
use crate::material::{CellMap, MaterialMap};
use crate::mesh::{Field, Mesh, Selection};
use crate::model::{Action, Cavity, Component, PressedFaces, Support, nodal_forces, unheld_bodies};
use crate::scene::{Hold, LoadCase, LoadKind, MeasuredEntry, Part, Scene};
use std::path::Path;

fn read_measured(scene: &Scene, entry: &MeasuredEntry, mesh: &Mesh) -> Result<Field> {
    let folder = scene.path().parent().unwrap_or(Path::new(""));
    Field::read_named(&folder.join(&entry.file), mesh, entry.scale, entry.array.as_deref())
}

/// The support of the `[[fix]]` entries.
///
/// # Errors
/// A part of the mesh is empty or unknown, or the space does not have an axis.
pub fn held(scene: &Scene, mesh: &Mesh) -> Result<Support> {
    let d = mesh.dimension;
    let mut fixed = Support::free(mesh);
    for (i, Hold { part, axes, clamp }) in scene.supports().iter().enumerate() {
        let at = |e| scene.at(&format!("fix[{i}]"), e);
        let points = part.selection(d).and_then(|s| s.points(mesh)).map_err(at)?;
        if points.is_empty() {
            return Err(at(part.without_members("holds nothing: the selected part has no points", mesh)));
        }
        let all: Vec<usize> = (0..d).collect();
        let directions = axes.as_ref().unwrap_or(&all);
        if directions.iter().any(|&k| k >= d) {
            return Err(at(Error::expected("axes", "\"x\" and \"y\" in a plane mesh", "\"z\"")));
        }
        fixed.fix(&points, directions, d);
        if *clamp {
            fixed.fix(&clamped(mesh, &points).map_err(at)?, directions, d);
        }
    }
    Ok(fixed)
}

/// The directors that go with these points.
///
/// # Errors
/// There are none.
fn clamped(mesh: &Mesh, points: &[usize]) -> Result<Vec<usize>> {
    let clamped = mesh.with_directors_of(points).split_off(points.len());
    if clamped.is_empty() {
        let expected = "a sheet with bending = \"plate\" of which both ends of an edge are in the part, or rods with bending = \"rod\"";
        return Err(Error::expected("clamp", expected, "none"));
    }
    Ok(clamped)
}

/// The support of the `[[fix]]` entries, and the load cases with the displacements that were measured at points of the mesh.
///
/// # Errors
/// Those of [`applied_cases`], and of a file of displacements.
pub fn load_cases(scene: &Scene, mesh: &Mesh, material: &MaterialMap) -> Result<(Support, Vec<Case>)> {
    let (fixed, mut cases) = applied_cases(scene, mesh, material)?;
    for (i, (load, case)) in scene.loads().iter().zip(&mut cases).enumerate() {
        let measured = load.measured.as_ref().map(|entry| read_measured(scene, entry, mesh)).transpose();
        let at = |e: Error| scene.at(&format!("load[{i}]"), e.under("measured"));
        case.measured = measured.map_err(|e| e.placed(at))?;
        if let (Some(field), Some(sigma)) = (&case.measured, case.noise) {
            let known = field.displacements.iter().zip(&case.support.prescribed);
            let free: Vec<f64> = known.filter(|(_, held)| held.is_none()).filter_map(|(u, _)| *u).collect();
            let rms = (free.iter().map(|u| u * u).sum::<f64>() / free.len().max(1) as f64).sqrt();
            // Noise as large as the displacements leaves nothing to fit, and is mostly an error of the unit.
            if !(sigma < rms) {
                let expected = format!("noise below the displacements under \"{}\", {rms:.3e} m (rms)", case.name);
                return Err(at(Error::expected("sigma", expected, format!("{sigma:.3e} m"))));
            }
        }
    }
    Ok((fixed, cases))
}

/// The support of the `[[fix]]` entries, and the load cases on the scene's mesh or a finer one, without measured displacements.
///
/// # Errors
/// A part of the mesh is empty or unknown, a load has the wrong number of entries, or a body is not held.
pub fn applied_cases(scene: &Scene, mesh: &Mesh, material: &MaterialMap) -> Result<(Support, Vec<Case>)> {
    let fixed = held(scene, mesh)?;
    let (mut cases, thicknesses) = (Vec::new(), material.thicknesses());
    // The mass per content of each cell.
    let masses = material.density().map_or(thicknesses.clone(), |density| density.product(&thicknesses));
    for (i, load) in scene.loads().iter().enumerate() {
        let at = |e| scene.at(&format!("load[{i}]"), e);
        let Acting { forces, support, pressed, cavity } = match load.single() {
            Some((part, action)) => {
                let weights = if load.is_acceleration() { &masses } else { &thicknesses };
                if matches!(action, Action::Moment(_)) && scene.law().is_some() {
                    let expected = "small deformation; a displacement with clamp = true turns edges and joints at large deformation";
                    return Err(at(Error::expected("moment", expected, "a law")));
                }
                acting(mesh, weights, &fixed, (load, part, action)).map_err(at)?
            }
            None => Acting { forces: Vec::new(), support: fixed.clone(), pressed: None, cavity: None },
        };
        // Asked before anything is factorised: a zero pivot would not say which body is loose.
        if let Some(body) = unheld_bodies(mesh, &support).first() {
            let expected = "supports that hold every body";
            let place = mesh.point(body.first_point);
            let motions = if body.motions == 1 { "motion" } else { "motions" };
            let found = format!(
                "{} rigid {motions} left to the body of {} points at {place:?} m under load \"{}\"",
                body.motions, body.points, load.name
            );
            return Err(Error::expected("fix", expected, found).of_kind(ErrorKind::Infeasible).in_file(scene.path()));
        }
        let is_prescribed = matches!(load.single(), Some((_, Action::Displacement(_) | Action::Volume(_))));
        if cavity.is_some() && scene.law().is_none() {
            let expected = "a material with a law: without one the pressure is proportional to the change of volume";
            return Err(at(Error::expected("volume", expected, "none")));
        }
        let (is_measured, noise) = (load.measured.is_some(), load.measured.as_ref().and_then(|entry| entry.sigma));
        let (measured, finer) = (None, None);
        if let Some(sigma) = noise.filter(|sigma| !(*sigma > 0.0 && sigma.is_finite())) {
            let expected = "a standard deviation above zero, m";
            return Err(at(Error::expected("sigma", expected, sigma).under("measured")));
        }
        let name = load.name.clone();
        cases.push(Case { name, support, forces, pressed, cavity, is_prescribed, measured, is_measured, finer, noise });
    }
    for (i, load) in scene.loads().iter().enumerate() {
        // Sums come last, because their parts may stand after them in the scene.
        if let LoadKind::Sum(parts) = &load.kind {
            let sum = |dof: usize| parts.iter().map(|&part| cases[part].forces[dof]).sum();
            let forces: Vec<f64> = (0..mesh.points.len()).map(sum).collect();
            let largest = |forces: &[f64]| forces.iter().fold(0.0, |a: f64, f| a.max(f.abs()));
            let most = parts.iter().map(|&part| largest(&cases[part].forces)).fold(0.0, f64::max);
            // What is left is a rounding error.
            if !(largest(&forces) > CANCELLED * most) {
                return Err(scene.at(&format!("load[{i}]"), Error::at("sum", "has loads that cancel each other")));
            }
            cases[i].forces = forces;
            let pressed = parts.iter().filter_map(|&part| cases[part].pressed.clone());
            // The parts keep following the body in a sum as well.
            cases[i].pressed = pressed.reduce(|mut all, pressed| {
                all.append(pressed);
                all
            });
        }
    }
    Ok((fixed, cases))
}

/// A displacement that varies agrees with a held point where it differs by at most this share of its largest value: an expression such as
/// `0.1*(x - 0.3)` is zero to rounding.
const ROUNDING: f64 = 1e-12;
/// Loads cancel each other if their sum is smaller than this share of the largest of them. What is left of them is the
/// rounding of the sums over their faces.
const CANCELLED: f64 = 1e-12;

/// What an action does to a body.
struct Acting {
    forces: Vec<f64>,
    support: Support,
    /// The faces on which it is a pressure.
    pressed: Option<PressedFaces>,
    /// The cavity that it fills.
    cavity: Option<Cavity>,
}

/// What the action of a load does. `weights` is what makes a content of a cell a volume or,
/// for accelerations, a mass.
fn acting(
    mesh: &Mesh,
    weights: &CellMap<f64>,
    fixed: &Support,
    (load, part, action): (&LoadCase, &Part, &Action),
) -> Result<Acting> {
    let (d, key) = (mesh.dimension, load.key());
    let entries = match action {
        Action::Traction(v) | Action::Body(v) => v.len(),
        Action::Pressure(_) | Action::Volume(_) => d,
        Action::Force(v) => v.len(),
        Action::Moment(v) if mesh.directors.is_some() => v.len(),
        Action::Moment(_) => {
            let expected = "bending = \"plate\" or \"rod\" in the material: other bodies have no joints or edges that a moment turns";
            return Err(Error::expected(key, expected, "none"));
        }
        Action::Displacement(v) => v.len(),
    };
    if entries != d {
        return Err(Error::expected(key, format!("{d} entries for a mesh of dimension {d}"), entries));
    }
    let uses_z = |c: &Component| matches!(c, Component::Varying(e) if e.uses(2));
    let of_z = match action {
        Action::Traction(v) | Action::Body(v) => v.iter().position(uses_z),
        Action::Displacement(v) => v.iter().position(|c| c.as_ref().is_some_and(uses_z)),
        Action::Pressure(p) => uses_z(p).then_some(0),
        Action::Force(_) | Action::Volume(_) | Action::Moment(_) => None,
    };
    // An expression in z would be evaluated without a third coordinate.
    if let (Some(i), 2) = (of_z, d) {
        let key = if matches!(action, Action::Pressure(_)) { key.to_string() } else { format!("{key}[{i}]") };
        return Err(Error::expected(key, "an expression of x and y in a plane mesh", "z"));
    }
    let selection: Selection = part.selection(d)?;
    let points = selection.points(mesh)?;
    // The part has been checked: any other error is about the load.
    let of_load = |e: Error| match points.is_empty() {
        true => part.without_members(e.problem(), mesh),
        false => Error::new(e.problem()),
    };
    let forces = nodal_forces(mesh, &selection, action, weights).map_err(of_load)?;
    let pressed = match action {
        Action::Pressure(pressure) => Some(PressedFaces::new(mesh, &selection, pressure, weights)?),
        _ => None,
    };
    let cavity = match action {
        Action::Volume(volume) => {
            let cavity =
                Cavity::new(mesh, &selection, *volume, weights, fixed).map_err(|e| match points.is_empty() {
                    true => part.without_members(e.problem(), mesh),
                    false => e,
                })?;
            let moves = |p: usize| (p * d..(p + 1) * d).any(|dof| !fixed.is_fixed(dof));
            if !cavity.sides.points().any(moves) {
                return Err(Error::at(key, "acts on nothing that can move"));
            }
            Some(cavity)
        }
        _ => None,
    };
    let mut support = fixed.clone();
    if let Action::Displacement(given) = action {
        let moved = |p: usize| given.iter().map(move |u| Some(u.as_ref()?.at(mesh.point(p))));
        let largest = points.iter().flat_map(|&p| moved(p)).flatten().fold(0.0, |a: f64, u| a.max(u.abs()));
        let moving = if load.is_clamped() { clamped(mesh, &points)? } else { Vec::new() };
        for &p in points.iter().chain(&moving) {
            for (k, u) in moved(p).enumerate().filter_map(|(k, u)| Some((k, u?))) {
                let dof = p * d + k;
                // A constant is what the user wrote: any difference from zero contradicts the support.
                let rounding = if matches!(given[k], Some(Component::Varying(_))) { ROUNDING * largest } else { 0.0 };
                if let Some(held) = fixed.prescribed[dof] {
                    if (held - u).abs() <= rounding {
                        continue;
                    }
                    let (axis, title, place) = (["x", "y", "z"][k], mesh.point_title(p), mesh.point(p));
                    let problem = format!("moves {title} at {place:?} m along {axis} by {u:?} m, which [[fix]] holds");
                    return Err(Error::at(format!("displacement[{k}]"), problem));
                }
                support.prescribed[dof] = Some(u);
            }
        }
    }
    // A load of zero everywhere is allowed: it is what an expression may come to.
    let acts = |(dof, force): (usize, &f64)| *force != 0.0 && !support.is_fixed(dof);
    if forces.iter().any(|force| *force != 0.0) && !forces.iter().enumerate().any(acts) {
        return Err(Error::at(key, "acts on nothing that can move"));
    }
    Ok(Acting { forces, support, pressed, cavity })
}
