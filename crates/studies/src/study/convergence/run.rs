//! Runs a scene on a sequence of meshes.

use super::levels::plan;
use super::outcome::{Convergence, Level, LoadConvergence, ModelConvergence, Step};
use super::quadratic::Quadratic;
use super::quantities::Quantities;
use super::reference::same_problem;
use crate::analysis::metrics::{displacement_error, product, square};
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::model::{Body, Elastic, Entries, displaced, finite_elements, is_flat, masses};
use crate::study::forecast::LONG;
use crate::study::run::run_with;
use crate::text::time_in_words;
use springfit_scenes::{BODY, Controls, Event, FitOutcome, LoadCase, Outcome, Output, Progress, Scene};
use std::time::Instant;

/// The largest number of levels. Each level has up to eight times as many cells as the previous one.
pub const MOST_LEVELS: usize = 8;
/// The note for bodies whose divided cells do not come nearer to a curved boundary.
const POLYHEDRON: &str = "the body keeps the straight edges of the coarsest mesh on all levels";
/// The note for surfaces in space, whose divided cells do not come nearer to the curved surface.
const FACETS: &str = "the surface keeps the flat cells of the coarsest mesh on all levels";
/// The note for a scene whose body is not that of its reference.
const DIFFERS: &str = "the bodies differ by more than rounding";
/// So many points quadratic elements on the finest level may have, which is some seconds.
const FINEST: usize = 60_000;
/// A fit that takes longer on that level is named, s.
const TOLD: f64 = 1.0;
/// The number of levels if none is requested and memory suffices.
const USUAL_LEVELS: usize = 4;

/// Runs the scene on its mesh and on meshes with cells of half the size each, and compares the compliance under every
/// load.
///
/// A box has twice as many cells in each direction on the next level. The cells of any other mesh are divided as by
/// [`Mesh::refined`], so that the body remains that of the first mesh. Conditions are asked on the first mesh, see [`Mesh::choose`]. Only fits and loads are run: no motion, gauge or
/// output.
///
/// # Errors
/// `levels` is not from 2 to [`MOST_LEVELS`]; the finest mesh is too large; the scene has no loads; or a run on some
/// level fails.
pub fn converge(scene: &Scene, levels: Option<usize>, progress: &mut Progress) -> Result<Convergence> {
    converge_with(scene, None, levels, &mut |_| Ok(()), progress)
}

/// What is done with the results of the levels so far, when one more is there.
pub type EachLevel<'a> = dyn FnMut(&Convergence) -> Result<()> + 'a;

/// Runs the levels as [`converge`] does, or as [`converge_to`] does with a reference; `each` is given the results of the first levels as
/// soon as they are there.
///
/// # Errors
/// A level fails as in [`converge`] and [`converge_to`], or `each` fails.
pub fn converge_with(
    scene: &Scene,
    reference: Option<&Scene>,
    levels: Option<usize>,
    each: &mut EachLevel,
    progress: &mut Progress,
) -> Result<Convergence> {
    match reference {
        None => of_levels(scene, levels, None, each, progress),
        Some(reference) => to_reference(scene, reference, levels, each, progress),
    }
}

/// Runs the levels; `completed` puts in a truth that is known besides them. Without it the truth is that of the finite elements, or of quadratic ones
/// where these lock.
fn of_levels(
    scene: &Scene,
    levels: Option<usize>,
    mut completed: Option<&mut dyn FnMut(&mut Convergence)>,
    each: &mut EachLevel,
    progress: &mut Progress,
) -> Result<Convergence> {
    let scenes = refinements(scene, levels)?;
    let (scene, count) = (&scenes[0], scenes.len());
    if levels.is_none() && count < USUAL_LEVELS {
        progress(Event::Note(&format!("{count} levels are run, for one more would take long; --levels asks for more")));
    }
    let title = scene.title().into();
    let (extent, notes, levels, loads) = Default::default();
    let (law, reference) = (None, None);
    let mut convergence = Convergence { scene: title, extent, law, reference, notes, levels, loads };
    let mut models: Vec<Vec<ModelConvergence>> = Vec::new();
    let mut quadratic: Option<Quadratic> = None;
    for level in 0..count {
        let number = format!("level {} of {count}", level + 1);
        let start = Instant::now();
        let mut staged = |event: Event| match event {
            Event::Stage { name, done, total } => progress(Event::stage(&format!("{number}: {name}"), done, total)),
            Event::Note(_) => progress(event),
        };
        let in_level = |e: Error| e.followed_by(format!(" ({number})"));
        let refined = &scenes[level];
        let controls = Controls { announce: true, ..Controls::default() };
        let outcome = run_with(refined, &controls, &mut staged).map_err(in_level)?;
        let (prescribed, steps) = steps(refined, &outcome).map_err(in_level)?;
        let mut notes = Vec::new();
        if level == 0 && completed.is_none() {
            let found = Quadratic::of(&outcome);
            quadratic = found.map(|(quadratic, note)| {
                notes.push(note);
                quadratic
            });
        }
        // On the cells of a level quadratic elements have as many unknowns as linear ones on the next: those of the finest cells of many levels would take
        // more than all levels together. A limit is extrapolated from three levels.
        let growth = 1 << outcome.mesh.cell_dimension();
        if level + 1 < count || level < 3 && growth * outcome.mesh.point_count() <= FINEST {
            notes.extend(quadratic.as_mut().and_then(|quadratic| quadratic.add(refined, &outcome.mesh, &mut staged)));
        }
        for (load, steps) in steps.into_iter().enumerate() {
            if level == 0 {
                let names = std::iter::once(BODY).chain(outcome.fits.iter().map(|fit| fit.fit.name.as_str()));
                models.push(names.map(|name| ModelConvergence { name: name.into(), steps: Vec::new() }).collect());
            }
            models[load].iter_mut().zip(steps).for_each(|(model, step)| model.steps.push(step));
        }
        let mesh = &outcome.mesh;
        let size =
            convergence.levels.first().map_or_else(|| cell_size(mesh), |first| first.size / 2f64.powi(level as i32));
        let seconds = start.elapsed().as_secs_f64();
        let (cells, points, unknowns) = (mesh.cell_count(), mesh.point_count(), mesh.points.len());
        convergence.levels.push(Level { size, cells, points, unknowns, seconds });
        let counted = if cells == 1 { "1 cell".into() } else { format!("{cells} cells") };
        progress(Event::Note(&format!("{number}: {counted}, {unknowns} unknowns, {seconds:.1} s")));
        if level == 0 {
            convergence.extent = mesh.extent();
            notes.extend(outcome.assumed.iter().chain(&outcome.of_loads).cloned());
            let input = scene.mesh();
            if input.disc.is_some() || input.fill.is_some() {
                notes.push(format!("{POLYHEDRON}, and the truth is that of this body"));
            } else if mesh.dimension == 3 && mesh.cell_dimension() == 2 && !is_flat(mesh) {
                notes.push(format!(
                    "{FACETS}, and the truth is that of this body: a curved one needs finer meshes of its own"
                ));
            }
        }
        notes.iter().for_each(|note| progress(Event::Note(note)));
        convergence.notes.extend(notes);
        // The time grows at least with the number of cells, of which each becomes `2^d`.
        let factor = 2f64.powi(mesh.cell_dimension() as i32);
        if level + 1 < count && factor * seconds > LONG {
            let next = format!("level {} of {count}: {}", level + 2, expected(&outcome, seconds, factor));
            progress(Event::Note(&next));
        }
        convergence.law = outcome.law;
        let loads = scene.loads().iter().zip(&prescribed).zip(&models);
        let of_load = |((load, is_prescribed), models): ((&LoadCase, &bool), &Vec<ModelConvergence>)| {
            LoadConvergence::new(load.name.clone(), *is_prescribed, models.clone())
        };
        convergence.loads = loads.map(of_load).collect();
        if let Some(quadratic) = &quadratic {
            quadratic.judge(&mut convergence.loads);
            convergence.reference = quadratic.name();
        }
        if let Some(completed) = &mut completed {
            completed(&mut convergence);
        }
        each(&convergence)?;
    }
    Ok(convergence)
}

/// The time of a level with so many times the cells of the last one, in words: what grows with the number of cells alone.
fn expected(last: &Outcome, seconds: f64, factor: f64) -> String {
    let of_fit = |fit: &FitOutcome| {
        let seconds = factor * (fit.seconds + fit.seconds_assembly) / rayon::current_num_threads() as f64;
        (seconds > TOLD).then(|| format!("{} for {}", time_in_words(seconds), fit.fit.name))
    };
    let fits: Vec<String> = last.fits.iter().filter_map(of_fit).collect();
    let fits = if fits.is_empty() { String::new() } else { format!(", of which {}", fits.join(", ")) };
    format!("at least {} expected by the last level{fits}", time_in_words(factor * seconds))
}

/// The scenes of all levels: that of the scene, without motion, gauge and output, and others with cells of half the size each.
///
/// # Errors
/// `levels` is not from 2 to [`MOST_LEVELS`] or the finest mesh is too large; the scene has no loads.
pub fn refinements(scene: &Scene, levels: Option<usize>) -> Result<Vec<Scene>> {
    if let Some(levels) = levels.filter(|levels| !(2..=MOST_LEVELS).contains(levels)) {
        return Err(Error::expected("levels", format!("a number from 2 to {MOST_LEVELS}"), levels));
    }
    if scene.loads().is_empty() {
        let problem = "expected at least one [[load]] to converge under, found none";
        return Err(scene.placed(Error::at("load", problem)));
    }
    let scene = scene.clone().without_motion().without_gauge().with_output(Output::default()).judged_by_cells();
    let count = plan(&scene, levels, USUAL_LEVELS)?;
    Ok((0..count).map(|level| scene.clone().halved(level as u32)).collect())
}

/// Runs the levels as [`converge`] does, with the limit from the finite elements of a reference: another scene with this body and these
/// loads, for example one of quadratic cells. If the finite elements of `scene` lock, their limit is far from the solution.
///
/// # Errors
/// Those of [`converge`] for each scene; or the reference has no load with the same name, or another body, material, supports or
/// loads.
pub fn converge_to(
    scene: &Scene,
    reference: &Scene,
    levels: Option<usize>,
    progress: &mut Progress,
) -> Result<Convergence> {
    converge_with(scene, Some(reference), levels, &mut |_| Ok(()), progress)
}

fn to_reference(
    scene: &Scene,
    reference: &Scene,
    levels: Option<usize>,
    each: &mut EachLevel,
    progress: &mut Progress,
) -> Result<Convergence> {
    let names: Vec<&str> = reference.loads().iter().map(|load| load.name.as_str()).collect();
    if let Some(load) = scene.loads().iter().find(|load| !names.contains(&load.name.as_str())) {
        let expected = format!("a load \"{}\" as in the scene", load.name);
        return Err(reference.placed(Error::expected("load", expected, names.join(", "))));
    }
    let differs = same_problem(scene, reference)?;
    let body = reference.clone().with_fits(Vec::new());
    let known = converge(&body, None, &mut |event: Event| match event {
        Event::Stage { name, done, total } => progress(Event::stage(&format!("reference, {name}"), done, total)),
        Event::Note(note) => progress(Event::Note(&format!("reference, {note}"))),
    })?;
    if let Some(differs) = &differs {
        progress(Event::Note(&format!("{DIFFERS}: {differs}")));
    }
    let mut completed = |convergence: &mut Convergence| {
        for load in &mut convergence.loads {
            if let Some(found) = known.loads.iter().find(|found| found.name == load.name) {
                (load.truth, load.mean_truth) = (found.truth, found.mean_truth);
            }
        }
        // With the first level.
        if convergence.reference.is_none() {
            convergence.reference = Some(known.scene.clone());
            convergence.notes.extend(known.notes.iter().map(|note| format!("reference, {note}")));
            convergence.notes.extend(differs.iter().map(|differs| format!("{DIFFERS}: {differs}")));
        }
    };
    of_levels(scene, levels, Some(&mut completed), each, progress)
}

/// The edge of a cube, square or interval with the mean content of the cells, m.
fn cell_size(mesh: &Mesh) -> f64 {
    let content: f64 = masses(mesh, 1.0, 1.0).iter().sum();
    (content / mesh.cell_count().max(1) as f64).powf(1.0 / mesh.cell_dimension() as f64)
}

/// For each load whether it prescribes displacements, and the results of the finite elements and of each fit.
fn steps(scene: &Scene, outcome: &Outcome) -> Result<(Vec<bool>, Vec<Vec<Step>>)> {
    let (mesh, material) = (&outcome.mesh, &outcome.material);
    let quantities = Quantities::of(scene, mesh, material)?;
    let prescribed = quantities.iter().any(Quantities::is_prescribed);
    // Forces at points with prescribed displacements do work only there.
    let energy = scene.laws(mesh, material)?;
    let stiffness =
        |linear: &dyn Fn() -> Entries| if prescribed && energy.is_none() { linear() } else { Entries::new() };
    let body = energy.as_ref().map(|laws| Body::new(mesh, laws));
    let body_stiffness = stiffness(&|| finite_elements(mesh, material.moduli()));
    let mut steps: Vec<Vec<Step>> = Vec::new();
    let compliance = |quantity: &Quantities, u: &[f64], stiffness: &Entries, large: Option<&dyn Elastic>| {
        let value = match large {
            _ if !quantity.is_prescribed() => quantity.work(u),
            Some(model) => {
                let mut force = vec![0.0; u.len()];
                let known = model.forces(&displaced(&mesh.points, u), &mut force);
                return known.then(|| product(&force, u)).filter(|value| value.is_finite());
            }
            None => square(stiffness, u),
        };
        Some(value).filter(|value| value.is_finite())
    };
    for (load, quantity) in outcome.loads.iter().zip(&quantities) {
        let reached = load.is_reached();
        let fem = Some(&load.fem).filter(|_| reached);
        let large = body.as_ref().map(|body| body as &dyn Elastic);
        steps.push(vec![Step {
            compliance: fem.and_then(|u| compliance(quantity, u, &body_stiffness, large)),
            mean_displacement: fem.and_then(|u| quantity.mean_displacement(u)),
            rms: None,
            status: if reached { "solved" } else { "stalled" },
        }]);
    }
    for fit in &outcome.fits {
        let network_stiffness = stiffness(&|| fit.network.stiffness(&mesh.points));
        let large = energy.as_ref().map(|_| &fit.network as &dyn Elastic);
        for (i, (load, quantity)) in fit.loads.iter().zip(&quantities).enumerate() {
            let u = load.displacement.as_deref();
            let body = &outcome.loads[i].fem;
            let against =
                |u: &Vec<f64>| steps[i][0].compliance.and_then(|_| displacement_error(body, u, mesh.dimension));
            let rms = u.and_then(against).map(|error| error.rms);
            steps[i].push(Step {
                compliance: u.and_then(|u| compliance(quantity, u, &network_stiffness, large)),
                mean_displacement: u.and_then(|u| quantity.mean_displacement(u)),
                rms,
                status: fit.status(),
            });
        }
    }
    Ok((quantities.iter().map(Quantities::is_prescribed).collect(), steps))
}
