//! What may become of a number: an error that names it, a status, or figures that are right.

use springfit_foundation::error::Error;
use springfit_mesh::mesh::Mesh;
use springfit_report::report;
use springfit_studies::study::{MotionEnding, Outcome, Scene, run};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// The result of a case.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    Refused,
    /// Some model has a status that says that its figures are not to be trusted.
    Named,
    /// The errors under each load, in percent: of each fit, of each load.
    Right(Vec<Vec<Option<f64>>>),
}

/// Calls `work`, which must not panic.
///
/// # Errors
/// It panics.
pub fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| {
        let text = panic.downcast_ref::<String>().cloned();
        format!("panics: {}", text.or(panic.downcast_ref::<&str>().map(|s| s.to_string())).unwrap_or_default())
    })
}

/// That an error is one line that names a key, or the line of a file.
///
/// # Errors
/// It is not.
pub fn refused(error: &Error) -> Result<Verdict, String> {
    let is_placed = error.key().is_some() || error.file().is_some() && error.line().is_some();
    match is_placed && !error.to_string().contains('\n') {
        true => Ok(Verdict::Refused),
        false => Err(format!("the error names no key: {error}")),
    }
}

/// Runs a scene that stands at `path`.
///
/// # Errors
/// The result is none of a [`Verdict`].
pub fn of_scene(text: &str, path: &Path) -> Result<Verdict, String> {
    guarded(|| {
        let outcome = Scene::parse(text, path).and_then(|scene| run(&scene, &mut |_| ()));
        outcome.map_or_else(|error| refused(&error), |outcome| of_outcome(&outcome))
    })?
}

/// The first word of a text that is an infinity or not a number.
pub fn not_finite(text: &str) -> Option<&str> {
    const WORDS: [&str; 3] = ["inf", "NaN", "nan"];
    // Most texts have none of these letters, and are not read word by word.
    if !WORDS.iter().any(|word| text.contains(word)) {
        return None;
    }
    let words = text.split(|c: char| !(c.is_alphanumeric() || "+-.".contains(c)));
    words.map(|word| word.trim_start_matches(['-', '+'])).find(|word| WORDS.contains(word))
}

/// # Errors
/// A figure is not finite or wrong.
pub fn of_outcome(outcome: &Outcome) -> Result<Verdict, String> {
    let mut texts = vec![report::summary(outcome), report::tables(outcome)];
    texts.extend(outcome.fits.iter().map(|fit| {
        let mut text = Vec::new();
        report::network_csv(&outcome.mesh, &fit.network, &mut text).unwrap();
        String::from_utf8(text).unwrap()
    }));
    let models = || outcome.motion.iter().flat_map(|motion| &motion.models);
    texts.extend(models().map(report::motion_csv));
    for text in &texts {
        if let Some(word) = not_finite(text) {
            return Err(format!("{word} is printed:\n{text}"));
        }
    }
    let mut is_trusted = outcome.fits.iter().all(|fit| ["stable", "converged", "fitted"].contains(&fit.status()));
    is_trusted &= models().all(|model| model.ending == MotionEnding::Complete && model.unsolved == 0);
    is_trusted &= outcome.frequencies.iter().all(|model| model.frequencies.is_some() || model.consistent.is_some());
    is_trusted &= outcome.fits.iter().all(|fit| fit.unreached == 0);
    let masses = outcome.masses.iter().flatten();
    if let Some(mass) = masses.copied().find(|m| !m.is_finite()) {
        return Err(format!("a mass is {mass}"));
    }
    for model in models() {
        if model.records.iter().any(|record| !record.is_finite()) {
            return Err(format!("a state of {} is not finite", model.name));
        }
    }
    for frequencies in outcome.frequencies.iter().filter_map(|model| model.frequencies.as_ref()) {
        if frequencies.iter().any(|f| !f.is_finite()) {
            return Err(format!("frequencies {frequencies:?}"));
        }
    }
    let mut errors = Vec::new();
    for fit in &outcome.fits {
        errors.push(fit.loads.iter().map(|load| load.error.map(|e| e.rms)).collect());
        for (load, body) in fit.loads.iter().zip(&outcome.loads) {
            let Some(u) = &load.displacement else {
                if is_trusted {
                    return Err(format!(
                        "{} is {} without displacements under {}",
                        fit.fit.name,
                        fit.status(),
                        load.name
                    ));
                }
                continue;
            };
            if u.iter().chain(&body.fem).any(|u| !u.is_finite()) {
                return Err(format!("displacements under {} are not finite", load.name));
            }
            let moves = body.fem.iter().any(|u| *u != 0.0);
            match (load.error, &body.measured) {
                (None, None) if moves && is_trusted => {
                    return Err(format!("no error under {} though the body moves", load.name));
                }
                (Some(error), None) => {
                    let expected = rms(&body.fem, u, &outcome.mesh);
                    if !((error.rms - expected).abs() <= 1e-9 * expected.max(1e-9)) {
                        return Err(format!("e_rms of {} is {expected:e}, found {:e}", load.name, error.rms));
                    }
                }
                (Some(error), Some(_)) if !(error.rms.is_finite() && error.max.is_finite()) => {
                    return Err(format!("errors under {} are {error:?}", load.name));
                }
                _ => {}
            }
        }
    }
    Ok(if is_trusted { Verdict::Right(errors) } else { Verdict::Named })
}

/// The error by its definition, of numbers that are brought to the size of one first.
fn rms(fem: &[f64], found: &[f64], mesh: &Mesh) -> f64 {
    // Directors of a sheet are no points of the body.
    let dofs = mesh.node_count() * mesh.dimension;
    let (fem, found) = (&fem[..dofs], &found[..dofs]);
    let unit = fem.iter().fold(0.0f64, |a, u| a.max(u.abs()));
    let length = |u: &[f64]| u.iter().map(|u| (u / unit).powi(2)).sum::<f64>();
    let largest = fem.chunks_exact(mesh.dimension).map(length).fold(0.0, f64::max).sqrt();
    let apart: Vec<f64> = fem.iter().zip(found).map(|(a, b)| a - b).collect();
    100.0 * (length(&apart) / mesh.node_count() as f64).sqrt() / largest
}
