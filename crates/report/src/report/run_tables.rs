//! The tables of a run, from its report.

use super::damping::{damping, dynamic_moduli};
use super::fit_record::FitRecord;
use super::frequencies::frequencies;
use super::held_out::held_out;
use super::json::Report;
use super::motion::motions;
use super::overview::{loads, measured, overview, standard};
use super::table::Digits::{Fixed, Signed, Significant};
use super::table::Priority::InFiles;
use super::table::{Cell, Column, Filled, Table};
use crate::study::{BODY, FitTimes, LoadOutcome, ModelTimes, Reading, Times};

impl Table {
    /// All tables for which the report has results.
    pub fn all(report: &Report) -> Vec<Table> {
        let all = [
            overview(report),
            fits(report),
            errors(report),
            materials(report),
            times(report),
            costs(report),
            whole(report),
            held_out(report),
            frequencies(&report.frequencies),
            damping(&report.damping),
            dynamic_moduli(report.dynamic_moduli.as_ref()),
            motions(report.motion_options.as_ref(), &report.motion),
        ];
        all.into_iter().filter(|table| !table.rows.is_empty()).collect()
    }
}

fn fits(report: &Report) -> Table {
    let matrices = "|R-K|/|R| Frobenius";
    let passes = if report.fits.iter().all(|fit| fit.times.is_some()) { "fit median" } else { "fit once" };
    let column = |title, group: &str| Column::numbers(title).group(group);
    let share = |value| Cell::number(Some(value), Fixed(4));
    let trained = |fit: &FitRecord| Some(fit.sampled.as_ref()?.trained.mean);
    let held_out = |fit: &FitRecord| Some(fit.sampled.as_ref()?.held_out.as_ref()?.mean);
    let all = Column::numbers("all").unit("ms").priority(InFiles);
    let columns: [Filled<&FitRecord>; 10] = [
        (Column::words("fit"), &|fit| fit.name.as_str().into()),
        (Column::words("network"), &|fit| fit.status.as_str().into()),
        (column("mean", matrices), &|fit| share(fit.relative_frobenius.mean)),
        (column("max", matrices), &|fit| share(fit.relative_frobenius.max)),
        (column("mean", "2-norm"), &|fit| share(fit.relative_spectral.mean)),
        (column("max", "2-norm"), &|fit| share(fit.relative_spectral.max)),
        (column(passes, "").unit("µs/element"), &|fit| Cell::number(Some(1e6 * fit.seconds_per_element), Fixed(2))),
        (all, &|fit| Cell::number(Some(1e3 * fit.seconds), Significant(3))),
        (column("fitted", "sampled forces").unit("%"), &|fit| Cell::percent(trained(fit), Fixed(2))),
        (column("held out", "sampled forces").unit("%"), &|fit| Cell::percent(held_out(fit), Fixed(2))),
    ];
    // The last two are those of sampled fits.
    let is_sampled = report.fits.iter().any(|fit| fit.sampled.is_some());
    let shown = if is_sampled { columns.len() } else { columns.len() - 2 };
    let title = "Matrices of the elements, and what the fits took";
    Table::of("fits", title, &report.fits, &columns[..shown])
}

fn errors(report: &Report) -> Table {
    let loads = loads(report);
    // A gauge that reads has a reading of the finite elements.
    let is_read = |load: usize| report.gauge.get(load).is_some_and(Option::is_some);
    let mut columns = vec![Column::words("fit")];
    for (i, load) in loads.iter().enumerate() {
        let standard = standard(report, &load.name);
        let column = |title| Column::numbers(title).unit("%").group(format!("{}{standard}", load.name));
        columns.extend(["e_rms", "e_max", "e_tip", "e_energy"].map(column));
        columns.push(Column::numbers("moves").unit("m").group(format!("{}{standard}", load.name)).priority(InFiles));
        if is_read(i) {
            let gauge = |title| Column::numbers(title).group(format!("{}, gauge", load.name));
            columns.extend([gauge("E").unit("Pa"), gauge("ν")]);
        }
    }
    let errors = |[rms, max, tip, energy]: [Option<f64>; 4], moves: Option<f64>| -> Vec<Cell> {
        let error = |error| Cell::number(error, Fixed(2));
        vec![error(rms), error(max), error(tip), Cell::number(energy, Signed(2)), Cell::number(moves, Significant(4))]
    };
    let cells = |(i, load): (usize, &LoadOutcome)| {
        let mut cells = errors(
            [load.error.map(|e| e.rms), load.error.map(|e| e.max), load.error.map(|e| e.tip), load.work_error],
            load.largest_displacement,
        );
        if is_read(i) {
            let reading = |of: fn(Reading) -> f64| load.gauge.map(of);
            cells.push(Cell::number(reading(|reading| reading.young), Significant(5)));
            cells.push(Cell::number(reading(|reading| reading.poisson), Fixed(3)));
        }
        cells
    };
    let row = |fit: &FitRecord| {
        std::iter::once(Cell::from(&*fit.marked())).chain(fit.loads.iter().enumerate().flat_map(cells)).collect()
    };
    let mut rows: Vec<Vec<Cell>> = if loads.is_empty() { Vec::new() } else { report.fits.iter().map(row).collect() };
    if !report.measured.is_empty() && !rows.is_empty() {
        let of_body = |(i, load): (usize, &LoadOutcome)| {
            let known = measured(report, &load.name);
            let mut cells = known.map_or_else(
                || errors([Some(0.0); 4], None),
                |known| errors([known.fem_e_rms, known.fem_e_max, known.fem_e_tip, known.fem_e_energy], None),
            );
            if let Some(reading) = report.gauge.get(i).copied().flatten() {
                cells.push(Cell::number(Some(reading.young), Significant(5)));
                cells.push(Cell::number(Some(reading.poisson), Fixed(3)));
            }
            cells
        };
        rows.push(std::iter::once(Cell::from(BODY)).chain(loads.iter().enumerate().flat_map(of_body)).collect());
    }
    let title = "Errors of the displacements in percent of the largest; e_energy is that of the compliance";
    Table::new("errors", title, columns, rows)
}

fn materials(report: &Report) -> Table {
    let mut columns = vec![
        Column::words("fit"),
        Column::numbers("E").unit("Pa"),
        Column::numbers("ν"),
        Column::numbers("error of C").unit("%"),
        Column::numbers("of the mean").unit("%").priority(InFiles),
        Column::numbers("of the worst").unit("%").priority(InFiles),
    ];
    let is_whole = report.fits.iter().any(|fit| fit.effective_young.is_some());
    if is_whole {
        let whole = |title| Column::numbers(title).group("whole").priority(InFiles);
        columns.extend([whole("E").unit("Pa"), whole("ν"), whole("Zener")]);
    }
    // The modulus of an anisotropic material depends on the direction, and its mean says little.
    let axes: &[&str] = if is_anisotropic(report) { &["x", "y", "z"][..report.extent.len()] } else { &[] };
    columns.extend(axes.iter().map(|axis| Column::numbers(*axis).unit("Pa").group("E along").priority(InFiles)));
    let row = |fit: &FitRecord| {
        let m = &fit.as_material;
        let distances = [m.distance, m.mean_distance, m.largest_distance];
        let mut row =
            vec![Cell::from(&*fit.marked()), Cell::number(m.young, Significant(5)), Cell::number(m.poisson, Fixed(3))];
        row.extend(distances.map(|share| Cell::percent(Some(share), Fixed(1))));
        if is_whole {
            row.push(Cell::number(fit.effective_young, Significant(5)));
            row.extend([fit.effective_poisson, fit.zener].map(|number| Cell::number(number, Fixed(3))));
        }
        let along = young_along(report, fit);
        row.extend((0..axes.len()).map(|k| Cell::number(along.as_ref().map(|along| along[k]), Significant(4))));
        row
    };
    let asked = match (report.young, report.poisson) {
        (Some(young), Some(poisson)) => format!("asked for are E = {young} Pa, ν = {poisson}"),
        _ if is_anisotropic(report) => "an anisotropic one is asked for, E and ν are means over all directions".into(),
        _ => "those that are asked for differ from cell to cell".into(),
    };
    let title = format!("Networks as materials; {asked}");
    Table::new("materials", title, columns, report.fits.iter().map(row)).with_notes(samples(report))
}

/// Whether no region of the body has Young's modulus, which anisotropic materials do not have.
fn is_anisotropic(report: &Report) -> bool {
    report.materials.iter().all(|region| region.young == [None, None])
}

/// Young's modulus of a network along the axes, Pa: `1/S_kk` of the compliance S of its tensor. `None` if a strain has no stiffness, and where the
/// tensor is not in the axes of the body or its thickness differs from cell to cell.
fn young_along(report: &Report, fit: &FitRecord) -> Option<Vec<f64>> {
    let (c, d) = (&fit.as_material.stiffness, report.extent.len());
    let thickness = match report.materials.first()?.thickness {
        None => 1.0,
        Some([least, most]) => least.filter(|_| least == most)?,
    };
    let compliance = (c.nrows() == d * (d + 1) / 2).then(|| c.clone().try_inverse()).flatten()?;
    let along: Vec<f64> = (0..d).map(|k| 1.0 / (compliance[(k, k)] * thickness)).collect();
    along.iter().all(|young| young.is_finite()).then_some(along)
}

/// Says what the rows of a body of several materials speak of: the mean of its samples, which is not that of the body.
fn samples(report: &Report) -> Option<String> {
    let m = &report.fits.first()?.as_material;
    if report.young.is_some() && report.poisson.is_some() {
        return None;
    }
    let asked = match (m.asked_young, m.asked_poisson) {
        (Some(young), Some(poisson)) => format!("; finite elements have E = {young:.4e} Pa, nu = {poisson:.3} there"),
        (Some(young), None) => format!("; finite elements have E = {young:.4e} Pa there"),
        (None, _) => String::new(),
    };
    let samples = if m.samples == 1 { "one sample".into() } else { format!("{} samples", m.samples) };
    if is_anisotropic(report) {
        let samples = if m.samples == 1 { "one sample".into() } else { format!("{} samples", m.samples) };
        return Some(format!(
            "The material is anisotropic: E and nu are means over all directions, of {samples} of cells{asked}."
        ));
    }
    Some(format!(
        "The materials differ from cell to cell: E and nu are those of {samples} of cells, not of the body{asked}."
    ))
}

fn times(report: &Report) -> Table {
    let words = |title| Column::words(title).priority(InFiles);
    let numbers = |title| Column::numbers(title).priority(InFiles);
    let known = |value: Option<usize>| Cell::number(value.map(|value| value as f64), Fixed(0));
    let time = |seconds: f64| Cell::number(Some(1e3 * seconds), Significant(3));
    let solver = |load: &LoadOutcome| match (&load.solved_lem, &load.followed) {
        (Some(solver), _) => solver.method.clone(),
        (None, Some(_)) => "Newton".into(),
        (None, None) => "–".into(),
    };
    let iterated = |load: &LoadOutcome| {
        let solved = load.solved_lem.as_ref().and_then(|solver| solver.iterations);
        solved.or(load.followed.map(|followed| followed.iterations))
    };
    let residual = |load: &LoadOutcome| {
        let solved = load.solved_lem.as_ref().map(|solver| solver.residual);
        solved.or(load.followed.map(|followed| followed.residual))
    };
    let rows = report.fits.iter().flat_map(|fit| fit.loads.iter().map(move |load| (fit, load)));
    let table = Table::of(
        "times",
        "Processor times to assemble and solve, each load as if it were alone",
        rows,
        &[
            (Column::words("fit"), &|(fit, _)| fit.name.as_str().into()),
            (words("load"), &|(_, load)| load.name.as_str().into()),
            (numbers("finite elements").unit("ms"), &|(_, load)| time(load.seconds_fem)),
            (numbers("springs").unit("ms"), &|(_, load)| time(load.seconds_lem)),
            (words("solver"), &|(_, load)| solver(load).into()),
            (numbers("unknowns"), &|(_, load)| known(load.solved_lem.as_ref().map(|solver| solver.unknowns))),
            (numbers("iterations"), &|(_, load)| known(iterated(load))),
            (numbers("residual"), &|(_, load)| Cell::number(residual(load), Significant(2))),
        ],
    );
    table.with_notes(means(report).into_iter().chain(iterations(report)))
}

/// What fits and models cost, where the scene asks for it.
fn costs(report: &Report) -> Table {
    let pair =
        |group: &str, unit: &str| ["least", "median"].map(|title| Column::numbers(title).unit(unit).group(group));
    let alone = |title: &str, unit: &str| Column::numbers(title).unit(unit);
    let mut columns = vec![Column::words("fit"), Column::numbers("elements fitted")];
    columns.extend(pair("constants", "µs/element"));
    columns.extend(pair("solution", "ms"));
    columns.extend(pair("explicit step", "µs"));
    columns.extend(pair("implicit step", "ms"));
    columns.extend(pair("simulated second", "s"));
    let third = [("assembly", "ms"), ("matrix errors", "ms"), ("moduli", "ms"), ("longest explicit step", "µs")];
    columns.extend(third.map(|(title, unit)| alone(title, unit).priority(InFiles)));
    let both = |times: Option<&Times>, factor: f64| {
        [times.map(|times| times.least), times.map(|times| times.median)]
            .map(|seconds| Cell::number(seconds.map(|seconds| factor * seconds), Significant(3)))
    };
    let median = |times: Option<&Times>, factor: f64| both(times, factor)[1].clone();
    let row = |name: &str, elements: Cell, fit: Option<&FitTimes>, model: &ModelTimes| {
        let mut row = vec![Cell::from(name), elements];
        row.extend(both(fit.map(|fit| &fit.element), 1e6));
        row.extend(both(model.solve.as_ref(), 1e3));
        row.extend(both(model.explicit_step.as_ref(), 1e6));
        row.extend(both(model.implicit_step.as_ref(), 1e3));
        row.extend(both(model.simulated_second.as_ref(), 1.0));
        row.push(median(fit.map(|fit| &fit.assembly), 1e3));
        row.push(median(fit.and_then(|fit| fit.errors.as_ref()), 1e3));
        row.push(median(fit.map(|fit| &fit.moduli), 1e3));
        row.push(Cell::number(model.longest_step.map(|step| 1e6 * step), Significant(4)));
        row
    };
    let of_fit = |fit: &FitRecord| {
        Some(row(&fit.marked(), fit.fitted_elements.into(), fit.times.as_ref(), fit.model_times.as_ref()?))
    };
    let mut rows: Vec<Vec<Cell>> = report.fits.iter().filter_map(of_fit).collect();
    rows.extend(report.model_times.as_ref().map(|model| row(BODY, Cell::number(None, Fixed(0)), None, model)));
    let title = "Costs: processor time of one thread, in passes that take turns";
    let turning = "Linear finite elements do not turn: their matrix is factorised before the first implicit step, that of springs in each one.";
    let notes = (report.law.is_none() && report.model_times.is_some()).then(|| turning.to_string());
    Table::new("costs", title, columns, rows).with_notes(notes)
}

/// All loads of all fits.
fn all_loads(report: &Report) -> impl Iterator<Item = &LoadOutcome> {
    report.fits.iter().flat_map(|fit| &fit.loads)
}

/// The mean times of a load.
fn means(report: &Report) -> Option<String> {
    let count = all_loads(report).count();
    let mean = |seconds: fn(&LoadOutcome) -> f64| {
        let mean = all_loads(report).map(seconds).sum::<f64>() / count as f64;
        if mean < 1.0 { format!("{:.2} ms", 1e3 * mean) } else { format!("{mean:.2} s") }
    };
    let [finite, springs] = [mean(|load| load.seconds_fem), mean(|load| load.seconds_lem)];
    (count > 0).then(|| {
        format!("One load, assembled and solved: {finite} with finite elements, {springs} with springs (means of processor times).")
    })
}

/// How iterations went, where there were any: the most of all loads and models, and the largest residual.
fn iterations(report: &Report) -> Option<String> {
    let solved = all_loads(report).flat_map(|load| load.solved_fem.iter().chain(&load.solved_lem));
    let iterated: Vec<_> = solved.filter(|solved| solved.iterations.is_some()).collect();
    let most = iterated.iter().max_by_key(|solved| solved.iterations)?;
    Some(format!(
        "{} unknowns solved by conjugate gradients with multigrid: at most {} iterations, residual {:.1e}; nodes x unknowns of the levels: \
         {}.",
        most.unknowns,
        most.iterations.unwrap_or(0),
        iterated.iter().map(|solved| solved.residual).fold(0.0, f64::max),
        most.levels.as_deref().unwrap_or("-").replace('×', "x")
    ))
}

fn whole(report: &Report) -> Table {
    let columns = [
        Column::words("load"),
        Column::words("used for"),
        Column::numbers("error before").unit("%"),
        Column::numbers("error after").unit("%"),
    ];
    let columns = std::iter::once(Column::words("fit")).chain(columns.map(|column| column.priority(InFiles)));
    let mut rows = Vec::new();
    for fit in &report.fits {
        let Some(whole) = &fit.whole else { continue };
        let fitted = whole.fitted.iter().map(|load| (load, "fit"));
        for (load, use_) in fitted.chain(whole.judged.iter().map(|load| (load, "validation"))) {
            let errors = [load.before, load.after].map(|share| Cell::percent(Some(share), Fixed(2)));
            rows.push(
                [[Cell::from(&*fit.name), Cell::from(&*load.load), use_.into()].to_vec(), errors.into()].concat(),
            );
        }
    }
    Table::new("whole", "Whole-object fits: errors at the start and at the end", columns.collect(), rows)
}
