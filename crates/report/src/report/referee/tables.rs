//! The rows of a referee as tables: a column for each load.

use super::record::{Factor, FoundRow, RefereeRecord, RefereeRow};
use crate::order::{distinct, grouped};
use crate::report::table::Digits::{Fixed, Signed};
use crate::report::table::{Cell, Column, Table};

/// The loads, in the order in which rows have them.
pub(super) fn loads(record: &RefereeRecord) -> Vec<&str> {
    distinct(record.rows.iter().map(|row| row.load.as_str()))
}

/// The rows of one model in one engine, by load.
pub(super) struct Bodies<'a> {
    pub first: &'a RefereeRow,
    pub by_load: Vec<Option<&'a RefereeRow>>,
}

/// The rows by engine, solver, model and Poisson's ratio, for which `chosen` holds.
pub(super) fn bodies<'a>(record: &'a RefereeRecord, chosen: impl Fn(&RefereeRow) -> bool) -> Vec<Bodies<'a>> {
    let loads = loads(record);
    let key = |row: &RefereeRow| (row.engine.clone(), row.solver.clone(), row.title(), row.poisson.to_bits());
    let bodies = |(_, rows): (_, Vec<&'a RefereeRow>)| {
        // The last row under a load counts, where there are several.
        let under = |load: &&str| rows.iter().rev().copied().find(|row| row.load == **load);
        Bodies { first: rows[0], by_load: loads.iter().map(under).collect() }
    };
    let rows = record.rows.iter().filter(|row| chosen(row)).map(|row| (key(row), row));
    grouped(rows).into_iter().map(bodies).collect()
}

/// All tables as text, and what was not run.
pub fn referee_text(record: &RefereeRecord) -> String {
    let versions = record.engines.iter().map(|engine| format!("{} {}", engine.name, engine.version));
    let mut text = format!("{}\n", versions.collect::<Vec<_>>().join(", "));
    for table in referee_tables(record) {
        text += &format!("\n{}", table.titled_text());
    }
    let lines = |word: &str, lines: &[String]| lines.iter().map(|line| format!("{word}: {line}\n")).collect::<String>();
    text + &lines("not run", &record.not_run) + &lines("failed", &record.failed)
}

/// All tables for which there are results.
pub fn referee_tables(record: &RefereeRecord) -> Vec<Table> {
    let elements = |row: &RefereeRow| row.is_of_elements();
    let springs = |row: &RefereeRow| !row.is_of_elements();
    let mesh = "beside finite elements of the same mesh, %";
    let tables = vec![
        by_load(record, "own elements", format!("Own elements: energy {mesh}; positive is too soft"), elements, |f| {
            f.energy_percent
        }),
        by_load(record, "tips", format!("Own elements: tip {mesh}"), elements, |f| f.tip_percent),
        by_load(
            record,
            "springs",
            "Springs: energy beside the equilibrium of the network itself, %".into(),
            springs,
            |f| f.of_model_percent,
        ),
        by_load(record, "fits", format!("Springs: energy {mesh}"), springs, |f| f.energy_percent),
        repairs(record),
        by_load(record, "truth", "Energy beside refined meshes, %".into(), |_| true, |f| f.truth_percent),
        mesh_errors(record),
    ];
    tables.into_iter().filter(|table| !table.rows.is_empty()).collect()
}

fn by_load(
    record: &RefereeRecord,
    name: &str,
    title: String,
    chosen: impl Fn(&RefereeRow) -> bool,
    value: fn(&FoundRow) -> f64,
) -> Table {
    let mut columns = ["engine", "model", "solver"].map(Column::words).to_vec();
    columns.push(Column::numbers("ν"));
    columns.extend(loads(record).into_iter().map(Column::numbers));
    let cell = |row: &Option<&RefereeRow>| match row {
        None => Cell::number(None, Signed(1)),
        Some(RefereeRow { found: None, moving_percent: None, .. }) => "diverged".into(),
        Some(RefereeRow { found: None, .. }) => "not at rest".into(),
        Some(RefereeRow { found: Some(found), .. }) => {
            Cell::number(Some(value(found)), Signed(1)).marked(if found.is_still { "" } else { "*" })
        }
    };
    let mut rows = Vec::new();
    let mut moving = 0.0f64;
    for bodies in bodies(record, chosen) {
        let RefereeRow { engine, solver, poisson, .. } = bodies.first;
        let mut cells: Vec<Cell> =
            [engine.clone(), bodies.first.title(), solver.clone(), poisson.to_string()].map(Cell::from).into();
        cells.extend(bodies.by_load.iter().map(cell));
        rows.push(cells);
        for row in bodies.by_load.iter().flatten().filter(|row| row.found.is_some_and(|found| !found.is_still)) {
            moving = moving.max(row.moving_percent.unwrap_or(0.0));
        }
    }
    let still = (moving > 0.0).then(|| format!("* still moving, by at most {moving:.2} % of the largest displacement"));
    Table::new(name, title, columns, rows).with_notes(still)
}

fn repairs(record: &RefereeRecord) -> Table {
    let mut columns = ["engine", "model", "solver"].map(Column::words).to_vec();
    columns.extend(["ν", "factor\nby tension", "derived:\nfactor of E", "and ν"].map(Column::numbers));
    let number = |value: Option<f64>| Cell::number(value, Fixed(3));
    let row = |repair: &super::record::RepairRecord| {
        let derived = |k: usize| number(repair.derived.map(|derived| derived[k]));
        let factor = match repair.factor {
            Factor::Number(factor) => number(Some(factor)),
            Factor::TooSoft => "too soft".into(),
            Factor::NotAtRest => "not at rest".into(),
        };
        let names = [&repair.engine, &repair.model, &repair.solver].map(|name| Cell::from(&**name));
        names.into_iter().chain([repair.poisson.to_string().into(), factor, derived(0), derived(1)]).collect::<Vec<_>>()
    };
    let title = "What to tell the engine: E, or all constants of springs, times the factor";
    Table::new("repairs", title, columns, record.repairs.iter().map(row))
}

/// How far the finite elements of the mesh are from the truth.
fn mesh_errors(record: &RefereeRecord) -> Table {
    let columns = vec![
        Column::words("load"),
        Column::numbers("ν"),
        Column::numbers("energy\nof the truth").unit("%"),
        Column::numbers("truth uncertain\nby").unit("%"),
    ];
    let row = |row: &RefereeRow| {
        let error = 100.0 * (row.energy_of_finite_elements / row.truth - 1.0);
        let figures = [(error, Signed(1)), (row.truth_uncertainty_percent, Fixed(1))];
        let mut cells = vec![Cell::from(&*row.load), row.poisson.to_string().into()];
        cells.extend(figures.map(|(value, digits)| Cell::number(Some(value), digits)));
        cells
    };
    let rows = distinct(record.rows.iter().map(row));
    Table::new("mesh", "Finite elements of the mesh beside refined meshes", columns, rows)
}
