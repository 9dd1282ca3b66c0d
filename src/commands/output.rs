//! How results are printed.

use super::choice::choice;
use crate::terminal::{Terminal, json_text};
use clap::Args;
use serde::Serialize;
use springfit_foundation::error::{Error, Result};
use springfit_foundation::text::printable_lines;
use springfit_report::report::{self, Detail, Markup, Report, Table};
use springfit_studies::study::Outcome;
use std::ffi::OsString;
use std::sync::OnceLock;

/// Notes that are printed of an outcome, unless all are asked for: more would push the table off the screen.
const MOST_NOTES: usize = 8;

/// The options of a command that prints tables.
#[derive(Args)]
#[command(next_help_heading = "Output")]
pub struct OutputOptions {
    /// Print one JSON document to standard output in place of tables; names of files go to standard error
    #[arg(long)]
    pub json: bool,
    /// Typeset the tables; LaTeX has the rules of booktabs. Names of files go to standard error
    #[arg(long, value_parser = choice::<Markup>(), conflicts_with = "json")]
    table: Option<Markup>,
}

impl OutputOptions {
    /// Whether results are printed as text, which may come in parts.
    pub fn is_text(&self) -> bool {
        !self.json && self.table.is_none()
    }

    /// Prints a result as it is asked for: its record as JSON, its tables typeset, or its text.
    ///
    /// # Errors
    /// Standard output cannot be written.
    pub fn print<R: Serialize>(
        &self,
        terminal: &mut Terminal,
        record: impl FnOnce() -> R,
        tables: impl FnOnce() -> Vec<Table>,
        text: impl FnOnce() -> String,
    ) -> Result<()> {
        self.print_text(terminal, &self.text(record, tables, text))
    }

    /// Prints what [`OutputOptions::text`] has made.
    ///
    /// # Errors
    /// Standard output cannot be written.
    pub fn print_text(&self, terminal: &mut Terminal, text: &str) -> Result<()> {
        if self.is_text() { terminal.print(&terminal.within_page(text)) } else { terminal.print_document(text) }
    }

    /// What is printed of a result.
    pub fn text<R: Serialize>(
        &self,
        record: impl FnOnce() -> R,
        tables: impl FnOnce() -> Vec<Table>,
        text: impl FnOnce() -> String,
    ) -> String {
        let text = match (self.json, self.table) {
            (true, _) => json_text(&record()),
            (false, Some(markup)) => markup.tables(&tables()),
            (false, None) => text(),
        };
        printable_lines(&text).into_owned()
    }

    /// Prints an outcome with its notes, which a report has as well. Unless all is asked for, it is one row for each fit and the notes that
    /// cost most, each once for all that it concerns.
    ///
    /// # Errors
    /// Standard output cannot be written.
    pub fn print_outcome(&self, terminal: &mut Terminal, outcome: &Outcome) -> Result<()> {
        let record = || Report::of(outcome);
        let detail = terminal.detail();
        let text = || format!("{}\n{}", report::summary(outcome), report::tables(outcome));
        self.print(terminal, record, || Table::all(&record()), text)?;
        if self.json {
            return Ok(());
        }
        let (notes, most) = match (self.is_text(), detail) {
            (false, _) => (report::notes(outcome), usize::MAX),
            (true, Detail::All) => (report::notes_beside_summary(outcome), usize::MAX),
            (true, Detail::Overview) => (report::groups_beside_summary(outcome), MOST_NOTES),
        };
        notes.iter().take(most).for_each(|note| terminal.note(note));
        if notes.len() > most {
            terminal.note(&format!("… and {} more with -v", notes.len() - most));
        }
        Ok(())
    }

    /// Prints what would be done, as JSON or as text.
    ///
    /// # Errors
    /// Standard output cannot be written; or the tables are to be typeset, and there are none yet.
    pub fn print_plan<R: Serialize>(
        &self,
        terminal: &mut Terminal,
        record: &R,
        text: impl FnOnce() -> String,
    ) -> Result<()> {
        match (self.json, self.table) {
            (_, Some(_)) => Err(Error::at("--table", "belongs to results, found with --explain")),
            (true, None) => terminal.print_json(record),
            (false, None) => terminal.print(&text()),
        }
    }
}

/// The arguments of the program.
static TYPED: OnceLock<Vec<OsString>> = OnceLock::new();

/// Keeps the arguments of the program for [`command`].
pub fn typed_as(arguments: Vec<OsString>) {
    // A program has one command.
    let _ = TYPED.set(arguments);
}

/// The command as it was typed, for files that say where they come from.
pub fn command() -> String {
    let words = TYPED.get().into_iter().flatten().map(|word| {
        let word = word.to_string_lossy();
        match word.chars().any(|c| c.is_whitespace() || c.is_control() || c == '"') {
            true => format!("{word:?}"),
            false => word.into_owned(),
        }
    });
    std::iter::once("springfit".to_string()).chain(words).collect::<Vec<_>>().join(" ")
}
