//! Runs a scene: fits each objective, solves each load with both models, and compares them.

use super::body::{Case, FineBody, Gauged, LargeBody, LinearBody, load_cases, load_notes};
use super::checkpoint::Controls;
use super::fits::{Finer, Reference, WholeBody};
use super::fitting::{fit_mesh, fit_without_errors};
use super::forecast::Forecast;
use super::masses::point_masses;
use super::outcome::{BodyLoad, Outcome};
use super::progress::{Event, Progress};
use super::scene::Scene;
use super::stages::stages;
use super::time::TimePlan;
use crate::analysis::moduli::moduli_of_body;
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::model::{Deformation, Support};

/// Runs the scene. Only the work that the scene requests is done.
///
/// # Errors
/// An input is wrong: a group, a support, a load or the mesh. A network that is not stable is not an error.
pub fn run(scene: &Scene, progress: &mut Progress) -> Result<Outcome> {
    run_with(scene, &Controls::default(), progress)
}

/// As [`run`]; whole-object fits can be cancelled and continued.
///
/// # Errors
/// Those of [`run`]; or the checkpoint is wrong or cannot be written.
pub fn run_with(scene: &Scene, controls: &Controls, progress: &mut Progress) -> Result<Outcome> {
    worked_out(scene, controls, progress).map_err(|e| scene.with_line(e))
}

fn worked_out(scene: &Scene, controls: &Controls, progress: &mut Progress) -> Result<Outcome> {
    controls.check()?;
    let mesh = scene.build_mesh()?;
    let material = &scene.material_of(&mesh)?;
    drawable(scene, &mesh)?;
    let (support, mut cases) = load_cases(scene, &mesh, material)?;
    let energy = scene.laws(&mesh, material)?;
    if controls.announce
        && let Some(words) = Forecast::of_body(scene, &mesh, material, &cases, energy.as_ref())?.announcement()
    {
        progress(Event::Note(&words));
    }
    let gauged = scene.gauge().map(|gauge| Gauged::new(scene, gauge, &mesh, &cases)).transpose()?;
    let plan = TimePlan::of(scene, &mesh, material, &support)?;
    let in_scene = |e: Error| e.placed(|e| e.in_file(scene.path()));
    let fine = FineBody::of(scene, &mesh, progress)?;
    if let Some(fine) = &fine {
        fine.measure(scene, &mut cases, progress)?;
    }
    let large = match energy {
        Some(energy) => Some(LargeBody::solve(&mesh, energy, scene.newton(), &cases, progress).map_err(in_scene)?),
        None => None,
    };
    let masses = material.density().map(|density| point_masses(&mesh, density, material)).transpose();
    let masses = masses.map_err(|e| scene.at("material", e))?;
    let linear = |progress: &mut Progress| {
        LinearBody::solve(&mesh, &material.moduli(), &cases, scene.solver(), progress).map_err(in_scene)
    };
    // Only fits to the whole object need the displacements of the body.
    let fits_whole = scene.fits().iter().any(|fit| fit.recipe.whole().is_some());
    let needed = large.is_none() && fits_whole;
    let body = if needed { Some(linear(progress)?) } else { None };
    let mut whole = WholeBody::new(&mesh, material, &support, controls);
    whole.cases = &cases;
    whole.displacements = match (&large, &body) {
        (Some(large), _) => large.complete().collect(),
        (None, Some(body)) => body.displacements().map(Some).collect(),
        (None, None) => Vec::new(),
    };
    whole.newton = large.as_ref().map(|_| scene.newton());
    whole.fine = fine.as_ref().map(|fine| fine as &dyn Finer);
    whole.masses = masses.as_ref().map(|masses| &masses.values[..]);
    whole.solver = scene.solver();
    whole.know(body.iter().flat_map(|body| body.held(&cases)));
    let held = held_points(&mesh, &support, &cases);
    let reference = Reference { large: large.as_ref(), whole: Some(&whole), held: &held };
    let mut fits = Vec::new();
    for fit in scene.fits() {
        let fitted = match scene.output().has_errors() {
            true => fit_mesh(&mesh, material, &reference, fit, progress),
            false => fit_without_errors(&mesh, material, &reference, fit, progress).map(|(fitted, _)| fitted),
        };
        fits.push(fitted.map_err(|e| e.placed(|e| scene.at(&fit.place(), e)))?);
    }
    let count = fits.len();
    if scene.output().moduli {
        for (done, fit) in fits.iter_mut().enumerate() {
            progress(Event::stage("moduli", done, count));
            fit.network.check_size()?;
            let found = moduli_of_body(&mesh, &fit.network.stiffness(&mesh.points))?;
            fit.moduli = found.map(|moduli| moduli.of_solid(material.state()));
            if fit.moduli.is_none() {
                let problem =
                    "the whole network has no moduli: some strain meets no resistance, or no point is inside the body";
                progress(Event::Note(&format!("{}: {problem}", fit.fit.name)));
            }
        }
    }
    let law = large.as_ref().map(|large| large.laws.title());
    let fibres = large.as_ref().and_then(|large| large.laws.distance_at_rest());
    let (fem, followed, energy) = match large {
        Some(large) => {
            for (done, fit) in fits.iter_mut().enumerate() {
                progress(Event::stage("networks", done, count));
                fit.loads = large.compare(&mesh, &cases, &fit.network)?;
            }
            let followed: Vec<_> = large.followed.into_iter().map(Some).collect();
            (large.displacements, followed, Some(large.laws))
        }
        None => {
            let body = body.map_or_else(|| linear(progress), Ok)?;
            for (done, fit) in fits.iter_mut().enumerate() {
                progress(Event::stage("networks", done, count));
                let compared = fit.kind.compared(material.moduli());
                let answers = body.compare(&mesh, &cases, &fit.network, &compared, progress).map_err(in_scene)?;
                (fit.loads, fit.stability, fit.loose_points) = (answers.loads, answers.stability, answers.loose_points);
            }
            (body.into_displacements(), vec![None; cases.len()], None)
        }
    };
    let is_linear = energy.is_none();
    let answers = cases.iter().zip(fem).zip(followed).enumerate();
    let loads = answers.map(|(i, ((case, fem), followed))| BodyLoad {
        name: case.name.clone(),
        support: case.support.clone(),
        forces: case.forces.clone(),
        gauge: gauged.as_ref().map(|gauged| gauged.body(&mesh, i, &fem, followed.as_ref())),
        measured: case.measured(&fem, mesh.dimension),
        deformation: is_linear.then(|| Deformation::largest(&mesh, &fem)),
        followed,
        fem,
    });
    let loads = loads.collect();
    if let Some(gauged) = &gauged {
        fits.iter_mut().for_each(|fit| gauged.measure(&mesh, &mut fit.loads));
    }
    let mut outcome = Outcome {
        scene: scene.title().into(),
        inputs: scene.inputs(),
        settings: scene.settings().iter().map(|setting| setting.to_string()).collect(),
        command: None,
        source: scene.mesh().title(),
        assumed: scene.assumption(&mesh),
        of_loads: load_notes(scene, &mesh),
        left_out: stages(scene).into_iter().filter_map(|(what, why)| Some(format!("{what}: {}", why?))).collect(),
        mesh,
        material: material.clone(),
        support: Some(support),
        lumping: masses.as_ref().map(|masses| masses.lumping),
        masses: masses.map(|masses| masses.values),
        law,
        fibres,
        loads,
        fits,
        motion: None,
        frequencies: Vec::new(),
    };
    if controls.cancelled() {
        progress(Event::Note("ended early, without motion and frequencies"));
    } else {
        plan.follow(scene, energy.as_ref(), &mut outcome, progress)?;
    }
    Ok(outcome)
}

/// Whether each point is held in all directions under every load; without loads, by `[[fix]]`.
fn held_points(mesh: &Mesh, support: &Support, cases: &[Case]) -> Vec<bool> {
    let d = mesh.dimension;
    let holds = |support: &Support, point: usize| (point * d..(point + 1) * d).all(|dof| support.is_fixed(dof));
    let held = |point| match cases {
        [] => holds(support, point),
        _ => cases.iter().all(|case| holds(&case.support, point)),
    };
    (0..mesh.point_count()).map(held).collect()
}

/// Checked before the work starts, not after it.
fn drawable(scene: &Scene, mesh: &Mesh) -> Result<()> {
    match mesh.blocks.iter().find(|b| scene.output().vtu && b.element.formats.vtk.is_none()) {
        Some(block) => {
            let expected = "elements that name their VTK type in [formats]";
            Err(Error::expected("output.vtu", expected, &block.element.name).in_file(scene.path()))
        }
        None => Ok(()),
    }
}
