//! A bar for each body: by how much its energy differs from that of the model that the engine was given.

use super::record::{RefereeRecord, RefereeRow};
use super::tables::{bodies, loads};
use crate::report::figure::{COLORS, Columns, faded, sheet, words};
use svg::Document;
use svg::node::element::Rectangle;

/// Pixels of a bar, between bodies, above the first, to the left of the axis' least end, and to the right of its largest.
// The left has the names of engine, solver and model in one line, and the right the number of a bar that is cut.
const BAR: f64 = 6.0;
const BETWEEN: f64 = 9.0;
const ABOVE: f64 = 40.0;
const BESIDE: f64 = 300.0;
const RIGHT: f64 = 34.0;
/// The names have this font size, so that the longest has room.
const LABEL: f64 = 9.0;
/// The ends of the axis, percent; bars beyond are cut and have their number beside them.
const LEAST: f64 = -20.0;
const MOST: f64 = 60.0;
/// The lines of the axis are this far apart, percent.
const EVERY: i32 = 20;

/// The error of the engine, without that of the fit: own elements beside finite elements, springs beside their own equilibrium.
fn drawn(row: &RefereeRow) -> Option<f64> {
    row.found.map(|found| if row.is_of_elements() { found.energy_percent } else { found.of_model_percent })
}

/// The chart as an SVG file's text.
pub fn referee_svg(record: &RefereeRecord) -> String {
    let (loads, groups) = (loads(record), bodies(record, |_| true));
    let each = loads.len() as f64 * BAR + BETWEEN;
    let height = ABOVE + groups.len() as f64 * each + 8.0;
    let width = f64::from(Columns::Two.pixels());
    let place = |percent: f64| BESIDE + (percent - LEAST) / (MOST - LEAST) * (width - BESIDE - RIGHT);
    let title = "Energies of bodies in simulators beside the models that they were given, percent";
    let mut document = sheet(Columns::Two, height, title);
    for (i, load) in loads.iter().enumerate() {
        let left = 8.0 + 90.0 * i as f64;
        document = document.add(block([left, 8.0], [10.0, 10.0], i)).add(words(load, [left + 14.0, 17.0], "start"));
    }
    // The ends of the axis are whole multiples of the distance of its lines.
    for percent in (LEAST as i32..=MOST as i32).step_by(EVERY as usize) {
        let x = place(f64::from(percent));
        let shade = if percent == 0 { "#444444" } else { "#dddddd" };
        let line = Rectangle::new().set("x", x - 0.25).set("y", ABOVE - 6.0).set("width", 0.5);
        document = document.add(line.set("height", height - ABOVE + 2.0).set("fill", shade)).add(words(
            &format!("{percent} %"),
            [x, ABOVE - 10.0],
            "middle",
        ));
    }
    for (g, group) in groups.iter().enumerate() {
        let top = ABOVE + g as f64 * each;
        let RefereeRow { engine, solver, poisson, .. } = group.first;
        let name = format!("{engine} {solver}, {}, ν = {poisson}", group.first.title());
        let label = words(&name, [BESIDE - 6.0, top + (each - BETWEEN) / 2.0 + 4.0], "end");
        document = document.add(label.set("font-size", LABEL));
        for (i, row) in group.by_load.iter().enumerate() {
            if let Some(row) = row {
                document = bar(document, row, i, top + i as f64 * BAR, &place);
            }
        }
    }
    document.to_string()
}

fn bar(document: Document, row: &RefereeRow, i: usize, y: f64, place: &dyn Fn(f64) -> f64) -> Document {
    let zero = place(0.0);
    let beside = |x: f64, text: &str| words(text, [x + 3.0, y + BAR - 0.5], "start").set("font-size", 6);
    let Some(percent) = drawn(row) else {
        return document.add(beside(zero, if row.moving_percent.is_some() { "not at rest" } else { "diverged" }));
    };
    let shown = place(percent.clamp(LEAST, MOST));
    // A bar of no length would not be seen.
    let (from, to) = (zero.min(shown), zero.max(shown).max(zero + 0.8));
    let document = document.add(block([from, y], [to - from, BAR - 1.0], i));
    if (LEAST..=MOST).contains(&percent) { document } else { document.add(beside(to, &format!("{percent:+.0} %"))) }
}

fn block([x, y]: [f64; 2], [width, height]: [f64; 2], i: usize) -> Rectangle {
    let shape = Rectangle::new().set("x", (100.0 * x).round() / 100.0).set("y", y);
    shape
        .set("width", (100.0 * width).round() / 100.0)
        .set("height", height)
        .set("fill", faded(COLORS[i % COLORS.len()], 0.0))
}
