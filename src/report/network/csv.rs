//! Networks as tables.

use super::file::NetworkFile;
use crate::element::SpringKind;
use crate::mesh::Mesh;
use crate::model::Network;
use crate::springs::Law;
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
    let lawful = network.others.iter().any(|spring| spring.law.is_some());
    let row = |kind: SpringKind, points: &[usize], constant: f64, rest: f64, law: Option<(&Law, &[f64])>| {
        let places: Vec<_> = points.iter().map(usize::to_string).collect();
        let unit = kind.properties().unit.into();
        let mut row = vec![kind.name().into(), places.join(" "), format!("{constant:e}"), format!("{rest:e}"), unit];
        if lawful {
            let parameters = law.map_or(String::new(), |(law, values)| {
                let named = law.parameters.iter().zip(values).map(|(name, value)| format!("{name}={value:e}"));
                named.collect::<Vec<_>>().join(" ")
            });
            row.extend([law.map_or(String::new(), |(law, _)| law.text.clone()), parameters]);
        }
        row.extend(mesh.numbering.as_ref().map(|numbering| {
            let numbers: Vec<_> = points.iter().map(|&p| numbering.nodes[p].to_string()).collect();
            numbers.join(" ")
        }));
        row
    };
    let lengths = network.lengths.iter().map(|s| row(SpringKind::Length, &s.points, s.constant, s.rest, None));
    let others = network.others.iter().map(|s| {
        let law = s.law.as_deref().map(|law| (law, &s.parameters[..]));
        row(s.kind, &s.points, s.constant, s.rest, law)
    });
    let mut header = vec!["kind", "points", "constant", "rest", "unit"];
    header.extend(lawful.then_some(["law", "parameters"]).iter().flatten());
    header.extend(mesh.numbering.as_ref().map(|_| "nodes"));
    let mut table = csv::Writer::from_writer(to);
    table.write_record(&header)?;
    lengths.chain(others).try_for_each(|row| table.write_record(row))?;
    table.flush()
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
