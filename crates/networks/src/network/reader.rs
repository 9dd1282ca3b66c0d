//! Reads a network from its JSON file and checks it.

use super::balance::Balance;
use super::lines::{check_texts, words};
use super::record::{FORMAT, MeasureKind, NETWORK_VERSION, NetworkRecord};
use crate::error::{Error, ErrorKind, Result};
use serde::Deserialize;
use std::path::Path;

/// The keys that tell what a file is, whatever else it holds.
#[derive(Deserialize)]
struct Head {
    format: Option<serde_json::Value>,
    version: Option<serde_json::Value>,
}

/// Reads and checks a network.
///
/// # Errors
/// The file cannot be read, is no network, is one of another version, is cut short, or contradicts itself: a number is missing or not
/// finite, a list has the wrong length, or a place is not in its list. The error names the line and the key.
pub fn read_network(path: &Path) -> Result<NetworkRecord> {
    let text = std::fs::read(path).map_err(|e| Error::io("cannot be read", e).in_file(path))?;
    parse(&text).map_err(|e| e.in_file(path))
}

pub(super) fn parse(text: &[u8]) -> Result<NetworkRecord> {
    let head: Head = serde_json::from_slice(text).map_err(|e| syntax(&e, text))?;
    match head.format.as_ref().and_then(|format| format.as_str()) {
        Some(FORMAT) => {}
        other => {
            let found = other.map_or("none".into(), |found| format!("\"{found}\""));
            let expected = format!("\"{FORMAT}\", as springfit run and fit write it");
            return Err(Error::expected("format", expected, found).of_kind(ErrorKind::Syntax));
        }
    }
    if head.version.as_ref().and_then(serde_json::Value::as_u64) != Some(u64::from(NETWORK_VERSION)) {
        let found = head.version.map_or("none".into(), |version| version.to_string());
        let expected = format!("{NETWORK_VERSION}; write the network again with this program");
        return Err(Error::expected("version", expected, found).of_kind(ErrorKind::Unsupported));
    }
    let mut json = serde_json::Deserializer::from_slice(text);
    let network: NetworkRecord = serde_path_to_error::deserialize(&mut json).map_err(|e| {
        let error = Error::at(e.path().to_string(), words(e.inner())).of_kind(ErrorKind::Invalid);
        error.on_line(e.inner().line().max(1))
    })?;
    json.end().map_err(|e| syntax(&e, text))?;
    check_texts(text)?;
    check(&network)?;
    Ok(network)
}

fn syntax(error: &serde_json::Error, text: &[u8]) -> Error {
    let problem = match error.is_eof() {
        true => format!("the file is cut short after {} bytes: {}", text.len(), words(error)),
        false => format!("expected JSON: {} at column {}", words(error), error.column()),
    };
    // An error of the whole text has the line zero, and lines are counted from one.
    Error::new(problem).of_kind(ErrorKind::Syntax).on_line(error.line().max(1))
}

fn check(network: &NetworkRecord) -> Result<()> {
    let (n, d) = (network.points.len(), network.dimension);
    if !(1..=3).contains(&d) {
        return Err(Error::expected("dimension", "1, 2 or 3", d));
    }
    let length = |key: String, expected: usize, found: usize| match expected == found {
        true => Ok(()),
        false => Err(Error::expected(key, format!("{expected} numbers"), found)),
    };
    // What serde reads from JSON is finite, except numbers that are too large.
    let finite = |key: String, value: f64| match value.is_finite() {
        true => Ok(()),
        false => Err(Error::expected(key, "a finite number", value)),
    };
    let place = |key: String, of: &str, place: usize, count: usize| match place < count {
        true => Ok(()),
        false => Err(Error::expected(key, format!("the place of one of {count} {of}, from 0"), place)),
    };
    for (p, x) in network.points.iter().enumerate() {
        length(format!("points[{p}]"), d, x.len())?;
        x.iter().enumerate().try_for_each(|(k, x)| finite(format!("points[{p}][{k}]"), *x))?;
    }
    if let Some(masses) = &network.masses {
        length("masses".into(), n, masses.len())?;
        masses.iter().enumerate().try_for_each(|(p, mass)| finite(format!("masses[{p}]"), *mass))?;
    }
    if let Some(nodes) = &network.nodes {
        length("nodes".into(), n, nodes.len())?;
    }
    if let Some(gravity) = &network.gravity {
        length("gravity".into(), d, gravity.len())?;
    }
    for (b, block) in network.cells.iter().enumerate() {
        for (c, cell) in block.points.iter().enumerate() {
            let key = |i: usize| format!("cells[{b}].points[{c}][{i}]");
            cell.iter().enumerate().try_for_each(|(i, p)| place(key(i), "points", *p, n))?;
        }
    }
    for (t, corners) in network.surface.iter().enumerate() {
        let key = |i: usize| format!("surface[{t}][{i}]");
        corners.iter().enumerate().try_for_each(|(i, p)| place(key(i), "points", *p, n))?;
    }
    let lists = network.loads.iter().enumerate().map(|(l, load)| (format!("loads[{l}].held"), &load.held));
    for (list, held) in std::iter::once(("held".to_string(), &network.held)).chain(lists) {
        for (h, held) in held.iter().enumerate() {
            place(format!("{list}[{h}].point"), "points", held.point, n)?;
            length(format!("{list}[{h}].displacement"), d, held.displacement.len())?;
        }
    }
    for (l, load) in network.loads.iter().enumerate() {
        for (f, force) in load.forces.iter().enumerate() {
            place(format!("loads[{l}].forces[{f}].point"), "points", force.point, n)?;
            length(format!("loads[{l}].forces[{f}].force"), d, force.force.len())?;
        }
    }
    for (m, measure) in network.measures.iter().enumerate() {
        let sizes = measure.cells.iter().map(|cell| cell.nodes.len());
        for (size, term) in sizes.flat_map(|size| measure.terms.iter().map(move |term| (size, term))) {
            length(format!("measures[{m}].terms.gradients"), size, term.gradients.len())?;
        }
        let places = match measure.kind {
            MeasureKind::Turn => 4,
            MeasureKind::Squares => 2,
            MeasureKind::Length | MeasureKind::Content | MeasureKind::Expression => continue,
        };
        if measure.kind == MeasureKind::Turn {
            length("dimension".into(), 3, d)?;
        }
        for (c, cell) in measure.cells.iter().enumerate() {
            length(format!("measures[{m}].cells[{c}].nodes"), places, cell.nodes.len())?;
        }
    }
    let mut balance = Balance::of(network);
    for (s, spring) in network.springs.iter().enumerate() {
        let key = |name: &str| format!("springs[{s}].{name}");
        finite(key("constant"), spring.constant)?;
        finite(key("rest"), spring.rest)?;
        place(key("measure"), "measures", spring.measure, network.measures.len())?;
        spring.points.iter().try_for_each(|p| place(key("points"), "points", *p, n))?;
        spring.groups.iter().try_for_each(|g| place(key("groups"), "groups", *g, network.groups.len()))?;
        let measure = &network.measures[spring.measure];
        if measure.kind == MeasureKind::Length && (spring.points.len() != 2 || spring.points[0] == spring.points[1]) {
            return Err(Error::expected(key("points"), "two points", format!("{:?}", spring.points)));
        }
        let nodes = measure.cells.iter().flat_map(|cell| &cell.nodes);
        let count = spring.points.len();
        nodes.copied().try_for_each(|a| place(key("points"), "points of the spring", a, count))?;
        balance.check(spring).map_err(|e| e.under(format!("springs[{s}]")))?;
    }
    Ok(())
}
