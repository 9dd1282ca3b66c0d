//! How a scene's models moved: a table, notes and a file over time for each.

use super::linear_theory::turning_note;
use super::motion_record::{MotionOptionsRecord, MotionRecord};
use super::note::{Note, Weight};
use super::quality::counted;
use super::table::Digits::{Fixed, Significant};
use super::table::Priority::Always;
use super::table::{Cell, Column, Table, csv};
use crate::dynamics::Integrator;
use crate::scalar::norm;
use crate::study::{ModelMotion, MotionEnding, MotionOutcome, MotionRecipe, Outcome, Record, motion_title};

/// One row per model.
pub(super) fn motions(options: Option<&MotionOptionsRecord>, models: &[MotionRecord]) -> Table {
    // The state at the start says nothing of the end.
    let end = |values: &[Option<f64>]| if values.len() > 1 { values.last().copied().flatten() } else { None };
    let start = |values: &[Option<f64>]| values.first().copied().flatten().filter(|_| values.len() > 1);
    let momentum = |model: &MotionRecord| {
        let axes = model.momentum.last().filter(|_| model.momentum.len() > 1)?;
        Some(norm(&axes.iter().copied().collect::<Option<Vec<f64>>>()?))
    };
    let number = |value| Cell::number(value, Significant(4));
    let energy = |title, group| Column::numbers(title).unit("J").group(group);
    let percent = |title| Column::numbers(title).unit("%").priority(Always);
    let speed = Column::numbers("speed").unit("steps/s").priority(Always);
    let title = options.map_or(String::new(), |options| setting(options, models));
    Table::of(
        "motion",
        title,
        models,
        &[
            (Column::words("model"), &|model| model.name.as_str().into()),
            (Column::words("ended").priority(Always), &|model| ended(model).into()),
            (Column::numbers("steps").priority(Always), &|model| model.steps.into()),
            (speed, &|model| Cell::number(model.steps_per_second, Significant(3))),
            (energy("kinetic", "at the end"), &|model| number(end(&model.kinetic))),
            (energy("work", "at the end"), &|model| number(end(&model.work))),
            (energy("dissipated", "at the end"), &|model| number(end(&model.dissipated))),
            (energy("start", "elastic energy"), &|model| number(start(&model.elastic))),
            (energy("end", "elastic energy"), &|model| number(end(&model.elastic))),
            (percent("drift of\nthe energy"), &|model| Cell::percent(end(&model.drift), Fixed(2))),
            (Column::numbers("momentum\nat the end").unit("kg m/s"), &|model| number(momentum(model))),
            (percent("mean").group("e_rms"), &|model| Cell::number(model.e_rms_mean, Fixed(2))),
            (percent("max").group("e_rms"), &|model| Cell::number(model.e_rms_max, Fixed(2))),
        ],
    )
}

fn setting(options: &MotionOptionsRecord, models: &[MotionRecord]) -> String {
    let states = models.iter().map(|model| model.time.len()).max().unwrap_or(0);
    let MotionOptionsRecord { duration, step, steps, integrator, precision, .. } = options;
    let title = motion_title(*duration, *steps, *step, integrator, precision);
    format!("Motion of {title}, {states} states written")
}

/// How the motion ended, and when.
fn ended(model: &MotionRecord) -> String {
    if model.ended == MotionEnding::Unsolved.name() {
        format!("{} in {}", model.ended, counted(model.unsolved_steps, "step"))
    } else if [MotionEnding::NoResponse, MotionEnding::RanAway].iter().any(|ending| ending.name() == model.ended) {
        format!("{} after {}", model.ended, counted(model.steps, "step"))
    } else if model.growth.is_some() || model.inverted_elements > 0 {
        format!("{}, not trusted", model.ended)
    } else {
        model.ended.clone()
    }
}

/// A body that is held and moves by more than this multiple of its own size is torn off.
// A held body that bends or turns moves by twice its size at most. To move so far it would be stretched about tenfold, which few
// elastomers bear.
const FAR: f64 = 10.0;
/// Linear finite elements that are strained by this much say nothing of a body.
// The term `½ Hᵀ H` that their strain omits is half as large as the strain then.
const LOST_LINEAR: f64 = 1.0;

/// Says that motions are not to be trusted, and why: one that did not come to its end, an unstable network, inverted cells, or a body that leaves
/// its place.
pub(super) fn motion_distrust(outcome: &Outcome) -> Option<String> {
    let motion = outcome.motion.as_ref()?;
    let size = outcome.mesh.longest_side();
    let points = 0..outcome.mesh.point_count() * outcome.mesh.dimension;
    let is_held = motion.pulls.is_empty() && points.into_iter().any(|place| motion.support.is_fixed(place));
    let why = |model: &ModelMotion| -> Option<String> {
        let percent = |share: f64| format!("{:.0} %", 100.0 * share);
        match &model.ending {
            MotionEnding::Complete | MotionEnding::Refused(_) => {}
            MotionEnding::Unsolved | MotionEnding::NoResponse | MotionEnding::RanAway => {
                return Some(model.ending.name().into());
            }
        }
        if model.growth.is_some() {
            return Some("is not stable at rest".into());
        }
        if model.inverted > 0 {
            return Some(format!("has {} inside out", counted(model.inverted, "cell")));
        }
        if let Some(of) = model.deformation.filter(|of| !(of.strain <= LOST_LINEAR)) {
            return Some(format!("is linear, with strains of {}", percent(of.strain)));
        }
        // A free body may fall any distance, and a body that is pulled follows the pull.
        (is_held && !(model.largest <= FAR * size))
            .then(|| format!("moves by {} of the body", percent(model.largest / size)))
    };
    let all: Vec<String> =
        motion.models.iter().filter_map(|model| Some(format!("{} ({})", model.name, why(model)?))).collect();
    (!all.is_empty()).then(|| format!("NOT TRUSTED: the motion of {}", all.join(", ")))
}

/// Where steps do not divide the times that are asked for.
fn step_notes(recipe: &MotionRecipe) -> Vec<String> {
    let (step, end) = (recipe.options.step, recipe.end());
    // Decimals are not exact in binary.
    let is_later = end > recipe.duration * (1.0 + 1e-9);
    let later = is_later.then(|| {
        format!(
            "the motion ends at {} s, with the first step that reaches {:?} s, which is no multiple of {step:?} s",
            short(end),
            recipe.duration
        )
    });
    let uneven = (!recipe.is_even()).then(|| {
        let every = recipe.every;
        format!(
            "states are written after the first step at or beyond each multiple of {every:?} s, which is no multiple of {step:?} s: the times \
             between them differ by a step"
        )
    });
    later.into_iter().chain(uneven).collect()
}

/// Without the last digits, which are rounding errors of products.
fn short(seconds: f64) -> f64 {
    format!("{seconds:.12e}").parse().unwrap_or(seconds)
}

/// What a reader must know of a motion before trusting it.
pub(super) fn motion_notes(outcome: &Outcome) -> Vec<Note> {
    let Some(motion) = &outcome.motion else { return Vec::new() };
    let is_bulk = outcome.mesh.cell_dimension() == outcome.mesh.dimension;
    let steps = step_notes(&motion.recipe).into_iter().map(|words| Note::of_body(Weight::Detail, words));
    let lost = loss(motion).map(|words| Note::of_body(Weight::Reference, words));
    let mut notes: Vec<Note> = steps.chain(lost).collect();
    let MotionRecipe { gravity, pulls, forces, .. } = &motion.recipe;
    if pulls.is_empty() && forces.is_empty() && gravity.iter().all(|g| *g == 0.0) {
        let words = "nothing moves: [motion] has neither gravity nor a pull nor a force, and those of [[load]] do not act in it";
        notes.push(Note::of_body(Weight::Broken, words));
    }
    for model in &motion.models {
        let mut broken = |words: String| notes.push(Note::of_model(Weight::Broken, &model.name, words));
        if let (Some(growth), Some(fit)) = (model.growth, model.fit) {
            let negative = outcome.fits[fit].network.negative();
            broken(format!(
                "indefinite, the fastest-growing motion grows by a factor of e every {:.1e} s at rest; {negative} spring constants are negative",
                1.0 / growth
            ));
        }
        let known = || model.records.last().map_or(0.0, |record| record.account.time);
        match &model.ending {
            MotionEnding::Complete | MotionEnding::Unsolved => {}
            MotionEnding::Refused(why) => broken(format!("the motion was not started: {why}")),
            MotionEnding::NoResponse => broken(format!(
                "the model has no response after {} steps; its motion is known up to {:?} s",
                model.steps,
                known()
            )),
            MotionEnding::RanAway => broken(format!(
                "its numbers grew beyond all bounds after {} steps; its motion is known up to {:?} s",
                model.steps,
                known()
            )),
        }
        if model.unsolved > 0 {
            let many = counted(model.unsolved, "step");
            broken(format!("in {many} the equations were not solved to the tolerance"));
        }
        notes.extend(turning_note(model, motion.models[0].deformation, is_bulk));
    }
    notes
}

/// The share of the energy from which on what an integrator takes is reported.
// The amplitude has lost half as much, half a percent: less hardly shows in a motion.
const LOST: f64 = 0.01;

/// How much energy an integrator that damps has taken from the model that lost most, where that is known. A vibration has lost half of that share
/// of its amplitude.
fn loss(motion: &MotionOutcome) -> Option<String> {
    let integrator = motion.recipe.options.integrator;
    // A motion without inertia has no vibration, and other integrators take no energy from one.
    if motion.recipe.options.quasi_static || !matches!(integrator, Integrator::ImplicitEuler | Integrator::Bdf2) {
        return None;
    }
    // A loss is a negative drift.
    let lost = |model: &ModelMotion| Some((-model.records.last()?.account.balance.as_ref()?.drift, model.name.clone()));
    let (lost, name) = motion.models.iter().filter_map(lost).max_by(|a, b| a.0.total_cmp(&b.0))?;
    (lost > LOST).then(|| {
        format!(
            "{} has taken {:.0} % of the largest energy from {name} (drift of the energy), and about half of that share from the amplitude of a \
             vibration: integrator = \"newmark\" takes none, and smaller steps take less",
            integrator.name(),
            100.0 * lost
        )
    })
}

/// One line per state written: `t` in s, energies, work and what was dissipated in J, the drift as a share of the largest energy,
/// momentum in kg m/s, the mean displacement of the watched points in m, and the error in percent. What is not known is empty.
pub fn motion_csv(model: &ModelMotion) -> String {
    let mut header: Vec<String> =
        ["t", "kinetic", "elastic", "total", "work", "dissipated", "drift"].map(String::from).into();
    let Some(first) = model.records.first() else { return csv(&header, &[]) };
    let axes = ["x", "y", "z"];
    for (name, count) in [("p", first.account.momentum.len()), ("u", first.watched.len())] {
        header.extend(axes[..count].iter().map(|axis| format!("{name}{axis}")));
    }
    header.extend(model.error().map(|_| "e_rms".into()));
    let row = |record: &Record| {
        let account = &record.account;
        let balance = account.balance.map(|b| [b.work, b.dissipated, b.drift]);
        // Times are products of the step.
        let t = short(account.time);
        let full = |value: f64| format!("{value:e}");
        let mut row = vec![t.to_string(), full(account.kinetic), full(account.elastic), full(account.total())];
        row.extend((0..3).map(|i| balance.map_or(String::new(), |balance| full(balance[i]))));
        row.extend(account.momentum.iter().chain(&record.watched).chain(&record.error).map(|value| full(*value)));
        row
    };
    csv(&header, &model.records.iter().map(row).collect::<Vec<_>>())
}
