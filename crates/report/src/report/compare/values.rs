//! All values of a comparison in long form: a row for each.

use super::tables::plain;
use crate::report::table::csv;
use crate::study::{CaseRecord, MethodRecord};
use serde_json::Value;
use std::collections::BTreeSet;

/// A column of the rows: a text or a number in each, or nothing.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    Texts(Vec<Option<String>>),
    Numbers(Vec<Option<f64>>),
}

/// The rows by columns.
#[derive(Debug, Clone, PartialEq)]
pub struct LongTable {
    pub columns: Vec<(String, Values)>,
    pub rows: usize,
}

/// One value: of what, on which item.
struct Row<'a> {
    case: usize,
    method: &'a MethodRecord,
    quantity: String,
    item: String,
    value: Option<f64>,
}

/// The rows of all cases: errors of each shape or load, figures of each case, and the processor time of each pass.
pub fn long_table(records: &[CaseRecord], [version, machine]: [&str; 2]) -> LongTable {
    let mut rows = Vec::new();
    for (case, record) in records.iter().enumerate() {
        record.methods.iter().for_each(|method| rows.extend(rows_of(case, method)));
    }
    let keys: BTreeSet<&str> = records.iter().flat_map(|record| record.settings.keys()).map(String::as_str).collect();
    let of_fits: BTreeSet<&str> = rows
        .iter()
        .flat_map(|row| row.method.settings.keys())
        .map(String::as_str)
        .filter(|k| !keys.contains(k))
        .collect();
    let mut columns = vec![("case".to_string(), numbers(&rows, |row| Some((row.case + 1) as f64)))];
    for key in keys {
        columns.push((key.into(), column(&rows, |row| records[row.case].settings.get(key))));
    }
    columns.push(("fit".into(), texts(&rows, |row| Some(row.method.fit.clone()))));
    for key in of_fits {
        columns.push((key.into(), column(&rows, |row| row.method.settings.get(key))));
    }
    columns.push(("fitted".into(), numbers(&rows, |row| Some(row.method.fitted as f64))));
    columns.push(("copied".into(), numbers(&rows, |row| Some(row.method.copied as f64))));
    columns.push(("item".into(), texts(&rows, |row| Some(row.item.clone()).filter(|item| !item.is_empty()))));
    columns.push(("quantity".into(), texts(&rows, |row| Some(row.quantity.clone()))));
    columns.push(("value".into(), numbers(&rows, |row| row.value)));
    columns.push(("version".into(), texts(&rows, |_| Some(version.into()))));
    columns.push(("machine".into(), texts(&rows, |_| Some(machine.into()))));
    LongTable { rows: rows.len(), columns }
}

fn rows_of(case: usize, method: &MethodRecord) -> Vec<Row<'_>> {
    let row =
        |quantity: &str, item: &str, value| Row { case, method, quantity: quantity.into(), item: item.into(), value };
    let mut rows = Vec::new();
    for (quantity, list) in &method.values {
        rows.extend(method.items.iter().zip(list).map(|(item, value)| row(quantity, item, *value)));
    }
    rows.extend(method.figures.iter().map(|(quantity, value)| row(quantity, "", *value)));
    for (kind, passes) in &method.times {
        let quantity = format!("seconds {kind}");
        let pass = |(i, seconds): (usize, &f64)| row(&quantity, &format!("pass {}", i + 1), Some(*seconds));
        rows.extend(passes.iter().enumerate().map(pass));
    }
    rows
}

fn numbers(rows: &[Row], of: impl Fn(&Row) -> Option<f64>) -> Values {
    Values::Numbers(rows.iter().map(of).collect())
}

fn texts(rows: &[Row], of: impl Fn(&Row) -> Option<String>) -> Values {
    Values::Texts(rows.iter().map(of).collect())
}

/// A column of numbers if all values are, otherwise of texts.
fn column<'a>(rows: &'a [Row], of: impl Fn(&'a Row) -> Option<&'a Value>) -> Values {
    let all: Vec<Option<&Value>> = rows.iter().map(of).collect();
    match all.iter().flatten().all(|value| value.is_number()) {
        true => Values::Numbers(all.into_iter().map(|value| value.and_then(Value::as_f64)).collect()),
        false => Values::Texts(all.into_iter().map(|value| value.map(plain)).collect()),
    }
}

impl LongTable {
    /// The columns by their names, in order: a list of `[name, values]`.
    pub fn json(&self) -> Value {
        let column = |(name, values): &(String, Values)| match values {
            Values::Texts(list) => serde_json::json!([name, list]),
            Values::Numbers(list) => serde_json::json!([name, list]),
        };
        self.columns.iter().map(column).collect()
    }

    /// Writes the columns as CSV with all digits; what is missing is an empty cell.
    pub fn csv(&self) -> String {
        let header: Vec<&str> = self.columns.iter().map(|(name, _)| name.as_str()).collect();
        let cell = |values: &Values, row: usize| match values {
            Values::Texts(list) => list[row].clone().unwrap_or_default(),
            Values::Numbers(list) => list[row].map_or(String::new(), |value| format!("{value:?}")),
        };
        let rows = (0..self.rows).map(|row| self.columns.iter().map(|(_, values)| cell(values, row)).collect());
        csv(&header, &rows.collect::<Vec<Vec<String>>>())
    }
}
