//! The files of a comparison.

use super::figures::{all, comparison_chart};
use super::summary::{Summary, VERSION, machine};
use super::tables::compare_tables;
use super::values::long_table;
use crate::error::{Error, Result};
use crate::file::{Edition, read_text, write_whole};
use crate::report::figure::Columns;
use crate::report::study_lines::{Line, mark_of};
use crate::report::table::Markup;
use crate::report::tables_page::tables_page;
use crate::study::CaseRecord;
use crate::text::printable_lines;
use std::path::{Path, PathBuf};

/// The file with a line for each case.
pub const CASES: &str = "cases.jsonl";

/// What [`write_comparison`] writes at most, beside [`CASES`].
pub const COMPARE_FILES: [&str; 23] = [
    "values.csv",
    "values.parquet",
    "summary.json",
    "comparison.csv",
    "objects.csv",
    "objects-frobenius.csv",
    "objects-e_rms.csv",
    "pairs.csv",
    "ranks.csv",
    "tables.tex",
    "tables.md",
    "compare.html",
    "precision.svg",
    "precision-solve.svg",
    "precision-explicit-step.svg",
    "precision-implicit-step.svg",
    "precision-simulated-second.svg",
    "ecdf.svg",
    "poisson.svg",
    "distortion.svg",
    "aspect.svg",
    "norms.svg",
    "samples.svg",
];

/// Writes the values, the tables, the figures and the page, and returns the paths; `lines` says whether the cases are written as well,
/// which a comparison that can be resumed has written before.
///
/// # Errors
/// A file cannot be written, and the folder is as it was.
pub fn write_comparison(
    summary: &Summary,
    records: &[CaseRecord],
    mut edition: Edition,
    lines: bool,
) -> Result<Vec<PathBuf>> {
    let mut texts: Vec<(String, String)> = Vec::new();
    let values = long_table(records, [&summary.version, &summary.machine]);
    texts.push(("values.csv".into(), values.csv()));
    texts.push(("summary.json".into(), serde_json::to_string_pretty(summary).expect("keys are text") + "\n"));
    let tables = compare_tables(summary);
    texts.extend(tables.iter().map(|table| (format!("{}.csv", table.name), table.csv())));
    texts.push(("tables.tex".into(), Markup::Latex.tables(&tables)));
    texts.push(("tables.md".into(), Markup::Markdown.tables(&tables)));
    let mut figures = Vec::new();
    for (name, drawn) in all(records) {
        // A comparison whose errors are all rounding has nothing to draw.
        let chart = comparison_chart(&summary.title, records, drawn, None)?;
        if let Ok(svg) = chart.svg(Columns::Two) {
            figures.push((format!("{name}.svg"), svg));
        }
    }
    let about = format!("springfit {}, {}", summary.version, summary.machine);
    let drawn = figures.iter().map(|(_, svg)| svg.as_str());
    texts.push(("compare.html".into(), tables_page(&summary.title, &about, drawn, &tables, &[])));
    texts.extend(figures);
    if lines {
        texts.push((CASES.into(), records.iter().map(Line::line).collect()));
    }
    for (name, text) in &texts {
        edition.write(name, |path| write_whole(path, printable_lines(text).as_bytes()))?;
    }
    let bytes = values.parquet()?;
    edition.write("values.parquet", |path| write_whole(path, &bytes))?;
    edition.publish()
}

/// All values of a comparison in long form: a list of columns, each its name and its values.
pub fn comparison_values(records: &[CaseRecord]) -> serde_json::Value {
    long_table(records, [VERSION, &machine()]).json()
}

/// The cases of a comparison in a folder.
///
/// # Errors
/// The folder has none, or the file is of something else.
pub fn read_cases(folder: &Path) -> Result<Vec<CaseRecord>> {
    let path = folder.join(CASES);
    let text = read_text(&path)?;
    let record = |(number, line): (usize, &str)| {
        let wrong = |e| Error::new(format!("expected a case of a comparison, found something else: {e}"));
        serde_json::from_str(line).map_err(|e| wrong(e).on_line(number + 1).in_file(&path))
    };
    let records: Vec<CaseRecord> = text.lines().enumerate().map(record).collect::<Result<_>>()?;
    // Cases that the last comparison did not have stay in the file.
    let summary = std::fs::read_to_string(folder.join("summary.json")).ok();
    let summary: Option<serde_json::Value> = summary.and_then(|text| serde_json::from_str(&text).ok());
    let Some(cases) = summary.as_ref().and_then(|summary| summary["cases"].as_array()) else { return Ok(records) };
    let own: Vec<String> = cases.iter().map(|case| case["settings"].to_string()).collect();
    Ok(records.into_iter().filter(|record| own.contains(&mark_of(&record.settings))).collect())
}
