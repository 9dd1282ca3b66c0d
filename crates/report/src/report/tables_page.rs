//! A result as one page of figures and tables that needs no network.

use super::table::{Cell, Table};
use crate::text::xml;
use std::fmt::Write;

/// All pages begin so.
pub(super) const BEGINNING: &str = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"generator\" content=\"springfit\">\n";

/// Figures keep their white paper where the page is dark.
const STYLE: &str = ":root{color-scheme:light dark;--ink:#111;--soft:#444;--line:#ddd;--rule:#888;--paper:#fff}\
@media(prefers-color-scheme:dark){:root{--ink:#eee;--soft:#bbb;--line:#3a3a3a;--rule:#888;--paper:#16181a}}\
body{font:15px/1.45 system-ui,sans-serif;max-width:1100px;margin:2em auto;padding:0 1em;color:var(--ink);background:var(--paper);\
overflow-wrap:anywhere}\
table{border-collapse:collapse;font-variant-numeric:tabular-nums;font-size:13px;margin:.6em 0;overflow-wrap:normal}\
th,td{padding:.2em .6em;text-align:left;border-bottom:1px solid var(--line)}th{border-bottom:2px solid var(--rule)}\
td.n,th.n{text-align:right}.wide{overflow-x:auto}figure{margin:1.2em 0;background:#fff;width:fit-content;max-width:100%}\
svg{max-width:100%;height:auto}.note{color:var(--soft);font-size:13px}";

/// The page: title, a line about it, figures as SVG, tables and notes.
pub(super) fn tables_page<'a>(
    title: &str,
    about: &str,
    figures: impl IntoIterator<Item = &'a str>,
    tables: &[Table],
    notes: &[String],
) -> String {
    let (title, about) = (xml(title), xml(about));
    let mut text = format!(
        "{BEGINNING}<meta name=\"viewport\" content=\"width=device-width\">\n<title>{title}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n\
         <h1>{title}</h1>\n<p class=\"note\">{about}</p>\n"
    );
    text += &paragraphs(notes);
    for svg in figures {
        writeln!(text, "<figure>{svg}</figure>").expect("a String grows");
    }
    tables.iter().for_each(|table| text += &html(table));
    text + "</body>\n</html>\n"
}

fn paragraphs(notes: &[String]) -> String {
    notes.iter().map(|note| format!("<p class=\"note\">{}</p>\n", xml(note))).collect()
}

fn html(table: &Table) -> String {
    let class = |numbers: bool| if numbers { " class=\"n\"" } else { "" };
    let head: String =
        table.columns.iter().map(|c| format!("<th{}>{}</th>", class(c.numbers), xml(&c.heading()))).collect();
    let cell = |(cell, numbers): (&Cell, bool)| {
        let text = xml(&cell.text);
        let text = if cell.is_best { format!("<b>{text}</b>") } else { text };
        format!("<td{}>{text}</td>", class(numbers))
    };
    let row = |row: &Vec<Cell>| {
        let cells: String = row.iter().zip(table.columns.iter().map(|c| c.numbers)).map(cell).collect();
        format!("<tr>{cells}</tr>\n")
    };
    let rows: String = table.rows.iter().map(row).collect();
    let notes = paragraphs(&table.notes);
    let title = xml(&table.title);
    format!(
        "<h2>{title}</h2>\n<div class=\"wide\"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n{notes}"
    )
}
