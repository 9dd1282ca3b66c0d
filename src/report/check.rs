//! What `check` found, as text and as JSON.

use super::columns::Heading;
use super::result_table::ResultTable;
use crate::number::finite;
use crate::study::{Inspection, Mark, Property};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
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

/// All properties of all files, to be typeset.
pub fn check_table(inspections: &[Inspection]) -> ResultTable {
    let header = ["file", "property", "mark", "finding"].map(Heading::words);
    let row = |inspection: &Inspection, property: &Property| {
        let mark = word(property.mark).trim().to_string();
        vec![inspection.file.clone(), property.name.into(), mark, property.finding.clone()]
    };
    let of_file = |inspection: &Inspection| -> Vec<Vec<String>> {
        inspection.properties.iter().map(|property| row(inspection, property)).collect()
    };
    let rows: Vec<Vec<String>> = inspections.iter().flat_map(of_file).collect();
    ResultTable::printed("check", "Properties of elements", &header, &rows)
}

/// A file in the JSON of `check`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct InspectionRecord {
    /// The file, or the name of a shipped element.
    pub file: String,
    /// What was checked: a file, or a shipped element.
    pub title: String,
    /// Whether each property holds.
    pub passes: bool,
    /// The properties in the order in which they are checked.
    pub properties: Vec<PropertyRecord>,
}

/// A property of a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PropertyRecord {
    /// What is checked.
    pub property: String,
    /// `ok`, `FAIL` or `-`.
    pub mark: String,
    /// What was found, in words.
    pub finding: String,
    /// The number that decides, where there is one.
    pub value: Option<f64>,
}

impl From<&Inspection> for InspectionRecord {
    fn from(inspection: &Inspection) -> InspectionRecord {
        InspectionRecord {
            file: inspection.file.clone(),
            title: inspection.title.clone(),
            passes: inspection.passes(),
            properties: inspection.properties.iter().map(PropertyRecord::from).collect(),
        }
    }
}

impl From<&Property> for PropertyRecord {
    fn from(property: &Property) -> PropertyRecord {
        PropertyRecord {
            property: property.name.into(),
            mark: word(property.mark).trim().into(),
            finding: property.finding.clone(),
            value: property.value.and_then(finite),
        }
    }
}

fn word(mark: Mark) -> &'static str {
    match mark {
        Mark::Holds => "ok  ",
        Mark::Fails => "FAIL",
        Mark::Noted => "-   ",
    }
}
