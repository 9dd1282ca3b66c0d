//! A scene with other materials and other sizes: what must stay the same, and how the networks change.

use super::elements::PROMISED;
use super::outcome::{Family, StabilityOutcome, StabilityRow, Verdict, worst};
use crate::dynamics::largest_square;
use crate::error::{Error, Result};
use crate::model::{Lumping, lumped_masses};
use crate::solve::Standing;
use crate::study::run::run;
use springfit_scenes::{Event, FitOutcome, NamedFit, Outcome, Output, Progress, Scene};
use std::time::Instant;

/// Poisson's ratios, up to nearly incompressible.
const RATIOS: [f64; 8] = [-0.9, -0.5, 0.0, 0.3, 0.45, 0.49, 0.499, 0.499999];
/// The factors on Young's modulus.
const STIFFER: [f64; 6] = [1e-12, 1e-6, 1e-3, 1e3, 1e6, 1e12];
/// The factors on all lengths.
const LONGER: [f64; 5] = [1e-7, 1e-3, 10.0, 1e4, 1e8];
/// What helps where the scene does not run.
const REFUSED: &str = "run the scene with this material by itself: its error names the key";
/// What helps against negative springs that let the network fall.
const INDEFINITE: &str =
    "fit with nonnegative = true, with the objective \"divergence\", or with springs on the content of cells";
/// What helps where springs do not hold a motion.
const MECHANISM: &str =
    "add springs (springs = \"all\"), or hold more nodes; springfit check counts the mechanisms of an element";
/// The density if the scene has none, kg/m³.
const DENSITY: f64 = 1000.0;

/// Runs the scene in each case: the fits of single cells and their displacements, without motion, gauge and outputs.
///
/// Errors of displacements must not depend on units: `e_rms` of each load is compared with that of the unchanged scene,
/// as a share of the largest displacement. Lengths are varied if no condition or expression of the scene is in metres.
///
/// # Errors
/// The scene itself does not run, has a law, or has no fit of single cells.
pub fn stability_of_scene(scene: &Scene, progress: &mut Progress) -> Result<StabilityOutcome> {
    let start = Instant::now();
    if scene.law().is_some() {
        let expected = "a scene at small deformation, whose answers know no unit";
        return Err(scene.at("material.law", Error::new(format!("expected {expected}, found a law"))));
    }
    let fits: Vec<NamedFit> =
        scene.fits().iter().filter(|fit| fit.recipe.kind().cell_method().is_some()).cloned().collect();
    if fits.is_empty() {
        return Err(scene.at("fit", Error::new("expected a fit of single cells, found none")));
    }
    let plain = scene.clone().with_fits(fits).with_output(Output::default()).without_motion().without_gauge();
    let plain = plain.judged_by_cells();
    let base = run(&plain, &mut |_| {})?;
    let mut cases: Vec<(Family, String, Scene, bool)> = Vec::new();
    for factor in STIFFER {
        cases.push((Family::Young, format!("E times {factor:e}"), plain.of_material(factor, None), true));
    }
    for factor in LONGER.into_iter().filter(|_| !plain.is_in_metres()) {
        let other = plain.clone().with_lengths_times(factor);
        cases.push((Family::Size, format!("lengths times {factor:e}"), other, true));
    }
    for nu in RATIOS {
        cases.push((Family::Poisson, format!("nu = {nu}"), plain.of_material(1.0, Some(nu)), false));
    }
    let mut rows: Vec<StabilityRow> = Vec::new();
    let total = cases.len();
    for (done, (family, case, other, same)) in cases.iter().enumerate() {
        progress(Event::stage(case, done, total));
        let subject = &base.scene;
        match run(other, &mut |_| {}) {
            Ok(outcome) => {
                for (fit, known) in outcome.fits.iter().zip(&base.fits) {
                    let row = |verdict| StabilityRow::new(subject, *family, case, &fit.fit.name, verdict);
                    rows.push(of_fit(row, &outcome, fit, same.then_some(known)));
                }
            }
            Err(e) => {
                let verdict = Verdict::Refused(e.to_string());
                rows.push(StabilityRow::new(subject, *family, case, "all", verdict).with_way_out(REFUSED));
            }
        }
    }
    Ok(StabilityOutcome { title: base.scene, rows, seconds: start.elapsed().as_secs_f64() })
}

/// `known` is the fit whose errors must be the same.
fn of_fit(
    row: impl Fn(Verdict) -> StabilityRow,
    outcome: &Outcome,
    fit: &FitOutcome,
    known: Option<&FitOutcome>,
) -> StabilityRow {
    let changes = known.iter().flat_map(|known| fit.loads.iter().zip(&known.loads)).map(|(new, old)| {
        match (new.error, old.error) {
            // Errors are in percent, and what is promised is a share.
            (Some(new), Some(old)) => (new.rms - old.rms).abs() / 100.0,
            (None, None) => 0.0,
            _ => f64::INFINITY,
        }
    });
    let changes: Vec<f64> = changes.collect();
    let error = (!changes.is_empty()).then(|| worst(changes));
    let standing = fit.stability.as_ref().map(|stability| stability.standing);
    let mut row = match (error, standing) {
        (Some(error), _) if error > PROMISED => row(Verdict::Lost).with_error(error, PROMISED),
        (_, Some(Standing::Indefinite)) => {
            row(Verdict::Told("the network is indefinite".into())).with_way_out(INDEFINITE)
        }
        (_, Some(Standing::Singular)) => {
            row(Verdict::Told("the network is a mechanism".into())).with_way_out(MECHANISM)
        }
        (_, Some(Standing::Soft)) => {
            row(Verdict::Told("the network is near a mechanism".into())).with_way_out(MECHANISM)
        }
        (Some(error), _) => row(Verdict::Accurate).with_error(error, PROMISED),
        (None, _) if fit.deficient > 0 => row(Verdict::Dependent),
        (None, Some(Standing::Stable)) => {
            row(Verdict::Told("stable; its error changes with Poisson's ratio and is not compared".into()))
        }
        (None, None) => row(Verdict::Told("not examined: the scene has no loads".into())),
    };
    row.negative = Some([fit.network.negative(), fit.network.len()]);
    row.softest = fit.stability.as_ref().map(|stability| stability.energy_ratio[0]);
    let (mesh, thickness) = (&outcome.mesh, outcome.material.thicknesses());
    let masses = lumped_masses(mesh, DENSITY, thickness, Lumping::Hrz);
    let masses: Vec<f64> = masses.iter().flat_map(|m| vec![*m; mesh.dimension]).collect();
    let entries = fit.network.stiffness(&mesh.points);
    let largest = largest_square(entries.iter().map(|e| (e.row, e.col, e.val)), &masses, &vec![false; masses.len()]);
    row.step = Some(2.0 / largest.sqrt()).filter(|step| step.is_finite());
    row
}
