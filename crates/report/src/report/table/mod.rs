//! A table of results. It is defined once, and written to the terminal, to the page, as LaTeX, as Markdown and as CSV.

mod cell;
mod column;
mod csv;
mod terminal;
mod typeset;

pub use cell::Cell;
pub(super) use cell::Digits;
pub use column::Column;
pub(super) use column::Priority;
pub(super) use csv::{csv, csv_of};
pub(super) use terminal::run_text;
pub use terminal::{Detail, set_page};
pub use typeset::Markup;
pub(super) use typeset::markdown_body;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Rows of cells under their columns.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Table {
    /// Options and labels call the table by this word.
    pub name: String,
    /// The title says what the table shows.
    pub title: String,
    /// The columns stand in this order.
    pub columns: Vec<Column>,
    /// Each row has a cell for each column.
    pub rows: Vec<Vec<Cell>>,
    /// Each sentence below the table says what a reader must know of its cells.
    pub notes: Vec<String>,
}

/// A column, and its cell of a row.
pub(super) type Filled<'a, R> = (Column, &'a dyn Fn(&R) -> Cell);

impl Table {
    /// A table without notes.
    pub(super) fn new<C: Into<Cell>>(
        name: &str,
        title: impl Into<String>,
        columns: Vec<Column>,
        rows: impl IntoIterator<Item = Vec<C>>,
    ) -> Table {
        let row = |row: Vec<C>| row.into_iter().zip(&columns).map(|(cell, column)| cell.into().of(column)).collect();
        let rows = rows.into_iter().map(row).collect();
        Table { name: name.into(), title: title.into(), columns, rows, notes: Vec::new() }
    }

    /// A table with a row for each of these: each column stands beside its cell of a row.
    pub(super) fn of<R>(
        name: &str,
        title: impl Into<String>,
        rows: impl IntoIterator<Item = R>,
        columns: &[Filled<R>],
    ) -> Table {
        let row = |row: R| columns.iter().map(|(_, cell)| cell(&row)).collect::<Vec<Cell>>();
        let rows: Vec<Vec<Cell>> = rows.into_iter().map(row).collect();
        Table::new(name, title, columns.iter().map(|(column, _)| column.clone()).collect(), rows)
    }

    /// Puts sentences below the table.
    pub(super) fn with_notes(self, notes: impl IntoIterator<Item = String>) -> Table {
        Table { notes: notes.into_iter().collect(), ..self }
    }
}
