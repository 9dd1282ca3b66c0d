//! The report of a run as one HTML file that needs no network.
//!
//! [`write()`] puts a record into the template of `assets/`. The page reads the record, and shows every text of it as text: nothing in it
//! is read as HTML. The page's policy forbids requests to anywhere.

#![forbid(unsafe_code)]

use base64::prelude::{BASE64_STANDARD, Engine};
use springfit_foundation::text::xml;
use std::io::{self, Write};

const TEMPLATE: &str = include_str!("../assets/page.html");
const STYLE: &str = include_str!("../assets/page.css");
/// Plotly, compressed by gzip; MIT licence, which its first lines state.
const LIBRARY: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/plotly.js.gz"));

/// One script, in the order in which its parts build on each other.
const SCRIPTS: [&str; 13] = [
    include_str!("../assets/element.js"),
    include_str!("../assets/number.js"),
    include_str!("../assets/record.js"),
    include_str!("../assets/theme.js"),
    include_str!("../assets/library.js"),
    include_str!("../assets/table.js"),
    include_str!("../assets/chart.js"),
    include_str!("../assets/charts.js"),
    include_str!("../assets/moduli.js"),
    include_str!("../assets/body.js"),
    include_str!("../assets/view.js"),
    include_str!("../assets/controls.js"),
    include_str!("../assets/page.js"),
];

/// Writes the page of a record. `title` is text; `record` is JSON.
///
/// # Errors
/// The writer fails.
pub fn write(title: &str, record: &str, to: &mut dyn Write) -> io::Result<()> {
    let mut rest = TEMPLATE;
    while let Some((before, after)) = rest.split_once("{{") {
        let (place, after) = after.split_once("}}").expect("the template closes its places");
        to.write_all(before.as_bytes())?;
        match place {
            "title" => to.write_all(xml(title).as_bytes())?,
            "style" => to.write_all(STYLE.as_bytes())?,
            "record" => write_json(record, to)?,
            "library" => to.write_all(BASE64_STANDARD.encode(LIBRARY).as_bytes())?,
            "script" => SCRIPTS.iter().try_for_each(|script| to.write_all(script.as_bytes()))?,
            other => unreachable!("the template has a place {other}"),
        }
        rest = after;
    }
    to.write_all(rest.as_bytes())
}

/// JSON within a script: `<` ends the element or begins a comment, and is in strings alone, where it may be written as its number.
fn write_json(record: &str, to: &mut dyn Write) -> io::Result<()> {
    let mut parts = record.split('<');
    to.write_all(parts.next().unwrap_or_default().as_bytes())?;
    parts.try_for_each(|part| {
        to.write_all(br"\u003c")?;
        to.write_all(part.as_bytes())
    })
}
