//! Networks as tables.

use crate::element::SpringKind;
use crate::mesh::Mesh;
use crate::model::{LengthSpring, MeasureSpring, Network, Support};
use crate::springs::Law;
use crate::text::{csv, push_exponential, push_list};
use std::io::{self, Write};

/// One spring per line: `kind,points,constant,rest,unit`. Points count from 0 among those of the mesh, which has no points without a cell.
/// The unit is that of the constant, J per square of the unit of what is measured: a length spring has N/m and its rest length m, a
/// spring on an area N/m³ and m², on a volume N/m⁵ and m³, on an angle N·m and rad.
///
/// A spring of the kinds `point-content`, `point-area` and `patch`, which exact networks have, measures what the columns do not tell:
/// [`write_json`](super::write_json) does.
///
/// Where springs have laws of force, two columns more give the law and its parameters, `k=1.5 a=2`; the constant is the slope at
/// rest then.
///
/// Of a mesh from a file the last column, `nodes`, has the numbers that the points have in the file: the node tags of a Gmsh file, the
/// places from 0 of a VTK file. They are those to look up in the mesh: `points` differ from them where tags are not 1, 2, …, and where
/// nodes of no cell were left out.
///
/// # Errors
/// The writer fails.
pub fn network_csv(mesh: &Mesh, network: &Network, to: &mut dyn Write) -> io::Result<()> {
    let lawful = network.others.iter().any(|spring| spring.law.is_some());
    let own = mesh.numbering.as_ref().map(|own| &own.nodes[..]);
    let mut table = SpringTable::new(to, lawful, own.is_some())?;
    let mut nodes = Vec::new();
    let mut write = |row: SpringRow| {
        nodes.clear();
        nodes.extend(own.iter().flat_map(|own| row.points.iter().map(|&p| own[p])));
        table.write(&row, &nodes)
    };
    network.lengths.iter().try_for_each(|spring| write(SpringRow::of_length(spring)))?;
    network.others.iter().try_for_each(|spring| write(SpringRow::of_other(spring, &spring.points)))?;
    table.flush()
}

/// One spring, as a table has it.
pub(super) struct SpringRow<'a> {
    kind: SpringKind,
    points: &'a [usize],
    constant: f64,
    rest: f64,
    law: Option<(&'a Law, &'a [f64])>,
}

impl<'a> SpringRow<'a> {
    pub fn of_length(spring: &'a LengthSpring) -> SpringRow<'a> {
        let LengthSpring { points, constant, rest } = spring;
        SpringRow { kind: SpringKind::Length, points, constant: *constant, rest: *rest, law: None }
    }

    /// Makes the row of a spring on these points.
    pub fn of_other(spring: &'a MeasureSpring, points: &'a [usize]) -> SpringRow<'a> {
        let law = spring.law.as_deref().map(|own| (&*own.law, &own.parameters[..]));
        SpringRow { kind: spring.kind, points, constant: spring.constant, rest: spring.rest, law }
    }
}

/// The columns of a table with all of them; the constant is one of those that are always there.
pub(super) const COLUMNS: [&str; 8] = ["kind", "points", "constant", "rest", "unit", "law", "parameters", "nodes"];
const CONSTANT: usize = 2;

/// Bytes that are gathered before they are written. A write for each line would be a call of the system for each.
const PIECE: usize = 1 << 16;

/// A table of springs that is being written. The text is that of the crate `csv`, of which the fields of most springs need no quotes.
pub(super) struct SpringTable<W: Write> {
    to: W,
    lawful: bool,
    numbered: bool,
    text: Vec<u8>,
    numbers: Vec<u64>,
}

impl<W: Write> SpringTable<W> {
    /// With laws, and with the numbers of the points in the mesh file.
    pub fn new(to: W, lawful: bool, numbered: bool) -> io::Result<SpringTable<W>> {
        let mut table = SpringTable { lawful, numbered, ..SpringTable::bare(to) };
        table.fields(COLUMNS.into_iter())?;
        Ok(table)
    }

    /// With all columns and no header.
    pub fn bare(to: W) -> SpringTable<W> {
        let (text, numbers) = (Vec::with_capacity(2 * PIECE), Vec::new());
        SpringTable { to, lawful: true, numbered: true, text, numbers }
    }

    /// Writes a spring whose points have the numbers `nodes` in the mesh file.
    pub fn write(&mut self, row: &SpringRow, nodes: &[u64]) -> io::Result<()> {
        let text = &mut self.text;
        text.extend_from_slice(row.kind.name().as_bytes());
        text.push(b',');
        self.numbers.clear();
        self.numbers.extend(row.points.iter().map(|point| *point as u64));
        push_list(text, &self.numbers);
        for value in [row.constant, row.rest] {
            text.push(b',');
            push_exponential(text, value);
        }
        text.push(b',');
        text.extend_from_slice(row.kind.properties().unit.as_bytes());
        if self.lawful {
            text.push(b',');
            push_field(text, &csv(row.law.map_or("", |(law, _)| &law.text)));
            text.push(b',');
            let mut joined = Vec::new();
            for (name, value) in row.law.iter().flat_map(|(law, values)| law.parameters.iter().zip(values.iter())) {
                if !joined.is_empty() {
                    joined.push(b' ');
                }
                joined.extend_from_slice(name.as_bytes());
                joined.push(b'=');
                push_exponential(&mut joined, *value);
            }
            push_field(text, &csv(&String::from_utf8_lossy(&joined)));
        }
        if self.numbered {
            text.push(b',');
            push_list(text, nodes);
        }
        self.end_line()
    }

    /// Writes a row of a table with all columns, and returns the constant of the spring, NaN if it is no number.
    pub fn copy(&mut self, row: &csv::StringRecord) -> io::Result<f64> {
        self.fields(row.iter())?;
        Ok(row.get(CONSTANT).and_then(|text| text.parse().ok()).unwrap_or(f64::NAN))
    }

    /// Writes those of all fields whose columns the table has.
    fn fields<'a>(&mut self, all: impl Iterator<Item = &'a str>) -> io::Result<()> {
        let has = |column: &str| match column {
            "law" | "parameters" => self.lawful,
            "nodes" => self.numbered,
            _ => true,
        };
        let own = COLUMNS.into_iter().zip(all).filter(|(column, _)| has(column));
        for (place, (_, field)) in own.enumerate() {
            if place > 0 {
                self.text.push(b',');
            }
            push_field(&mut self.text, field);
        }
        self.end_line()
    }

    fn end_line(&mut self) -> io::Result<()> {
        self.text.push(b'\n');
        if self.text.len() >= PIECE { self.pass_on() } else { Ok(()) }
    }

    fn pass_on(&mut self) -> io::Result<()> {
        let written = self.text.chunks(PIECE).try_for_each(|piece| self.to.write_all(piece));
        self.text.clear();
        written
    }

    pub fn flush(&mut self) -> io::Result<()> {
        self.pass_on()?;
        self.to.flush()
    }

    /// What was written to, with all of it.
    pub fn into_inner(mut self) -> io::Result<W> {
        self.flush()?;
        Ok(self.to)
    }
}

/// Appends a field, in quotes where it has what ends a field or a line.
fn push_field(text: &mut Vec<u8>, field: &str) {
    if !field.contains([',', '"', '\r', '\n']) {
        text.extend_from_slice(field.as_bytes());
        return;
    }
    text.push(b'"');
    text.extend_from_slice(field.replace('"', "\"\"").as_bytes());
    text.push(b'"');
}

/// One point per line, in the order in which springs name them: its place, its number in the mesh file, its coordinates (m), its mass
/// (kg), and the axes along which `[[fix]]` holds it. What is not known is empty.
///
/// # Errors
/// The writer fails.
pub fn write_points(mesh: &Mesh, masses: Option<&[f64]>, support: &Support, to: &mut dyn Write) -> io::Result<()> {
    let d = mesh.dimension;
    let axes = &["x", "y", "z"][..d];
    let mut table = csv::Writer::from_writer(to);
    let units = axes.iter().map(|axis| format!("{axis} (m)"));
    let header = ["point", "node"].map(String::from).into_iter().chain(units);
    table.write_record(header.chain(["mass (kg)", "held"].map(String::from)))?;
    for p in 0..mesh.point_count() {
        let number = mesh.numbering.as_ref().map_or(String::new(), |numbering| numbering.nodes[p].to_string());
        let mut row = vec![p.to_string(), number];
        row.extend(mesh.point(p).iter().map(|x| format!("{x:e}")));
        row.push(masses.map_or(String::new(), |masses| format!("{:e}", masses[p])));
        let held = axes.iter().enumerate().filter(|(k, _)| support.is_fixed(p * d + k));
        row.push(held.map(|(_, axis)| *axis).collect::<Vec<_>>().join(" "));
        table.write_record(row)?;
    }
    table.flush()
}
