//! Two shells with membranes of triangles and on the domains of edges, as the tests of shells compute them.

use super::markdown;
use crate::shells::{KINDS, Kind, hemisphere, roof};

/// The six-node shells S6 of CalculiX with the nodes of the first row, by `benches/shells.py`.
const CALCULIX: [&str; 8] =
    ["CalculiX 2.20, S6", "parallel diagonals", "0.815", "0.978", "0.996", "0.047", "0.376", "0.893"];

pub fn table() -> String {
    let header = ["membrane", "triangles", "roof, n = 8", "16", "32", "hemisphere, n = 8", "16", "32"];
    let rows = [true, false].into_iter().flat_map(|on_edges| KINDS.map(|kind| (on_edges, kind)));
    let row = |(on_edges, kind): (bool, Kind)| {
        let triangles = match kind {
            Kind::Right => "parallel diagonals",
            Kind::Left => "across those",
            Kind::Jitter => "the first, points moved",
            Kind::Union => "alternating diagonals",
        };
        let membrane = if on_edges { "`shear = \"edges\"`" } else { "each triangle" };
        let values = [roof, hemisphere].into_iter().flat_map(|of| [8, 16, 32].map(|n| of(kind, on_edges, n)));
        let cells = values.map(|value| format!("{value:.3}"));
        [membrane.to_string(), triangles.to_string()].into_iter().chain(cells).collect::<Vec<_>>()
    };
    let of_calculix = CALCULIX.map(String::from).to_vec();
    markdown(&header, &rows.map(row).chain([of_calculix]).collect::<Vec<_>>())
}
