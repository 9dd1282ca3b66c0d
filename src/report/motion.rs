//! How a scene's models moved: a table, notes, JSON and a file over time for each.

use super::table::aligned;
use crate::study::{DampingRecipe, ModelMotion, MotionEnding, MotionOutcome, Outcome, integrator_name};
use serde_json::{Value, json};
use std::fmt::Write;

/// One row per model; empty without a motion.
pub(super) fn motion_table(outcome: &Outcome) -> String {
    let Some(motion) = &outcome.motion else { return String::new() };
    let header: Vec<String> = [
        "motion",
        "steps",
        "steps/s",
        "kinetic (J)\nat the end",
        "elastic (J)\nstart / end",
        "work (J)\nat the end",
        "dissipated (J)\nat the end",
        "drift %",
        "momentum (kg m/s)\nat the end",
        "%e_rms\nmean / max",
        "ended",
    ]
    .map(String::from)
    .into();
    let rows: Vec<_> = motion.models.iter().map(row).collect();
    format!("\n{}\n{}", setting(motion), aligned(&header, &rows))
}

fn setting(motion: &MotionOutcome) -> String {
    let states = motion.models.iter().map(|model| model.records.len()).max().unwrap_or(0);
    format!("Motion of {}, {states} states written", motion.recipe.title())
}

fn row(model: &ModelMotion) -> Vec<String> {
    let ended = match &model.ending {
        MotionEnding::Complete => "complete".into(),
        MotionEnding::NoResponse => format!("no response after {} steps", model.steps),
        MotionEnding::RanAway => format!("ran away after {} steps", model.steps),
        MotionEnding::Refused(_) => "not begun".into(),
    };
    let none = || "-".to_string();
    let speed = if model.steps > 0 { format!("{:.0}", model.steps_per_second()) } else { none() };
    let mut row = vec![model.name.clone(), model.steps.to_string(), speed];
    match (model.records.first(), model.records.last()) {
        (Some(first), Some(last)) => {
            let momentum = last.account.momentum.iter().map(|p| p * p).sum::<f64>().sqrt();
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

/// What a reader must know of a motion before trusting it.
pub(super) fn motion_notes(outcome: &Outcome) -> Vec<String> {
    let Some(motion) = &outcome.motion else { return Vec::new() };
    let mut notes = Vec::new();
    for model in &motion.models {
        let name = &model.name;
        if let (Some(growth), Some(fit)) = (model.growth, model.fit) {
            let negative = outcome.fits[fit].network.negative();
            notes.push(format!(
                "{name}: indefinite, a motion that releases energy grows by e every {:.1e} s at rest; it has {negative} \
                 negative springs",
                1.0 / growth
            ));
        }
        if let MotionEnding::Refused(why) = &model.ending {
            notes.push(format!("{name}: its motion was not begun: {why}"));
        }
        if model.unsolved > 0 {
            notes.push(format!("{name}: the equations of {} steps were not solved to the tolerance", model.unsolved));
        }
    }
    notes
}

/// What was asked for.
pub(super) fn motion_options(motion: &MotionOutcome) -> Value {
    let recipe = &motion.recipe;
    let is_newton = !recipe.options.linear && integrator_name(recipe.options.integrator) != "symplectic-euler";
    json!({
        "duration": recipe.duration,
        "step": recipe.options.step,
        "steps": recipe.steps,
        "integrator": integrator_name(recipe.options.integrator),
        "linear": recipe.options.linear,
        "iterations": is_newton.then_some(recipe.options.iterations),
        "tolerance": is_newton.then_some(recipe.options.tolerance),
        "every": recipe.every,
        "gravity": recipe.gravity,
        "rayleigh": if let DampingRecipe::Rayleigh(pair) = recipe.damping { Some(pair) } else { None },
        "damping_ratio": if let DampingRecipe::Ratio(ratio) = recipe.damping { Some(ratio) } else { None },
        "watched_points": motion.watched,
    })
}

/// One entry per model, one number per state written in its lists; null where a model has none.
pub(super) fn motion_json(model: &ModelMotion) -> Value {
    let each = |of: &dyn Fn(&crate::study::Record) -> Value| model.records.iter().map(of).collect::<Vec<_>>();
    json!({
        "name": model.name,
        "steps": model.steps,
        "seconds": model.seconds,
        "steps_per_second": if model.steps > 0 { Some(model.steps_per_second()) } else { None },
        "ended": match model.ending {
            MotionEnding::Complete => "complete",
            MotionEnding::NoResponse => "no response",
            MotionEnding::RanAway => "ran away",
            MotionEnding::Refused(_) => "not begun",
        },
        "reason": if let MotionEnding::Refused(why) = &model.ending { Some(why) } else { None },
        "unsolved_steps": model.unsolved,
        "growth": model.growth,
        "time": each(&|r| json!(r.account.time)),
        "kinetic": each(&|r| json!(r.account.kinetic)),
        "elastic": each(&|r| json!(r.account.elastic)),
        "work": each(&|r| json!(r.account.balance.map(|b| b.work))),
        "dissipated": each(&|r| json!(r.account.balance.map(|b| b.dissipated))),
        "drift": each(&|r| json!(r.account.balance.map(|b| b.drift))),
        "momentum": each(&|r| json!(r.account.momentum)),
        "angular_momentum": each(&|r| json!(r.account.angular_momentum)),
        "watched": each(&|r| json!(r.watched)),
        "e_rms": each(&|r| json!(r.error)),
        "e_rms_mean": model.error().map(|[mean, _]| mean),
        "e_rms_max": model.error().map(|[_, max]| max),
    })
}

/// One line per state written: `t` in s, energies, work and what was dissipated in J, the drift as a share of the largest energy,
/// momentum in kg m/s, the mean displacement of the watched points in m, and the error in percent. What is not known is empty.
pub fn motion_csv(model: &ModelMotion) -> String {
    let mut text = "t,kinetic,elastic,total,work,dissipated,drift".to_string();
    let Some(first) = model.records.first() else { return text + "\n" };
    let axes = ["x", "y", "z"];
    for (name, count) in [("p", first.account.momentum.len()), ("u", first.watched.len())] {
        axes[..count].iter().for_each(|axis| text += &format!(",{name}{axis}"));
    }
    let compared = model.error().is_some();
    text += if compared { ",e_rms\n" } else { "\n" };
    for record in &model.records {
        let account = &record.account;
        let balance = account.balance.map(|b| [b.work, b.dissipated, b.drift]);
        // Times are products of the step.
        let t = format!("{:.12e}", account.time).parse::<f64>().unwrap_or(account.time);
        write!(text, "{t},{:e},{:e},{:e}", account.kinetic, account.elastic, account.total()).expect("a String grows");
        (0..3).for_each(|i| text += &balance.map_or(",".into(), |b| format!(",{:e}", b[i])));
        account.momentum.iter().chain(&record.watched).for_each(|x| text += &format!(",{x:e}"));
        if let Some(error) = record.error {
            text += &format!(",{error:e}");
        }
        text.push('\n');
    }
    text
}
