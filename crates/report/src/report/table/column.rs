//! A column of a table.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The heading of a column, and how its cells are written.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct Column {
    /// Columns beside each other belong together if they have the same group, such as the name of a load; it is empty for a column alone.
    #[serde(default)]
    pub group: String,
    /// The column has this name. On the terminal it may have several lines.
    pub title: String,
    /// The numbers of the column are in this unit; it is empty for words and shares.
    pub unit: String,
    /// The cells are numbers, which are aligned to the right.
    pub numbers: bool,
    /// The cells are sentences, which the terminal breaks into lines.
    #[serde(skip)]
    pub(super) wraps: bool,
    #[serde(skip)]
    pub(super) priority: Priority,
}

/// Where the terminal has a column; all other writers have all columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(in crate::report) enum Priority {
    /// The terminal has it.
    Always,
    /// The terminal has it where more is asked for, and in tables that are printed by themselves.
    #[default]
    Verbose,
    /// The terminal leaves it out.
    InFiles,
}

impl Column {
    /// A column of words.
    pub fn words(title: impl Into<String>) -> Column {
        Column { title: title.into(), ..Column::default() }
    }

    /// A column of lists or sentences.
    pub fn sentences(title: impl Into<String>) -> Column {
        Column { wraps: true, ..Column::words(title) }
    }

    /// A column of numbers.
    pub fn numbers(title: impl Into<String>) -> Column {
        Column { numbers: true, ..Column::words(title) }
    }

    /// Sets the unit of the column.
    pub(in crate::report) fn unit(self, unit: &str) -> Column {
        Column { unit: unit.into(), ..self }
    }

    /// Sets the group of the column.
    pub fn group(self, group: impl Into<String>) -> Column {
        Column { group: group.into(), ..self }
    }

    /// Sets the priority of the column.
    pub(in crate::report) fn priority(self, priority: Priority) -> Column {
        Column { priority, ..self }
    }

    /// Group, title and unit in one line.
    pub(in crate::report) fn heading(&self) -> String {
        // A hyphen at the end of a line divides a word.
        let title = self.title.replace("-\n", "-").replace('\n', " ");
        let named = if self.group.is_empty() { title } else { format!("{}: {title}", self.group) };
        if self.unit.is_empty() { named } else { format!("{named}, {}", self.unit) }
    }

    /// Writes group, title and unit in one line, in the letters that every program reads.
    pub(in crate::report) fn plain_heading(&self) -> String {
        Column { title: ascii(&self.title), unit: ascii(&self.unit), ..self.clone() }.heading()
    }
}

/// Signs of formulas in the letters that every terminal has.
pub(super) fn ascii(text: &str) -> String {
    text.replace('ν', "nu").replace('µ', "u").replace(['−', '–'], "-")
}
