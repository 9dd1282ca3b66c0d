//! A sweep as a table, as CSV, and as maps of its errors.

use super::table::{Column, Table, csv_of};
use super::write_files;
use crate::error::Result;
use crate::file::Edition;
use crate::order::distinct;
use crate::study::{Family, StabilityOutcome, StabilityRow, Verdict};
use std::fmt::Write;
use std::path::PathBuf;
use svg::Document;
use svg::node::element::{Rectangle, Text, Title};

/// Pixels of one case in a map, and beside and above them.
const CELL: (usize, usize) = (9, 20);
const BESIDE: usize = 190;
const ABOVE: usize = 132;
/// What an error of 1e-16, 1e-14, … 1e-2 and more is drawn as: light where all digits are right (Crameri's lajolla, turned).
const SHADES: [&str; 8] = ["#fbf1c2", "#f8dc8c", "#f2c25c", "#e99f51", "#dd7350", "#b64a4a", "#6d3632", "#1f1a0c"];
const REFUSED: &str = "#c8ccd4";
const TOLD: &str = "#9db8d9";

/// What came of each family and method.
pub fn stability_table(outcome: &StabilityOutcome) -> Table {
    let mut columns = ["family", "of"].map(Column::words).to_vec();
    columns.push(Column::numbers("cases"));
    columns.extend(Verdict::NAMES.map(|name| Column::numbers(name.replace('-', "-\n"))));
    let figures = ["worst\nerror", "worst error\nin f32", "largest\ncondition"];
    columns.extend(figures.map(Column::numbers));
    columns.push(Column::numbers("k < 0").unit("%"));
    Table::new("stability", &*outcome.title, columns, families(outcome))
}

/// What came of each family and method, then what is trouble with its way out, what is only said, and what is lost.
pub fn stability_text(outcome: &StabilityOutcome) -> String {
    let mut text = stability_table(outcome).titled_text();
    for (is_trouble, heading) in [(true, "Trouble, and the way out"), (false, "Remarks that are no trouble")] {
        let reasons = reasons(outcome, is_trouble);
        if !reasons.is_empty() {
            writeln!(text, "\n{heading}").expect("a String grows");
        }
        for Reason { family, words, way_out, count, .. } in reasons {
            writeln!(text, "  {:<16} {count:>4}  {words}", family.name()).expect("a String grows");
            if let Some(way_out) = way_out {
                writeln!(text, "  {:<16} {:>4}  -> {way_out}", "", "").expect("a String grows");
            }
        }
    }
    for row in outcome.lost() {
        let (error, allowed) = (number(row.error), number(row.allowed));
        let StabilityRow { subject, case, method, .. } = row;
        writeln!(text, "LOST: {subject}, {case}, {method}: error {error}, allowed {allowed}").expect("a String grows");
    }
    let (cases, lost) = (outcome.rows.len(), outcome.lost().count());
    writeln!(text, "{cases} cases in {:.1} s, {lost} lost", outcome.seconds).expect("a String grows");
    text
}

/// One row per family and kind of method.
fn families(outcome: &StabilityOutcome) -> Vec<Vec<String>> {
    let mut keys: Vec<(Family, &str)> = outcome.rows.iter().map(|row| (row.family, row.method.as_str())).collect();
    keys.sort();
    keys.dedup();
    let largest = |values: &mut dyn Iterator<Item = f64>| values.reduce(f64::max);
    let row = |&(family, method): &(Family, &str)| {
        let rows: Vec<&StabilityRow> =
            outcome.rows.iter().filter(|row| (row.family, row.method.as_str()) == (family, method)).collect();
        let count = |name: &str| rows.iter().filter(|row| row.verdict.name() == name).count();
        let worst = largest(&mut rows.iter().filter_map(|row| row.error));
        let single = largest(&mut rows.iter().filter_map(|row| row.single));
        let condition = largest(&mut rows.iter().filter_map(|row| row.condition));
        let negative = rows.iter().filter_map(|row| row.negative).fold([0, 0], |[a, b], [n, m]| [a + n, b + m]);
        let mut cells = vec![family.name().to_string(), method.to_string(), rows.len().to_string()];
        for name in Verdict::NAMES {
            let count = count(name);
            cells.push(if count == 0 { "-".into() } else { count.to_string() });
        }
        cells.extend([number(worst), number(single), number(condition)]);
        let share = |[n, m]: [usize; 2]| format!("{:.0}", 100.0 * n as f64 / m as f64);
        cells.push(if negative[1] == 0 { "-".into() } else { share(negative) });
        cells
    };
    keys.iter().map(row).collect()
}

fn number(value: Option<f64>) -> String {
    value.map_or("-".into(), |v| if v == 0.0 { "0".into() } else { format!("{v:.1e}") })
}

/// Cases with one reason: its numbers are taken out, so that like ones are counted together, and the first stands for them.
struct Reason<'a> {
    family: Family,
    plain: String,
    words: &'a str,
    way_out: Option<&'static str>,
    count: usize,
}

/// The reasons of what is trouble, or of what is not.
fn reasons(outcome: &StabilityOutcome, is_trouble: bool) -> Vec<Reason<'_>> {
    let mut found: Vec<Reason> = Vec::new();
    let rows = outcome.rows.iter().filter(|row| row.is_trouble() == is_trouble && !row.verdict.words().is_empty());
    for row in rows {
        let (words, way_out) = (row.verdict.words(), row.way_out);
        let plain: String = words.chars().filter(|c| c.is_alphabetic() || *c == ' ').collect();
        let like = |known: &&mut Reason| known.family == row.family && known.plain == plain && known.way_out == way_out;
        match found.iter_mut().find(like) {
            Some(known) => known.count += 1,
            None => found.push(Reason { family: row.family, plain, words, way_out, count: 1 }),
        }
    }
    found
}

/// Every case in full.
fn table(outcome: &StabilityOutcome) -> String {
    let full = |value: Option<f64>| value.map_or(String::new(), |v| format!("{v:e}"));
    let whole = |count: Option<usize>| count.map_or(String::new(), |count| count.to_string());
    csv_of(
        &outcome.rows,
        &[
            ("of", &|row| row.subject.clone()),
            ("family", &|row| row.family.name().into()),
            ("case", &|row| row.case.clone()),
            ("method", &|row| row.method.clone()),
            ("status", &|row| row.verdict.name().into()),
            ("words", &|row| row.verdict.words().into()),
            ("error", &|row| full(row.error)),
            ("allowed", &|row| full(row.allowed)),
            ("error_f32", &|row| full(row.single)),
            ("condition", &|row| full(row.condition)),
            ("negative", &|row| whole(row.negative.map(|[negative, _]| negative))),
            ("springs", &|row| whole(row.negative.map(|[_, springs]| springs))),
            ("softest", &|row| full(row.softest)),
            ("step_s", &|row| full(row.step)),
            ("iterations", &|row| whole(row.iterations)),
            ("way_out", &|row| row.way_out.unwrap_or_default().into()),
        ],
    )
}

/// One map for each subject with a case per column and a method per row, in the order of the sweep; an SVG file's text.
fn map(subject: &str, rows: &[&StabilityRow]) -> String {
    let methods = distinct(rows.iter().map(|row| row.method.as_str()));
    let cases = distinct(rows.iter().map(|row| (row.family, row.case.as_str())));
    let place = |row: &StabilityRow| {
        let column = cases.iter().position(|case| *case == (row.family, row.case.as_str())).unwrap_or(0);
        let line = methods.iter().position(|method| *method == row.method).unwrap_or(0);
        // A gap between families.
        let gaps = cases[..=column].windows(2).filter(|pair| pair[0].0 != pair[1].0).count();
        (BESIDE + column * CELL.0 + 6 * gaps, ABOVE + line * CELL.1)
    };
    let width = rows.iter().map(|row| place(row).0).max().unwrap_or(0) + CELL.0 + 30;
    let height = ABOVE + methods.len() * CELL.1 + 62;
    let words = |x: usize, y: usize, size: usize, text: &str| {
        Text::new(text).set("x", x).set("y", y).set("font-size", size).set("font-family", "sans-serif")
    };
    let mut picture = Document::new()
        .set("viewBox", (0, 0, width.max(760), height))
        .set("width", width.max(760))
        .set("height", height);
    picture = picture.add(Rectangle::new().set("width", "100%").set("height", "100%").set("fill", "white"));
    picture = picture.add(words(12, 24, 16, &format!("{subject}: error of each case against its reference")));
    picture = picture.add(words(12, 42, 12, "a column for each case, in the order of stability.csv"));
    for (line, method) in methods.iter().enumerate() {
        picture = picture.add(words(12, ABOVE + line * CELL.1 + 15, 13, method));
    }
    let mut last = None;
    for (family, case) in &cases {
        let Some(row) = rows.iter().find(|row| (row.family, row.case.as_str()) == (*family, *case)) else { continue };
        if last != Some(*family) {
            let (x, _) = place(row);
            let name = words(x + 4, ABOVE - 6, 12, family.name());
            picture = picture.add(name.set("transform", format!("rotate(-55 {} {})", x + 4, ABOVE - 6)));
        }
        last = Some(*family);
    }
    for row in rows {
        let (x, y) = place(row);
        let said = format!(
            "{}, {}: {} {} {}",
            row.case,
            row.method,
            row.verdict.name(),
            number(row.error),
            row.verdict.words()
        );
        let color = match (&row.verdict, row.error) {
            (Verdict::Refused(_), _) => REFUSED,
            (Verdict::Told(_) | Verdict::Dependent, _) => TOLD,
            (_, Some(error)) => shade(error),
            (_, None) => TOLD,
        };
        let edge = if row.verdict == Verdict::Lost { "red" } else { "white" };
        let cell = Rectangle::new().set("x", x).set("y", y).set("width", CELL.0 - 1).set("height", CELL.1 - 1);
        let cell = cell.set("fill", color).set("stroke", edge).set("stroke-width", if edge == "red" { 3 } else { 1 });
        picture = picture.add(cell.add(Title::new(said)));
    }
    let base = height - 40;
    let legend = SHADES.iter().enumerate().map(|(i, color)| (*color, format!("1e{}", 2 * i as i32 - 16)));
    let legend = legend.chain([(REFUSED, "refused".into()), (TOLD, "told or dependent".into())]);
    let mut x = 12;
    for (color, name) in legend {
        let key = Rectangle::new().set("x", x).set("y", base).set("width", 16).set("height", 16);
        picture = picture.add(key.set("fill", color).set("stroke", "#888"));
        picture = picture.add(words(x + 21, base + 13, 12, &name));
        x += 28 + 8 * name.len();
    }
    picture.to_string()
}

fn shade(error: f64) -> &'static str {
    // Zero has no logarithm, and all of its digits are right.
    let decade = if error > 0.0 { error.log10() } else { -16.0 };
    let place = ((decade + 16.0) / 2.0).floor().clamp(0.0, (SHADES.len() - 1) as f64);
    SHADES[place as usize]
}

/// What [`write_stability`] writes whatever the subjects are.
pub const STABILITY_FILES: [&str; 1] = ["stability.csv"];

/// Writes `stability.csv` and a map for each subject as SVG, and returns the paths.
///
/// # Errors
/// A file cannot be written; the folder is as it was.
pub fn write_stability(outcome: &StabilityOutcome, edition: Edition) -> Result<Vec<PathBuf>> {
    let subjects = distinct(outcome.rows.iter().map(|row| row.subject.as_str()));
    let mut files = vec![(STABILITY_FILES[0].to_string(), table(outcome))];
    for (subject, stem) in subjects.iter().zip(super::names::file_stems(subjects.iter().copied())) {
        let rows: Vec<&StabilityRow> = outcome.rows.iter().filter(|row| row.subject == *subject).collect();
        files.push((format!("{stem}.svg"), map(subject, &rows)));
    }
    write_files(edition, &files)
}
