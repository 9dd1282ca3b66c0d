//! Tables of a report as LaTeX and as Markdown.

use super::result_table::ResultTable;
use crate::text;
use clap::ValueEnum;
use std::fmt::Write;

/// The language of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Markup {
    /// With the rules of the package booktabs.
    Latex,
    /// Of GitHub.
    Markdown,
}

impl Markup {
    /// Tables in this language, one below the other.
    pub fn tables(self, tables: &[ResultTable]) -> String {
        tables.iter().map(|table| self.table(table)).collect::<Vec<_>>().join("\n")
    }

    /// The table in this language.
    pub fn table(self, table: &ResultTable) -> String {
        match self {
            Markup::Latex => latex(table),
            Markup::Markdown => markdown(table),
        }
    }
}

fn heading(title: &str, unit: &str) -> String {
    if unit.is_empty() { title.into() } else { format!("{title}, {unit}") }
}

fn markdown(table: &ResultTable) -> String {
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let cell = text::markdown;
    let mut text = format!("**{}**\n\n", cell(&table.title));
    text += &line(table.columns.iter().map(|c| cell(&heading(&c.title, &c.unit))).collect());
    text += &line(table.columns.iter().map(|c| if c.numbers { "---:" } else { "---" }.to_string()).collect());
    table.rows.iter().for_each(|row| text += &line(row.iter().map(|c| cell(&c.text)).collect()));
    text
}

fn latex(table: &ResultTable) -> String {
    let line = |cells: Vec<String>| format!("    {} \\\\\n", cells.join(" & "));
    let columns: String = table.columns.iter().map(|c| if c.numbers { 'r' } else { 'l' }).collect();
    let mut text = String::from("\\begin{table}\n  \\centering\n");
    writeln!(text, "  \\caption{{{}}}", escaped(&table.title)).expect("a String grows");
    let plain: String = table.name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
    writeln!(text, "  \\label{{tab:{plain}}}").expect("a String grows");
    writeln!(text, "  \\begin{{tabular}}{{{columns}}}\n    \\toprule").expect("a String grows");
    text += &line(table.columns.iter().map(|c| escaped(&heading(&c.title, &c.unit))).collect());
    text += "    \\midrule\n";
    for row in &table.rows {
        let cell = |(c, column): (&super::result_table::CellRecord, &super::result_table::ColumnRecord)| {
            if column.numbers { number(&c.text) } else { escaped(&c.text) }
        };
        text += &line(row.iter().zip(&table.columns).map(cell).collect());
    }
    text + "    \\bottomrule\n  \\end{tabular}\n\\end{table}\n"
}

/// Numbers with their signs and their powers of ten; `-` where nothing is known.
fn number(text: &str) -> String {
    let one = |word: &str| match (word.parse::<f64>().is_ok_and(f64::is_finite), word.split_once('e')) {
        (true, Some((digits, power))) => format!("${digits}\\cdot 10^{{{power}}}$"),
        (true, None) if word.starts_with('-') => format!("${word}$"),
        (false, _) if word == "-" => "--".into(),
        _ => escaped(word),
    };
    text.split_whitespace().map(one).collect::<Vec<_>>().join(" ")
}

/// A text with the notation of formulas that reports use.
fn escaped(text: &str) -> String {
    let parts = text.replace(">=", "≥").replace("<=", "≤");
    let parts: Vec<String> = parts.split("|R-K|/|R|").map(text::latex).collect();
    parts.join("$\\|R-K\\|/\\|R\\|$")
}
