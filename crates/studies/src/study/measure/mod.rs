//! What a network is as a material and as a body, whoever made it.
//!
//! Theory: page *Lattices* of the book.

mod engine;
mod hull;
mod motions;
mod outcome;

pub use outcome::{MeasuredNetwork, MeasuredRegion, NetworkStability};

use crate::analysis::homogenise::{Elasticity, Tension, affine, of_body, of_period, of_points};
use crate::engine::Setting;
use crate::error::{Error, ErrorKind, Result};
use crate::material::{CellMap, Plane, State};
use crate::mesh::Mesh;
use crate::model::{Lumping, Specimen, content, lumped_masses};
use hull::Hull;
use motions::{Motions, parts};
use springfit_scenes::EngineLimit;

/// How a network is measured.
#[derive(Debug, Clone, Default)]
pub struct MeasureOptions {
    /// The volume of the whole network, m³; in the plane its area, m².
    pub volume: Option<f64>,
    /// The volume is that of the convex hull of the points.
    pub hull: bool,
    /// The volume of each point, m³; in the plane its area, m².
    pub point_volumes: Option<Vec<f64>>,
    /// The state of a plane network; plane stress without one.
    pub state: Option<State>,
    /// Parts of the network by name, and whether each point is in them.
    pub regions: Vec<(String, Vec<bool>)>,
    /// So many frequencies are sought.
    pub frequencies: usize,
    /// The settings of an engine whose limit is sought.
    pub engine: Option<Setting>,
    /// The settings of the engine to which the constants belong.
    pub of_engine: Option<Setting>,
    /// The density of a network without masses, kg/m³; in the plane without a thickness kg/m².
    pub density: Option<f64>,
}

impl MeasureOptions {
    /// The state of a plane network: as it is asked for, or as its file says it; plane stress and 1 m where one of both is known alone, and `None`
    /// where neither is.
    pub fn plane_state(plane: Option<Plane>, thickness: Option<f64>, own: Option<(Plane, f64)>) -> Option<State> {
        if plane.is_none() && thickness.is_none() && own.is_none() {
            return None;
        }
        let thickness = thickness.or(own.map(|own| own.1)).unwrap_or(1.0);
        Some(plane.or(own.map(|own| own.0)).unwrap_or(Plane::Stress).state(thickness))
    }
}

/// The content of a network, m³ or m².
struct Content {
    value: f64,
    of: &'static str,
    /// Whether each point follows a strain of the boundary, where that is known.
    boundary: Option<Vec<bool>>,
}

/// Measures a network: its elasticity tensor, affine and relaxed, of the whole and of regions; density, tension at rest, stability, lowest
/// frequencies, longest step, and the limit of an engine.
///
/// # Errors
/// The volume is not known (key `volume`); a region, a density or an engine does not go with the network; or the equations do not fit into
/// memory.
pub fn measure(specimen: &Specimen, options: &MeasureOptions) -> Result<MeasuredNetwork> {
    let d = specimen.network.dimension;
    let state = options.state.unwrap_or(match d {
        1 => State::Rod { area: 1.0 },
        2 => State::PlaneStress { thickness: 1.0 },
        _ => State::Solid,
    });
    if state.dimension() != d {
        return Err(Error::expected("plane", format!("a state of a network of {d} dimensions"), "another"));
    }
    let mut notes = Vec::new();
    let specimen = &with_masses(specimen, options, state, &mut notes)?;
    let content = content_of(specimen, options)?;
    let volume = content.value * state.thickness();
    let whole = affine(specimen, volume);
    if !whole.iter().all(|c| c.is_finite()) {
        return Err(
            Error::expected("springs", "a stiffness of numbers", "one that is not finite").of_kind(ErrorKind::Limit)
        );
    }
    if specimen.period.is_some() && specimen.masses.is_some() {
        notes.push("the longest step is that of motions which repeat with the period: waves of a larger piece may need a shorter one".into());
    }
    if options.state.is_none() && d == 2 {
        notes.push("no thickness is known: figures are those of a network that is 1 m thick".into());
    }
    if let Some(setting) = options.of_engine.as_ref() {
        notes.push(format!(
            "the constants belong to {}, where the network answers in another way: moduli and frequencies are those of equations that are solved to the end",
            setting.words()
        ));
    }
    let tension = Tension::of(specimen, volume);
    notes.extend(tension_note(tension.as_ref()));
    let relaxed = match (&specimen.period, &content.boundary) {
        (Some(_), _) => Some(of_period(specimen, volume)),
        (None, Some(boundary)) => Some(of_body(specimen, boundary, volume)),
        (None, None) => {
            notes.push("which points are the boundary is not known without cells: no relaxed material".into());
            None
        }
    };
    let relaxed = match relaxed.transpose() {
        Ok(relaxed) => relaxed,
        Err(error) if error.kind() == ErrorKind::Infeasible => {
            notes.push(format!("no relaxed material: {}", error.problem()));
            None
        }
        Err(error) => return Err(error),
    };
    if relaxed.as_ref().is_some_and(|(_, is_stable)| !is_stable) {
        notes
            .push("some motion of the points that give way releases energy: the relaxed material is no minimum".into());
    }
    let relaxed = relaxed.map(|(c, _)| Elasticity::of(&c, state));
    let alone = parts(specimen).iter().filter(|part| part.len() == 1).count();
    if alone > 0 && specimen.period.is_none() {
        notes.push(format!("{alone} points have no spring"));
    }
    let motions = Motions::of(specimen)?;
    let masses = specimen.masses.as_deref();
    let stability = motions.stability(masses)?;
    let frequencies = match masses.filter(|_| specimen.period.is_none() && options.frequencies > 0) {
        Some(masses) => match motions.frequencies(masses, &stability, options.frequencies) {
            Ok(found) => found,
            Err(error) => {
                notes.push(format!("no frequencies: {}", error.problem()));
                None
            }
        },
        None => None,
    };
    let affine = Elasticity::of(&whole, state);
    let young = relaxed.as_ref().unwrap_or(&affine).young;
    let engine = match &options.engine {
        Some(setting) => {
            let (limit, words) = engine::engine_limit(specimen, young, setting)?;
            notes.push(match &limit {
                Some(limit) => format!(
                    "for {}, {words}: {}",
                    setting.words(),
                    limit.words("the network, as solved equations have it,").unwrap_or_default()
                ),
                None => format!("for {}: {}", setting.words(), EngineLimit::NONE),
            });
            limit
        }
        None => None,
    };
    let mass = masses.map(|masses| masses.iter().sum::<f64>());
    Ok(MeasuredNetwork {
        dimension: d,
        points: specimen.count(),
        springs: specimen.network.len(),
        negative_springs: specimen.network.negative(),
        volume,
        volume_of: content.of.into(),
        mass,
        density: mass.map(|mass| mass / volume),
        tension,
        affine,
        relaxed,
        regions: regions(specimen, options, state)?,
        // Where a motion releases energy no step is stable.
        longest_step: masses.filter(|_| stability.releasing == 0).and_then(|masses| motions.longest_step(masses)),
        stability,
        frequencies,
        engine,
        notes,
    })
}

/// What must be told of springs that pull at rest.
fn tension_note(tension: Option<&Tension>) -> Option<String> {
    let Some(tension) = tension else {
        return Some("a spring of no length has no direction: the forces at rest are not known".into());
    };
    if tension.springs == 0 {
        return None;
    }
    let of = format!("{} springs pull at rest, with {:.3e} N at most", tension.springs, tension.largest);
    Some(match tension.is_balanced() {
        true => format!("{of}; their forces balance each other"),
        false => format!(
            "{of}, and their forces leave {:.1} % of them at some point: the network is not at rest in this shape, and what follows is of its \
             stiffness here",
            100.0 * tension.unbalanced
        ),
    })
}

/// The network with masses, by a density where it has none.
fn with_masses(
    specimen: &Specimen,
    options: &MeasureOptions,
    state: State,
    notes: &mut Vec<String>,
) -> Result<Specimen> {
    let mut specimen = specimen.clone();
    let Some(density) = options.density else { return Ok(specimen) };
    if specimen.masses.is_some() {
        notes.push("the masses are those of the density that is given, in place of those of the network".into());
    }
    if !(density > 0.0 && density.is_finite()) {
        return Err(Error::expected("density", "a density above zero, kg/m³", density));
    }
    let count = specimen.count();
    let masses = match (&options.point_volumes, filled(&specimen), &specimen.period) {
        (Some(volumes), ..) => {
            check_volumes(&specimen, volumes)?;
            volumes.iter().map(|volume| density * volume * state.thickness()).collect()
        }
        (None, Some(mesh), _) => {
            let thickness = CellMap::Uniform(state.thickness());
            lumped_masses(mesh, CellMap::Uniform(density), thickness, Lumping::Hrz)
        }
        // All points of a lattice weigh the same.
        (None, None, Some(period)) => {
            vec![density * period.cell.determinant().abs() * state.thickness() / count as f64; count]
        }
        (None, None, None) => {
            let expected = "a network with cells, or with a volume of each point, which shares the mass among them";
            return Err(Error::expected("density", expected, "neither"));
        }
    };
    specimen.masses = Some(masses);
    Ok(specimen)
}

/// The cells, if they fill their space.
fn filled(specimen: &Specimen) -> Option<&Mesh> {
    specimen.mesh.as_ref().filter(|mesh| mesh.cell_dimension() == mesh.dimension)
}

fn content_of(specimen: &Specimen, options: &MeasureOptions) -> Result<Content> {
    let d = specimen.network.dimension;
    let positive = |value: f64| match value > 0.0 && value.is_finite() {
        true => Ok(value),
        false => Err(Error::expected("volume", "a number above zero", value)),
    };
    let mesh = filled(specimen);
    let boundary = mesh.map(Mesh::outer_points);
    if let Some(period) = &specimen.period {
        if let Some(volume) = options.volume {
            let expected = "none of a network that repeats itself, whose period has one";
            return Err(Error::expected("volume", expected, volume));
        }
        return Ok(Content { value: period.cell.determinant().abs(), of: "period", boundary: None });
    }
    if let Some(volume) = options.volume {
        return Ok(Content { value: positive(volume)?, of: "given", boundary });
    }
    if let Some(volumes) = &options.point_volumes {
        check_volumes(specimen, volumes)?;
        return Ok(Content { value: positive(volumes.iter().sum())?, of: "points", boundary });
    }
    if let Some(mesh) = mesh.filter(|_| !options.hull) {
        return Ok(Content { value: content(mesh), of: "cells", boundary });
    }
    if options.hull {
        let flat =
            || Error::expected("volume", "points whose convex hull has a volume", "points on a line or in a plane");
        let Hull { content, is_outer } = Hull::of(&specimen.points, d).ok_or_else(flat)?;
        return Ok(Content { value: content, of: "hull", boundary: Some(is_outer) });
    }
    let expected = "the volume of the network, which has no cells that fill it: a number in m³ (in the plane an area in m²), or that of the convex \
                    hull";
    Err(Error::expected("volume", expected, "none"))
}

fn check_volumes(specimen: &Specimen, volumes: &[f64]) -> Result<()> {
    if volumes.len() != specimen.count() {
        return Err(Error::expected(
            "volumes",
            format!("{} numbers, one of each point", specimen.count()),
            volumes.len(),
        ));
    }
    match volumes.iter().position(|volume| !(*volume >= 0.0 && volume.is_finite())) {
        Some(p) => Err(Error::expected(format!("volumes[{p}]"), "a number of at least zero", volumes[p])),
        None => Ok(()),
    }
}

/// The content of each point: its own, or its share of the cells around it.
fn shares(specimen: &Specimen, options: &MeasureOptions) -> Result<Vec<f64>> {
    let count = specimen.count();
    match (&options.point_volumes, filled(specimen), &specimen.period) {
        (Some(volumes), ..) => check_volumes(specimen, volumes).map(|()| volumes.clone()),
        (None, Some(mesh), _) => Ok(lumped_masses(mesh, CellMap::Uniform(1.0), CellMap::Uniform(1.0), Lumping::Hrz)),
        (None, None, Some(period)) => Ok(vec![period.cell.determinant().abs() / count as f64; count]),
        (None, None, None) => {
            let expected = "cells, or a volume of each point, by which a region has a volume";
            Err(Error::expected("regions", expected, "neither"))
        }
    }
}

fn regions(specimen: &Specimen, options: &MeasureOptions, state: State) -> Result<Vec<MeasuredRegion>> {
    if options.regions.is_empty() {
        return Ok(Vec::new());
    }
    let shares = shares(specimen, options)?;
    let region = |(name, part): &(String, Vec<bool>)| {
        let key = || format!("regions.{name}");
        if part.len() != specimen.count() {
            return Err(Error::expected(key(), format!("a flag of each of {} points", specimen.count()), part.len()));
        }
        let points = part.iter().filter(|inside| **inside).count();
        let own = shares.iter().zip(part).filter(|(_, inside)| **inside).map(|(share, _)| share);
        let volume = own.sum::<f64>() * state.thickness();
        if !(points > 0 && volume > 0.0) {
            return Err(Error::expected(key(), "points with a volume", format!("{points} points")));
        }
        let affine = Elasticity::of(&of_points(specimen, part, volume), state);
        Ok(MeasuredRegion { name: name.clone(), points, volume, affine })
    };
    options.regions.iter().map(region).collect()
}
