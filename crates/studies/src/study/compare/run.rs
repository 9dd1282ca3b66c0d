//! Runs the cases of a comparison.

use super::axes::{VariedFit, solver_of};
use super::cells::{MethodOutcome, measure_fits};
use super::plan::{Case, Comparing, Subject};
use super::record::{CaseRecord, MethodRecord};
use super::usual::{compared, usual_fits};
use crate::error::Result;
use crate::number::finite;
use crate::study::jobs::{apart, each_of};
use crate::study::run::run_with;
use crate::study::stretches::{Pulled, STRETCHES, StretchedFit};
use serde_json::{Value, json};
use springfit_scenes::{BODY, Controls, FitOutcome, Measured, NamedFit, Outcome, Progress, Times};
use std::collections::BTreeMap;

impl Comparing {
    /// Runs the cases of these places, `jobs` at a time, and passes the record of each to `each` as it becomes ready; an error that `each`
    /// returns ends the work. With several jobs the times are still those of one thread each, but the threads share what a machine shares.
    ///
    /// # Errors
    /// That of `each`; or no thread can be started.
    pub fn run(&self, places: &[usize], jobs: usize, each: impl FnMut(usize, CaseRecord) -> Result<()>) -> Result<()> {
        each_of(places, jobs, |place| self.record(&self.cases[place], &mut |_| {}), each)
    }

    /// The record of one case; its error is in it.
    pub fn record(&self, case: &Case, progress: &mut Progress) -> CaseRecord {
        let found = apart("case", || self.methods(case, progress));
        let (methods, error) = match found {
            Ok(methods) => (methods, None),
            Err(error) => (Vec::new(), Some(error.to_string())),
        };
        CaseRecord { settings: case.settings.clone(), inputs: self.sum(case), methods, error }
    }

    fn methods(&self, case: &Case, progress: &mut Progress) -> Result<Vec<MethodRecord>> {
        let listed = |usual: Vec<NamedFit>| match self.fits.is_empty() {
            true => usual.into_iter().map(VariedFit::from).collect(),
            false => self.fits.clone(),
        };
        match &case.subject {
            Subject::Shapes { element, material, set } => {
                let fits: Vec<VariedFit> = listed(usual_fits(element, *material, self.iterations));
                let found = measure_fits(element, *material, set, &named(&fits), self.is_timed, progress)?;
                let record = |(fit, found): (&VariedFit, Result<MethodOutcome>)| match found {
                    Ok(found) => of_shapes(begun(fit), &found, material.young()),
                    Err(error) => refused(fit, &error.to_string()),
                };
                Ok(fits.iter().zip(found).map(record).collect())
            }
            Subject::Box { element, material, law } => {
                let pulled = Pulled::new(element, *material, law)?;
                let fits: Vec<VariedFit> = listed(pulled.usual_fits(self.stretch)?);
                let found = pulled.compare(&named(&fits), self.is_timed, progress)?;
                let record = |(fit, found): (&VariedFit, Result<StretchedFit>)| match found {
                    Ok(found) => of_box(begun(fit), &found),
                    Err(error) => refused(fit, &error.to_string()),
                };
                Ok(fits.iter().zip(found).map(record).collect())
            }
            Subject::Scene(scene) => {
                let mut scene = match self.fits.is_empty() {
                    true => compared(scene)?,
                    false => scene.clone().of_loads()?.with_fits(named(&self.fits)),
                };
                scene.output_mut().time = self.is_timed;
                let fits: Vec<VariedFit> = listed(scene.fits().to_vec());
                let outcome = run_with(&scene, &Controls::default(), progress).map_err(|e| self.of_fit(e))?;
                let of_fit = |(fit, found): (&VariedFit, &FitOutcome)| of_scene(begun(fit), found, &outcome);
                let mut records: Vec<MethodRecord> = fits.iter().zip(&outcome.fits).map(of_fit).collect();
                records.push(of_body(&outcome));
                Ok(records)
            }
        }
    }
}

fn named(fits: &[VariedFit]) -> Vec<NamedFit> {
    fits.iter().map(|fit| fit.named.clone()).collect()
}

/// A record with the settings of the fit.
fn begun(fit: &VariedFit) -> MethodRecord {
    let mut settings = fit.varied.clone();
    if let Ok(Value::Object(own)) = serde_json::to_value(fit.named.recipe.kind().record()) {
        let told = ["objective", "nonnegative", "tied", "weight"];
        settings.extend(own.into_iter().filter(|(key, value)| told.contains(&&**key) && !value.is_null()));
    }
    settings.insert("solver".into(), json!(solver_of(&fit.named)));
    let groups = fit.named.springs.as_ref().map_or("default".into(), |groups| groups.join(" "));
    settings.insert("springs".into(), json!(groups));
    MethodRecord { fit: fit.named.name.clone(), settings, ..MethodRecord::default() }
}

fn refused(fit: &VariedFit, why: &str) -> MethodRecord {
    MethodRecord { refused: Some(why.into()), ..begun(fit) }
}

/// The passes by what was done, of what was measured.
fn times<const N: usize>(known: [(&str, Option<&Times>); N]) -> BTreeMap<String, Vec<f64>> {
    let known = known.into_iter().filter_map(|(name, times)| Some((name.to_string(), times?.seconds.clone())));
    known.collect()
}

fn all(values: &[f64]) -> Vec<Option<f64>> {
    values.iter().copied().map(finite).collect()
}

fn of_shapes(record: MethodRecord, found: &MethodOutcome, young: f64) -> MethodRecord {
    let shapes = found.errors.frobenius.len();
    let negatives: Vec<f64> = found.negatives.iter().map(|count| *count as f64).collect();
    let lists = [
        ("frobenius", all(&found.errors.frobenius)),
        ("spectral", all(&found.errors.spectral)),
        ("negative", all(&negatives)),
        ("gap", all(&found.gaps)),
    ];
    let moduli = found.moduli.as_ref();
    let figures = [
        ("springs", Some(found.springs as f64)),
        ("young_ratio", moduli.and_then(|moduli| finite(moduli.young / young))),
        ("poisson", moduli.and_then(|moduli| finite(moduli.poisson))),
        ("zener", moduli.and_then(|moduli| finite(moduli.zener))),
    ];
    MethodRecord {
        fitted: found.fitted,
        copied: shapes - found.fitted,
        items: (1..=shapes).map(|shape| shape.to_string()).collect(),
        values: lists.into_iter().filter(|(_, list)| list.len() == shapes).map(|(k, v)| (k.into(), v)).collect(),
        figures: figures.map(|(key, value)| (key.to_string(), value)).into(),
        times: times([("fit", found.times.as_ref())]),
        ..record
    }
}

fn of_box(record: MethodRecord, found: &StretchedFit) -> MethodRecord {
    let sampled = found.sampled.as_ref();
    let figures = [
        ("trained", sampled.and_then(|sampled| finite(sampled.trained.mean))),
        ("held_out", sampled.and_then(|sampled| finite(sampled.held_out.as_ref()?.mean))),
    ];
    MethodRecord {
        items: STRETCHES.iter().map(|stretch| stretch.to_string()).collect(),
        values: [("e_rms".to_string(), found.errors.clone()), ("force".into(), found.excess.clone())].into(),
        figures: figures.map(|(key, value)| (key.to_string(), value)).into(),
        times: times([("fit", found.times.as_ref())]),
        ..record
    }
}

fn of_scene(record: MethodRecord, found: &FitOutcome, outcome: &Outcome) -> MethodRecord {
    let error = |of: fn(&crate::study::DisplacementError) -> f64| -> Vec<Option<f64>> {
        found.loads.iter().map(|load| load.error.as_ref().map(of).and_then(finite)).collect()
    };
    let values = [("e_rms", error(|e| e.rms)), ("e_max", error(|e| e.max)), ("e_tip", error(|e| e.tip))];
    let figures = [
        ("springs", Some(found.network.len() as f64)),
        ("negative", Some(found.network.negative() as f64)),
        ("frobenius", found.frobenius().and_then(|spread| finite(spread.mean))),
        ("spectral", found.spectral().and_then(|spread| finite(spread.mean))),
        ("error_of_c", finite(100.0 * found.as_material.distance)),
    ];
    // A network that does not stand has no errors, and no steps: its motion grows.
    let stands = !["indefinite", "mechanism"].contains(&found.status());
    let (fit, model) = (found.times.as_ref(), found.model_times.as_ref().filter(|_| stands));
    let values = values.map(|(key, list)| (key, if stands { list } else { vec![None; list.len()] }));
    MethodRecord {
        fitted: outcome.mesh.cell_count() - found.reused,
        copied: found.reused,
        items: found.loads.iter().map(|load| load.name.clone()).collect(),
        values: values.map(|(key, list)| (key.to_string(), list)).into(),
        figures: figures.map(|(key, value)| (key.to_string(), value)).into(),
        times: times([
            ("fit", fit.map(|fit| &fit.element)),
            ("assembly", fit.map(|fit| &fit.assembly)),
            ("solve", model.and_then(|model| model.solve.as_ref())),
            ("explicit-step", model.and_then(|model| model.explicit_step.as_ref())),
            ("implicit-step", model.and_then(|model| model.implicit_step.as_ref())),
            ("simulated-second", model.and_then(|model| model.simulated_second.as_ref())),
        ]),
        refused: (!stands).then(|| format!("the network is {}", found.status())),
        ..record
    }
}

/// The finite elements of the mesh, with their errors where these are known.
fn of_body(outcome: &Outcome) -> MethodRecord {
    let error = |of: fn(&Measured) -> Option<f64>| -> Vec<Option<f64>> {
        outcome.loads.iter().map(|load| load.measured.as_ref().and_then(of)).collect()
    };
    let values =
        [("e_rms", error(|e| e.fem_e_rms)), ("e_max", error(|e| e.fem_e_max)), ("e_tip", error(|e| e.fem_e_tip))];
    let model = outcome.model_times.as_ref();
    // Linear finite elements do not turn: their matrix is factorised once, that of springs in each step.
    let turns = outcome.law.is_some();
    MethodRecord {
        fit: BODY.into(),
        items: outcome.loads.iter().map(|load| load.name.clone()).collect(),
        values: values.map(|(key, list)| (key.to_string(), list)).into(),
        times: times([
            ("solve", model.and_then(|model| model.solve.as_ref())),
            ("explicit-step", model.and_then(|model| model.explicit_step.as_ref())),
            ("implicit-step", model.and_then(|model| model.implicit_step.as_ref()).filter(|_| turns)),
            ("simulated-second", model.and_then(|model| model.simulated_second.as_ref())),
        ]),
        ..MethodRecord::default()
    }
}
