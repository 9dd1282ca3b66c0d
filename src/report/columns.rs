//! Tables as text, in columns.

use crate::text::{printable, printable_lines};
use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, ContentArrangement, Table, TableComponent};

/// The heading of a column, and to which side its entries are aligned.
#[derive(Debug, Clone, PartialEq)]
pub struct Heading {
    pub text: String,
    alignment: Alignment,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Alignment {
    Left,
    Right,
}

impl Heading {
    /// Of a column of words, aligned to the left.
    pub fn words(text: impl Into<String>) -> Heading {
        Heading { text: text.into(), alignment: Alignment::Left }
    }

    /// Of a column of numbers, aligned to the right.
    pub fn numbers(text: impl Into<String>) -> Heading {
        Heading { text: text.into(), alignment: Alignment::Right }
    }
}

/// The texts of the headings.
pub(super) fn texts(columns: &[Heading]) -> Vec<&str> {
    columns.iter().map(|heading| heading.text.as_str()).collect()
}

/// Rows under their headings.
pub(super) fn aligned(columns: &[Heading], rows: &[Vec<String>]) -> String {
    let mut table = Table::new();
    table.load_preset(NOTHING).set_style(TableComponent::HeaderLines, '-');
    let header = columns.iter().map(|heading| printable_lines(&heading.text));
    let rows = rows.iter().map(|row| row.iter().map(|cell| printable(cell)).collect::<Vec<_>>());
    table.set_content_arrangement(ContentArrangement::Disabled).set_header(header).add_rows(rows);
    for (column, heading) in table.column_iter_mut().zip(columns) {
        column.set_cell_alignment(match heading.alignment {
            Alignment::Left => CellAlignment::Left,
            Alignment::Right => CellAlignment::Right,
        });
    }
    table.lines().map(|line| line.trim_end().to_string() + "\n").collect()
}
