//! What `check` found, as text and as JSON.

use crate::study::{Inspection, Mark};
use serde_json::json;
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

/// All files as one list.
pub fn check_json(inspections: &[Inspection]) -> String {
    let file = |inspection: &Inspection| {
        let property = |p: &crate::study::Property| json!({ "property": p.name, "mark": word(p.mark).trim(), "finding": p.finding, "value": p.value });
        json!({
            "file": inspection.file,
            "title": inspection.title,
            "passes": inspection.passes(),
            "properties": inspection.properties.iter().map(property).collect::<Vec<_>>(),
        })
    };
    let all: Vec<_> = inspections.iter().map(file).collect();
    serde_json::to_string_pretty(&all).expect("a value of finite numbers and text is JSON") + "\n"
}

fn word(mark: Mark) -> &'static str {
    match mark {
        Mark::Holds => "ok  ",
        Mark::Fails => "FAIL",
        Mark::Noted => "-   ",
    }
}
