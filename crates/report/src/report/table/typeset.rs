//! Tables of a report as LaTeX and as Markdown.

use super::{Cell, Column, Table};
use crate::report::choice::choices;
use crate::text;
use std::fmt::Write;

choices! {
    /// The language of a table.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Markup {
        /// With the rules of the package booktabs.
        Latex = "latex",
        /// With bars between the columns, as GitHub reads it.
        Markdown = "markdown",
    }
}

impl Markup {
    /// Tables in this language, one below the other.
    pub fn tables(self, tables: &[Table]) -> String {
        tables.iter().map(|table| self.table(table)).collect::<Vec<_>>().join("\n")
    }

    /// The table in this language.
    pub fn table(self, table: &Table) -> String {
        match self {
            Markup::Latex => latex(table),
            Markup::Markdown => markdown(table),
        }
    }
}

fn markdown(table: &Table) -> String {
    format!("**{}**\n\n{}", text::markdown(&table.title), markdown_body(table))
}

/// The table without its title.
pub(in crate::report) fn markdown_body(table: &Table) -> String {
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let cell = text::markdown;
    let mut text = line(table.columns.iter().map(|c| cell(&c.heading())).collect());
    text += &line(table.columns.iter().map(|c| if c.numbers { "---:" } else { "---" }.to_string()).collect());
    let bold = |c: &Cell| if c.is_best { format!("**{}**", cell(&c.text)) } else { cell(&c.text).to_string() };
    table.rows.iter().for_each(|row| text += &line(row.iter().map(bold).collect()));
    table.notes.iter().for_each(|note| text += &format!("\n{}\n", cell(note)));
    text
}

fn latex(table: &Table) -> String {
    let line = |cells: Vec<String>| format!("    {} \\\\\n", cells.join(" & "));
    let columns: String = table.columns.iter().map(|c| if c.numbers { 'r' } else { 'l' }).collect();
    let mut text = String::from("\\begin{table}\n  \\centering\n");
    writeln!(text, "  \\caption{{{}}}", escaped(&table.title)).expect("a String grows");
    let plain: String = table.name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
    writeln!(text, "  \\label{{tab:{plain}}}").expect("a String grows");
    writeln!(text, "  \\begin{{tabular}}{{{columns}}}\n    \\toprule").expect("a String grows");
    text += &headings(&table.columns);
    text += "    \\midrule\n";
    for row in &table.rows {
        let cell = |(c, column): (&Cell, &Column)| {
            let text = if column.numbers { number(&c.text) } else { escaped(&c.text) };
            if c.is_best { format!("\\textbf{{{text}}}") } else { text }
        };
        text += &line(row.iter().zip(&table.columns).map(cell).collect());
    }
    text += "    \\bottomrule\n  \\end{tabular}\n";
    for note in &table.notes {
        writeln!(text, "  \\par\\smallskip{{\\footnotesize {}\\par}}", escaped(note)).expect("a String grows");
    }
    text + "\\end{table}\n"
}

/// The headings: columns of a group that stand beside each other are under its name.
fn headings(columns: &[Column]) -> String {
    let line = |cells: Vec<String>| format!("    {} \\\\\n", cells.join(" & "));
    let groups: Vec<&[Column]> = columns.chunk_by(|a, b| !a.group.is_empty() && a.group == b.group).collect();
    if groups.iter().all(|group| group.len() == 1) {
        return line(columns.iter().map(|column| escaped(&column.heading())).collect());
    }
    let (mut names, mut rules, mut first) = (Vec::new(), String::new(), 1);
    for group in &groups {
        let last = first + group.len() - 1;
        match group.len() {
            1 => names.push(String::new()),
            count => {
                names.push(format!("\\multicolumn{{{count}}}{{c}}{{{}}}", escaped(&group[0].group)));
                rules += &format!("\\cmidrule(lr){{{first}-{last}}}");
            }
        }
        first = last + 1;
    }
    let alone = |column: &Column| escaped(&Column { group: String::new(), ..column.clone() }.heading());
    let own = groups.iter().flat_map(|group| {
        let is_alone = group.len() == 1;
        group.iter().map(move |column| if is_alone { escaped(&column.heading()) } else { alone(column) })
    });
    format!("{}    {rules}\n{}", line(names), line(own.collect()))
}

/// Numbers with their signs and their powers of ten; a dash where nothing is known.
fn number(text: &str) -> String {
    let one = |word: &str| match (word.parse::<f64>().is_ok_and(f64::is_finite), word.split_once('e')) {
        (true, Some((digits, power))) => format!("${digits}\\cdot 10^{{{power}}}$"),
        (true, None) if word.starts_with('-') => format!("${word}$"),
        (false, _) if word == "-" || word == "–" => "--".into(),
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
