//! Networks as flexes of MuJoCo: the edges of the cells of `<flexcomp type="direct">` and `<flex>`.

use super::file::{SpecimenFile, SpecimenOptions, place, simplex_mesh};
use super::flex_places::{Places, numbers};
use crate::error::{Error, ErrorKind, Result};
use crate::model::{LengthSpring, Network, Specimen};
use crate::springs::distance;
use roxmltree::{Document, Node};
use std::collections::BTreeSet;

pub fn read(bytes: &[u8], _: &SpecimenOptions) -> Result<SpecimenFile> {
    let text = std::str::from_utf8(bytes).map_err(|_| Error::new("expected a text").of_kind(ErrorKind::Syntax))?;
    let document = Document::parse(text).map_err(|e| {
        let problem = format!("expected XML: {e}");
        Error::new(problem).of_kind(ErrorKind::Syntax).on_line(e.pos().row as usize)
    })?;
    let flexes: Vec<Node> =
        document.descendants().filter(|node| matches!(node.tag_name().name(), "flex" | "flexcomp")).collect();
    let [flex] = &flexes[..] else {
        let expected = "one <flex> or <flexcomp>, which is measured";
        return Err(Error::expected("flex", expected, flexes.len()));
    };
    let line = document.text_pos_at(flex.range().start).row as usize;
    one(&document, *flex).map_err(|e| e.on_line(line))
}

fn one(document: &Document, flex: Node) -> Result<SpecimenFile> {
    let child = |name: &str| flex.children().find(|node| node.tag_name().name() == name);
    let dim: usize =
        flex.attribute("dim").unwrap_or("2").parse().ok().filter(|dim| (1..=3).contains(dim)).ok_or_else(|| {
            Error::expected("dim", "1, 2 or 3", format!("\"{}\"", flex.attribute("dim").unwrap_or_default()))
        })?;
    if child("elasticity").and_then(|node| node.attribute("young")).is_some_and(|young| young.trim() != "0") {
        let expected = "a flex of springs, with <edge stiffness>";
        let found = "<elasticity young>: finite elements, whose material is the one that is named there";
        return Err(Error::expected("elasticity", expected, found).of_kind(ErrorKind::Unsupported));
    }
    let stiffness = child("edge").and_then(|node| node.attribute("stiffness")).unwrap_or("0");
    let constant = numbers("edge.stiffness", stiffness)?.first().copied().unwrap_or(0.0);
    if constant == 0.0 {
        let expected = "the constant of the springs, N/m";
        return Err(Error::expected("edge.stiffness", expected, "none"));
    }
    let points = Places { document, flex }.points()?;
    let listed = flex.attribute("element").unwrap_or_default();
    let nodes = numbers("element", listed)?;
    if nodes.is_empty() || !nodes.len().is_multiple_of(dim + 1) {
        let expected = format!("{} vertices of each element", dim + 1);
        return Err(Error::expected("element", expected, format!("{} numbers", nodes.len())));
    }
    let count = points.len() / 3;
    let nodes = nodes
        .iter()
        .map(|p| match p.fract() == 0.0 {
            true => place("element", *p as i64, 0, count),
            false => Err(Error::expected("element", "whole numbers", p)),
        })
        .collect::<Result<Vec<usize>>>()?;
    let mut edges = BTreeSet::new();
    for cell in nodes.chunks_exact(dim + 1) {
        for (a, b) in (0..cell.len()).flat_map(|a| (0..a).map(move |b| (a, b))) {
            if cell[a] == cell[b] {
                return Err(Error::expected("element", "different vertices", format!("vertex {} twice", cell[a])));
            }
            // MuJoCo has one spring for each edge, however many elements share the edge.
            edges.insert([cell[a].min(cell[b]), cell[a].max(cell[b])]);
        }
    }
    // Triangles at one height are a plane body. Any other sheet is a surface in space.
    let is_plane = dim == 2 && points.iter().skip(2).step_by(3).all(|z| *z == points[2]);
    let d = if is_plane { 2 } else { 3 };
    let points: Vec<f64> = points.chunks_exact(3).flat_map(|x| &x[..d]).copied().collect();
    let spring = |&points_of: &[usize; 2]| {
        let [a, b] = points_of.map(|p| &points[p * d..(p + 1) * d]);
        LengthSpring { points: points_of, constant, rest: distance(a, b) }
    };
    let network = Network { dimension: d, lengths: edges.iter().map(spring).collect(), others: Vec::new() };
    let mass = flex.attribute("mass").map(|text| numbers("mass", text)).transpose()?;
    let mass = mass.and_then(|mass| mass.first().copied());
    let mut notes =
        vec![format!("each of {} edges is a spring of {constant} N/m at its length, as MuJoCo has them", edges.len())];
    if mass.is_some() {
        notes.push("the mass of the flex is shared equally among its vertices, as MuJoCo shares it".into());
    }
    let specimen = Specimen {
        masses: mass.map(|mass| vec![mass / count as f64; count]),
        // Cells of fewer dimensions do not fill their space.
        mesh: if dim == d { simplex_mesh(&points, d, nodes)? } else { None },
        ..Specimen::new(network, points)
    };
    Ok(SpecimenFile { notes, ..SpecimenFile::plain(specimen, "MuJoCo, a flex") })
}
