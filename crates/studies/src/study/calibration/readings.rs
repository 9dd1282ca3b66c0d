//! What was measured under the loads of a scene, as observations of places and parts of the body.

use crate::calibration::{Observation, Quantity};
use crate::error::{Error, Result};
use crate::mesh::{Mesh, Scattered};
use crate::model::Support;
use crate::named::unknown;
use springfit_scenes::{Reaction, Scene};
use std::collections::BTreeMap;
use std::path::Path;

/// What was measured under a load.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Seen {
    /// The displacements.
    pub displacements: Scattered,
    /// The standard deviation of their noise, m.
    pub sigma: Option<f64>,
    /// The forces.
    pub reactions: Vec<Reaction>,
}

/// What was measured, by the name of the load. Loads of the scene that are not here have what their keys say.
pub type Readings = BTreeMap<String, Seen>;

/// A place beyond the surface of the mesh by more than this multiple of its cell, about the middle of the cell, is outside.
// Of the multiples that an embedding tries 1.08 is the last below this one, and 1.2 the next above it.
const OUTSIDE: f64 = 1.1;

/// All observations, with the places and parts that they name.
#[derive(Debug, Default)]
pub(super) struct Observed {
    /// The loads, by their numbers in the scene.
    pub loads: Vec<usize>,
    /// The observations; their loads are places in `loads`.
    pub observations: Vec<Observation>,
    /// The places, `[places × dimension]`, m.
    pub places: Vec<f64>,
    /// The groups whose forces were measured.
    pub parts: Vec<String>,
    /// How far what was measured of what is held is from where it is held, m, with the place of its load in `loads`.
    pub held: Vec<(usize, f64)>,
}

/// What was measured under a load of the scene.
///
/// # Errors
/// A file is wrong, or a key names no group.
fn of_scene(scene: &Scene, mesh: &Mesh, load: usize) -> Result<Seen> {
    let case = &scene.loads()[load];
    let at = |e: Error| scene.at(&format!("load[{load}]"), e);
    let mut seen = Seen { reactions: case.reactions.clone(), ..Seen::default() };
    if let Some(entry) = &case.measured {
        let path = scene.path().parent().unwrap_or(Path::new("")).join(&entry.file);
        let found = Scattered::read(&path, mesh, entry.scale, entry.array.as_deref());
        seen.displacements = found.map_err(|e| e.under("measured").placed(at))?;
        seen.sigma = entry.sigma;
    }
    Ok(seen)
}

impl Observed {
    /// Whether forces were measured.
    pub fn has_forces(&self) -> bool {
        self.observations.iter().any(|seen| matches!(seen.quantity, Quantity::Force { .. }))
    }

    /// The largest component of the displacements, m.
    pub fn largest(&self) -> f64 {
        let of = |seen: &&Observation| matches!(seen.quantity, Quantity::Displacement { .. });
        self.observations.iter().filter(of).fold(0.0, |most, seen| most.max(seen.value.abs()))
    }

    /// The observations of a scene.
    ///
    /// # Errors
    /// Nothing was measured under a load that is named, or anywhere; or a value is wrong.
    pub fn of(
        scene: &Scene,
        mesh: &Mesh,
        supports: &[Support],
        given: &Readings,
        wanted: Option<&[String]>,
    ) -> Result<Observed> {
        let names = || scene.loads().iter().map(|load| load.name.as_str());
        for name in given.keys().chain(wanted.into_iter().flatten()) {
            if names().all(|known| known != name) {
                let expected = format!("loads of the scene ({})", names().collect::<Vec<_>>().join(", "));
                return Err(unknown(expected, names(), name).at_key("loads"));
            }
        }
        let d = mesh.dimension;
        let mut all = Observed::default();
        let mut known_places: std::collections::HashMap<Vec<u64>, usize> = std::collections::HashMap::new();
        for (number, load) in scene.loads().iter().enumerate() {
            let is_named = wanted.map(|wanted| wanted.contains(&load.name));
            if is_named == Some(false) {
                continue;
            }
            let seen = match given.get(&load.name) {
                Some(seen) => seen.clone(),
                None => of_scene(scene, mesh, number)?,
            };
            let at = |key: &str, expected: &str, found: String| {
                Error::expected(format!("measured of \"{}\"", load.name), expected, format!("{found}{key}"))
            };
            if seen.displacements.places.is_empty() && seen.reactions.is_empty() {
                if is_named == Some(true) {
                    return Err(at("", "displacements or forces", "none".into()));
                }
                continue;
            }
            let own = all.loads.len();
            all.loads.push(number);
            if let Some(sigma) = seen.sigma.filter(|sigma| !(*sigma > 0.0 && sigma.is_finite())) {
                return Err(at("", "a sigma above zero, m", format!("{sigma}")));
            }
            let held = held_places(mesh, &supports[number]);
            let rows = seen.displacements.places.chunks_exact(d).zip(seen.displacements.displacements.chunks_exact(d));
            for (place, moved) in rows {
                // A place that is seen under several loads is written with the same digits in each file, and has the
                // same bits. Floats have no hash, and a tolerance would need a search for each place.
                let bits = bits_of(place);
                let next = all.places.len() / d;
                let index = *known_places.entry(bits.clone()).or_insert(next);
                if index == next {
                    all.places.extend(place);
                }
                for (axis, value) in moved.iter().enumerate() {
                    let Some(value) = *value else { continue };
                    // What is held has no displacement to explain: a modulus does not move it.
                    if let Some(place) = held.get(&bits).and_then(|held| held[axis]) {
                        all.held.push((own, value - place));
                        continue;
                    }
                    let quantity = Quantity::Displacement { place: index, axis };
                    all.observations.push(Observation { load: own, quantity, value, sigma: seen.sigma });
                }
            }
            for reaction in &seen.reactions {
                let groups = || mesh.groups.keys().map(String::as_str);
                let Some(group) = mesh.groups.get(&reaction.group) else {
                    let expected = format!("groups of the mesh ({})", groups().collect::<Vec<_>>().join(", "));
                    return Err(unknown(expected, groups(), &reaction.group).at_key("reactions"));
                };
                if reaction.force.len() != d {
                    return Err(at(" in a force", &format!("{d} components"), reaction.force.len().to_string()));
                }
                let part = match all.parts.iter().position(|name| *name == reaction.group) {
                    Some(part) => part,
                    None => {
                        all.parts.push(reaction.group.clone());
                        all.parts.len() - 1
                    }
                };
                for (axis, value) in reaction.force.iter().enumerate() {
                    let Some(value) = *value else { continue };
                    let is_held = |p: &usize| supports[number].is_fixed(p * d + axis);
                    // The force on a free point is that of the load, whatever the moduli: it says nothing of them.
                    if !group.points.iter().all(is_held) {
                        let expected = "forces on groups that are held or moved in their direction";
                        let found = format!("\"{}\", which is free along {}", reaction.group, ["x", "y", "z"][axis]);
                        return Err(at("", expected, found));
                    }
                    let quantity = Quantity::Force { part, axis };
                    all.observations.push(Observation { load: own, quantity, value, sigma: reaction.sigma });
                }
            }
        }
        if let Some(own) = (0..all.loads.len()).find(|own| all.observations.iter().all(|seen| seen.load != *own)) {
            let key = format!("measured of \"{}\"", scene.loads()[all.loads[own]].name);
            let found =
                if all.held.iter().any(|(load, _)| *load == own) { "those of what is held alone" } else { "none" };
            return Err(Error::expected(key, "displacements of what may move, or forces", found));
        }
        if all.observations.is_empty() {
            let expected = "loads with measured displacements or forces, as measured = { file = \"…\" } or reactions in a [[load]]";
            return Err(Error::expected("load", expected, "none").in_file(scene.path()));
        }
        Ok(all)
    }

    /// That all places are in the body.
    ///
    /// # Errors
    /// One is not.
    pub fn check_inside(&self, dimension: usize, multiples: &[f64]) -> Result<()> {
        let Some(place) = multiples.iter().position(|multiple| *multiple > OUTSIDE) else { return Ok(()) };
        let x = &self.places[place * dimension..(place + 1) * dimension];
        let found = format!("one at {x:?} m, outside of it");
        Err(Error::expected("measured", "places in the body", found))
    }

    /// 1/σ of each observation. Where noise is not known it is that of a noise in proportion to the root mean square of all displacements, or of
    /// all forces, under the load.
    ///
    /// # Errors
    /// The noise of some is known, and of others it is not; or a load has moved nothing.
    pub fn weights(&self) -> Result<(Vec<f64>, bool)> {
        let known = self.observations.iter().filter(|observation| observation.sigma.is_some()).count();
        // Residuals over σ have the variance one, those over the size of the displacements have another: a sum of both
        // squares has no known distribution.
        if known != 0 && known != self.observations.len() {
            let found = format!("it for {known} of {} numbers", self.observations.len());
            return Err(Error::expected("sigma", "the noise of all measurements, or of none", found));
        }
        let size = |load: usize, force: bool| {
            // Forces and displacements have different units, so that each has a size of its own.
            let own = self.observations.iter().filter(|o| o.load == load && o.quantity.is_force() == force);
            let (sum, count) = own.fold((0.0, 0), |(sum, count), o| (sum + o.value * o.value, count + 1));
            (sum / f64::from(count).max(1.0)).sqrt()
        };
        let mut sizes = BTreeMap::new();
        let weights = self.observations.iter().map(|o| match o.sigma {
            Some(sigma) => Ok(1.0 / sigma),
            None => {
                let key = (o.load, o.quantity.is_force());
                let size = *sizes.entry(key).or_insert_with(|| size(key.0, key.1));
                if size > 0.0 {
                    Ok(1.0 / size)
                } else {
                    Err(Error::expected(
                        "measured",
                        "loads under which something moves",
                        "one under which nothing does",
                    ))
                }
            }
        });
        Ok((weights.collect::<Result<_>>()?, known != 0))
    }
}

/// A place as a key; both zeros are one place.
fn bits_of(place: &[f64]) -> Vec<u64> {
    place.iter().map(|x| (x + 0.0).to_bits()).collect()
}

/// Where points of a mesh are held, in the directions in which they are, by their coordinates.
fn held_places(mesh: &Mesh, support: &Support) -> std::collections::HashMap<Vec<u64>, Vec<Option<f64>>> {
    let d = mesh.dimension;
    let held = (0..mesh.point_count()).filter_map(|p| {
        let own = support.prescribed[p * d..(p + 1) * d].to_vec();
        own.iter().any(Option::is_some).then(|| (bits_of(mesh.point(p)), own))
    });
    held.collect()
}
