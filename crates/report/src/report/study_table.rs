//! The table of a sweep: a row for each study, fit and load.

use super::figure::{Columns, RunFolder, swept_chart};
use super::study_record::{StudyRecord, reference};
use super::table::{Cell, Column, Digits, Table, csv};
use super::tables_page;
use crate::error::{Error, ErrorKind, Result};
use crate::file::{check_apart, check_file, check_folder};
use crate::order::distinct;
use crate::solve::Standing;
use crate::study::{Study, standing_word};
use crate::text::printable_lines;
use serde_json::{Map, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// The first line of a table begins so.
const BEGINNING: &[u8] = b"study,";
/// Studies that are printed at most: a screen has few more lines, and `table.csv` has all.
const PRINTED: usize = 40;
/// Studies whose errors are printed at most. They are mostly alike, and the table of the file has all.
const FAULTS: usize = 10;
/// How networks stand whose errors mean little.
const UNSTABLE: [Standing; 3] = [Standing::Soft, Standing::Indefinite, Standing::Singular];
/// The columns after the values that are set, in this order where there are any; the others follow by name.
const LEADING: [&str; 10] =
    ["error", "fit", "load", "reference", "e_rms", "e_max", "e_tip", "e_energy", "springs", "status"];
/// What the report says of the whole body that a row has as well.
const OF_BODY: [&str; 2] = ["nodes", "elements"];

/// The rows of a sweep in the order of its studies, and the columns that have a value anywhere. Times are left out, so that a table is
/// the same however it was made.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyTable {
    /// The names of the columns.
    pub columns: Vec<String>,
    /// The rows, with a value for each column.
    pub rows: Vec<Vec<Value>>,
}

impl StudyTable {
    /// Makes the table of the studies that have a record; `keys` are those of the sweep, and studies are counted from 1. A key of the name of
    /// another column, as `fit`, has the column `set.fit`.
    pub fn of<'a>(keys: &[String], studies: &[Study], record: impl Fn(&str) -> Option<&'a StudyRecord>) -> StudyTable {
        let mut figures = BTreeSet::new();
        let mut rows: Vec<(Vec<Value>, BTreeMap<String, Value>)> = Vec::new();
        for (place, study) in studies.iter().enumerate() {
            let values = study.values();
            let Some(record) = record(&StudyRecord::mark(&values)) else { continue };
            let set = keys.iter().map(|key| values.get(key).cloned().unwrap_or_default());
            let first: Vec<Value> = std::iter::once(Value::from(place + 1)).chain(set).collect();
            for row in rows_of(record) {
                figures.extend(row.iter().filter(|(_, value)| !value.is_null()).map(|(name, _)| name.clone()));
                rows.push((first.clone(), row));
            }
        }
        let named = LEADING.iter().map(ToString::to_string).filter(|name| figures.contains(name));
        let others = figures.iter().filter(|name| !LEADING.contains(&name.as_str())).cloned();
        let figures: Vec<String> = named.chain(others).collect();
        let set = keys.iter().map(|key| if figures.contains(key) { format!("set.{key}") } else { key.clone() });
        let columns = std::iter::once("study".to_string()).chain(set).chain(figures.iter().cloned());
        let complete = |(mut first, row): (Vec<Value>, BTreeMap<String, Value>)| {
            first.extend(figures.iter().map(|name| row.get(name).cloned().unwrap_or_default()));
            first
        };
        StudyTable { columns: columns.collect(), rows: rows.into_iter().map(complete).collect() }
    }

    /// Writes the table as CSV; a value that is missing is an empty cell.
    pub fn csv(&self) -> String {
        csv(&self.columns, &self.rows.iter().map(|row| row.iter().map(cell).collect()).collect::<Vec<_>>())
    }

    /// Converts the table to a list of objects, in JSON.
    pub fn json(&self) -> Value {
        let object = |row: &Vec<Value>| {
            Value::Object(self.columns.iter().cloned().zip(row.iter().cloned()).collect::<Map<_, _>>())
        };
        Value::Array(self.rows.iter().map(object).collect())
    }
}

/// Checks that the table of a sweep can be written at `path`, before the work.
///
/// # Errors
/// It cannot be written; it is one of the inputs; or there is a file that does not begin as a table of a sweep does.
pub fn check_study_table(path: &Path, inputs: &[PathBuf]) -> Result<()> {
    check_own(path, inputs, BEGINNING, "the table of a sweep")
}

/// Checks that the page of a sweep can be written at `path`, before the work.
///
/// # Errors
/// As [`check_study_table`].
pub fn check_study_page(path: &Path, inputs: &[PathBuf]) -> Result<()> {
    check_own(path, inputs, tables_page::BEGINNING.as_bytes(), "a page of this program")
}

/// Checks that a file may be written that is not there or begins as ours do.
fn check_own(path: &Path, inputs: &[PathBuf], own: &[u8], what: &str) -> Result<()> {
    check_folder(path.parent().unwrap_or(Path::new("")))?;
    check_apart(&[path.to_path_buf()], inputs)?;
    if path.symlink_metadata().is_err() {
        return Ok(());
    }
    check_file(path)?;
    let mut beginning = Vec::new();
    let read = File::open(path).and_then(|file| file.take(own.len() as u64).read_to_end(&mut beginning));
    read.map_err(|e| Error::io("cannot be read", e).in_file(path))?;
    if beginning == own {
        return Ok(());
    }
    let problem = format!("would be replaced, and is not {what}: move it away, or choose another folder");
    Err(Error::new(problem).of_kind(ErrorKind::Io).in_file(path))
}

/// The page of the studies in a folder: errors over the first key that has several numbers, if there is one, and the table.
pub fn studies_page(title: &str, table: &Table, folder: &Path) -> String {
    let figure = swept_chart(&RunFolder::at(folder), None).and_then(|chart| chart.svg(Columns::Two)).ok();
    let about = concat!("Sweep by springfit ", env!("CARGO_PKG_VERSION"));
    printable_lines(&tables_page::tables_page(title, about, figure.as_deref(), std::slice::from_ref(table), &[]))
        .into_owned()
}

/// The cells of one study: for each fit and load, or with the error alone.
fn rows_of(record: &StudyRecord) -> Vec<BTreeMap<String, Value>> {
    let Some(report) = &record.report else {
        return vec![BTreeMap::from([("error".into(), record.error.clone().into())])];
    };
    let mut rows = Vec::new();
    for fit in report["fits"].as_array().into_iter().flatten() {
        let mut own: BTreeMap<String, Value> =
            OF_BODY.iter().map(|name| (name.to_string(), report[*name].clone())).collect();
        leaves("", fit, &mut own);
        own.remove("name");
        own.insert("fit".into(), fit["name"].clone());
        let loads = fit["loads"].as_array().into_iter().flatten();
        let before = rows.len();
        rows.extend(loads.map(|load| {
            let mut row = own.clone();
            leaves("", load, &mut row);
            row.remove("name");
            row.insert("load".into(), load["name"].clone());
            row.insert("reference".into(), reference(report, load).into());
            row
        }));
        if rows.len() == before {
            rows.push(own);
        }
    }
    rows
}

/// Numbers, texts and flags of an object and those inside it, by their paths; without lists, and without times.
fn leaves(parent: &str, object: &Value, found: &mut BTreeMap<String, Value>) {
    for (key, value) in object.as_object().into_iter().flatten() {
        let path = if parent.is_empty() { key.clone() } else { format!("{parent}.{key}") };
        match value {
            Value::Object(_) => leaves(&path, value, found),
            Value::Array(_) => {}
            _ if key.starts_with("seconds") => {}
            Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => _ = found.insert(path, value.clone()),
        }
    }
}

fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Bool(_) | Value::Number(_) | Value::Array(_) | Value::Object(_) => value.to_string(),
    }
}

/// What each study sets.
pub fn planned_table(title: &str, keys: &[String], studies: &[Study]) -> Table {
    let columns = std::iter::once(Column::words("study")).chain(keys.iter().map(Column::numbers)).collect();
    let row = |(place, study): (usize, &Study)| settings(keys, place, study);
    Table::new("studies", title, columns, studies.iter().enumerate().map(row))
}

/// The number of a study, and what it sets.
fn settings(keys: &[String], place: usize, study: &Study) -> Vec<Cell> {
    let values = study.values();
    let set = keys.iter().map(|key| values.get(key).map_or_else(String::new, shown).into());
    std::iter::once(Cell::from(place + 1)).chain(set).collect()
}

/// The first rows of a table of studies, and how many there are more.
pub fn studies_text(mut table: Table) -> String {
    let more = table.rows.len().saturating_sub(PRINTED);
    table.rows.truncate(PRINTED);
    if more > 0 {
        table.notes.insert(0, format!("and {more} more"));
    }
    table.titled_text()
}

/// One row for each study that is done: the values that were set, the largest error of each fit under any load, and what went wrong.
pub fn studies_table<'a>(
    title: &str,
    keys: &[String],
    studies: &[Study],
    record: impl Fn(&str) -> Option<&'a StudyRecord>,
) -> Table {
    let found = |study: &Study| record(&StudyRecord::mark(&study.values()));
    let rms = |fit: &Value| fit["loads"].as_array()?.iter().filter_map(|load| load["e_rms"].as_f64()).reduce(f64::max);
    let fits = |record: &'a StudyRecord| -> &'a [Value] {
        record.report.as_ref().and_then(|report| report["fits"].as_array()).map_or(&[], Vec::as_slice)
    };
    let names = distinct(studies.iter().filter_map(found).flat_map(fits).filter_map(|fit| fit["name"].as_str()));
    let mut columns = vec![Column::words("study")];
    columns.extend(keys.iter().map(Column::numbers));
    // What fits cost is told where it was measured as comparisons measure it: in repeated passes of one thread.
    let seconds = |fit: &Value| fit["times"]["element"]["median"].as_f64();
    let is_timed = studies.iter().filter_map(found).flat_map(fits).any(|fit| seconds(fit).is_some());
    for name in &names {
        columns.push(Column::numbers("e_rms").unit("%").group(*name));
        columns.extend(is_timed.then(|| Column::numbers("fit median").unit("µs/element").group(*name)));
    }
    let done: Vec<_> = studies.iter().enumerate().filter_map(|(i, study)| Some((i, study, found(study)?))).collect();
    let mut is_marked = false;
    let rows: Vec<Vec<Cell>> = done
        .iter()
        .map(|&(place, study, record)| {
            let mut row = settings(keys, place, study);
            row.extend(names.iter().flat_map(|name| {
                let fit = fits(record).iter().find(|fit| fit["name"] == **name);
                let error = Cell::number(fit.and_then(rms), Digits::Fixed(2));
                let status = fit.and_then(|fit| fit["status"].as_str()).unwrap_or_default();
                let stands = !UNSTABLE.map(standing_word).contains(&status);
                is_marked |= !stands;
                let error = if stands { error } else { error.marked(" !") };
                let time = Cell::number(fit.and_then(seconds).map(|seconds| 1e6 * seconds), Digits::Significant(3));
                std::iter::once(error).chain(is_timed.then_some(time))
            }));
            row
        })
        .collect();
    let mark =
        "! the network is not stable, so that its errors mean little; the column status of table.csv has the verdict";
    let failed: Vec<String> = done
        .iter()
        .filter_map(|(place, _, record)| Some(format!("study {} failed: {}", place + 1, record.error.as_ref()?)))
        .collect();
    let more = failed.len().saturating_sub(FAULTS);
    let references: BTreeSet<&str> = done
        .iter()
        .filter_map(|(.., record)| record.report.as_ref())
        .flat_map(|report| {
            let loads = report["fits"][0]["loads"].as_array().into_iter().flatten();
            loads.map(|load| reference(report, load))
        })
        .collect();
    let mixed = (references.len() > 1).then(|| {
        let known = references.iter().copied().collect::<Vec<_>>().join(", ");
        format!(
            "errors of these studies are relative to different solutions ({known}), as the column reference of table.csv says: they are not to be \
             compared; from in [reference] sets one for all"
        )
    });
    let notes = mixed.into_iter().chain(is_marked.then(|| mark.to_string())).chain(failed.into_iter().take(FAULTS));
    let timed = "Times are processor times of one thread for each element that is fitted, in passes that take turns within a study.";
    let notes = notes.chain(is_timed.then(|| timed.to_string()));
    let notes: Vec<String> = notes.chain((more > 0).then(|| format!("and {more} more failed"))).collect();
    Table::new("sweep", format!("{title}: largest e_rms under any load"), columns, rows).with_notes(notes)
}

/// A value in a printed table: numbers with at most six digits.
fn shown(value: &Value) -> String {
    match value.as_f64() {
        Some(number) if value.is_f64() => {
            let short: f64 = format!("{number:.5e}").parse().unwrap_or(number);
            if short == 0.0 || (1e-4..1e7).contains(&short.abs()) { short.to_string() } else { format!("{short:e}") }
        }
        _ => cell(value),
    }
}
