//! Networks for simulators.

use crate::element::{SpringKind, Tabulation};
use crate::mesh::Mesh;
use crate::model::{MeasureSpring, Network};
use crate::springs::{Law, Measure};
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use std::io::{self, Write};

/// One spring per line: `kind,points,constant,rest`. Points count from 0 among those of the mesh, which has no points without a cell.
/// A length spring has N/m and m, a spring on an area N/m³ and m², on a volume N/m⁵ and m³, on an angle N·m and rad; a coupling, on the sum of two lengths, N/m and m.
///
/// A spring of the kinds `point-content`, `point-area` and `patch`, which exact networks have, measures what the columns do not tell:
/// [`network_json`] does.
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
    let row = |kind: &str, points: &[usize], constant: f64, rest: f64, law: Option<(&Law, &[f64])>| {
        let places: Vec<_> = points.iter().map(usize::to_string).collect();
        let mut row = vec![kind.into(), places.join(" "), format!("{constant:e}"), format!("{rest:e}")];
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
    let lengths = network.lengths.iter().map(|s| row("length", &s.points, s.constant, s.rest, None));
    let others = network.others.iter().map(|s| {
        let law = s.law.as_deref().map(|law| (law, &s.parameters[..]));
        row(s.kind.name(), &s.points, s.constant, s.rest, law)
    });
    let mut header = vec!["kind", "points", "constant", "rest"];
    header.extend(lawful.then_some(["law", "parameters"]).iter().flatten());
    header.extend(mesh.numbering.as_ref().map(|_| "nodes"));
    let mut table = csv::Writer::from_writer(to);
    table.write_record(&header)?;
    lengths.chain(others).try_for_each(|row| table.write_record(row))?;
    table.flush()
}

/// A network in JSON; its records are made while they are written.
#[derive(Serialize)]
struct NetworkRecord<'a> {
    /// By quantity.
    units: BTreeMap<String, &'static str>,
    /// `[points][axes]`.
    #[serde(serialize_with = "points")]
    points: &'a Mesh,
    /// What `nodes` are; null of a mesh that is no file.
    numbering: Option<&'static str>,
    /// The numbers of the points in the file.
    nodes: Option<&'a [u64]>,
    masses: Option<&'a [f64]>,
    #[serde(serialize_with = "springs")]
    springs: &'a Network,
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    notes: &'a [String],
}

/// A spring; only one with a law of force has the keys of the law, and only one of a kind of exact networks those of its measure.
#[derive(Debug, Serialize)]
struct SpringRecord<'a> {
    kind: &'static str,
    /// Places in the list of points, from 0.
    points: &'a [usize],
    constant: f64,
    rest: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    law: Option<&'a str>,
    /// Of the law, by name.
    #[serde(skip_serializing_if = "Option::is_none")]
    parameters: Option<BTreeMap<&'a str, f64>>,
    #[serde(flatten)]
    measure: Option<MeasureRecord<'a>>,
}

/// What a spring measures, where its kind and points do not tell.
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum MeasureRecord<'a> {
    /// `weight` times the content of `Σ_a x_a ⊗ gradients_a`: its determinant, or of two columns in three dimensions the area that
    /// they span, of one column its length.
    Gradients { weight: f64, gradients: Vec<&'a [f64]> },
    /// `Σ share · content` of simplices, whose nodes are places in `points`.
    Patch { cells: Vec<ShareRecord<'a>> },
}

/// A cell of a patch.
#[derive(Debug, Serialize)]
struct ShareRecord<'a> {
    nodes: &'a [usize],
    share: f64,
}

impl<'a> MeasureRecord<'a> {
    fn of(measure: &'a Measure) -> Option<MeasureRecord<'a>> {
        let of_point = |table: &'a Tabulation, q: usize| {
            let size = table.nodes * table.dimension;
            let gradients = table.gradients[q * size..(q + 1) * size].chunks_exact(table.dimension).collect();
            MeasureRecord::Gradients { weight: table.point_weight(q), gradients }
        };
        match measure {
            Measure::Length | Measure::Content(_) | Measure::Function(_) => None,
            Measure::PointContent(element, q) => Some(of_point(&element.tabulation, *q)),
            Measure::Span(table) => Some(of_point(table, 0)),
            Measure::Patch(patch) => {
                let cells = patch.cells.iter().map(|(nodes, share)| ShareRecord { nodes, share: *share });
                Some(MeasureRecord::Patch { cells: cells.collect() })
            }
        }
    }
}

/// Of lengths, masses and the constants of each kind of springs.
fn units() -> BTreeMap<String, &'static str> {
    let kinds = SpringKind::all().map(|kind| (format!("{} spring", kind.name()), kind.properties().unit));
    [("length".into(), "m"), ("mass".into(), "kg")].into_iter().chain(kinds).collect()
}

fn points<S: Serializer>(mesh: &&Mesh, to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(mesh.points.chunks_exact(mesh.dimension))
}

fn springs<S: Serializer>(network: &&Network, to: S) -> Result<S::Ok, S::Error> {
    let lengths = network.lengths.iter().map(|s| SpringRecord {
        kind: "length",
        points: &s.points,
        constant: s.constant,
        rest: s.rest,
        law: None,
        parameters: None,
        measure: None,
    });
    to.collect_seq(lengths.chain(network.others.iter().map(SpringRecord::of)))
}

impl<'a> SpringRecord<'a> {
    fn of(spring: &'a MeasureSpring) -> SpringRecord<'a> {
        let parameters =
            |law: &'a Law| law.parameters.iter().map(String::as_str).zip(spring.parameters.iter().copied()).collect();
        SpringRecord {
            kind: spring.kind.name(),
            points: &spring.points,
            constant: spring.constant,
            rest: spring.rest,
            law: spring.law.as_deref().map(|law| law.text.as_str()),
            parameters: spring.law.as_deref().map(parameters),
            measure: MeasureRecord::of(&spring.measure),
        }
    }
}

/// Points (m), their numbers in the file (`nodes`, of which `numbering` says what they are), masses (kg, if known) and springs, units
/// as in [`network_csv`]; and what a reader must know of the fit, one sentence each, if there is something. The points of a spring are
/// places in the list of points, from 0.
///
/// # Errors
/// The writer fails.
pub fn network_json(
    mesh: &Mesh,
    masses: Option<&[f64]>,
    network: &Network,
    notes: &[String],
    to: &mut dyn Write,
) -> io::Result<()> {
    let record = NetworkRecord {
        units: units(),
        points: mesh,
        numbering: mesh.numbering.as_ref().map(|numbering| numbering.title()),
        nodes: mesh.numbering.as_ref().map(|numbering| &numbering.nodes[..]),
        masses,
        springs: network,
        notes,
    };
    serde_json::to_writer(&mut *to, &record)?;
    to.write_all(b"\n")
}
