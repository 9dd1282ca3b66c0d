//! Networks for simulators.

use crate::mesh::Mesh;
use crate::model::Network;
use serde_json::json;
use std::fmt::Write;

/// One spring per line: `kind,points,constant,rest`. Points count from 0. A length spring has N/m and m, a spring on
/// an area N/m³ and m², on a volume N/m⁵ and m³, on an angle N·m and rad; a coupling, on the sum of two lengths, N/m and m.
pub fn network_csv(network: &Network) -> String {
    let mut text = String::from("kind,points,constant,rest\n");
    let mut line = |kind: &str, points: &[usize], constant: f64, rest: f64| {
        let points: Vec<_> = points.iter().map(usize::to_string).collect();
        writeln!(text, "{kind},{},{constant:e},{rest:e}", points.join(" ")).expect("a String grows");
    };
    for spring in &network.lengths {
        line("length", &spring.points, spring.constant, spring.rest);
    }
    for spring in &network.others {
        line(spring.kind.name(), &spring.points, spring.constant, spring.rest);
    }
    text
}

/// Points (m), masses (kg, if known) and springs, units as in [`network_csv`].
pub fn network_json(mesh: &Mesh, masses: Option<&[f64]>, network: &Network) -> String {
    let lengths = network
        .lengths
        .iter()
        .map(|s| json!({ "kind": "length", "points": s.points, "constant": s.constant, "rest": s.rest }));
    let others = network
        .others
        .iter()
        .map(|s| json!({ "kind": s.kind.name(), "points": s.points, "constant": s.constant, "rest": s.rest }));
    let value = json!({
        "units": { "length": "m", "mass": "kg", "length spring": "N/m", "area spring": "N/m^3", "volume spring": "N/m^5", "angle spring": "N*m" },
        "points": mesh.points.chunks_exact(mesh.dimension).collect::<Vec<_>>(),
        "masses": masses,
        "springs": lengths.chain(others).collect::<Vec<_>>(),
    });
    serde_json::to_string(&value).expect("a value of finite numbers and text is JSON") + "\n"
}
