//! Tables of a report as LaTeX and as Markdown.

use super::result_table::ResultTable;
use crate::text::printable;
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
    let cell = |text: &str| printable(text).replace('\\', "\\\\").replace('|', "\\|").replace('<', "&lt;");
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

/// Words without the characters that LaTeX reads as commands, and with those beyond ASCII that it may not know as commands.
fn escaped(text: &str) -> String {
    let mut safe = String::new();
    for c in printable(text).replace(">=", "≥").replace("<=", "≤").replace("|R-K|/|R|", "‖").chars() {
        match c {
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => safe.extend(['\\', c]),
            '\\' => safe.push_str("\\textbackslash{}"),
            '~' => safe.push_str("\\textasciitilde{}"),
            '^' => safe.push_str("\\textasciicircum{}"),
            '<' | '>' | '|' => safe.extend(['$', c, '$']),
            '−' => safe.push_str("$-$"),
            '–' => safe.push_str("--"),
            'ν' => safe.push_str("$\\nu$"),
            'ρ' => safe.push_str("$\\rho$"),
            '×' => safe.push_str("$\\times$"),
            '†' => safe.push_str("$\\dagger$"),
            '²' => safe.push_str("$^2$"),
            '³' => safe.push_str("$^3$"),
            '…' => safe.push_str("\\dots{}"),
            'µ' => safe.push_str("\\textmu{}"),
            '‖' => safe.push_str("$\\|R-K\\|/\\|R\\|$"),
            '≤' => safe.push_str("$\\le$"),
            '≥' => safe.push_str("$\\ge$"),
            _ => safe.push(c),
        }
    }
    safe
}
