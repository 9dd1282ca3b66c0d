//! The standard bodies in one engine, and what repairs their modulus.

use super::body::{Case, StandardBody};
use super::engine::{Engine, Law, Solver};
use super::rest::{MOVING, Rest, STILL, come_to_rest, damping};
use super::session::Session;
use crate::export::target_named;
use springfit_foundation::error::Result;
use springfit_foundation::file::create_folder;
use springfit_report::report::{Factor, FoundRow, NetworkRecord, RefereeRecord, RefereeRow, RepairRecord, Telling};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// A model whose energy of tension is nearer than this to its own is not repaired, percent.
// A body at rest may still move by 0.03 % of its displacement, and single precision rounds it: the factor of a repair is known to a few
// times that, and one that is nearer to one says nothing of the engine.
const RIGHT: f64 = 0.5;
/// The load by which a modulus is repaired.
const TENSION: &str = "tension";

/// An engine with what it needs to run.
pub struct Trial<'a> {
    /// The engine.
    pub engine: &'a Engine,
    /// What runs it.
    pub program: &'a Path,
    /// The scripts and exports are in this folder.
    pub folder: &'a Path,
    /// The bodies of one Poisson's ratio.
    pub bodies: &'a [StandardBody],
    /// Where rows go.
    pub record: &'a mut RefereeRecord,
    /// Called after each row.
    pub shown: &'a mut dyn FnMut(&RefereeRow),
}

/// Own elements, or the springs of a fit.
#[derive(Clone, Copy, PartialEq)]
enum Model {
    Elements,
    Springs(&'static str),
}

impl Model {
    fn title(self) -> String {
        match self {
            Model::Elements => "own elements".into(),
            Model::Springs(fit) => format!("{fit} springs"),
        }
    }
}

/// What an engine is told: E times the factor and ν, or springs whose constants are multiplied.
#[derive(Clone, Copy)]
struct Told {
    telling: Telling,
    factor: f64,
    poisson: f64,
}

impl Trial<'_> {
    /// Measures all models of a solver.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn run(&mut self, solver: &Solver) -> Result<()> {
        if let Some(law) = solver.elements {
            self.measure_and_repair(solver, Model::Elements, law)?;
        }
        solver.networks.iter().try_for_each(|fit| self.measure_and_repair(solver, Model::Springs(fit), |_| None))
    }

    fn measure_and_repair(&mut self, solver: &Solver, model: Model, law: Law) -> Result<()> {
        let [young, poisson] = self.bodies[0].moduli;
        let given = Told { telling: Telling::Given, factor: 1.0, poisson };
        let rows = self.measured(solver, model, given, None)?;
        let error =
            rows.iter().find(|row| row.load == TENSION).map(|row| row.found.map(|found| found.of_model_percent));
        self.keep(rows);
        let Some(Some(error)) = error.filter(|error| error.is_none_or(|error| error.abs() >= RIGHT)) else {
            return Ok(());
        };
        let factor = self.factor(solver, model, given, error / 100.0)?;
        if let Factor::Number(factor) = factor {
            let rows = self.measured(solver, model, Told { telling: Telling::Repaired, factor, ..given }, None)?;
            self.keep(rows);
        }
        let derived = law([young, poisson]);
        if let Some([of_law, poisson]) = derived {
            let told = Told { telling: Telling::Derived, factor: of_law / young, poisson };
            let rows = self.measured(solver, model, told, None)?;
            self.keep(rows);
        }
        self.record.repairs.push(RepairRecord {
            engine: self.engine.name.into(),
            solver: solver.name.into(),
            model: model.title(),
            poisson,
            factor,
            derived: derived.map(|[of_law, poisson]| [of_law / young, poisson]),
        });
        Ok(())
    }

    /// The factor by which tension is right. The compliance that is found is affine in that which is told, `c = a/f + b`: b is 0 if the
    /// law has another modulus, and positive if iterations are left out. If b alone is at least the right compliance, no
    /// factor makes tension right.
    fn factor(&mut self, solver: &Solver, model: Model, given: Told, error: f64) -> Result<Factor> {
        // With b = 0 this factor is right at once, and it is near the right one where b is small.
        let first = 1.0 + error;
        let told = Told { telling: Telling::Repaired, factor: first, ..given };
        let rows = self.measured(solver, model, told, Some(TENSION))?;
        let Some(second) = rows.first().and_then(|row| row.found) else {
            return Ok(Factor::NotAtRest);
        };
        // With `c(f) = a/f + b`, relative to the right compliance, two factors give a and b, and `c = 1` gives `f =
        // a/(1 − b)`.
        let (at_one, at_first) = (1.0 + error, 1.0 + second.of_model_percent / 100.0);
        let a = (at_one - at_first) / (1.0 - 1.0 / first);
        let factor = a / (1.0 - (at_one - a));
        Ok(if factor.is_finite() && factor > 0.0 { Factor::Number(factor) } else { Factor::TooSoft })
    }

    fn keep(&mut self, rows: Vec<RefereeRow>) {
        self.record.rows.extend(rows);
    }

    /// The rows of all loads, or of one. A body whose program ends early is noted, and has no rows from there on.
    fn measured(&mut self, solver: &Solver, model: Model, told: Told, only: Option<&str>) -> Result<Vec<RefereeRow>> {
        let mut rows = Vec::new();
        for body in self.bodies {
            let cases = || body.cases.iter().filter(|case| only.is_none_or(|load| case.load == load));
            if cases().next().is_none() {
                continue;
            }
            let (fit, moduli, factor) = match model {
                Model::Elements => ("exact", Some([told.factor * body.moduli[0], told.poisson]), 1.0),
                Model::Springs(fit) => (fit, None, told.factor),
            };
            let place =
                body.networks.iter().position(|(name, _)| name == fit).expect("engines name fits of the scenes");
            let folder = self.exported(body, fit, &body.networks[place].1, factor)?;
            let opened = Session::start(self.engine, self.program, self.folder).and_then(|mut session| {
                session.open(&folder, solver.name, moduli, damping(body.slowest))?;
                Ok(session)
            });
            let found = opened.and_then(|mut session| {
                for case in cases() {
                    let start = Instant::now();
                    // Half the difference of both signs of the load: what is of second order in it cancels out.
                    let ends = [1.0, -1.0].map(|sign| {
                        let forces: Vec<f64> = case.forces.iter().map(|f| sign * f).collect();
                        come_to_rest(&mut session, &forces, body.slowest)
                    });
                    let [there, back] = ends;
                    let ends = [there?, back?];
                    let own = if model == Model::Elements { &case.elements } else { &case.networks[place] };
                    let row = RefereeRow {
                        engine: self.engine.name.into(),
                        solver: solver.name.into(),
                        model: model.title(),
                        telling: told.telling,
                        told: moduli,
                        seconds: start.elapsed().as_secs_f64(),
                        ..row(case, body.moduli[1], own, &ends)
                    };
                    (self.shown)(&row);
                    rows.push(row);
                }
                Ok(())
            });
            if let Err(error) = found {
                let (engine, model) = (self.engine.name, model.title());
                let what = format!("{engine} {}, {model}, {}, nu {}", solver.name, body.name, body.moduli[1]);
                self.record.failed.push(format!("{what}: {error}"));
            }
        }
        Ok(rows)
    }

    /// Exports a network without gravity, and with its constants multiplied.
    fn exported(&self, body: &StandardBody, fit: &str, network: &NetworkRecord, factor: f64) -> Result<PathBuf> {
        let mut network = network.clone();
        network.springs.iter_mut().for_each(|spring| spring.constant *= factor);
        // The frequencies grow with the root of the constants.
        network.largest_step = network.largest_step.map(|step| step / factor.max(1.0).sqrt());
        let files = target_named(self.engine.target)?.files(&network, Some(&[0.0; 3]))?;
        let name = format!("{}-{}-{}-{fit}", self.engine.name, body.name, body.moduli[1]);
        let folder = self.folder.join(name);
        create_folder(&folder)?;
        files.iter().try_for_each(|(name, content)| content.write(&folder.join(name)))?;
        Ok(folder)
    }
}

/// What was found of a case with both signs of the load; `own` is where the model rests by linear theory.
fn row(case: &Case, poisson: f64, own: &[f64], ends: &[Rest; 2]) -> RefereeRow {
    let mut warnings: Vec<String> = ends.iter().flat_map(|end| end.warnings.iter().cloned()).collect();
    warnings.sort();
    warnings.dedup();
    let moving = ends[0].moving.max(ends[1].moving);
    let both = ends[0].displacement.as_ref().zip(ends[1].displacement.as_ref());
    let u = both.map(|(there, back)| there.iter().zip(back).map(|(a, b)| (a - b) / 2.0).collect::<Vec<f64>>());
    RefereeRow {
        load: case.load.clone(),
        poisson,
        truth: case.truth[0],
        truth_uncertainty_percent: 100.0 * (case.truth[1] / case.truth[0]).abs(),
        tip_of_finite_elements: case.tip(&case.elements),
        energy_of_finite_elements: case.energy(&case.elements),
        found: u.as_ref().filter(|_| moving <= MOVING).map(|u| found(case, own, u, moving <= STILL)),
        moving_percent: u.map(|_| 100.0 * moving),
        warnings,
        ..RefereeRow::default()
    }
}

fn found(case: &Case, own: &[f64], u: &[f64], is_still: bool) -> FoundRow {
    let percent = |found: f64, expected: f64| 100.0 * (found / expected - 1.0);
    let energy = case.energy(u);
    FoundRow {
        is_still,
        tip: case.tip(u),
        energy,
        of_model_percent: percent(energy, case.energy(own)),
        tip_percent: percent(case.tip(u), case.tip(&case.elements)),
        energy_percent: percent(energy, case.energy(&case.elements)),
        truth_percent: percent(energy, case.truth[0]),
    }
}
