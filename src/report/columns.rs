//! Tables as text, in columns.

use crate::text::{printable, printable_lines};
use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, ColumnConstraint, ContentArrangement, Table, TableComponent};
use std::sync::atomic::{AtomicUsize, Ordering};

/// The heading of a column, and to which side its entries are aligned.
#[derive(Debug, Clone, PartialEq)]
pub struct Heading {
    /// The name of the column.
    pub text: String,
    alignment: Alignment,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Alignment {
    Left,
    /// To the left, in several lines where the page is narrow.
    Wrapped,
    Right,
}

impl Heading {
    /// Of a column of words, aligned to the left.
    pub fn words(text: impl Into<String>) -> Heading {
        Heading { text: text.into(), alignment: Alignment::Left }
    }

    /// Of a column of lists or sentences, which may be broken into lines.
    pub fn sentences(text: impl Into<String>) -> Heading {
        Heading { text: text.into(), alignment: Alignment::Wrapped }
    }

    /// Of a column of numbers, aligned to the right.
    pub fn numbers(text: impl Into<String>) -> Heading {
        Heading { text: text.into(), alignment: Alignment::Right }
    }

    /// Whether the column has numbers.
    pub(super) fn is_of_numbers(&self) -> bool {
        self.alignment == Alignment::Right
    }
}

/// Columns of the page that tables are fitted to; no table is broken unless a program sets it.
static PAGE: AtomicUsize = AtomicUsize::new(usize::MAX);

/// Fits all tables from now on to a page of that many columns: a table that is wider goes on below, with its first column again.
pub fn set_page_width(columns: usize) {
    PAGE.store(columns, Ordering::Relaxed);
}

/// The texts of the headings.
pub(super) fn texts(columns: &[Heading]) -> Vec<&str> {
    columns.iter().map(|heading| heading.text.as_str()).collect()
}

/// Rows under their headings, on the page that is set.
pub(super) fn aligned(columns: &[Heading], rows: &[Vec<String>]) -> String {
    aligned_within(columns, rows, PAGE.load(Ordering::Relaxed))
}

/// Rows under their headings, at most `page` columns wide if each column fits beside the first.
fn aligned_within(columns: &[Heading], rows: &[Vec<String>], page: usize) -> String {
    if columns.iter().any(|heading| heading.alignment == Alignment::Wrapped) {
        return block(columns, rows, Some(page));
    }
    let widths: Vec<usize> = (0..columns.len()).map(|column| width(columns, rows, column)).collect();
    if widths.iter().sum::<usize>() <= page {
        return block(columns, rows, None);
    }
    // The first columns of words name a row, unless all are words.
    let words = columns.iter().take_while(|heading| heading.alignment == Alignment::Left).count();
    let names = if words < columns.len() { words.max(1) } else { 1 };
    let named: usize = widths[..names].iter().sum();
    let mut blocks: Vec<Vec<usize>> = Vec::new();
    let mut room = 0;
    for column in names..columns.len() {
        if blocks.is_empty() || widths[column] > room {
            blocks.push((0..names).collect());
            room = page.saturating_sub(named);
        }
        if let Some(last) = blocks.last_mut() {
            last.push(column);
        }
        room = room.saturating_sub(widths[column]);
    }
    let part = |chosen: &Vec<usize>| {
        let columns: Vec<Heading> = chosen.iter().map(|&column| columns[column].clone()).collect();
        let cell = |row: &Vec<String>, column: usize| row.get(column).cloned().unwrap_or_default();
        let rows: Vec<Vec<String>> =
            rows.iter().map(|row| chosen.iter().map(|&column| cell(row, column)).collect()).collect();
        block(&columns, &rows, None)
    };
    blocks.iter().map(part).collect::<Vec<_>>().join("\n")
}

/// The columns that the page gives to a column, with a blank on each side.
fn width(columns: &[Heading], rows: &[Vec<String>], column: usize) -> usize {
    let cells = rows.iter().filter_map(|row| row.get(column)).map(|cell| console::measure_text_width(&printable(cell)));
    let heading = columns[column].text.lines().map(console::measure_text_width);
    2 + heading.chain(cells).max().unwrap_or(0)
}

/// The columns beside each other; where there is a page, those of sentences are broken into lines.
fn block(columns: &[Heading], rows: &[Vec<String>], page: Option<usize>) -> String {
    let mut table = Table::new();
    table.load_preset(NOTHING).set_style(TableComponent::HeaderLines, '-');
    let header = columns.iter().map(|heading| printable_lines(&heading.text));
    let rows = rows.iter().map(|row| row.iter().map(|cell| printable(cell)).collect::<Vec<_>>());
    table.set_content_arrangement(ContentArrangement::Disabled).set_header(header).add_rows(rows);
    if let Some(page) = page {
        let page = u16::try_from(page).unwrap_or(u16::MAX);
        table.set_content_arrangement(ContentArrangement::Dynamic).set_width(page);
    }
    for (column, heading) in table.column_iter_mut().zip(columns) {
        column.set_cell_alignment(match heading.alignment {
            Alignment::Left | Alignment::Wrapped => CellAlignment::Left,
            Alignment::Right => CellAlignment::Right,
        });
        if page.is_some() && heading.alignment != Alignment::Wrapped {
            column.set_constraint(ColumnConstraint::ContentWidth);
        }
    }
    table.lines().map(|line| line.trim_end().to_string() + "\n").collect()
}
