//! Tables on the terminal.

use super::column::ascii;
use super::{Cell, Column, Priority, Table};
use crate::text::{printable, printable_lines};
use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, ColumnConstraint, ContentArrangement, TableComponent};
use std::ops::RangeInclusive;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// A column of the terminal: the heading, to which side entries are aligned, and the entries.
#[derive(Debug, Clone)]
struct Strip {
    heading: String,
    alignment: Alignment,
    entries: Vec<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Alignment {
    Left,
    /// To the left, in several lines where the page is narrow.
    Wrapped,
    Right,
}

/// Columns of the page that tables are fitted to; no table is broken unless a program sets it.
static WIDTH: AtomicUsize = AtomicUsize::new(usize::MAX);

/// Whether tables have their first columns alone.
static IS_OVERVIEW: AtomicBool = AtomicBool::new(false);

/// The unit stands in the same line as the heading if both are no wider than this, or than the cells.
const NARROW: usize = 12;

/// How much of a table is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Detail {
    /// The columns that all readers want.
    Overview,
    /// All columns but those for files alone.
    All,
}

/// Sets the page of all tables from now on. A table that is wider than so many columns goes on below, with its first column again.
pub fn set_page(columns: usize, detail: Detail) {
    WIDTH.store(columns, Ordering::Relaxed);
    IS_OVERVIEW.store(detail == Detail::Overview, Ordering::Relaxed);
}

impl Table {
    /// The title, the columns and the notes.
    pub fn titled_text(&self) -> String {
        format!("{}\n\n{}", printable(&self.title), self.text())
    }

    /// The columns, on the page that is set, and the notes.
    pub fn text(&self) -> String {
        let overview = strips(self, Priority::Always..=last());
        let strips = if overview.is_empty() { strips(self, Priority::Always..=Priority::Verbose) } else { overview };
        within(strips, WIDTH.load(Ordering::Relaxed)) + &notes(self)
    }
}

/// The last priority that the page has.
fn last() -> Priority {
    if IS_OVERVIEW.load(Ordering::Relaxed) { Priority::Always } else { Priority::Verbose }
}

/// The tables of a run. On a page with an overview, a table without first columns is left out.
pub(in crate::report) fn run_text(tables: &[Table]) -> String {
    let page = WIDTH.load(Ordering::Relaxed);
    let mut text = String::new();
    for (place, table) in tables.iter().enumerate() {
        let strips = strips(table, Priority::Always..=last());
        if strips.is_empty() && last() == Priority::Always {
            continue;
        }
        // The first table follows the summary of what was modelled.
        if place > 0 {
            text += &format!("\n{}\n", ascii(&table.title));
        }
        if !strips.is_empty() {
            text += &within(strips, page);
        }
        text += &notes(table);
    }
    text
}

fn notes(table: &Table) -> String {
    table.notes.iter().map(|note| format!("{}\n", printable(note))).collect()
}

/// The columns of a table that have such a priority behind the first one, which names the rows; none if there are no others. Columns of
/// numbers in a group stand in one, `mean / max`.
fn strips(table: &Table, priorities: RangeInclusive<Priority>) -> Vec<Strip> {
    let chosen = |place: &usize| *place == 0 || priorities.contains(&table.columns[*place].priority);
    let places: Vec<usize> = (0..table.columns.len()).filter(chosen).collect();
    // The names of the rows alone say nothing.
    if table.columns.len() > 1 && places.len() < 2 {
        return Vec::new();
    }
    let together = |a: &usize, b: &usize| {
        let [a, b] = [a, b].map(|place| &table.columns[*place]);
        !a.group.is_empty() && a.group == b.group
    };
    places.chunk_by(together).map(|places| strip(table, places)).collect()
}

/// One column, or a group.
fn strip(table: &Table, places: &[usize]) -> Strip {
    let columns: Vec<&Column> = places.iter().map(|place| &table.columns[*place]).collect();
    let [first, .., last] = &columns[..] else { return alone(table, places[0]) };
    let is_one_unit = columns.iter().all(|column| column.unit == last.unit);
    let named = |column: &&Column| match is_one_unit || column.unit.is_empty() {
        true => ascii(&column.title),
        false => ascii(&format!("{} {}", column.title, column.unit)),
    };
    let unit = if is_one_unit && !last.unit.is_empty() { format!(" {}", ascii(&last.unit)) } else { String::new() };
    let names: Vec<String> = columns.iter().map(named).collect();
    let heading = format!("{}\n{}{unit}", printable(&first.group), names.join(" / "));
    let widths: Vec<usize> =
        places.iter().map(|place| table.rows.iter().map(|row| width(row[*place].plain())).max().unwrap_or(0)).collect();
    let entry = |row: &Vec<Cell>| {
        if places.iter().all(|place| row[*place].is_unknown()) {
            return "-".to_string();
        }
        if places.iter().all(|place| row[*place].text.is_empty()) {
            return String::new();
        }
        let cell = |(place, room): (&usize, &usize)| {
            let text = row[*place].plain();
            format!("{}{text}", " ".repeat(room - width(text)))
        };
        places.iter().zip(&widths).map(cell).collect::<Vec<_>>().join(" / ")
    };
    Strip { heading, alignment: Alignment::Right, entries: table.rows.iter().map(entry).collect() }
}

fn alone(table: &Table, place: usize) -> Strip {
    let column = &table.columns[place];
    let entries: Vec<String> = table.rows.iter().map(|row| row[place].plain().to_string()).collect();
    let room = entries.iter().map(|entry| width(entry)).max().unwrap_or(0).max(NARROW);
    let heading = match column.title.lines().last() {
        Some(last) if width(last) + 1 + width(&column.unit) <= room => format!("{} {}", column.title, column.unit),
        _ => format!("{}\n{}", column.title, column.unit),
    };
    let heading = format!("{}\n{}", column.group, ascii(&heading));
    let alignment = match (column.numbers, column.wraps) {
        (true, _) => Alignment::Right,
        (false, true) => Alignment::Wrapped,
        (false, false) => Alignment::Left,
    };
    Strip { heading: heading.trim().into(), alignment, entries }
}

fn width(text: &str) -> usize {
    console::measure_text_width(&printable(text))
}

/// The columns, at most `page` wide if each fits beside the first.
fn within(strips: Vec<Strip>, page: usize) -> String {
    if strips.iter().any(|strip| strip.alignment == Alignment::Wrapped) {
        return block(&strips.iter().collect::<Vec<_>>(), Some(page));
    }
    let widths: Vec<usize> = strips.iter().map(Strip::width).collect();
    if widths.iter().sum::<usize>() <= page {
        return block(&strips.iter().collect::<Vec<_>>(), None);
    }
    // The first columns of words name a row, unless all are words.
    let words = strips.iter().take_while(|strip| strip.alignment == Alignment::Left).count();
    let names = if words < strips.len() { words.max(1) } else { 1 };
    let named: usize = widths[..names].iter().sum();
    let mut blocks: Vec<Vec<&Strip>> = Vec::new();
    let mut room = 0;
    for (strip, width) in strips.iter().zip(&widths).skip(names) {
        if blocks.is_empty() || *width > room {
            blocks.push(strips[..names].iter().collect());
            room = page.saturating_sub(named);
        }
        if let Some(last) = blocks.last_mut() {
            last.push(strip);
        }
        room = room.saturating_sub(*width);
    }
    blocks.iter().map(|strips| block(strips, None)).collect::<Vec<_>>().join("\n")
}

impl Strip {
    /// The columns that the page gives it, with a blank on each side.
    fn width(&self) -> usize {
        let heading = self.heading.lines().map(console::measure_text_width);
        2 + heading.chain(self.entries.iter().map(|entry| width(entry))).max().unwrap_or(0)
    }
}

/// The columns beside each other; where there is a page, those of sentences are broken into lines.
fn block(strips: &[&Strip], page: Option<usize>) -> String {
    let mut table = comfy_table::Table::new();
    table.load_preset(NOTHING).set_style(TableComponent::HeaderLines, '-');
    let header = strips.iter().map(|strip| printable_lines(&strip.heading));
    let count = strips.first().map_or(0, |strip| strip.entries.len());
    let rows = (0..count).map(|row| strips.iter().map(|strip| printable(&strip.entries[row])).collect::<Vec<_>>());
    table.set_content_arrangement(ContentArrangement::Disabled).set_header(header).add_rows(rows);
    if let Some(page) = page {
        let page = u16::try_from(page).unwrap_or(u16::MAX);
        table.set_content_arrangement(ContentArrangement::Dynamic).set_width(page);
    }
    for (column, strip) in table.column_iter_mut().zip(strips) {
        column.set_cell_alignment(match strip.alignment {
            Alignment::Left | Alignment::Wrapped => CellAlignment::Left,
            Alignment::Right => CellAlignment::Right,
        });
        if page.is_some() && strip.alignment != Alignment::Wrapped {
            column.set_constraint(ColumnConstraint::ContentWidth);
        }
    }
    table.lines().map(|line| line.trim_end().to_string() + "\n").collect()
}
