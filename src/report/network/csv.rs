//! Networks as tables.

use super::file::NetworkFile;
use crate::element::SpringKind;
use crate::mesh::Mesh;
use crate::model::{LengthSpring, MeasureSpring, Network};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};

/// One spring per line: `kind,points,constant,rest,unit`. Points count from 0 among those of the mesh, which has no points without a cell.
/// The unit is that of the constant, J per square of the unit of what is measured: a length spring has N/m and its rest length m, a
/// spring on an area N/m³ and m², on a volume N/m⁵ and m³, on an angle N·m and rad.
///
/// A spring of the kinds `point-content`, `point-area` and `patch`, which exact networks have, measures what the columns do not tell:
/// [`network_json`](super::network_json) does.
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
    let numbers = |points: &[usize]| mesh.numbering.as_ref().map(|own| points.iter().map(|&p| own.nodes[p]).collect());
    let lengths = network.lengths.iter().map(|spring| SpringRow::of_length(spring, numbers(&spring.points)));
    let others =
        network.others.iter().map(|spring| SpringRow::of_other(spring, spring.points.clone(), numbers(&spring.points)));
    let lawful = network.others.iter().any(|spring| spring.law.is_some());
    let mut table = SpringTable::new(to, lawful, mesh.numbering.is_some())?;
    lengths.chain(others).try_for_each(|row| table.write(&row))?;
    table.flush()
}

/// The columns of one spring.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct SpringRow {
    kind: String,
    points: String,
    constant: String,
    rest: String,
    unit: String,
    law: String,
    parameters: String,
    nodes: String,
}

impl SpringRow {
    /// The constant; NaN if it is no number.
    pub fn constant(&self) -> f64 {
        self.constant.parse().unwrap_or(f64::NAN)
    }

    pub fn of_length(spring: &LengthSpring, numbers: Option<Vec<u64>>) -> SpringRow {
        let (kind, none) = (SpringKind::Length, String::new);
        SpringRow::new(kind, &spring.points, [spring.constant, spring.rest], [none(), none()], numbers)
    }

    /// Of a spring on these points.
    pub fn of_other(spring: &MeasureSpring, points: Vec<usize>, numbers: Option<Vec<u64>>) -> SpringRow {
        let law = spring.law.as_deref().map(|law| {
            let named = law.parameters.iter().zip(&spring.parameters).map(|(name, value)| format!("{name}={value:e}"));
            [law.text.clone(), named.collect::<Vec<_>>().join(" ")]
        });
        SpringRow::new(spring.kind, &points, [spring.constant, spring.rest], law.unwrap_or_default(), numbers)
    }

    fn new(
        kind: SpringKind,
        points: &[usize],
        [constant, rest]: [f64; 2],
        [law, parameters]: [String; 2],
        numbers: Option<Vec<u64>>,
    ) -> SpringRow {
        let joined = |numbers: Vec<String>| numbers.join(" ");
        SpringRow {
            kind: kind.name().into(),
            points: joined(points.iter().map(usize::to_string).collect()),
            constant: format!("{constant:e}"),
            rest: format!("{rest:e}"),
            unit: kind.properties().unit.into(),
            law,
            parameters,
            nodes: joined(numbers.unwrap_or_default().iter().map(u64::to_string).collect()),
        }
    }
}

/// A table of springs that is being written.
pub(super) struct SpringTable<'a> {
    table: csv::Writer<&'a mut dyn Write>,
    lawful: bool,
    numbered: bool,
}

impl<'a> SpringTable<'a> {
    /// With laws, and with the numbers of the points in the mesh file.
    pub fn new(to: &'a mut dyn Write, lawful: bool, numbered: bool) -> io::Result<SpringTable<'a>> {
        let mut table = csv::Writer::from_writer(to);
        let mut header = vec!["kind", "points", "constant", "rest", "unit"];
        header.extend(lawful.then_some(["law", "parameters"]).iter().flatten());
        header.extend(numbered.then_some("nodes"));
        table.write_record(&header)?;
        Ok(SpringTable { table, lawful, numbered })
    }

    pub fn write(&mut self, row: &SpringRow) -> io::Result<()> {
        let mut columns = vec![&row.kind, &row.points, &row.constant, &row.rest, &row.unit];
        columns.extend(self.lawful.then_some([&row.law, &row.parameters]).iter().flatten());
        columns.extend(self.numbered.then_some(&row.nodes));
        Ok(self.table.write_record(columns)?)
    }

    pub fn flush(&mut self) -> io::Result<()> {
        self.table.flush()
    }
}

/// One point per line, in the order in which springs name them: its place, its number in the mesh file, its coordinates (m), its mass
/// (kg), and the axes along which `[[fix]]` holds it. What is not known is empty.
///
/// # Errors
/// The writer fails.
pub fn points_csv(file: &NetworkFile, to: &mut dyn Write) -> io::Result<()> {
    let (mesh, masses, support) = (file.mesh, file.masses(), file.support());
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
