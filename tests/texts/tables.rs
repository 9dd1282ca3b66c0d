//! Tables in LaTeX, Markdown and CSV, and scenes of `springfit new`.

use super::hostile::{every, others};
use super::readers::{of_markdown, parts, printed};
use crate::shapes::bodies::grid;
use springfit_foundation::text::{csv, not_a_line, of_csv, printable};
use springfit_mesh::mesh::Group;
use springfit_report::report::{Cell, Column, Markup, Table};
use springfit_studies::study::{DraftMaterial, DraftSource, DraftUnit, draft};

fn table(text: &str) -> Table {
    let cell = |text: &str| Cell { text: text.into(), value: None, is_best: false };
    Table {
        name: text.into(),
        title: text.into(),
        columns: [Column::words("a"), Column::numbers("b"), Column::words("c")].map(|column| column.group(text)).into(),
        rows: vec![vec![cell(text), cell("1.5"), cell("end")], vec![cell(text), cell("-"), cell(text)]],
        notes: Vec::new(),
    }
}

#[test]
fn a_cell_of_a_table_is_one_cell_with_its_text() {
    for text in every() {
        let shown = printable(&text);
        // A column without a group has its title alone.
        let title = |row: usize| match (row, text.is_empty()) {
            (0, true) => "a",
            (0, false) => ": a",
            _ => "",
        };
        let latex = Markup::Latex.table(&table(&text));
        let rows: Vec<&str> = latex.lines().filter_map(|line| line.strip_suffix(" \\\\")).collect();
        // Columns of a group stand under its name.
        let is_grouped = !text.is_empty();
        assert_eq!(rows.len(), 3 + usize::from(is_grouped), "{latex}");
        let rows = match is_grouped {
            true => {
                let name = rows[0].trim().strip_prefix("\\multicolumn{3}{c}{").and_then(|rest| rest.strip_suffix('}'));
                let name =
                    printed(name.unwrap_or_else(|| panic!("{}", rows[0]))).unwrap_or_else(|| panic!("{}", rows[0]));
                assert_eq!(name.trim(), shown.trim().replace("|R-K|", ""), "{}", rows[0]);
                &rows[1..]
            }
            false => &rows[..],
        };
        for (i, row) in rows.iter().enumerate() {
            let title = if i == 0 { "a" } else { "" };
            let shown = if i == 0 { "" } else { &*shown };
            let cells = parts(row, '&');
            assert_eq!(cells.len(), 3, "{row}");
            // Leading blanks of a line and those beside `&` have no meaning.
            let first = printed(cells[0].trim_start()).unwrap_or_else(|| panic!("{row}"));
            let expected = format!("{shown}{title}").trim_start().replace("|R-K|", "");
            assert_eq!(first.trim_end(), expected.trim_end(), "{row}");
        }
        let markdown = Markup::Markdown.table(&table(&text));
        assert_eq!(markdown.lines().count(), 6, "{markdown}");
        for (i, line) in markdown.lines().skip(2).filter(|line| !line.contains("---:")).enumerate() {
            let title = title(i);
            let cells = parts(line, '|');
            assert_eq!(cells.len(), 5, "{line}");
            assert_eq!(of_markdown(&cells[1]).as_deref(), Some(&*format!(" {shown}{title} ")), "{line}");
        }
    }
}

/// OWASP, CSV injection: a cell that begins with = + - @ is a formula. Numbers stay numbers, and what is read again is the text.
#[test]
fn no_text_is_a_formula_of_a_spreadsheet() {
    for text in every() {
        let cell = csv(&text);
        assert_eq!(of_csv(&cell), text);
        let is_number = text.trim().parse::<f64>().is_ok();
        assert!(is_number || !cell.trim_start_matches(' ').starts_with(['=', '+', '-', '@', '\t', '\r']), "{cell}");
        assert!(!is_number || cell == text);
    }
    for number in ["-1.5", "+3", "-1e-3", "-", "-0.1 2 -3", "1", "", "inf"] {
        assert_eq!(csv(number), number);
    }
}

#[test]
fn a_first_scene_has_each_text_in_its_place() {
    let plain = grid("tet4", &[1.0; 3], &[4, 1, 1]);
    for text in every() {
        let mut mesh = plain.clone();
        let held = mesh.groups["xmin"].clone();
        mesh.groups.clear();
        mesh.groups.insert(text.clone(), Group { ..held });
        let material = DraftMaterial::default();
        let scene = draft(
            &mesh,
            DraftSource::File(&text),
            DraftUnit { text: &text, scale: 1.0, space: None },
            std::slice::from_ref(&text),
            &text,
            &material,
        );
        let read: toml::Table = scene.parse().unwrap_or_else(|e| panic!("{e}: {scene}"));
        let is_unit = text.parse::<f64>().is_ok();
        assert_eq!(read["title"].as_str(), Some(&text[..]));
        assert_eq!(read["mesh"]["file"].as_str(), Some(&text[..]));
        assert_eq!(read["mesh"]["elements"][0].as_str(), Some(&text[..]));
        assert!(is_unit || read["mesh"]["scale"].as_str() == Some(&text[..]));
        let keys: Vec<&str> = read.keys().map(String::as_str).collect();
        assert!(
            keys.iter()
                .all(|key| ["title", "mesh", "material", "fit", "reference", "fix", "load", "output"].contains(key)),
            "{keys:?}"
        );
        // A group that no scene can name is not named.
        let group = read["fix"][0].get("group").and_then(toml::Value::as_str);
        assert!(group == Some(&text[..]) || not_a_line(&text, false).is_some() && group.is_none(), "{scene}");
    }
    assert!(others().iter().all(|text| not_a_line(text, false).is_some()));
}
