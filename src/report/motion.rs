//! How a scene's models moved: a table, notes and a file over time for each.

use super::columns::{Heading, aligned};
use super::linear_theory::turning_note;
use super::rows::csv;
use crate::scalar::norm;
use crate::study::{ModelMotion, MotionEnding, MotionOutcome, MotionRecipe, Outcome, Record};

/// One row per model; empty without a motion.
pub(super) fn motion_table(outcome: &Outcome) -> String {
    let Some(motion) = &outcome.motion else { return String::new() };
    let mut header = vec![Heading::words("motion")];
    header.extend(
        [
            "steps",
            "steps/s",
            "kinetic (J)\nat the end",
            "elastic (J)\nstart / end",
            "work (J)\nat the end",
            "dissipated (J)\nat the end",
            "drift %",
            "momentum (kg m/s)\nat the end",
            "%e_rms\nmean / max",
        ]
        .map(Heading::numbers),
    );
    header.push(Heading::words("ended"));
    let rows: Vec<_> = motion.models.iter().map(row).collect();
    format!("\n{}\n{}", setting(motion), aligned(&header, &rows))
}

fn setting(motion: &MotionOutcome) -> String {
    let states = motion.models.iter().map(|model| model.records.len()).max().unwrap_or(0);
    format!("Motion of {}, {states} states written", motion.recipe.title())
}

fn row(model: &ModelMotion) -> Vec<String> {
    let ended = match &model.ending {
        MotionEnding::Complete | MotionEnding::Refused(_) => model.ending.name().into(),
        MotionEnding::Unsolved => format!("{} in {}", model.ending.name(), steps(model.unsolved)),
        MotionEnding::NoResponse | MotionEnding::RanAway => {
            format!("{} after {} steps", model.ending.name(), model.steps)
        }
    };
    let none = || "-".to_string();
    let speed = if model.steps > 0 { format!("{:.0}", model.steps_per_second()) } else { none() };
    let mut row = vec![model.name.clone(), model.steps.to_string(), speed];
    // The state at the start says nothing of the end.
    match (model.records.first(), model.records.last().filter(|_| model.has_moved())) {
        (Some(first), Some(last)) => {
            let momentum = norm(&last.account.momentum);
            let balance = last.account.balance;
            row.push(format!("{:.3e}", last.account.kinetic));
            row.push(format!("{:.3e} / {:.3e}", first.account.elastic, last.account.elastic));
            row.push(balance.map_or_else(none, |b| format!("{:.3e}", b.work)));
            row.push(balance.map_or_else(none, |b| format!("{:.3e}", b.dissipated)));
            row.push(balance.map_or_else(none, |b| format!("{:.2}", 100.0 * b.drift)));
            row.push(format!("{momentum:.3e}"));
        }
        _ => row.extend(std::iter::repeat_n(none(), 6)),
    }
    row.push(model.error().map_or_else(none, |[mean, max]| format!("{mean:.2} / {max:5.2}")));
    row.push(ended);
    row
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

fn steps(count: usize) -> String {
    format!("{count} {}", if count == 1 { "step" } else { "steps" })
}

/// What a reader must know of a motion before trusting it.
pub(super) fn motion_notes(outcome: &Outcome) -> Vec<String> {
    let Some(motion) = &outcome.motion else { return Vec::new() };
    let is_bulk = outcome.mesh.cell_dimension() == outcome.mesh.dimension;
    let mut notes = step_notes(&motion.recipe);
    for model in &motion.models {
        let name = &model.name;
        if let (Some(growth), Some(fit)) = (model.growth, model.fit) {
            let negative = outcome.fits[fit].network.negative();
            notes.push(format!(
                "{name}: indefinite, the fastest-growing motion grows by a factor of e every {:.1e} s at rest; {negative} spring \
                 constants are negative",
                1.0 / growth
            ));
        }
        notes.extend(turning_note(model, motion.models[0].deformation, is_bulk));
        let known = || model.records.last().map_or(0.0, |record| record.account.time);
        match &model.ending {
            MotionEnding::Complete | MotionEnding::Unsolved => {}
            MotionEnding::Refused(why) => notes.push(format!("{name}: the motion was not started: {why}")),
            MotionEnding::NoResponse => notes.push(format!(
                "{name}: the model has no response after {} steps; its motion is known up to {:?} s",
                model.steps,
                known()
            )),
            MotionEnding::RanAway => notes.push(format!(
                "{name}: its numbers grew beyond all bounds after {} steps; its motion is known up to {:?} s",
                model.steps,
                known()
            )),
        }
        if model.unsolved > 0 {
            let many = steps(model.unsolved);
            notes.push(format!("{name}: in {many} the equations were not solved to the tolerance"));
        }
    }
    notes
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
