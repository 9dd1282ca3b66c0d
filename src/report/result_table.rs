//! The tables of a report: one home for those of the page, of LaTeX and of Markdown.

use super::columns::Heading;
use super::fit_record::FitRecord;
use super::json::Report;
use super::load_record::LoadRecord;
use super::motion_record::MotionRecord;
use crate::number::finite;
use crate::study::FrequencyOutcome;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A table of a report.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ResultTable {
    /// A word for it.
    pub name: String,
    /// What it shows.
    pub title: String,
    /// The headings.
    pub columns: Vec<ColumnRecord>,
    /// The cells, row after row.
    pub rows: Vec<Vec<CellRecord>>,
}

/// The heading of a column.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ColumnRecord {
    /// The name of the column.
    pub title: String,
    /// Of its numbers; empty for words and shares.
    pub unit: String,
    /// Whether its cells are numbers.
    pub numbers: bool,
}

/// A cell: what it shows, and the number behind it, by which rows are sorted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CellRecord {
    /// What is shown; `–` where nothing is known.
    pub text: String,
    /// Null for words, and where nothing is known.
    pub value: Option<f64>,
}

/// How a number is shown.
#[derive(Debug, Clone, Copy)]
enum Digits {
    /// Behind the point.
    Fixed(usize),
    /// All that differ from zero, at most so many.
    Significant(usize),
}
use Digits::{Fixed, Significant};

impl ResultTable {
    /// All tables for which the report has results.
    pub fn all(report: &Report) -> Vec<ResultTable> {
        let all = [
            fits(report),
            errors(report),
            materials(report),
            times(report),
            whole(report),
            frequencies(report),
            motions(report),
        ];
        all.into_iter().filter(|table| !table.rows.is_empty()).collect()
    }

    /// A table that is printed as well: rows of texts under their headings.
    pub(super) fn printed(name: &str, title: &str, columns: &[Heading], rows: &[Vec<String>]) -> ResultTable {
        let column = |heading: &Heading| ColumnRecord {
            title: heading.text.split_whitespace().collect::<Vec<_>>().join(" ").replace("- ", "-"),
            unit: String::new(),
            numbers: heading.is_of_numbers(),
        };
        let cell = |(text, column): (&String, &Heading)| CellRecord {
            text: text.clone(),
            value: text.parse().ok().filter(|_| column.is_of_numbers()),
        };
        let row = |row: &Vec<String>| row.iter().zip(columns).map(cell).collect();
        ResultTable::new(name, title, columns.iter().map(column).collect(), rows.iter().map(row).collect())
    }

    fn new(name: &str, title: &str, columns: Vec<ColumnRecord>, rows: Vec<Vec<CellRecord>>) -> ResultTable {
        ResultTable { name: name.into(), title: title.into(), columns, rows }
    }
}

fn words(title: &str) -> ColumnRecord {
    ColumnRecord { title: title.into(), unit: String::new(), numbers: false }
}

fn numbers(title: impl Into<String>, unit: &str) -> ColumnRecord {
    ColumnRecord { title: title.into(), unit: unit.into(), numbers: true }
}

fn text(text: &str) -> CellRecord {
    CellRecord { text: text.into(), value: None }
}

fn number(value: Option<f64>, digits: Digits) -> CellRecord {
    let shown = |value: f64| match digits {
        // Without the sign of a zero.
        Fixed(places) => {
            format!("{value:.places$}").replacen(&format!("-{:.places$}", 0.0), &format!("{:.places$}", 0.0), 1)
        }
        Significant(count) => significant(value, count),
    };
    CellRecord { text: value.map_or("–".into(), shown), value }
}

fn count(value: usize) -> CellRecord {
    CellRecord { text: value.to_string(), value: Some(value as f64) }
}

/// A number with so many digits; beyond six places before or four zeros behind the point with its power of ten.
pub(super) fn significant(value: f64, digits: usize) -> String {
    let power = if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 };
    match power {
        -4..6 => format!("{value:.*}", (digits as i32 - 1 - power).max(0) as usize),
        _ => format!("{value:.*e}", digits - 1),
    }
}

fn fits(report: &Report) -> ResultTable {
    let columns = vec![
        words("fit"),
        words("network"),
        numbers("springs", ""),
        numbers("k < 0", ""),
        numbers("|R−K|/|R| Frobenius, mean", ""),
        numbers("max", ""),
        numbers("2-norm, mean", ""),
        numbers("max", ""),
        numbers("fit", "µs/element"),
        numbers("all", "ms"),
    ];
    let row = |fit: &FitRecord| {
        let share = |value| number(finite(value), Fixed(4));
        vec![
            text(&fit.name),
            text(&fit.status),
            count(fit.springs),
            count(fit.negative_springs),
            share(fit.relative_frobenius.mean),
            share(fit.relative_frobenius.max),
            share(fit.relative_spectral.mean),
            share(fit.relative_spectral.max),
            number(Some(1e6 * fit.seconds_per_element), Fixed(2)),
            number(Some(1e3 * fit.seconds), Significant(3)),
        ]
    };
    ResultTable::new(
        "fits",
        "Networks and the matrices of their elements",
        columns,
        report.fits.iter().map(row).collect(),
    )
}

fn errors(report: &Report) -> ResultTable {
    let mut columns = vec![words("fit")];
    let loads = report.fits.first().map_or(&[][..], |fit| &fit.loads);
    for load in loads {
        columns.extend(
            ["e_rms", "e_max", "e_tip", "e_energy"].map(|error| numbers(format!("{}: {error}", load.name), "%")),
        );
    }
    let row = |fit: &FitRecord| {
        let of = |load: &LoadRecord| {
            [load.e_rms, load.e_max, load.e_tip, load.e_energy].map(|error| number(error, Fixed(2)))
        };
        std::iter::once(text(&fit.name)).chain(fit.loads.iter().flat_map(of)).collect()
    };
    let rows = if loads.is_empty() { Vec::new() } else { report.fits.iter().map(row).collect() };
    let title = "Errors of the displacements in percent of the largest; e_energy is that of the compliance";
    ResultTable::new("errors", title, columns, rows)
}

fn materials(report: &Report) -> ResultTable {
    let columns = vec![
        words("fit"),
        numbers("E", "Pa"),
        numbers("ν", ""),
        numbers("tensor off", "%"),
        numbers("of the mean", "%"),
        numbers("of the worst", "%"),
        numbers("whole: E", "Pa"),
        numbers("whole: ν", ""),
        numbers("whole: Zener", ""),
    ];
    let row = |fit: &FitRecord| {
        let m = &fit.as_material;
        let percent = |share: Option<f64>| number(share.map(|share| 100.0 * share), Fixed(1));
        vec![
            text(&fit.name),
            number(m.young, Significant(5)),
            number(m.poisson, Fixed(3)),
            percent(finite(m.distance)),
            percent(finite(m.mean_distance)),
            percent(finite(m.largest_distance)),
            number(fit.effective_young, Significant(5)),
            number(fit.effective_poisson, Fixed(3)),
            number(fit.zener, Fixed(3)),
        ]
    };
    let asked = match (report.young, report.poisson) {
        (Some(young), Some(poisson)) => format!("asked for are E = {young} Pa, ν = {poisson}"),
        _ => "those that are asked for differ from cell to cell".into(),
    };
    let title = format!("Networks as materials; {asked}");
    let whole = report.fits.iter().any(|fit| fit.effective_young.is_some());
    let shown = if whole { columns.len() } else { columns.len() - 3 };
    let rows = report.fits.iter().map(row).map(|row: Vec<_>| row.into_iter().take(shown).collect()).collect();
    ResultTable::new("materials", &title, columns.into_iter().take(shown).collect(), rows)
}

fn times(report: &Report) -> ResultTable {
    let columns = vec![
        words("fit"),
        words("load"),
        numbers("finite elements", "ms"),
        numbers("springs", "ms"),
        words("solver"),
        numbers("unknowns", ""),
        numbers("iterations", ""),
        numbers("residual", ""),
    ];
    let row = |fit: &FitRecord, load: &LoadRecord| {
        let solver = load.solver_lem.as_ref();
        let known = |value: Option<usize>| number(value.map(|value| value as f64), Fixed(0));
        let followed = load.followed.as_ref();
        vec![
            text(&fit.name),
            text(&load.name),
            number(Some(1e3 * load.seconds_fem), Significant(3)),
            number(Some(1e3 * load.seconds_lem), Significant(3)),
            text(solver.map_or(if followed.is_some() { "Newton" } else { "–" }, |solver| &solver.method)),
            known(solver.map(|solver| solver.unknowns)),
            known(solver.and_then(|solver| solver.iterations).or(followed.map(|followed| followed.iterations))),
            number(solver.map(|s| s.residual).or(followed.map(|f| f.residual)).and_then(finite), Significant(2)),
        ]
    };
    let rows = report.fits.iter().flat_map(|fit| fit.loads.iter().map(move |load| row(fit, load))).collect();
    ResultTable::new("times", "Times to assemble and solve, each load as if it were alone", columns, rows)
}

fn whole(report: &Report) -> ResultTable {
    let columns =
        vec![words("fit"), words("load"), words("used for"), numbers("error before", "%"), numbers("error after", "%")];
    let mut rows = Vec::new();
    for fit in &report.fits {
        let Some(whole) = &fit.whole else { continue };
        let fitted = whole.fitted.iter().map(|load| (load, "fit"));
        for (load, use_) in fitted.chain(whole.judged.iter().map(|load| (load, "validation"))) {
            let percent = |share: f64| number(finite(share).map(|share| 100.0 * share), Fixed(2));
            rows.push(vec![text(&fit.name), text(&load.load), text(use_), percent(load.before), percent(load.after)]);
        }
    }
    ResultTable::new("whole", "Whole-object fits: errors at the start and at the end", columns, rows)
}

fn frequencies(report: &Report) -> ResultTable {
    let known = |model: &FrequencyOutcome| model.frequencies.clone().unwrap_or_default();
    let most = report.frequencies.iter().map(|model| known(model).len()).max().unwrap_or(0);
    let columns = std::iter::once(words("model")).chain((1..=most).map(|i| numbers(format!("{i}"), "Hz"))).collect();
    let row = |model: &FrequencyOutcome| {
        let values = known(model);
        let found = (0..most).map(|i| number(values.get(i).copied(), Significant(4)));
        std::iter::once(text(&model.name)).chain(found).collect()
    };
    ResultTable::new("frequencies", "Natural frequencies", columns, report.frequencies.iter().map(row).collect())
}

fn motions(report: &Report) -> ResultTable {
    let columns = vec![
        words("model"),
        words("ended"),
        numbers("steps", ""),
        numbers("speed", "steps/s"),
        numbers("e_rms, mean", "%"),
        numbers("e_rms, max", "%"),
        numbers("drift of the energy", "%"),
    ];
    let row = |model: &MotionRecord| {
        let drift = model.drift.last().copied().flatten();
        vec![
            text(&model.name),
            text(&model.ended),
            count(model.steps),
            number(model.steps_per_second, Significant(3)),
            number(model.e_rms_mean, Fixed(2)),
            number(model.e_rms_max, Fixed(2)),
            number(drift.map(|share| 100.0 * share), Significant(2)),
        ]
    };
    ResultTable::new("motion", "Motions", columns, report.motion.iter().map(row).collect())
}
