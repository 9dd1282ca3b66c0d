//! The table on the terminal.

use super::agreement::{Agreement, agreements};
use super::columns::{Heading, aligned};
use super::frequencies::{frequency_notes, frequency_table};
use super::linear_theory::linear_notes;
use super::load_errors::load_error_table;
use super::materials::{material_note, material_table};
use super::motion::{motion_notes, motion_table};
use super::quality::{changes, counted, quality_lines};
use super::region_record::RegionRecord;
use crate::fit::Spread;
use crate::mesh::Filled;
use crate::model::Lumping;
use crate::solve::{Ending, Standing};
use crate::study::{BodyLoad, FitOutcome, Followed, GaugeResult, LoadOutcome, Outcome, Reading, extent};
use crate::text::printable;
use std::fmt::Write;

/// The mesh, the size of the body and the material.
pub(super) fn summary_line(outcome: &Outcome) -> String {
    let mesh = &outcome.mesh;
    let cells: Vec<_> = mesh.blocks.iter().map(|b| format!("{} {}", b.cells().len(), b.element.name)).collect();
    format!(
        "{} points, {}, {}; {}{}",
        mesh.point_count(),
        cells.join(", "),
        size(&extent(mesh)),
        material_words(outcome),
        outcome.law.as_ref().map_or(String::new(), |law| format!(", {law}"))
    )
}

/// The material, or the number of regions with their own.
fn material_words(outcome: &Outcome) -> String {
    match &RegionRecord::all(outcome)[..] {
        [one] => one.words(),
        regions => format!("{} materials", regions.len()),
    }
}

/// What was modelled, in a few lines.
pub fn summary(outcome: &Outcome) -> String {
    let mesh = &outcome.mesh;
    let given =
        if outcome.settings.is_empty() { String::new() } else { format!(" with {}", outcome.settings.join(", ")) };
    let mut text = format!("{}\n{}\n", printable(&(outcome.scene.clone() + &given)), summary_line(outcome));
    for line in changes(mesh) {
        writeln!(text, "{line}").expect("a String grows");
    }
    if let Some(numbering) = mesh.numbering.as_ref().filter(|numbering| !numbering.is_contiguous()) {
        let title = numbering.title();
        writeln!(
            text,
            "in the output, \"points\" are indices from 0 and \"nodes\" are the numbers of the mesh file: {title}"
        )
        .expect("a String grows");
    }
    for region in RegionRecord::all(outcome) {
        if let Some(name) = &region.region {
            let cells = counted(region.cells, "cell");
            writeln!(text, "material of {}: {}, {cells}", printable(name), region.words()).expect("a String grows");
        }
    }
    for line in quality_lines(&mesh.quality) {
        writeln!(text, "{line}").expect("a String grows");
    }
    text
}

/// The sizes along the axes, such as `0.120 x 0.075 x 0.062 m`: the largest has three digits.
pub(super) fn size(extent: &[f64]) -> String {
    let largest = extent.iter().fold(0.0, |largest: f64, x| largest.max(*x));
    let decimals = (2.0 - largest.log10().floor()).clamp(0.0, 9.0) as usize;
    let along = |x: &f64| match largest {
        1e-4..1e6 => format!("{x:.decimals$}"),
        _ => format!("{x:.2e}"),
    };
    format!("{} m", extent.iter().map(along).collect::<Vec<_>>().join(" x "))
}

/// One row per fit, and what each network is as a material; then, where they were asked for, natural frequencies and motions, one row per model.
pub fn table(outcome: &Outcome) -> String {
    let mut header = vec![Heading::words("fit")];
    header.extend(
        ["springs", "k < 0", "|R-K|/|R| Frobenius\nmean / max", "2-norm\nmean / max", "fit\nus/element"]
            .map(Heading::numbers),
    );
    let sampled = outcome.fits.iter().any(|fit| fit.kind.sampled().is_some());
    if sampled {
        header.push(Heading::numbers("sampled forces %\nfitted / held out"));
    }
    for load in &outcome.loads {
        header.push(Heading::numbers(format!("{}\n%e_rms / %e_max", printable(&load.name))));
        if load.reading().is_some() {
            header.push(Heading::numbers(format!("{}, gauge\nE Pa / nu", printable(&load.name))));
        }
    }
    if !outcome.loads.is_empty() {
        header.push(Heading::words("network"));
    }
    let rows: Vec<_> = outcome.fits.iter().map(|fit| row(outcome, fit, sampled)).collect();
    let under = [
        load_error_table(outcome),
        material_table(outcome),
        times(outcome),
        gauge(outcome),
        frequency_table(outcome),
        motion_table(outcome),
    ];
    aligned(&header, &rows) + &under.concat()
}

fn row(outcome: &Outcome, fit: &FitOutcome, sampled: bool) -> Vec<String> {
    let elements = outcome.mesh.cell_count();
    let pair = |spread: Option<Spread>| spread.map_or("-".into(), |s| format!("{:.4} / {:.4}", s.mean, s.max));
    let mut row = vec![
        fit.fit.name.clone(),
        fit.network.len().to_string(),
        fit.network.negative().to_string(),
        pair(fit.frobenius()),
        pair(fit.spectral()),
        format!("{:.2}{}", 1e6 * fit.seconds / elements.max(1) as f64, if fit.reused > 0 { "*" } else { "" }),
    ];
    if sampled {
        let percent = |spread: &Spread| format!("{:.2}", 100.0 * spread.mean);
        row.push(fit.kind.sampled().map_or("-".into(), |s| {
            format!("{} / {:>5}", percent(&s.trained), s.held_out.as_ref().map_or("-".into(), percent))
        }));
    }
    for (load, body) in fit.loads.iter().zip(&outcome.loads) {
        row.push(load.error.map_or("-".into(), |e| format!("{:.2} / {:5.2}", e.rms, e.max)));
        if body.reading().is_some() {
            row.push(load.gauge.map_or("-".into(), |r| format!("{:.4e} / {:.3}", r.young, r.poisson)));
        }
    }
    if !fit.loads.is_empty() {
        row.push(fit.status().into());
    }
    row
}

/// The gauge's readings of the finite elements.
fn gauge(outcome: &Outcome) -> String {
    let line = |load: &BodyLoad| {
        let Reading { young, poisson } = load.reading()?;
        Some(format!(
            "Gauge reading of the finite elements under {}: E = {young:.4e} Pa, nu = {poisson:.3}.\n",
            load.name
        ))
    };
    outcome.loads.iter().filter_map(line).collect()
}

fn times(outcome: &Outcome) -> String {
    let loads: Vec<_> = outcome.fits.iter().flat_map(|f| &f.loads).collect();
    if loads.is_empty() {
        return String::new();
    }
    let mean = |seconds: &dyn Fn(&LoadOutcome) -> f64| {
        let mean = loads.iter().map(|l| seconds(l)).sum::<f64>() / loads.len() as f64;
        if mean < 1.0 { format!("{:.2} ms", 1e3 * mean) } else { format!("{mean:.2} s") }
    };
    format!(
        "One load, assembled and solved: {} with finite elements, {} with springs (means).\n",
        mean(&|l| l.seconds_fem),
        mean(&|l| l.seconds_lem)
    ) + &iterations(&loads)
}

/// How iterations went, where there were any: the most of all loads and models, and the largest residual.
fn iterations(loads: &[&LoadOutcome]) -> String {
    let solved = || loads.iter().flat_map(|l| l.solved_fem.iter().chain(&l.solved_lem));
    let iterated: Vec<_> = solved().filter(|solved| solved.iterations.is_some()).collect();
    let Some(most) = iterated.iter().max_by_key(|solved| solved.iterations) else { return String::new() };
    format!(
        "{} unknowns solved by conjugate gradients with multigrid: at most {} iterations, residual {:.1e}; nodes x unknowns of the levels: \
         {}.\n",
        most.unknowns,
        most.iterations.unwrap_or(0),
        iterated.iter().map(|solved| solved.residual).fold(0.0, f64::max),
        most.levels.as_deref().unwrap_or("-").replace('×', "x")
    )
}

/// What a reader must know before trusting a row, one sentence per line.
pub fn notes(outcome: &Outcome) -> Vec<String> {
    let filled = outcome.mesh.quality.filled.as_ref().map_or(Vec::new(), Filled::lines);
    filled.into_iter().chain(notes_beside_summary(outcome)).collect()
}

/// The same without the lines that [`summary`] has.
pub fn notes_beside_summary(outcome: &Outcome) -> Vec<String> {
    let finite = outcome.loads.iter().filter_map(|load| trouble(&load.name, load.followed.as_ref()?));
    let finite = finite.map(|trouble| format!("finite elements: {trouble}"));
    let measured = outcome.loads.iter().filter_map(|load| {
        let measured = load.measured?;
        let error = measured.error.map_or("-".into(), |e| format!("%e_rms / %e_max {:.2} / {:.2}", e.rms, e.max));
        let by = if measured.is_of_finer { "of the finer body" } else { "measured" };
        Some(format!(
            "errors under {} are relative to the displacements {by} at {} points; finite elements: {error}",
            load.name, measured.points
        ))
    });
    let own = outcome.fits.iter().flat_map(|fit| note(outcome, fit));
    let starts = agreements(outcome);
    let silent = outcome.loads.iter().filter(|load| load.gauge == Some(GaugeResult::NoReading)).map(|load| {
        let why = "it requires a force along its axis that acts on one side of it only";
        format!("the gauge has no reading under {}: {why}", load.name)
    });
    let notes = outcome
        .assumed
        .iter()
        .cloned()
        .chain(fibres(outcome))
        .chain(outcome.mesh.quality.filled.as_ref().and_then(Filled::far_off))
        .chain(outcome.of_loads.iter().cloned())
        .chain(lumping(outcome))
        .chain(finite)
        .chain(linear_notes(outcome))
        .chain(silent)
        .chain(measured)
        .chain(own)
        .chain(starts.iter().map(agreed));
    notes.chain(frequency_notes(outcome)).chain(motion_notes(outcome)).collect()
}

/// That what is linear does not know the fibres of the law.
fn fibres(outcome: &Outcome) -> Option<String> {
    let (law, share) = (outcome.law.as_ref()?, 100.0 * outcome.fibres?);
    Some(format!(
        "{law}: with its fibres the elasticity tensor at rest differs by {share:.1} % from that of E and nu. Errors of matrices, the networks \
         as materials and fits of linear springs are for E and nu, without fibres"
    ))
}

/// That masses are not the row sums that most expect. A motion says itself how it lumps them.
fn lumping(outcome: &Outcome) -> Option<String> {
    let is_hrz = outcome.motion.is_none() && outcome.lumping == Some(Lumping::Hrz);
    is_hrz.then(|| "some row sums of the mass matrix are not positive: the masses are those of the HRZ method".into())
}

/// What is wrong with an equilibrium.
fn trouble(load: &str, followed: &Followed) -> Option<String> {
    match (followed.ending, followed.inverted) {
        (Ending::Stalled, _) if followed.residual.is_nan() => {
            Some(format!("the response is not finite at {:.3} of the load {load}", followed.load))
        }
        (Ending::Stalled, _) => Some(format!(
            "no equilibrium was found beyond {:.3} of the load {load} (residual {:.1e} there)",
            followed.load, followed.residual
        )),
        (Ending::Converged, 0) if followed.is_rounded => Some(format!(
            "under {load} rounding limits the equilibrium: the residual is {:.1e} of the forces",
            followed.residual
        )),
        (_, 0) => None,
        (_, count) => Some(format!("{count} elements are inverted under {load}")),
    }
}

fn note(outcome: &Outcome, fit: &FitOutcome) -> Vec<String> {
    let name = &fit.fit.name;
    let mut notes = Vec::new();
    if fit.deficient > 0 {
        notes.push(format!(
            "{name}: in {} elements the objective has more than one optimum; the one with the smallest constants is used",
            fit.deficient
        ));
    }
    if fit.reused > 0 {
        let cells = outcome.mesh.cell_count();
        let fitted = cells.saturating_sub(fit.reused).max(1);
        notes.push(format!(
            "{name}: {fitted} of {cells} elements {} fitted, in {:.3} us each. Each of the others has the shape of one of them and takes its \
             constants (* in the table)",
            if fitted == 1 { "was" } else { "were" },
            1e6 * fit.seconds / fitted as f64
        ));
    }
    if fit.unreached > 0 {
        let elements = if fit.unreached == 1 { "element" } else { "elements" };
        notes
            .push(format!("{name}: in {} {elements} the iteration ended before it reached the optimum", fit.unreached));
    }
    let own = fit.kind.notes(outcome.mesh.cell_count(), &outcome.material);
    notes.extend(own.into_iter().map(|note| format!("{name}: {note}")));
    notes.extend(material_note(outcome, fit));
    if let Some(m) = &fit.moduli {
        let (of, unit) = match outcome.material.thicknesses().uniform() {
            Some(thickness) => (m.young / thickness, "Pa"),
            None => (m.young, "N/m"),
        };
        let material = outcome.material.uniform().map_or(String::new(), |material| {
            format!("; the material has {:e} Pa, {}, 1", material.young(), material.poisson())
        });
        notes.push(format!(
            "{name}: the whole network has E = {of:.4e} {unit}, nu = {:.3}, Zener ratio {:.3}{material}",
            m.poisson, m.zener,
        ));
    }
    for load in &fit.loads {
        if let Some(trouble) = load.followed.and_then(|followed| trouble(&load.name, &followed)) {
            notes.push(format!("{name}: {trouble}"));
        }
    }
    let Some(stability) = &fit.stability else { return notes };
    let points = points(outcome, &fit.loose_points);
    let [least, _] = stability.energy_ratio;
    let remedy = if fit.network.negative() > 0 && fit.kind.published().is_some() {
        format!("; {} spring constants are negative", fit.network.negative())
    } else if fit.network.negative() > 0 {
        format!("; {} spring constants are negative, which \"nonnegative = true\" prevents", fit.network.negative())
    } else {
        String::new()
    };
    let reason = fit.loads.iter().find_map(|load| load.unsolved.as_ref());
    let reason = reason.map_or(String::new(), |reason| format!(" ({reason})"));
    let unsolved = match fit.loads.iter().all(|load| load.displacement.is_none()) {
        true => format!(", and no displacements are given{reason}"),
        false => String::new(),
    };
    if !stability.is_found && [Standing::Stable, Standing::Soft].contains(&stability.standing) {
        notes.push(format!(
            "{name}: the search for the softest motion has not converged; the least energy ratio may be lower than {least:.1e}"
        ));
    }
    match stability.standing {
        Standing::Stable => {}
        Standing::Soft => notes.push(format!(
            "{name}: near-mechanism, a motion has only {least:.1e} of the body's stiffness; the displacements are unreliable. \
             Loosest: {points}{remedy}"
        )),
        Standing::Indefinite => notes.push(format!(
            "{name}: indefinite, a motion releases energy ({least:.1e} of the energy that it stores in the body): the \
             equilibrium is unstable{unsolved}. Moving most: {points}{remedy}"
        )),
        Standing::Singular => notes.push(format!(
            "{name}: mechanism, a motion has no stiffness, so no displacements are given. Moving freely: {points}{remedy}"
        )),
    }
    notes
}

fn agreed(agreement: &Agreement) -> String {
    let percent = 100.0 * agreement.difference;
    let verdict = match agreement.agree {
        true => format!("agree within {percent:.0} %"),
        false if percent.is_finite() => format!("do not agree: they differ by up to {percent:.0} %"),
        false => "cannot be compared: one of them is not known".into(),
    };
    format!("{}: held-out errors {verdict} ({})", agreement.fits.join(", "), agreement.load)
}

fn points(outcome: &Outcome, points: &[usize]) -> String {
    let place = |&p: &usize| {
        let x: Vec<String> = outcome.mesh.point(p).iter().map(|x| format!("{x:.4}")).collect();
        format!("{} ({})", outcome.mesh.point_number(p), x.join(", "))
    };
    let named: Vec<_> = points.iter().take(3).map(place).collect();
    let rest = if points.len() > 3 { format!(" and {} more", points.len() - 3) } else { String::new() };
    let (word, many) = (outcome.mesh.point_word(), if points.len() == 1 { "" } else { "s" });
    format!("{word}{many} {}{rest}", named.join(", "))
}
