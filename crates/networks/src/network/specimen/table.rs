//! Networks as tables: one spring per line, and a table of the points.

use super::file::{SpecimenFile, SpecimenOptions, place};
use crate::element::SpringKind;
use crate::error::{Error, ErrorKind, Result};
use crate::model::{LengthSpring, MeasureSpring, Network, Specimen, SpringLaw};
use crate::springs::{Law, Measure, distance};
use crate::stiffness::gather;
use smallvec::SmallVec;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// Names of columns, the first of which springfit writes.
const ENDS: [[&str; 2]; 6] =
    [["i", "j"], ["a", "b"], ["node1", "node2"], ["source", "target"], ["p0", "p1"], ["from", "to"]];
const CONSTANT: [&str; 4] = ["constant", "k", "stiffness", "ke"];
/// Names of the column of the number by which springs name a point, the first of which springfit writes.
const NUMBER: [&str; 8] = ["point", "id", "index", "number", "node", "node_id", "point_id", "vertex"];
const REST: [&str; 5] = ["rest", "rest_length", "length", "l0", "r0"];

/// The unit of a column that has one.
fn unit_of(name: &str) -> Option<&'static str> {
    match name {
        "x" | "y" | "z" => Some("m"),
        "mass" => Some("kg"),
        _ if REST.contains(&name) => Some("m"),
        _ if CONSTANT.contains(&name) => Some(OF_LENGTHS),
        _ => None,
    }
}

/// The unit of the constants of springs on lengths.
const OF_LENGTHS: &str = "N/m";

/// A table with named columns, and the line of each row.
struct Table {
    columns: HashMap<String, usize>,
    rows: Vec<(usize, csv::StringRecord)>,
}

impl Table {
    fn read(bytes: &[u8]) -> Result<Table> {
        let wrong = |e: csv::Error| {
            let line = e.position().map(|position| position.line() as usize);
            let error = Error::new(format!("expected a table with commas: {e}")).of_kind(ErrorKind::Syntax);
            line.map_or(error.clone(), |line| error.on_line(line))
        };
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(bytes);
        let header = reader.headers().map_err(wrong)?.clone();
        // A unit in brackets is no part of the name.
        let parts = |text: &str| -> (String, Option<String>) {
            let (name, rest) = text.split_once(['(', '[']).unwrap_or((text, ""));
            let unit = rest.trim_end_matches([')', ']']).trim();
            (name.trim().to_lowercase(), (!unit.is_empty()).then(|| unit.to_string()))
        };
        let mut columns = HashMap::new();
        for (i, text) in header.iter().enumerate() {
            let (name, unit) = parts(text.trim_start_matches('\u{feff}'));
            if let (Some(found), Some(known)) = (unit, unit_of(&name))
                && found != known
            {
                return Err(Error::expected(name, format!("values in {known}"), format!("({found})")).on_line(1));
            }
            columns.insert(name, i);
        }
        let mut rows = Vec::new();
        for row in reader.records() {
            let row = row.map_err(wrong)?;
            let line = row.position().map_or(0, |position| position.line() as usize);
            rows.push((line, row));
        }
        Ok(Table { columns, rows })
    }

    fn column(&self, names: &[&str]) -> Option<usize> {
        names.iter().find_map(|name| self.columns.get(*name).copied())
    }

    fn names(&self) -> String {
        let mut names: Vec<(&String, &usize)> = self.columns.iter().collect();
        names.sort_by_key(|(_, at)| **at);
        names.into_iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(", ")
    }
}

fn number(row: &csv::StringRecord, column: usize, key: &str, line: usize) -> Result<f64> {
    let text = row.get(column).unwrap_or_default();
    let number = text.parse::<f64>().ok().filter(|x| x.is_finite());
    number.ok_or_else(|| Error::expected(key, "a number", format!("\"{text}\"")).on_line(line))
}

fn whole(text: &str, key: &str, line: usize) -> Result<i64> {
    text.parse().map_err(|_| Error::expected(key, "the number of a point", format!("\"{text}\"")).on_line(line))
}

/// The points of a table, in the order of its lines.
#[derive(Debug)]
pub struct PointTable {
    /// The number of coordinates.
    pub dimension: usize,
    /// `[points × dimension]`, m.
    pub points: Vec<f64>,
    /// The number by which springs name each point: that of a column `point`, `id`, `node` …, or of its line, from 0.
    pub numbers: Vec<i64>,
    /// kg, if the table has a column `mass`.
    pub masses: Option<Vec<f64>>,
    /// The rows of a matrix that have the displacements along the axes, from 0, `[points × dimension]`, if the table has columns `rx`, `ry` …
    pub rows: Option<Vec<usize>>,
}

/// Reads a table of points, with the columns x, y and z, m.
///
/// # Errors
/// The file cannot be read, a column is missing, an entry is no number, or two points have the same number; the error names the line.
pub fn read_points(path: &Path) -> Result<PointTable> {
    let bytes = std::fs::read(path).map_err(|e| Error::io("cannot be read", e).in_file(path))?;
    let read = || {
        let table = Table::read(&bytes)?;
        let axes: Vec<usize> = ["x", "y", "z"].iter().map_while(|axis| table.column(&[axis])).collect();
        if axes.is_empty() || table.rows.is_empty() {
            return Err(Error::expected("columns", "x, y and z of at least one point", table.names()));
        }
        let (number_of, mass) = (table.column(&NUMBER), table.column(&["mass"]));
        let row_columns: Option<Vec<usize>> =
            ["rx", "ry", "rz"][..axes.len()].iter().map(|name| table.column(&[name])).collect();
        let (mut x, mut masses, mut rows) = (Vec::new(), Vec::new(), Vec::new());
        let (mut numbers, mut lines) = (Vec::new(), HashMap::new());
        for (at, (line, row)) in table.rows.iter().enumerate() {
            let own = match number_of {
                Some(column) => whole(row.get(column).unwrap_or_default(), "point", *line)?,
                None => at as i64,
            };
            if let Some(first) = lines.insert(own, *line) {
                let found = format!("{own}, which line {first} has as well");
                return Err(Error::expected("point", "a number of its own", found).on_line(*line));
            }
            numbers.push(own);
            for (k, &column) in axes.iter().enumerate() {
                x.push(number(row, column, ["x", "y", "z"][k], *line)?);
            }
            for &column in row_columns.iter().flatten() {
                let text = row.get(column).unwrap_or_default();
                let place = text.parse::<usize>();
                rows.push(place.map_err(|_| {
                    Error::expected("rx", "a row of the matrix, from 0", format!("\"{text}\"")).on_line(*line)
                })?);
            }
            if let Some(column) = mass.filter(|column| row.get(*column).is_some_and(|text| !text.is_empty())) {
                masses.push(number(row, column, "mass", *line)?);
            }
        }
        let has_masses = masses.len() == table.rows.len();
        Ok(PointTable {
            dimension: axes.len(),
            points: x,
            numbers,
            masses: has_masses.then_some(masses),
            rows: row_columns.map(|_| rows),
        })
    };
    read().map_err(|e| e.in_file(path))
}

pub fn read(bytes: &[u8], options: &SpecimenOptions) -> Result<SpecimenFile> {
    let Some(path) = &options.points else {
        let expected = "a table of the points beside a table of springs, which has no places";
        return Err(Error::expected("--points", expected, "none"));
    };
    let PointTable { points, dimension: width, numbers, masses, .. } = read_points(path)?;
    let places: HashMap<i64, usize> = numbers.iter().enumerate().map(|(at, &number)| (number, at)).collect();
    // Points that are numbered by their lines have the usual words of errors.
    let is_plain = numbers.iter().enumerate().all(|(at, &number)| number == at as i64);
    let place_of = |number: i64| match is_plain {
        true => place("points", number, 0, numbers.len()),
        false => places
            .get(&number)
            .copied()
            .ok_or_else(|| Error::expected("points", format!("the number of a point in {}", path.display()), number)),
    };
    let is_plane = width == 3 && points.iter().skip(2).step_by(3).all(|z| *z == 0.0);
    let d = if is_plane { 2 } else { width };
    let points: Vec<f64> = points.chunks_exact(width).flat_map(|x| &x[..d]).copied().collect();
    let table = Table::read(bytes)?;
    let ends = ENDS.iter().find_map(|[a, b]| Some([table.column(&[a])?, table.column(&[b])?]));
    let (own, constant) = (table.column(&["points"]), table.column(&CONSTANT));
    let (Some(constant), true) = (constant, ends.is_some() || own.is_some()) else {
        let expected = "columns i, j and k of springs, or points and constant as springfit writes them";
        return Err(Error::expected("columns", expected, table.names()).of_kind(ErrorKind::Syntax));
    };
    let (rest, kind, law) = (table.column(&REST), table.column(&["kind"]), table.column(&["law"]));
    let (parameters, unit) = (table.column(&["parameters"]), table.column(&["unit"]));
    let mut springs =
        Springs { d, points: &points, network: Network { dimension: d, ..Network::default() }, known: HashMap::new() };
    for (line, row) in &table.rows {
        let text = |column: Option<usize>| column.and_then(|column| row.get(column)).unwrap_or_default();
        let named: Vec<&str> = match ends {
            Some(ends) => ends.iter().map(|&column| row.get(column).unwrap_or_default()).collect(),
            None => text(own).split_whitespace().collect(),
        };
        let at = |e: Error| e.on_line(*line);
        let nodes: SmallVec<[usize; 4]> =
            named.iter().map(|text| place_of(whole(text, "points", *line)?).map_err(at)).collect::<Result<_>>()?;
        let k = number(row, constant, "constant", *line)?;
        let (unit, is_length) = (text(unit), ["", "length"].contains(&text(kind)));
        if is_length && !unit.is_empty() && unit != OF_LENGTHS {
            return Err(at(Error::expected("unit", OF_LENGTHS, format!("\"{unit}\""))));
        }
        let rest = match text(rest) {
            "" => None,
            _ => Some(number(row, rest.expect("it has a text"), "rest", *line)?),
        };
        springs.add(text(kind), nodes, k, rest, (text(law), text(parameters))).map_err(at)?;
    }
    let specimen = Specimen { masses, ..Specimen::new(springs.network, points.clone()) };
    Ok(SpecimenFile::plain(specimen, "a table of springs"))
}

struct Springs<'a> {
    d: usize,
    points: &'a [f64],
    network: Network,
    /// Measures by kind and number of points.
    known: HashMap<(SpringKind, usize), Measure>,
}

impl Springs<'_> {
    fn add(
        &mut self,
        kind: &str,
        nodes: SmallVec<[usize; 4]>,
        constant: f64,
        rest: Option<f64>,
        (law, parameters): (&str, &str),
    ) -> Result<()> {
        let kind =
            if kind.is_empty() { SpringKind::Length } else { SpringKind::named(kind).map_err(|e| e.at_key("kind"))? };
        let mut x = vec![0.0; nodes.len() * self.d];
        gather(self.points, self.d, &nodes, &mut x);
        if kind == SpringKind::Length && law.is_empty() {
            let &[i, j] = &nodes[..] else { return Err(Error::expected("points", "two points", nodes.len())) };
            if i == j {
                return Err(Error::expected("points", "two points", format!("point {i} twice")));
            }
            let rest = rest.unwrap_or_else(|| distance(&x[..self.d], &x[self.d..]));
            self.network.lengths.push(LengthSpring { points: [i.min(j), i.max(j)], constant, rest });
            return Ok(());
        }
        let measure = match self.known.get(&(kind, nodes.len())) {
            Some(measure) => measure.clone(),
            None => {
                let measure = match kind {
                    SpringKind::Length => Measure::Length,
                    _ => {
                        let function = Measure::of_kind(kind, nodes.len(), self.d).map_err(|e| {
                            let words =
                                "; a table does not say what such a spring measures: the JSON file of the network does";
                            e.at_key("kind").followed_by(words)
                        });
                        Measure::Function(Arc::new(function?.into()))
                    }
                };
                self.known.insert((kind, nodes.len()), measure.clone());
                measure
            }
        };
        let rest = rest.unwrap_or_else(|| measure.value(&x, self.d));
        let law = if law.is_empty() { None } else { Some(Box::new(own_law(law, parameters)?)) };
        self.network.others.push(MeasureSpring { kind, points: nodes, constant, rest, measure, law });
        Ok(())
    }
}

/// `k=1.5 a=2`.
fn own_law(text: &str, parameters: &str) -> Result<SpringLaw> {
    let law = Law::parse(text).map_err(|e| e.at_key("law"))?;
    let given: HashMap<&str, f64> = parameters
        .split_whitespace()
        .filter_map(|word| word.split_once('='))
        .filter_map(|(name, value)| Some((name, value.parse().ok()?)))
        .collect();
    let value = |name: &String| {
        let missing = || Error::expected("parameters", format!("{name}=NUMBER"), format!("\"{parameters}\""));
        given.get(name.as_str()).copied().ok_or_else(missing)
    };
    let values = law.parameters.iter().map(value).collect::<Result<Vec<f64>>>()?;
    Ok(SpringLaw::new(Arc::new(law), &values))
}
