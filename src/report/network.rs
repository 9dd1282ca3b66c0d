//! Networks for simulators.

use super::rows::csv;
use crate::element::SpringKind;
use crate::mesh::Mesh;
use crate::model::Network;
use crate::springs::Law;
use serde::Serialize;
use std::collections::BTreeMap;

/// One spring per line: `kind,points,constant,rest`. Points count from 0. A length spring has N/m and m, a spring on
/// an area N/m³ and m², on a volume N/m⁵ and m³, on an angle N·m and rad; a coupling, on the sum of two lengths, N/m and m.
///
/// Where springs have laws of force, two columns more give the law and its parameters, `k=1.5 a=2`; the constant is the slope at
/// rest then.
pub fn network_csv(network: &Network) -> String {
    let lawful = network.others.iter().any(|spring| spring.law.is_some());
    let row = |kind: &str, points: &[usize], constant: f64, rest: f64, law: Option<(&Law, &[f64])>| {
        let points: Vec<_> = points.iter().map(usize::to_string).collect();
        let mut row = vec![kind.into(), points.join(" "), format!("{constant:e}"), format!("{rest:e}")];
        if lawful {
            let parameters = law.map_or(String::new(), |(law, values)| {
                let named = law.parameters.iter().zip(values).map(|(name, value)| format!("{name}={value:e}"));
                named.collect::<Vec<_>>().join(" ")
            });
            row.extend([law.map_or(String::new(), |(law, _)| law.text.clone()), parameters]);
        }
        row
    };
    let lengths = network.lengths.iter().map(|s| row("length", &s.points, s.constant, s.rest, None));
    let others = network.others.iter().map(|s| {
        let law = s.law.as_deref().map(|law| (law, &s.parameters[..]));
        row(s.kind.name(), &s.points, s.constant, s.rest, law)
    });
    let header = ["kind", "points", "constant", "rest", "law", "parameters"];
    csv(&header[..if lawful { 6 } else { 4 }], &lengths.chain(others).collect::<Vec<_>>())
}

/// A network in JSON.
#[derive(Debug, Serialize)]
struct NetworkRecord<'a> {
    /// By quantity.
    units: BTreeMap<String, &'static str>,
    /// `[points][axes]`.
    points: Vec<&'a [f64]>,
    masses: Option<&'a [f64]>,
    springs: Vec<SpringRecord<'a>>,
}

/// A spring; only one with a law of force has the last two keys.
#[derive(Debug, Serialize)]
struct SpringRecord<'a> {
    kind: &'static str,
    /// From 0.
    points: &'a [usize],
    constant: f64,
    rest: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    law: Option<&'a str>,
    /// Of the law, by name.
    #[serde(skip_serializing_if = "Option::is_none")]
    parameters: Option<BTreeMap<&'a str, f64>>,
}

/// Of lengths, masses and the constants of each kind of springs.
fn units() -> BTreeMap<String, &'static str> {
    let kinds = SpringKind::all().map(|kind| (format!("{} spring", kind.name()), kind.properties().unit));
    [("length".into(), "m"), ("mass".into(), "kg")].into_iter().chain(kinds).collect()
}

/// Points (m), masses (kg, if known) and springs, units as in [`network_csv`].
pub fn network_json<'a>(mesh: &'a Mesh, masses: Option<&'a [f64]>, network: &'a Network) -> String {
    let lengths = network.lengths.iter().map(|s| SpringRecord {
        kind: "length",
        points: &s.points,
        constant: s.constant,
        rest: s.rest,
        law: None,
        parameters: None,
    });
    let others = network.others.iter().map(|s| {
        let parameters =
            |law: &'a Law| law.parameters.iter().map(String::as_str).zip(s.parameters.iter().copied()).collect();
        SpringRecord {
            kind: s.kind.name(),
            points: &s.points,
            constant: s.constant,
            rest: s.rest,
            law: s.law.as_deref().map(|law| law.text.as_str()),
            parameters: s.law.as_deref().map(parameters),
        }
    });
    let record = NetworkRecord {
        units: units(),
        points: mesh.points.chunks_exact(mesh.dimension).collect(),
        masses,
        springs: lengths.chain(others).collect(),
    };
    serde_json::to_string(&record).expect("keys are text") + "\n"
}
