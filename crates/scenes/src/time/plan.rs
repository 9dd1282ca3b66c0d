//! The motion and the vibrations of a scene, checked on its mesh before any work is done.

use super::frequencies::natural_frequencies;
use super::harmonic::dynamic_moduli;
use super::motion::{Planned, move_models};
use super::relaxing::Relaxing;
use crate::dynamics::{Curve, Drive};
use crate::error::{Error, Result};
use crate::material::{CellMap, EnergyMap, MaterialMap, Relaxation};
use crate::mesh::Mesh;
use crate::model::{Action, Support, lumped_masses, nodal_forces};
use crate::outcome::{Outcome, TimedForce, TimedPull};
use crate::progress::Progress;
use crate::range;
use crate::scene::{AppliedForce, MotionRecipe, Part, PrescribedMotion, Scene};
use crate::symbolic::{Expr, Program};

/// The largest number of bytes of displacements that are kept until they are written or compared.
const MOST_BYTES: f64 = 4e9;
/// The largest number of times at which a curve is evaluated to check that it is finite.
const TRIALS: usize = 100_000;

/// The motion and the vibrations that a scene requests.
pub struct TimePlan {
    /// The `[[fix]]` support.
    support: Support,
    motion: Option<Planned>,
    /// What becomes of stress, if moduli are wanted over frequency and it relaxes.
    relaxing: Option<Relaxing>,
}

impl TimePlan {
    /// Checks the motion and the vibrations of a scene on its mesh.
    ///
    /// # Errors
    /// A part of the mesh is empty or unknown, a list has the wrong length, a driven degree of freedom is held, a
    /// point that moves has no mass, or the material does not relax so. `held` says of each point whether every load holds it.
    pub fn of(
        scene: &Scene,
        mesh: &Mesh,
        (material, laws): (&MaterialMap, Option<&EnergyMap>),
        support: &Support,
        held: Vec<bool>,
    ) -> Result<TimePlan> {
        let at = |e: Error| e.placed(|e| scene.at("motion", e));
        let plan = |recipe: &MotionRecipe| planned(scene, recipe, mesh, material, support).map_err(at);
        let mut motion = scene.motion().map(plan).transpose()?;
        let has_moduli = scene.output().dynamic_moduli.is_some();
        let mut relaxes = None;
        if let (true, Some((key, relaxation))) = (motion.is_some() || has_moduli, scene.relaxation()) {
            for (region, series) in relaxation.iter().enumerate().filter(|_| laws.is_some()) {
                let at = |e: Error| scene.at(&scene.relaxation_key(region), e);
                series.iter().try_for_each(Relaxation::check_large).map_err(at)?;
            }
            let relaxing = Relaxing::new(relaxation, material, laws, scene.fits(), held);
            let relaxing = relaxing.map_err(|e| scene.at(&key, e))?;
            relaxes = has_moduli.then(|| relaxing.clone());
            if let Some(motion) = &mut motion {
                motion.relaxing = Some(relaxing);
            }
        }
        Ok(TimePlan { support: support.clone(), motion, relaxing: relaxes })
    }

    /// Moves the finite elements and the networks of `outcome` and computes their frequencies and moduli, as far as the scene
    /// requests it.
    ///
    /// # Errors
    /// A step exceeds the limit of an explicit method, or there are fewer frequencies than requested.
    pub fn follow(
        &self,
        scene: &Scene,
        energy: Option<&EnergyMap>,
        outcome: &mut Outcome,
        progress: &mut Progress,
    ) -> Result<()> {
        if scene.output().frequencies > 0 {
            let found = natural_frequencies(scene, &self.support, outcome, progress);
            outcome.frequencies = found.map_err(|e| scene.at("output.frequencies", e))?;
        }
        // A network that does not relax so.
        let place = |e: Error, other: &str| match (e.key(), scene.relaxation()) {
            (Some("terms"), Some((key, _))) => scene.at(&key, e),
            _ => scene.at(other, e),
        };
        if let Some(entry) = &scene.output().dynamic_moduli {
            let frequencies = entry.frequencies().map_err(|e| scene.at("output.dynamic_moduli", e))?;
            let model = (self.relaxing.as_ref(), self.motion.as_ref());
            let found = dynamic_moduli(&frequencies, model, outcome, progress);
            outcome.dynamic_moduli = Some(found.map_err(|e| e.placed(|e| place(e, "output")))?);
        }
        if let Some(planned) = &self.motion {
            let moved = move_models(planned, energy, outcome, progress);
            outcome.motion = Some(moved.map_err(|e| e.placed(|e| place(e, "motion")))?);
        }
        Ok(())
    }
}

fn planned(
    scene: &Scene,
    recipe: &MotionRecipe,
    mesh: &Mesh,
    material: &MaterialMap,
    fixed: &Support,
) -> Result<Planned> {
    let d = mesh.dimension;
    if !(recipe.gravity.is_empty() || recipe.gravity.len() == d) {
        return Err(entries("gravity", d, recipe.gravity.len()));
    }
    // Pictures are drawn at the end, of the states of the body and of every network.
    let kept = if scene.output().has_pictures() { scene.fits().len() + 1 } else { 1 };
    let (state, written) = ((8 * mesh.points.len() * kept) as f64, recipe.written());
    if state * written.len() as f64 > MOST_BYTES {
        let expected = format!("at most {:.0} states, which fill {MOST_BYTES:e} bytes", MOST_BYTES / state);
        return Err(Error::expected("every", expected, written.len()));
    }
    let mut planned = Planned {
        recipe: recipe.clone(),
        support: fixed.clone(),
        drive: Drive::default().gravity(&recipe.gravity),
        masses: lumped_masses(mesh, material.densities(), material.thicknesses(), recipe.lumping),
        forces: Vec::new(),
        pulls: Vec::new(),
        watched: Vec::new(),
        written,
        solver: scene.solver(),
        relaxing: None,
        draws: scene.output().has_pictures(),
    };
    let mut prescribed_by: Vec<Option<usize>> = vec![None; mesh.points.len()];
    for (i, pull) in recipe.pulls.iter().enumerate() {
        add_prescribed_motion(&mut planned, mesh, fixed, i, pull, &mut prescribed_by)
            .map_err(|e| e.under(format!("pull[{i}]")))?;
    }
    for (i, push) in recipe.forces.iter().enumerate() {
        add_force(&mut planned, mesh, &material.thicknesses(), push).map_err(|e| e.under(format!("force[{i}]")))?;
    }
    if let Some(part) = &recipe.watch {
        planned.watched = points(mesh, part).map_err(|e| e.under("watch"))?;
    }
    let moves = |p: usize| (p * d..(p + 1) * d).any(|dof| !planned.support.is_fixed(dof));
    // Row sums of some quadratic cells are zero or negative at corners. The comparison is negated, so that NaN counts
    // as massless.
    let massless = |p: &usize| moves(*p) && !(planned.masses[*p] > 0.0);
    if let Some(p) = (0..mesh.point_count()).find(massless).filter(|_| !recipe.options.quasi_static) {
        let expected = "a mass above zero at every point that moves (\"hrz\" gives one)";
        return Err(Error::expected(
            "mass",
            expected,
            format!("{:e} kg at {}", planned.masses[p], mesh.point_title(p)),
        ));
    }
    Ok(planned)
}

fn entries(key: &str, d: usize, found: usize) -> Error {
    Error::expected(key, format!("{d} entries for a mesh of dimension {d}"), found)
}

fn points(mesh: &Mesh, part: &Part) -> Result<Vec<usize>> {
    let points = part.selection(mesh.dimension)?.points(mesh)?;
    match points.is_empty() {
        true => Err(Error::new("the selected part has no points")),
        false => Ok(points),
    }
}

/// Adds the `[[motion.pull]]` with the number `index`.
fn add_prescribed_motion(
    planned: &mut Planned,
    mesh: &Mesh,
    fixed: &Support,
    index: usize,
    pull: &PrescribedMotion,
    prescribed_by: &mut [Option<usize>],
) -> Result<()> {
    let d = mesh.dimension;
    if pull.displacement.len() != d {
        return Err(entries("displacement", d, pull.displacement.len()));
    }
    let points = points(mesh, &pull.part)?;
    let mut largest = 0.0f64;
    for (k, expression) in pull.displacement.iter().enumerate() {
        let Some(expression) = expression else { continue };
        let key = format!("displacement[{k}]");
        if d == 2 && expression.uses(3) {
            return Err(Error::expected(key, "an expression of t, x and y in a plane mesh", "z"));
        }
        let still = *expression == Expr::integer(0);
        let varies = (1..=d).any(|k| expression.uses(k));
        let program = Program::of(expression);
        // A curve of time alone is the same at all points, and is made and checked once.
        let mut shared: Option<Curve> = None;
        let mut moved = Vec::new();
        for &p in &points {
            let dof = p * d + k;
            let moves = |by: &str| {
                let axis = ["x", "y", "z"][k];
                Error::at(
                    &key,
                    format!("moves {} at {:?} m along {axis}, which {by}", mesh.point_title(p), mesh.point(p)),
                )
            };
            if fixed.is_fixed(dof) {
                // A displacement of zero repeats what the support says already.
                if still {
                    continue;
                }
                return Err(moves("[[fix]] holds"));
            }
            if let Some(other) = prescribed_by[dof].replace(index) {
                return Err(moves(&format!("motion.pull[{other}] moves")));
            }
            let curve = match &shared {
                Some(curve) => curve.clone(),
                None => {
                    let mut at = [0.0; 4];
                    at[1..=d].copy_from_slice(mesh.point(p));
                    let program = program.clone();
                    // An expression has the time first, and then the place at rest.
                    let curve = Curve::new(move |t| program.evaluate(&[t, at[1], at[2], at[3]]));
                    let size = size(planned, &curve, points.len(), 1).map_err(|e| e.under(&key))?;
                    largest = largest.max(size);
                    if !varies {
                        shared = Some(curve.clone());
                    }
                    curve
                }
            };
            moved.push(p);
            // The drive gives the value at each time. The support only says that the direction is held.
            planned.support.prescribed[dof] = Some(0.0);
            planned.drive = std::mem::take(&mut planned.drive).displacement(dof, curve);
        }
        let curve = expression.text(&["t", "x", "y", "z"]);
        planned.pulls.push(TimedPull { axis: k, curve, points: moved });
    }
    range::largest("displacement", [largest], "m")
}

/// Adds one `[[motion.force]]`.
fn add_force(planned: &mut Planned, mesh: &Mesh, thicknesses: &CellMap<f64>, push: &AppliedForce) -> Result<()> {
    let d = mesh.dimension;
    if push.force.len() != d {
        return Err(entries("force", d, push.force.len()));
    }
    let (points, selection) = (points(mesh, &push.part)?, push.part.selection(d)?);
    let (mut felt, mut largest) = (false, 0.0f64);
    for (k, expression) in push.force.iter().enumerate() {
        let curve = Curve::of(expression)?;
        largest = largest.max(size(planned, &curve, 1, 0).map_err(|e| e.under(format!("force[{k}]")))?);
        if *expression == Expr::integer(0) {
            continue;
        }
        let mut forces = vec![0.0; mesh.points.len()];
        match push.each {
            true => points.iter().for_each(|p| forces[p * d + k] = 1.0),
            false => {
                let unit = (0..d).map(|l| if l == k { 1.0 } else { 0.0 }).collect();
                let shared = nodal_forces(mesh, &selection, &Action::Force(unit), thicknesses);
                forces = shared.map_err(|e| Error::new(e.problem()))?;
            }
        }
        let shares = (0..mesh.point_count()).map(|p| (p, forces[p * d + k])).filter(|(_, share)| *share != 0.0);
        planned.forces.push(TimedForce { axis: k, curve: expression.text(&["t"]), shares: shares.collect() });
        // A force on held points alone would leave the body at rest without a word.
        felt |= forces.iter().enumerate().any(|(dof, f)| *f != 0.0 && !planned.support.is_fixed(dof));
        planned.drive = std::mem::take(&mut planned.drive).forces(&forces, curve);
    }
    match felt {
        true => range::largest("force", [largest], "N"),
        false => Err(Error::at("force", "acts on nothing that can move")),
    }
}

/// The largest absolute value of a curve, one of `count`, at the times at which steps use it: up to `beyond` half steps
/// after the end, from which a pull takes its velocity.
///
/// # Errors
/// It is not finite somewhere, or exceeds the range of quantities.
fn size(planned: &Planned, curve: &Curve, count: usize, beyond: usize) -> Result<f64> {
    let (h, halves) = (planned.recipe.options.step, 2 * planned.recipe.steps + beyond);
    let trials = (TRIALS / count.max(1)).max(100);
    let stride = halves.div_ceil(trials);
    // The end is a time of its own, because the stride need not divide the number of half steps.
    let mut times = (0..=halves).step_by(stride).chain([halves]).map(|i| i as f64 * h / 2.0);
    let mut largest = 0.0f64;
    let beyond_range = |t: &f64| {
        largest = largest.max(curve.at(*t).abs());
        // The comparison is negated, so that NaN is found too.
        !(curve.at(*t).abs() <= range::LARGEST)
    };
    let Some(t) = times.find(beyond_range) else { return Ok(largest) };
    // Without the last digits, which half steps change.
    let shown: f64 = format!("{t:.9e}").parse().unwrap_or(t);
    // The sum of half steps is the duration up to rounding.
    let after = if t > planned.recipe.duration * (1.0 + 1e-9) { ", half a step after the end" } else { "" };
    let expected = format!("finite values of at most {:e} in size at all times of the motion", range::LARGEST);
    Err(Error::new(format!("expected {expected}, found {} at {shown} s{after}", curve.at(t))))
}
