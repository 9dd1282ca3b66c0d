//! What `check` found, as text and as a table.

use super::table::{Column, Table};
use crate::study::{Inspection, Mark, Property};
use std::fmt::Write;

/// One line per property.
pub fn check_text(inspection: &Inspection) -> String {
    let mut text = format!("{}  {}\n", inspection.file, inspection.title).trim_end().to_string() + "\n";
    let width = inspection.properties.iter().map(|p| p.name.len()).max().unwrap_or(0);
    for property in &inspection.properties {
        writeln!(text, "  {}  {:width$}  {}", word(property.mark), property.name, property.finding)
            .expect("a String grows");
    }
    text
}

/// All properties of all files.
pub fn check_table(inspections: &[Inspection]) -> Table {
    let columns = ["file", "property", "mark", "finding"].map(Column::words).to_vec();
    let row = |inspection: &Inspection, property: &Property| {
        let mark = word(property.mark).trim().to_string();
        vec![inspection.file.clone(), property.name.into(), mark, property.finding.clone()]
    };
    let of_file = |inspection: &Inspection| -> Vec<Vec<String>> {
        inspection.properties.iter().map(|property| row(inspection, property)).collect()
    };
    Table::new("check", "Properties of elements", columns, inspections.iter().flat_map(of_file))
}

fn word(mark: Mark) -> &'static str {
    match mark {
        Mark::Holds => "ok  ",
        Mark::Fails => "FAIL",
        Mark::Noted => "-   ",
    }
}
