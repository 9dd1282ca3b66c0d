//! The rows of a referee as tables: a column for each load.

use super::record::{Factor, FoundRow, RefereeRecord, RefereeRow};
use crate::report::columns::{Heading, aligned};
use crate::report::result_table::ResultTable;

/// A table: its name, its title, its headings and its rows.
struct Sheet {
    name: &'static str,
    title: String,
    headings: Vec<Heading>,
    rows: Vec<Vec<String>>,
}

/// The loads, in the order in which rows have them.
pub(super) fn loads(record: &RefereeRecord) -> Vec<&str> {
    let mut found = Vec::new();
    for row in &record.rows {
        if !found.contains(&row.load.as_str()) {
            found.push(&row.load);
        }
    }
    found
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
    let mut found: Vec<Bodies> = Vec::new();
    for row in record.rows.iter().filter(|row| chosen(row)) {
        let place = found.iter().position(|bodies| key(bodies.first) == key(row)).unwrap_or_else(|| {
            found.push(Bodies { first: row, by_load: vec![None; loads.len()] });
            found.len() - 1
        });
        let column = loads.iter().position(|load| *load == row.load).expect("of a row");
        found[place].by_load[column] = Some(row);
    }
    found
}

/// All tables, to be typeset.
pub fn referee_tables(record: &RefereeRecord) -> Vec<ResultTable> {
    let of = |sheet: &Sheet| ResultTable::printed(sheet.name, &sheet.title, &sheet.headings, &sheet.rows);
    sheets(record).iter().map(of).collect()
}

/// All tables as text, and what was not run.
pub fn referee_text(record: &RefereeRecord) -> String {
    let versions = record.engines.iter().map(|engine| format!("{} {}", engine.name, engine.version));
    let mut text = format!("{}\n", versions.collect::<Vec<_>>().join(", "));
    for sheet in sheets(record) {
        text += &format!("\n{}\n\n{}", sheet.title, aligned(&sheet.headings, &sheet.rows));
    }
    let lines = |word: &str, lines: &[String]| lines.iter().map(|line| format!("{word}: {line}\n")).collect::<String>();
    text + &lines("not run", &record.not_run) + &lines("failed", &record.failed)
}

fn sheets(record: &RefereeRecord) -> Vec<Sheet> {
    let elements = |row: &RefereeRow| row.is_of_elements();
    let springs = |row: &RefereeRow| !row.is_of_elements();
    let mesh = "beside finite elements of the same mesh, %";
    let sheets = vec![
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
    sheets.into_iter().filter(|sheet| !sheet.rows.is_empty()).collect()
}

fn by_load(
    record: &RefereeRecord,
    name: &'static str,
    title: String,
    chosen: impl Fn(&RefereeRow) -> bool,
    value: fn(&FoundRow) -> f64,
) -> Sheet {
    let mut headings = ["engine", "model", "solver"].map(Heading::words).to_vec();
    headings.push(Heading::numbers("ν"));
    headings.extend(loads(record).into_iter().map(Heading::numbers));
    let cell = |row: &Option<&RefereeRow>| match row {
        None => "–".into(),
        Some(RefereeRow { found: None, moving_percent: None, .. }) => "diverged".into(),
        Some(RefereeRow { found: None, .. }) => "not at rest".into(),
        Some(RefereeRow { found: Some(found), .. }) => {
            format!("{}{}", signed(value(found)), if found.is_still { "" } else { "*" })
        }
    };
    let mut rows = Vec::new();
    let mut moving = 0.0f64;
    for bodies in bodies(record, chosen) {
        let RefereeRow { engine, solver, poisson, .. } = bodies.first;
        let mut cells = vec![engine.clone(), bodies.first.title(), solver.clone(), poisson.to_string()];
        cells.extend(bodies.by_load.iter().map(cell));
        rows.push(cells);
        for row in bodies.by_load.iter().flatten().filter(|row| row.found.is_some_and(|found| !found.is_still)) {
            moving = moving.max(row.moving_percent.unwrap_or(0.0));
        }
    }
    let still = format!("{title} (* still moving, by at most {moving:.2} % of the largest displacement)");
    Sheet { name, title: if moving > 0.0 { still } else { title }, headings, rows }
}

/// Signed with one digit behind the point, and a zero without a sign.
fn signed(percent: f64) -> String {
    let text = format!("{percent:+.1}");
    if text == "+0.0" || text == "-0.0" { "0.0".into() } else { text }
}

fn repairs(record: &RefereeRecord) -> Sheet {
    let mut headings = ["engine", "model", "solver"].map(Heading::words).to_vec();
    headings.extend(["ν", "factor\nby tension", "derived:\nfactor of E", "and ν"].map(Heading::numbers));
    let number = |value: Option<f64>| value.map_or("–".into(), |value| format!("{value:.3}"));
    let row = |repair: &super::record::RepairRecord| {
        let derived = |k: usize| number(repair.derived.map(|derived| derived[k]));
        let factor = match repair.factor {
            Factor::Number(factor) => number(Some(factor)),
            Factor::TooSoft => "too soft".into(),
            Factor::NotAtRest => "not at rest".into(),
        };
        let names = [&repair.engine, &repair.model, &repair.solver].map(String::clone);
        names.into_iter().chain([repair.poisson.to_string(), factor, derived(0), derived(1)]).collect()
    };
    let title = "What to tell the engine: E, or all constants of springs, times the factor".into();
    Sheet { name: "repairs", title, headings, rows: record.repairs.iter().map(row).collect() }
}

/// How far the finite elements of the mesh are from the truth.
fn mesh_errors(record: &RefereeRecord) -> Sheet {
    let headings = ["ν", "energy\nof the truth %", "truth uncertain\nby %"].map(Heading::numbers);
    let mut rows: Vec<Vec<String>> = Vec::new();
    for row in &record.rows {
        let error = 100.0 * (row.energy_of_finite_elements / row.truth - 1.0);
        let uncertain = format!("{:.1}", row.truth_uncertainty_percent);
        let cells = vec![row.load.clone(), row.poisson.to_string(), signed(error), uncertain];
        if !rows.contains(&cells) {
            rows.push(cells);
        }
    }
    let headings = std::iter::once(Heading::words("load")).chain(headings).collect();
    Sheet { name: "mesh", title: "Finite elements of the mesh beside refined meshes".into(), headings, rows }
}
