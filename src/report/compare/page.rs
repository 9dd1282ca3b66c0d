//! A comparison as one page that needs no network.

use super::summary::Summary;
use super::tables::compare_tables;
use crate::report::table::{Cell, Table};
use crate::text::xml;
use std::fmt::Write;

const STYLE: &str = "body{font:15px/1.45 system-ui,sans-serif;max-width:1100px;margin:2em auto;padding:0 1em;color:#111;background:#fff}\
table{border-collapse:collapse;font-variant-numeric:tabular-nums;font-size:13px;margin:.6em 0}\
th,td{padding:.2em .6em;text-align:left;border-bottom:1px solid #ddd}th{border-bottom:2px solid #888}\
td.n,th.n{text-align:right}.wide{overflow-x:auto}figure{margin:1.2em 0}svg{max-width:100%;height:auto}.note{color:#444;font-size:13px}";

/// The page: title, figures and tables.
pub fn page(summary: &Summary, figures: &[(String, String)]) -> String {
    let mut text = String::from("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n");
    let title = xml(&summary.title);
    let about = format!("springfit {}, {}", summary.version, summary.machine);
    write!(
        text,
        "<meta name=\"viewport\" content=\"width=device-width\">\n<title>{title}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n\
         <h1>{title}</h1>\n<p class=\"note\">{}</p>\n",
        xml(&about)
    )
    .expect("a String grows");
    for (_, svg) in figures {
        writeln!(text, "<figure>{svg}</figure>").expect("a String grows");
    }
    compare_tables(summary).iter().for_each(|table| text += &html(table));
    text + "</body>\n</html>\n"
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
    let notes: String = table.notes.iter().map(|note| format!("<p class=\"note\">{}</p>\n", xml(note))).collect();
    let title = xml(&table.title);
    format!(
        "<h2>{title}</h2>\n<div class=\"wide\"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n{notes}"
    )
}
