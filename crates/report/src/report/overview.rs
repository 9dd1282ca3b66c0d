//! The first table of a run: one row for each fit.

use super::fit_record::FitRecord;
use super::json::Report;
use super::table::Digits::{Fixed, Significant};
use super::table::Priority::Always;
use super::table::{Cell, Column, Table};
use super::verdict::{LOCKS, TOO_STIFF};
use crate::study::statistics::median;
use crate::study::{BODY, LoadOutcome, Measured, Times};

/// With more loads than this, the median and the worst of them are shown: a column of each would be wider than a terminal.
const MOST_LOADS: usize = 5;

/// A column, and its cell for a fit and for the finite elements.
struct Shown<'a> {
    column: Column,
    of_fit: Box<dyn Fn(&FitRecord) -> Cell + 'a>,
    of_body: Cell,
}

impl<'a> Shown<'a> {
    fn new(column: Column, of_fit: impl Fn(&FitRecord) -> Cell + 'a) -> Shown<'a> {
        Shown { column: column.priority(Always), of_fit: Box::new(of_fit), of_body: Cell::from("") }
    }

    fn body(self, of_body: Cell) -> Shown<'a> {
        Shown { of_body, ..self }
    }
}

/// One row for each fit: its springs, what must be known of it first, its largest error under each load, and its cost where that was
/// measured. The finite elements have a row where errors are not relative to theirs.
pub(super) fn overview(report: &Report) -> Table {
    let mut shown = vec![
        Shown::new(Column::numbers("springs"), |fit| fit.springs.into()),
        Shown::new(Column::numbers("k < 0"), |fit| fit.negative_springs.into()),
        Shown::new(Column::words("verdict"), |fit| fit.verdict.as_str().into())
            .body(report.finite_elements_verdict.as_str().into()),
    ];
    let is_sampled = report.fits.iter().any(|fit| fit.sampled.is_some());
    match loads(report) {
        [] if !is_sampled => shown.extend(of_matrices()),
        [] => {}
        few if few.len() <= MOST_LOADS => {
            shown.extend(few.iter().enumerate().map(|(place, load)| of_load(report, place, load)))
        }
        many => shown.extend(of_many(report, many.len())),
    }
    if is_sampled {
        let held_out = |fit: &FitRecord| fit.sampled.as_ref()?.held_out.as_ref().map(|spread| spread.mean);
        let column = Column::numbers("held out").unit("%").group("sampled forces");
        shown.push(Shown::new(column, move |fit| Cell::percent(held_out(fit), Fixed(2))));
    }
    shown.extend(of_costs(report));
    let row = |fit: &FitRecord| -> Vec<Cell> {
        std::iter::once(Cell::from(&*fit.name)).chain(shown.iter().map(|shown| (shown.of_fit)(fit))).collect()
    };
    let mut rows: Vec<Vec<Cell>> = report.fits.iter().map(row).collect();
    let is_judged = !report.measured.is_empty() || report.model_times.is_some();
    if is_judged && !rows.is_empty() {
        rows.push(std::iter::once(Cell::from(BODY)).chain(shown.iter().map(|shown| shown.of_body.clone())).collect());
    }
    let columns = std::iter::once(Column::words("fit")).chain(shown.into_iter().map(|shown| shown.column)).collect();
    let title = match loads(report) {
        [] => "Networks",
        _ => "Networks; e_max is the largest error of a point, in percent of the largest displacement",
    };
    Table::new("overview", title, columns, rows)
}

/// The loads of each fit.
pub(super) fn loads(report: &Report) -> &[LoadOutcome] {
    report.fits.first().map_or(&[], |fit| &fit.loads)
}

/// What errors under a load are relative to, unless it is the finite elements of the mesh.
pub(super) fn measured<'a>(report: &'a Report, load: &str) -> Option<&'a Measured> {
    report.measured.iter().find(|known| known.load == load)
}

/// What heads the errors under a load after its name: what they are relative to, unless that is finite elements of the mesh that are right.
pub(super) fn standard(report: &Report, load: &str) -> &'static str {
    let of_cells = if [LOCKS, TOO_STIFF].contains(&&*report.finite_elements_verdict) { ", cells" } else { "" };
    measured(report, load).map_or(of_cells, |known| known.standard.heading())
}

/// The error of the finite elements under a load.
fn error_of_body(report: &Report, load: &str) -> Option<f64> {
    measured(report, load).map_or(Some(0.0), |known| known.fem_e_max)
}

fn of_load<'a>(report: &'a Report, place: usize, load: &LoadOutcome) -> Shown<'a> {
    let standard = standard(report, &load.name);
    let column = Column::numbers("e_max").unit("%").group(format!("{}{standard}", load.name));
    let error = move |fit: &FitRecord| fit.loads.get(place).and_then(|load| load.error.map(|e| e.max));
    Shown::new(column, move |fit| Cell::number(error(fit), Fixed(2)))
        .body(Cell::number(error_of_body(report, &load.name), Fixed(2)))
}

/// The median and the largest error under many loads.
fn of_many(report: &Report, count: usize) -> Vec<Shown<'_>> {
    let known = |loads: &[LoadOutcome], error: &dyn Fn(&LoadOutcome) -> Option<f64>| {
        // An error that is not known is no small one.
        loads.iter().map(error).collect::<Option<Vec<f64>>>()
    };
    let cells = move |known: Option<Vec<f64>>| -> [Cell; 2] {
        let middle = known.as_deref().map(median);
        let worst = known.and_then(|known| known.into_iter().reduce(f64::max));
        [middle, worst].map(|error| Cell::number(error, Fixed(2)))
    };
    let of_fit = move |fit: &FitRecord| cells(known(&fit.loads, &|load| load.error.map(|e| e.max)));
    let of_body = cells(known(loads(report), &|load| error_of_body(report, &load.name)));
    let group = format!("e_max of {count} loads");
    let columns = ["median", "worst"].map(|title| Column::numbers(title).unit("%").group(group.as_str()));
    let shown = columns.into_iter().zip(of_body).enumerate();
    shown.map(|(place, (column, body))| Shown::new(column, move |fit| of_fit(fit)[place].clone()).body(body)).collect()
}

/// Without loads: how near the matrices of the elements are, and what the network is as a material.
fn of_matrices<'a>() -> Vec<Shown<'a>> {
    let share = |title: &str, of: fn(&FitRecord) -> f64| {
        Shown::new(Column::numbers(title).group("|R-K|/|R|, mean"), move |fit| Cell::number(Some(of(fit)), Fixed(4)))
    };
    vec![
        share("Frobenius", |fit| fit.relative_frobenius.mean),
        share("2-norm", |fit| fit.relative_spectral.mean),
        Shown::new(Column::numbers("E").unit("Pa"), |fit| Cell::number(fit.as_material.young, Significant(5))),
        Shown::new(Column::numbers("ν"), |fit| Cell::number(fit.as_material.poisson, Fixed(3))),
    ]
}

/// What a fit and a solution cost, where the scene asks for it.
fn of_costs(report: &Report) -> Vec<Shown<'_>> {
    let median =
        |times: Option<&Times>, factor: f64| Cell::number(times.map(|times| factor * times.median), Significant(3));
    let of = |title: &str, unit: &str, of_fit: fn(&FitRecord) -> Option<&Times>, factor: f64| {
        let column = Column::numbers(title).unit(unit);
        Shown::new(column, move |fit| median(of_fit(fit), factor))
    };
    let body = report.model_times.as_ref();
    let mut shown = Vec::new();
    if report.fits.iter().any(|fit| fit.times.is_some()) {
        shown.push(of("fit", "µs/element", |fit| Some(&fit.times.as_ref()?.element), 1e6));
    }
    if report.fits.iter().any(|fit| fit.model_times.as_ref().is_some_and(|times| times.solve.is_some())) {
        let solve = of("solve", "ms", |fit| fit.model_times.as_ref()?.solve.as_ref(), 1e3);
        shown.push(solve.body(median(body.and_then(|times| times.solve.as_ref()), 1e3)));
    }
    if report.fits.iter().any(|fit| fit.model_times.as_ref().is_some_and(|times| times.explicit_step.is_some())) {
        let step = of("step", "µs", |fit| fit.model_times.as_ref()?.explicit_step.as_ref(), 1e6);
        shown.push(step.body(median(body.and_then(|times| times.explicit_step.as_ref()), 1e6)));
    }
    shown
}
