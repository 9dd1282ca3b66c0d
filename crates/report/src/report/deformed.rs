//! Shapes of a body under a load: at rest, with finite elements, and with springs.

use super::figure::magnification;
use super::outline::edges_of_sides;
use crate::springs::norm;
use crate::study::{DisplacementError, Outcome};
use svg::Document;
use svg::node::element::path::Data;
use svg::node::element::{Path, Text};

/// Width of a panel, of its margin and of the line above it, in units of the picture.
const PANEL: f64 = 320.0;
const MARGIN: f64 = 20.0;
const CAPTION: f64 = 44.0;

/// A panel for each of these fits that has displacements under the load: undeformed dotted grey, finite elements dashed blue,
/// springs solid red; the SVG file's text. `None` where there is nothing to show.
///
/// Displacements are drawn alike in all panels, larger than they are, and the factor is said. A solid is seen from the front,
/// a little from the right and above.
pub fn deformed(outcome: &Outcome, load: &str, fits: &[&str]) -> Option<String> {
    let mesh = &outcome.mesh;
    let d = mesh.dimension;
    let place = outcome.load(load)?;
    let fem = &outcome.loads.get(place).filter(|load| load.is_reached())?.fem;
    let mut panels: Vec<(&str, &Vec<f64>, Option<DisplacementError>)> = Vec::new();
    for name in fits {
        let fit = outcome.fits.iter().find(|fit| fit.fit.name == **name);
        let found =
            fit.and_then(|fit| fit.loads.get(place)).and_then(|l| Some((*name, l.displacement.as_deref()?, l.error)));
        panels.extend(found.filter(|_| panels.iter().all(|(known, ..)| known != name)));
    }
    let standard = outcome.loads[place].measured.as_ref().map_or("", |measured| measured.standard.heading());
    let largest = fem.chunks_exact(d).map(norm).fold(0.0, f64::max);
    // The scale of the displacements would divide by zero.
    if panels.is_empty() || largest == 0.0 {
        return None;
    }
    let edges = edges_of_sides(mesh, faces_viewer);
    // At large deformation shapes are drawn as they are.
    let factor = if outcome.law.is_some() { 1.0 } else { magnification(mesh, fem) };
    let moved = |u: &[f64]| -> Vec<[f64; 2]> {
        let x: Vec<f64> = mesh.points.iter().zip(u).map(|(x, u)| x + factor * u).collect();
        x.chunks_exact(d).map(seen).collect()
    };
    let rest = moved(&vec![0.0; fem.len()]);
    let body = moved(fem);
    let nets: Vec<Vec<[f64; 2]>> = panels.iter().map(|(_, u, _)| moved(u)).collect();
    let all = || nets.iter().flatten().chain(&rest).chain(&body);
    let range = |k: usize| all().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x[k]), b.max(x[k])));
    let (across, up) = (range(0), range(1));
    // A body that is tall is drawn smaller, so that its panel is at most 1/0.6 times as high as wide.
    let scale = (PANEL - 2.0 * MARGIN) / (across.1 - across.0).max(0.6 * (up.1 - up.0));
    let height = CAPTION + 2.0 * MARGIN + scale * (up.1 - up.0) + 24.0;
    let width = PANEL * panels.len() as f64;
    let mut document = Document::new()
        .set("viewBox", (0.0, 0.0, width, height.ceil()))
        .set("font-family", "sans-serif")
        .add(Path::new().set("d", format!("M0,0H{width}V{}H0z", height.ceil())).set("fill", "white"));
    for (i, ((name, _, error), net)) in panels.iter().zip(&nets).enumerate() {
        let left = PANEL * i as f64 + (PANEL - scale * (across.1 - across.0)) / 2.0;
        let on_page = |x: &[f64; 2]| (left + scale * (x[0] - across.0), CAPTION + MARGIN + scale * (up.1 - x[1]));
        let path = |points: &[[f64; 2]], color: &str, dashes: &str, width: f64| {
            let mut data = Data::new();
            for &[a, b] in &edges {
                // More digits are not seen, and make the file larger.
                let hundredth = |(x, y): (f64, f64)| ((x * 100.0).round() / 100.0, (y * 100.0).round() / 100.0);
                data = data.move_to(hundredth(on_page(&points[a]))).line_to(hundredth(on_page(&points[b])));
            }
            let path = Path::new().set("d", data).set("fill", "none").set("stroke", color).set("stroke-width", width);
            if dashes.is_empty() { path } else { path.set("stroke-dasharray", dashes) }
        };
        let words = |text: &str, y: f64, size: u32| {
            Text::new(text)
                .set("x", PANEL * (i as f64 + 0.5))
                .set("y", y)
                .set("text-anchor", "middle")
                .set("font-size", size)
        };
        let error = error.map_or(String::new(), |e| format!("e_rms {:.2} %, e_max {:.2} %{standard}", e.rms, e.max));
        document = document
            .add(path(&rest, "#999", "0.6 2.4", 0.8))
            .add(path(&body, "#0072b2", "5 3", 1.1))
            .add(path(net, "#d0021b", "", 0.8))
            .add(words(name, 20.0, 15))
            .add(words(&error, 38.0, 12));
    }
    let size = if factor == 1.0 { String::new() } else { format!(", displacements times {factor}") };
    let key = format!("{}, {load}{size}: at rest dotted, finite elements dashed blue, springs red", outcome.scene);
    let key = Text::new(key).set("x", width / 2.0).set("y", height - 10.0).set("text-anchor", "middle");
    Some(document.add(key.set("font-size", 11)).to_string())
}

/// A solid in cabinet projection: x to the right, z up, y into the picture at half its length.
fn seen(x: &[f64]) -> [f64; 2] {
    match x {
        // An oblique projection: what is deeper lies farther up and to the right.
        [x, y, z] => [x + 0.35 * y, z + 0.25 * y],
        [x, y] => [*x, *y],
        _ => [x[0], 0.0],
    }
}

/// Whether a side of a solid is on the side of its cell from which [`seen`] looks.
fn faces_viewer(corners: &[&[f64]], centre: [f64; 3]) -> bool {
    let from = |a: &[f64], b: &[f64]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let inner = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let [a, b] = [from(corners[1], corners[0]), from(corners[2], corners[0])];
    let normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let outward = inner(normal, from(corners[0], &centre)).signum();
    // The projection maps this direction to a point: it is the one from which it looks.
    outward * inner(normal, [0.35, -1.0, 0.25]) > 0.0
}
