//! Networks for simulators.

use crate::mesh::Mesh;
use crate::model::Network;
use crate::springs::Law;
use serde_json::json;
use std::fmt::Write;

/// One spring per line: `kind,points,constant,rest`. Points count from 0. A length spring has N/m and m, a spring on
/// an area N/m³ and m², on a volume N/m⁵ and m³, on an angle N·m and rad; a coupling, on the sum of two lengths, N/m and m.
///
/// Where springs have laws of force, two columns more give the law and its parameters, `k=1.5 a=2`; the constant is the slope at
/// rest then.
pub fn network_csv(network: &Network) -> String {
    let lawful = network.others.iter().any(|spring| spring.law.is_some());
    let mut text = format!("kind,points,constant,rest{}\n", if lawful { ",law,parameters" } else { "" });
    let mut line = |kind: &str, points: &[usize], constant: f64, rest: f64, law: Option<(&Law, &[f64])>| {
        let points: Vec<_> = points.iter().map(usize::to_string).collect();
        write!(text, "{kind},{},{constant:e},{rest:e}", points.join(" ")).expect("a String grows");
        if lawful {
            let parameters = law.map_or(String::new(), |(law, values)| {
                let named = law.parameters.iter().zip(values).map(|(name, value)| format!("{name}={value:e}"));
                named.collect::<Vec<_>>().join(" ")
            });
            write!(text, ",{},{parameters}", law.map_or("", |(law, _)| &law.text)).expect("a String grows");
        }
        text.push('\n');
    };
    for spring in &network.lengths {
        line("length", &spring.points, spring.constant, spring.rest, None);
    }
    for spring in &network.others {
        let law = spring.law.as_deref().map(|law| (law, &spring.parameters[..]));
        line(spring.kind.name(), &spring.points, spring.constant, spring.rest, law);
    }
    text
}

/// Points (m), masses (kg, if known) and springs, units as in [`network_csv`].
pub fn network_json(mesh: &Mesh, masses: Option<&[f64]>, network: &Network) -> String {
    let lengths = network
        .lengths
        .iter()
        .map(|s| json!({ "kind": "length", "points": s.points, "constant": s.constant, "rest": s.rest }));
    let others = network.others.iter().map(|s| {
        let mut spring = json!({ "kind": s.kind.name(), "points": s.points, "constant": s.constant, "rest": s.rest });
        if let Some(law) = &s.law {
            let named = law.parameters.iter().zip(&s.parameters).map(|(name, value)| (name.clone(), json!(value)));
            spring["law"] = json!(law.text);
            spring["parameters"] = named.collect();
        }
        spring
    });
    let value = json!({
        "units": { "length": "m", "mass": "kg", "length spring": "N/m", "area spring": "N/m^3", "volume spring": "N/m^5", "angle spring": "N*m" },
        "points": mesh.points.chunks_exact(mesh.dimension).collect::<Vec<_>>(),
        "masses": masses,
        "springs": lengths.chain(others).collect::<Vec<_>>(),
    });
    serde_json::to_string(&value).expect("a value of finite numbers and text is JSON") + "\n"
}
