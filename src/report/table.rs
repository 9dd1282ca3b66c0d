//! The table on the terminal.

use super::agreement::{Agreement, SAME, agreements};
use super::frequencies::{frequency_notes, frequency_table};
use super::json::status;
use super::motion::{motion_notes, motion_table};
use crate::fit::Spread;
use crate::mesh::Quality;
use crate::solve::{Ending, Standing};
use crate::study::{FitOutcome, Followed, LoadOutcome, Outcome, Reading, Recipe, WholeOutcome};
use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, ContentArrangement, Table, TableComponent};
use std::fmt::Write;

/// What was modelled, in a line or two.
pub fn summary(outcome: &Outcome) -> String {
    let mesh = &outcome.mesh;
    let cells: Vec<_> = mesh.blocks.iter().map(|b| format!("{} {}", b.cells().len(), b.element.name)).collect();
    let material = outcome.material;
    let mut text = format!(
        "{}\n{} points, {}; E = {} Pa, nu = {}{}\n",
        outcome.scene,
        mesh.point_count(),
        cells.join(", "),
        material.young(),
        material.poisson(),
        outcome.law.as_ref().map_or(String::new(), |law| format!(", {law}"))
    );
    if mesh.reversed > 0 {
        writeln!(text, "{} elements were numbered the other way round and have been turned", mesh.reversed)
            .expect("a String grows");
    }
    if mesh.unused_points > 0 {
        writeln!(text, "{} points of the file belong to no element and were left out", mesh.unused_points)
            .expect("a String grows");
    }
    for line in quality(&mesh.quality) {
        writeln!(text, "{line}").expect("a String grows");
    }
    text
}

/// What is wrong with the cells and points of a mesh, one line each.
fn quality(quality: &Quality) -> Vec<String> {
    let mut lines = Vec::new();
    if quality.skipped > 0 {
        lines.push(format!("{} cells of poor quality, flat or tangled, were left out", quality.skipped));
    }
    if let Some(worst) = quality.worst.as_ref().filter(|_| quality.poor > 0) {
        lines.push(format!(
            "{} cells have a quality below {:e}, the worst {:.1e} ({}): their constants lose as many digits",
            quality.poor, quality.least, worst.quality, worst.cell
        ));
    }
    if quality.coincident > 0 {
        lines.push(format!("{} points are at the place of another: the body is open there", quality.coincident));
    }
    if quality.hanging > 0 {
        lines.push(format!("{} points hang in the middle of edges that do not have them", quality.hanging));
    }
    lines
}

/// One row per fit; then, where they were asked for, natural frequencies and motions, one row per model.
pub fn table(outcome: &Outcome) -> String {
    let loads: Vec<&str> = outcome.fits.first().map_or(vec![], |f| f.loads.iter().map(|l| l.name.as_str()).collect());
    let mut header: Vec<String> =
        ["fit", "springs", "k < 0", "|R-K|/|R| Frobenius\nmean / max", "2-norm\nmean / max", "fit\nus/element"]
            .map(String::from)
            .into();
    let sampled = outcome.fits.iter().any(|fit| fit.sampled.is_some());
    if sampled {
        header.push("sampled forces %\nfitted / held out".into());
    }
    for (i, load) in loads.iter().enumerate() {
        header.push(format!("{load}\n%e_rms / %e_max"));
        if gauged(outcome, i) {
            header.push(format!("{load}, gauge\nE Pa / nu"));
        }
    }
    if !loads.is_empty() {
        header.push("network".into());
    }
    let rows: Vec<_> = outcome.fits.iter().map(|fit| row(outcome, fit, sampled)).collect();
    let under = [times(outcome), gauge(outcome), frequency_table(outcome), motion_table(outcome)];
    aligned(&header, &rows) + &under.concat()
}

/// Rows under a header: columns of words to the left, of numbers to the right.
pub(super) fn aligned(header: &[String], rows: &[Vec<String>]) -> String {
    let mut table = Table::new();
    table.load_preset(NOTHING).set_style(TableComponent::HeaderLines, '-');
    table.set_content_arrangement(ContentArrangement::Disabled).set_header(header).add_rows(rows);
    for (column, name) in table.column_iter_mut().zip(header) {
        let words = ["object", "objective", "solver", "fit", "network", "motion", "frequencies", "ended"];
        let words = words.contains(&name.as_str());
        column.set_cell_alignment(if words { CellAlignment::Left } else { CellAlignment::Right });
    }
    table.lines().map(|line| line.trim_end().to_string() + "\n").collect()
}

fn row(outcome: &Outcome, fit: &FitOutcome, sampled: bool) -> Vec<String> {
    let elements = outcome.mesh.cell_count();
    let pair = |spread: Option<Spread>| spread.map_or("-".into(), |s| format!("{:.4} / {:.4}", s.mean, s.max));
    let mut row = vec![
        fit.fit.name.clone(),
        fit.network.len().to_string(),
        fit.network.negative().to_string(),
        pair(fit.frobenius),
        pair(fit.spectral),
        format!("{:.2}", 1e6 * fit.seconds / elements.max(1) as f64),
    ];
    if sampled {
        let percent = |spread: &Spread| format!("{:.2}", 100.0 * spread.mean);
        row.push(fit.sampled.as_ref().map_or("-".into(), |s| {
            format!("{} / {:>5}", percent(&s.trained), s.held_out.as_ref().map_or("-".into(), percent))
        }));
    }
    for (i, load) in fit.loads.iter().enumerate() {
        row.push(load.error.map_or("-".into(), |e| format!("{:.2} / {:5.2}", e.rms, e.max)));
        if gauged(outcome, i) {
            row.push(load.gauged.map_or("-".into(), |r| format!("{:.4e} / {:.3}", r.young, r.poisson)));
        }
    }
    if !fit.loads.is_empty() {
        row.push(status(fit).into());
    }
    row
}

/// Whether the scene's gauge says something under the load of that number.
fn gauged(outcome: &Outcome, load: usize) -> bool {
    outcome.gauged.get(load).is_some_and(Option::is_some)
}

/// What the gauge says of the finite elements.
fn gauge(outcome: &Outcome) -> String {
    let loads = outcome.fits.first().map_or(&[][..], |fit| &fit.loads);
    let line = |(load, reading): (&LoadOutcome, &Option<Reading>)| {
        let Reading { young, poisson } = (*reading)?;
        Some(format!("Gauge of the finite elements under {}: E = {young:.4e} Pa, nu = {poisson:.3}.\n", load.name))
    };
    loads.iter().zip(&outcome.gauged).filter_map(line).collect()
}

fn times(outcome: &Outcome) -> String {
    let loads: Vec<_> = outcome.fits.iter().flat_map(|f| &f.loads).collect();
    if loads.is_empty() {
        return String::new();
    }
    let mean = |seconds: &dyn Fn(&crate::study::LoadOutcome) -> f64| {
        1e3 * loads.iter().map(|l| seconds(l)).sum::<f64>() / loads.len() as f64
    };
    format!(
        "One load, assembled and solved: {:.2} ms with finite elements, {:.2} ms with springs (means).\n",
        mean(&|l| l.seconds_fem),
        mean(&|l| l.seconds_lem)
    )
}

/// What a reader must know before trusting a row, one sentence per line.
pub fn notes(outcome: &Outcome) -> Vec<String> {
    let loads = outcome.fits.first().map_or(&[][..], |fit| &fit.loads);
    let finite = loads.iter().zip(&outcome.followed).filter_map(|(load, followed)| trouble(&load.name, followed));
    let finite = finite.map(|trouble| format!("finite elements: {trouble}"));
    let measured = outcome.measured.iter().map(|load| {
        let error = load.error.map_or("-".into(), |e| format!("%e_rms / %e_max {:.2} / {:.2}", e.rms, e.max));
        format!(
            "errors under {} are those from what was measured at {} points; finite elements: {error}",
            load.name, load.points
        )
    });
    let own = outcome.fits.iter().flat_map(|fit| note(outcome, fit));
    let starts = agreements(outcome);
    let silent = loads.iter().zip(&outcome.gauged).filter(|(_, reading)| reading.is_none()).map(|(load, _)| {
        let why = "it needs a force along its axis that acts at one side of it alone";
        format!("the gauge says nothing under {}: {why}", load.name)
    });
    let notes = finite.chain(silent).chain(measured).chain(own).chain(starts.iter().map(agreed));
    notes.chain(frequency_notes(outcome)).chain(motion_notes(outcome)).collect()
}

/// What is wrong with an equilibrium.
fn trouble(load: &str, followed: &Followed) -> Option<String> {
    match (followed.ending, followed.inverted) {
        (Ending::Stalled, _) if followed.residual.is_nan() => {
            Some(format!("no finite response at {:.3} of the load {load}", followed.load))
        }
        (Ending::Stalled, _) => Some(format!(
            "no equilibrium found beyond {:.3} of the load {load} (residual {:.1e} there)",
            followed.load, followed.residual
        )),
        (_, 0) => None,
        (_, count) => Some(format!("{count} elements are turned inside out under {load}")),
    }
}

fn note(outcome: &Outcome, fit: &FitOutcome) -> Vec<String> {
    let name = &fit.fit.name;
    let mut notes = Vec::new();
    if fit.deficient > 0 {
        notes.push(format!(
            "{name}: in {} elements this objective does not determine the springs; of all optima the least was taken",
            fit.deficient
        ));
    }
    if let (Some(unmet), Recipe::Published(method)) = (&fit.unmet, &fit.fit.recipe) {
        let all = outcome.mesh.cell_count();
        let ratio = unmet.poisson.map(|assumed| {
            format!("is made for Poisson's ratio {assumed:.4}, the material's is {}", outcome.material.poisson())
        });
        let shape = (unmet.cells > 0).then(|| {
            let percent = 100.0 * unmet.deviation;
            format!(
                "{} of {all} elements do not have the shape it is made for (lengths off by up to {percent:.0} %)",
                unmet.cells
            )
        });
        let lacking: Vec<String> = ratio.into_iter().chain(shape).collect();
        if !lacking.is_empty() {
            notes.push(format!("{name}: {} {}", method.name(), lacking.join("; ")));
        }
    }
    if fit.reused > 0 {
        notes.push(format!("{name}: {} elements have the shape of another and took its constants over", fit.reused));
    }
    if fit.unreached > 0 {
        notes.push(format!("{name}: in {} elements the iteration stopped short of the optimum", fit.unreached));
    }
    if let Some(gap) = fit.gap {
        let mut note = format!("{name}: certified, no constants do better by more than {gap:.1e} of the error");
        if fit.ambiguous > 0 {
            note += &format!("; in {} elements others do as well: the least Frobenius error decides", fit.ambiguous);
        }
        notes.push(note);
    }
    if let Some(epsilon) = fit.energy_error {
        notes.push(format!("{name}: the energy of every deformation is within {:.1} % of the body's", 100.0 * epsilon));
    }
    if let Some(m) = &fit.moduli {
        let (young, thickness) = (outcome.material.young(), outcome.material.thickness());
        notes.push(format!(
            "{name}: as a material E = {:.4e} Pa, nu = {:.3}, Zener {:.3}; asked {young:e} Pa, {}, 1",
            m.young / thickness,
            m.poisson,
            m.zener,
            outcome.material.poisson()
        ));
    }
    if let Some(sampled) = &fit.sampled {
        if !sampled.loads.is_empty() {
            notes.push(format!(
                "{name}: fitted to the shapes of the finite elements under {}: its errors there are not held out",
                sampled.loads.join(", ")
            ));
        }
        if let Some(agreeing) = sampled.agreeing.filter(|share| *share < 1.0) {
            notes.push(format!(
                "{name}: in the worst element {:.0} % of the starts found the best parameters, the others worse ones",
                100.0 * agreeing
            ));
        }
    }
    if let Some(whole) = &fit.whole {
        notes.push(format!("{name}: {}", seen(whole)));
    }
    for load in &fit.loads {
        if let Some(trouble) = load.followed.and_then(|followed| trouble(&load.name, &followed)) {
            notes.push(format!("{name}: {trouble}"));
        }
    }
    let Some(stability) = &fit.stability else { return notes };
    let points = points(outcome, &fit.loose_points);
    let [least, _] = stability.energy_ratio;
    let remedy = if fit.network.negative() > 0 {
        format!("; it has {} negative springs, which \"nonnegative = true\" forbids", fit.network.negative())
    } else {
        String::new()
    };
    match stability.standing {
        Standing::Sound => {}
        Standing::Soft => notes.push(format!(
            "{name}: near-mechanism, some motion meets only {least:.1e} of the body's resistance; its displacements are \
             not to be trusted. Loosest: {points}{remedy}"
        )),
        Standing::Indefinite => notes.push(format!(
            "{name}: indefinite, some motion releases energy ({least:.1e} of what the body stores): it has an equilibrium \
             but runs away from it. Moving most: {points}{remedy}"
        )),
        Standing::Singular => notes.push(format!(
            "{name}: mechanism, some motion meets no resistance, so no displacement is given. Moving freely: {points}{remedy}"
        )),
    }
    notes
}

fn agreed(agreement: &Agreement) -> String {
    let percent = 100.0 * agreement.difference;
    let verdict = match agreement.difference <= SAME {
        true => format!("agree within {percent:.0} %"),
        false if percent.is_finite() => format!("do not agree: they differ by up to {percent:.0} %"),
        false => "do not agree: one of them is not known".into(),
    };
    format!("{}: held-out errors {verdict} ({})", agreement.fits.join(", "), agreement.load)
}

/// What a whole-object fit has seen and done.
fn seen(whole: &WholeOutcome) -> String {
    let validated = match &whole.validated[..] {
        [] => String::new(),
        loads => format!(", rho chosen by {}", loads.join(", ")),
    };
    let done = match whole.regularization {
        Some(rho) => {
            let (change, range) = (whole.change, whole.range);
            format!(
                "rho {rho:.0e}, {} steps, constants changed by factors up to {change:.1}, range {range:.0}",
                whole.steps
            )
        }
        None if !whole.stands => "at the start it does not stand under each of them, so it is left as it was".into(),
        None => format!("none of the rho tried did better than the start, {} steps", whole.steps),
    };
    let largest = |errors: &[f64]| 100.0 * errors.iter().fold(0.0f64, |a, e| a.max(e.abs()));
    let [before, after] = [0, 1].map(|i| largest(&whole.frequencies[i]));
    let done = match whole.frequencies[0].len() {
        0 => done,
        count => format!("{done}, {count} frequencies off by up to {before:.1} -> {after:.1} %"),
    };
    let ended = match (whole.cancelled, whole.limited) {
        (true, _) => "; ended before its time",
        (_, true) => "; a smaller rho goes beyond the range that is allowed",
        _ => "",
    };
    format!("fitted to {}, whose errors are not held out{validated}: {done}{ended}", whole.loads.join(", "))
}

fn points(outcome: &Outcome, points: &[usize]) -> String {
    let place = |&p: &usize| {
        let x: Vec<String> = outcome.mesh.point(p).iter().map(|x| format!("{x:.4}")).collect();
        format!("{} ({})", p + 1, x.join(", "))
    };
    let named: Vec<_> = points.iter().take(3).map(place).collect();
    let rest = if points.len() > 3 { format!(" and {} more", points.len() - 3) } else { String::new() };
    let word = if points.len() == 1 { "point" } else { "points" };
    format!("{word} {}{rest}", named.join(", "))
}
