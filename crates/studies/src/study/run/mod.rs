//! Runs a scene: the body with its supports and loads, its finite elements, a network for each fit, and the answers of both beside each other.

mod answers;
mod posed;
mod solved;

use crate::error::Result;
use answers::Answers;
use posed::Posed;
use solved::Solved;
use springfit_scenes::{Controls, Event, FitLimit, Outcome, Progress, Scene};

/// Runs the scene. Only the work that the scene requests is done.
///
/// # Errors
/// An input is wrong: a group, a support, a load or the mesh. A network that is not stable is not an error.
pub fn run(scene: &Scene, progress: &mut Progress) -> Result<Outcome> {
    run_with(scene, &Controls::default(), progress)
}

/// Runs the scene as [`run`] does; whole-object fits can be cancelled and continued.
///
/// # Errors
/// An input is wrong, as for [`run`]; or the checkpoint is wrong or cannot be written.
pub fn run_with(scene: &Scene, controls: &Controls, progress: &mut Progress) -> Result<Outcome> {
    in_stages(scene, controls, progress).map_err(|e| scene.with_line(e))
}

/// How stiff a body each engine of the scene can hold, one entry for each fit with an `engine`. The finite elements are solved for it.
///
/// # Errors
/// Those of a run before its fits, and those of the springs from which fits start.
pub fn engine_limits(scene: &Scene) -> Result<Vec<FitLimit>> {
    if scene.fits().iter().all(|fit| fit.engine.is_none()) {
        return Ok(Vec::new());
    }
    let silent = &mut |_: Event| ();
    let mut limits = || {
        let controls = Controls::default();
        let mut posed = Posed::of(scene, &controls, silent)?;
        Solved::of(&mut posed, silent)?.engine_limits(&posed, &controls, silent)
    };
    limits().map_err(|e| scene.with_line(e))
}

/// The stages of a run, one after the other.
fn in_stages(scene: &Scene, controls: &Controls, progress: &mut Progress) -> Result<Outcome> {
    controls.check()?;
    let mut posed = Posed::of(scene, controls, progress)?;
    let solved = Solved::of(&mut posed, progress)?;
    let mut fits = solved.fits(&posed, controls, progress)?;
    posed.measure_moduli(&mut fits, progress)?;
    let model_times = solved.measure_times(&posed, &mut fits, progress)?;
    let answers = Answers::of(&mut posed, solved, &mut fits, progress)?;
    let (mut outcome, plan, laws) = answers.outcome(posed, fits);
    outcome.model_times = model_times;
    if controls.cancelled() {
        progress(Event::Note("ended early, without motion and frequencies"));
    } else {
        plan.follow(scene, laws.as_ref(), &mut outcome, progress)?;
    }
    Ok(outcome)
}
