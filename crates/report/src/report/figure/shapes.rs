//! The drawing of a deformation: what is nearer covers what is farther.

use super::axis::prefix;
use super::camera::{Camera, Seen, nearness, silhouette, turning};
use super::deformation::Deformation;
use super::palette::{COLORS, faded, ramp};
use super::sheet::{Columns, cut, line, outline, sheet, tenth, words};
use crate::springs::{cross, dot, norm};
use plotters::style::RGBColor;
use svg::Document;
use svg::node::element::{Circle, Mask, Path, Rectangle};

/// Pixels: around a panel, of its caption, and of the key below all panels.
const MARGIN: f64 = 10.0;
const CAPTION: f64 = 20.0;
const KEY: f64 = 50.0;
/// A key with its entries below the bar of colours has this height, pixels.
const TALL_KEY: f64 = 95.0;
/// Pixels across the bar of colours, and its steps.
const BAR: f64 = 7.0;
const STEPS: i32 = 40;
/// A line of the key has this height, pixels.
const LINE: f64 = 15.0;
/// The longest arrow as a part of the larger side of the picture of the body.
const ARROW: f64 = 0.14;
/// Pixels across the lines around a body.
const OUTLINE: f64 = 0.8;
const BLACK: RGBColor = RGBColor(0, 0, 0);
const SOFT: RGBColor = RGBColor(120, 120, 120);

/// A part of a picture, and how near it is.
type Part = (f64, Path);

struct Scale {
    /// The least of all shapes across, the largest up, m.
    corner: [f64; 2],
    /// Pixels of a metre.
    size: f64,
}

impl Deformation {
    /// Draws the text of an SVG file: the body at rest with supports and forces, finite elements, springs.
    pub fn svg(&self, columns: Columns) -> String {
        let d = self.mesh.dimension;
        let camera = Camera::of(&self.mesh);
        let moved = |u: &[f64]| -> Vec<Seen> {
            let x: Vec<f64> = self.mesh.points.iter().zip(u).map(|(x, u)| x + self.factor * u).collect();
            camera.see(&x, d)
        };
        let rest = camera.see(&self.mesh.points, d);
        let shapes = [moved(&self.displacements[0]), moved(&self.displacements[1])];
        let arrows = self.arrows(&camera, &rest);
        let ends = arrows.iter().flatten().copied();
        let all: Vec<[f64; 2]> = rest.iter().chain(shapes.iter().flatten()).map(|p| p.at).chain(ends).collect();
        let bound = |k: usize, pick: fn(f64, f64) -> f64, from: f64| all.iter().map(|p| p[k]).fold(from, pick);
        let (low, high) =
            ([0, 1].map(|k| bound(k, f64::min, f64::INFINITY)), [0, 1].map(|k| bound(k, f64::max, f64::NEG_INFINITY)));
        // A body that is seen as a point or a line has no width, by which nothing may be divided.
        let [wide, tall] = [(high[0] - low[0]).max(1e-300), high[1] - low[1]];
        let width = f64::from(columns.pixels());
        // In one column the key has the place of a fourth panel, unless the body is flat.
        let across = match columns {
            Columns::One if wide > 1.6 * tall => 1,
            Columns::One => 2,
            Columns::Two => 3,
        };
        let panel = width / f64::from(across);
        let size = ((panel - 2.0 * MARGIN) / wide).min(1.3 * (panel - 2.0 * MARGIN) / tall.max(1e-300));
        let own = CAPTION + 2.0 * MARGIN + size * tall;
        let (rows, beside) = (f64::from((3 + across - 1) / across), across == 2);
        let own = if beside { own.max(TALL_KEY + CAPTION + 3.0 * LINE) } else { own };
        let key = if beside { [panel + MARGIN, own + CAPTION] } else { [MARGIN, own * rows] };
        let mut document = sheet(
            columns,
            own * rows
                + if beside {
                    0.0
                } else if across == 1 {
                    TALL_KEY
                } else {
                    KEY
                },
            &self.title,
        );
        let largest = self.displacements[0].chunks_exact(d).map(norm).fold(0.0, f64::max);
        for (i, caption) in self.captions().iter().enumerate() {
            let (column, row) = (i as i32 % across, i as i32 / across);
            let left = panel * f64::from(column) + (panel - size * wide) / 2.0;
            let top = own * f64::from(row);
            let scale = Scale { corner: [low[0] - left / size, high[1] + (top + CAPTION + MARGIN) / size], size };
            let centre = panel * (f64::from(column) + 0.5);
            document = document.add(words(&cut(caption, panel), [centre, top + 14.0], "middle"));
            document = match i {
                0 => self.at_rest(document, &scale, &rest, &arrows),
                1 => self.filled(document, &scale, &rest, &shapes[0], largest),
                _ => self.network(document, &scale, &rest, &shapes),
            };
        }
        self.key(document, key, width, largest).to_string()
    }

    fn captions(&self) -> [String; 3] {
        ["(a) at rest".into(), "(b) finite elements".into(), format!("(c) {}", self.fit)]
    }

    fn is_solid(&self) -> bool {
        self.mesh.cell_dimension() == 3
    }

    /// The faces that are turned to the viewer, each with this colour and this line around it.
    fn surface(&self, scale: &Scale, points: &[Seen], color: impl Fn(&[usize]) -> String) -> Vec<Part> {
        // Faces of a solid that are turned away are behind others. A sheet shows both of its sides.
        let seen = self.faces.iter().filter(|face| !self.is_solid() || turning(face, points) > 0.0);
        let part = |face: &Vec<usize>| {
            let at: Vec<[f64; 2]> = face.iter().map(|&p| scale.place(points[p].at)).collect();
            let path = Path::new().set("d", outline(&at) + "z").set("fill", color(face));
            (
                nearness(face, points),
                path.set("stroke", "#333").set("stroke-width", 0.35).set("stroke-linejoin", "round"),
            )
        };
        let edge = |ends: &[usize; 2]| {
            let at = ends.map(|p| scale.place(points[p].at));
            (nearness(ends, points), line(&at, BLACK, 1.0, &[]).set("stroke", color(ends)))
        };
        seen.map(part).chain(self.edges.iter().map(edge)).collect()
    }

    fn at_rest(&self, document: Document, scale: &Scale, rest: &[Seen], arrows: &[[[f64; 2]; 2]]) -> Document {
        // Light from the viewer's upper left.
        let shade = |face: &[usize]| format!("#{0:02x}{0:02x}{0:02x}", self.shade(face, rest));
        let mut document = drawn(document, self.surface(scale, rest, shade));
        let front = self.fronts(rest);
        for &point in self.held.iter().filter(|point| front[**point]) {
            let [x, y] = scale.place(rest[point].at).map(tenth);
            document = document.add(Circle::new().set("cx", x).set("cy", y).set("r", 1.6).set("fill", "black"));
        }
        for [tail, tip] in arrows {
            let (tail, tip) = (scale.place(*tail), scale.place(*tip));
            let [dx, dy] = [tip[0] - tail[0], tip[1] - tail[1]];
            let long = dx.hypot(dy);
            // An arrow of less than a pixel has no direction that could be seen.
            if long < 1.0 {
                continue;
            }
            // A short arrow has a short head, so that more than half of its length is left for the shaft.
            let head = (0.45 * long).min(5.0) / long;
            let back = [tip[0] - head * dx, tip[1] - head * dy];
            let side = [-0.45 * head * dy, 0.45 * head * dx];
            let corners = [[back[0] + side[0], back[1] + side[1]], tip, [back[0] - side[0], back[1] - side[1]]];
            document = document
                .add(line(&[tail, back], COLORS[4], 1.1, &[]))
                .add(Path::new().set("d", outline(&corners) + "z").set("fill", faded(COLORS[4], 0.0)));
        }
        document
    }

    fn filled(&self, document: Document, scale: &Scale, rest: &[Seen], body: &[Seen], largest: f64) -> Document {
        let d = self.mesh.dimension;
        let share = |p: &usize| norm(&self.displacements[0][p * d..][..d]) / largest;
        let color = |face: &[usize]| ramp(face.iter().map(share).sum::<f64>() / face.len() as f64);
        let document = drawn(document, self.surface(scale, body, color));
        self.outline(document, scale, rest, ("b-rest", SOFT, &[3, 2]))
    }

    fn network(&self, document: Document, scale: &Scale, rest: &[Seen], shapes: &[Vec<Seen>; 2]) -> Document {
        let points = &shapes[1];
        let depth = points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), p| (a.min(p.near), b.max(p.near)));
        let far = |ends: &[usize; 2]| (depth.1 - nearness(ends, points)) / (depth.1 - depth.0).max(1e-300);
        let part = |(ends, is_negative): &([usize; 2], bool)| {
            let at = ends.map(|p| scale.place(points[p].at));
            // A spring that pushes is drawn before others at its place, dashed.
            let (color, dashes): (_, &[i32]) = if *is_negative { (COLORS[4], &[2, 2]) } else { (COLORS[0], &[]) };
            let fade = if self.is_solid() { 0.75 * far(ends) } else { 0.0 };
            let path = line(&at, color, if *is_negative { 0.9 } else { 0.6 }, dashes);
            (nearness(ends, points), path.set("stroke", faded(color, fade)))
        };
        let document = drawn(document, self.springs.iter().map(part).collect());
        let document = self.outline(document, scale, rest, ("c-rest", SOFT, &[3, 2]));
        self.outline(document, scale, &shapes[0], ("c-body", BLACK, &[]))
    }

    /// The edges around a shape, with a name of its own, a colour and dashes. Of a solid the outer half of the lines around it: a mask
    /// hides those in front of the body, such as those of steps.
    fn outline(
        &self,
        document: Document,
        scale: &Scale,
        points: &[Seen],
        (name, color, dashes): (&str, RGBColor, &[i32]),
    ) -> Document {
        let edges =
            if self.faces.is_empty() { self.edges.clone() } else { silhouette(&self.faces, points, self.is_solid()) };
        let place = |p: usize| scale.place(points[p].at);
        let data: String = edges.iter().map(|ends| outline(&ends.map(place))).collect();
        let path = line(&[], color, OUTLINE, dashes).set("d", data).set("stroke-linecap", "round");
        if !self.is_solid() {
            return document.add(path);
        }
        let seen = self.faces.iter().filter(|face| turning(face, points) > 0.0);
        let body: String =
            seen.map(|face| outline(&face.iter().map(|&p| place(p)).collect::<Vec<_>>()) + "z").collect();
        let all = Rectangle::new().set("width", "100%").set("height", "100%").set("fill", "white");
        let mask = Mask::new().set("id", name).set("maskUnits", "userSpaceOnUse").set("x", 0).set("y", 0);
        let mask = mask.set("width", "100%").set("height", "100%").add(all);
        // The line closes the gaps between faces.
        let mask = mask.add(Path::new().set("d", body).set("stroke", "black").set("stroke-width", 0.4));
        document.add(mask).add(path.set("stroke-width", 2.0 * OUTLINE).set("mask", format!("url(#{name})")))
    }

    /// The shade of a face in the light, from 0 to 255.
    fn shade(&self, face: &[usize], points: &[Seen]) -> u8 {
        if !self.is_solid() || face.len() < 3 {
            return 225;
        }
        let at = |i: usize| [points[face[i]].at[0], points[face[i]].at[1], points[face[i]].near];
        let from = |a: [f64; 3], b: [f64; 3]| [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
        let (a, b) = (from(at(0), at(1)), from(at(0), at(2)));
        let normal = cross(a, b);
        let light = [-0.3, 0.75, 0.6];
        let cosine = dot(&normal, &light) / (norm(&normal) * norm(&light)).max(1e-300);
        // The greys are from 160 to 250: a face is never as dark as the lines and dots on it, nor as light as the page.
        (190.0 + 60.0 * cosine.clamp(-0.5, 1.0)) as u8
    }

    /// Whether each point is a corner of a face that is seen; all of a body that is no solid.
    fn fronts(&self, points: &[Seen]) -> Vec<bool> {
        let mut front = vec![!self.is_solid(); points.len()];
        let seen = self.faces.iter().filter(|face| turning(face, points) > 0.0);
        seen.flatten().for_each(|&p| front[p] = true);
        front
    }

    /// Tails and tips of the forces as they are seen. The tips are at their points where these pull, tails where they push.
    fn arrows(&self, camera: &Camera, rest: &[Seen]) -> Vec<[[f64; 2]; 2]> {
        let d = self.mesh.dimension;
        let largest = self.forces.iter().map(|(_, force)| norm(force)).fold(0.0, f64::max);
        let range = |k: usize| {
            let values = || rest.iter().map(|p| p.at[k]);
            values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
        };
        let (longest, front) = (ARROW * range(0).max(range(1)), self.fronts(rest));
        let arrow = |(point, force): &(usize, Vec<f64>)| {
            let seen = camera.see(force, d)[0].at.map(|along| longest * along / largest);
            let tail = rest[*point].at;
            [tail, [tail[0] + seen[0], tail[1] + seen[1]]]
        };
        self.forces.iter().filter(|(point, _)| largest > 0.0 && front[*point]).map(arrow).collect()
    }

    /// What colours and lines are, from a corner to the right end of the sheet.
    fn key(&self, document: Document, [left, top]: [f64; 2], width: f64, largest: f64) -> Document {
        let (factor, unit) = prefix(largest);
        let long = (0.26 * width).max(110.0).min(width - left - MARGIN);
        let number = format!("{:.2e}", largest / factor).parse::<f64>().unwrap_or_default().to_string();
        let times = if self.factor == 1.0 { "drawn to scale".into() } else { format!("drawn × {}", self.factor) };
        let error = self.error.map_or(String::new(), |error| format!("(c) e_rms {error:.2} %"));
        // Beside the bar, or below it.
        let is_wide = width - left - long > 2.0 * long;
        let below = if is_wide { [left + 90.0, top + 41.0] } else { [left, top + 56.0] };
        let mut document = document
            .add(words("0", [left, top + 24.0], "start"))
            .add(words(&number, [left + long, top + 24.0], "end"))
            .add(words(&format!("|u|, {unit}m"), [left + long / 2.0, top + 24.0], "middle"))
            .add(words(&times, [left, top + 41.0], "start"))
            .add(words(&error, below, "start"));
        // Each step goes on to the end below the next one, so that no gap is seen between them.
        for i in 0..STEPS {
            let share = f64::from(i) / f64::from(STEPS);
            let step = Rectangle::new().set("x", tenth(left + share * long)).set("y", tenth(top + 6.0));
            let step = step.set("width", tenth((1.0 - share) * long)).set("height", BAR);
            document = document.add(step.set("fill", ramp(share)));
        }
        let surface = if self.is_surface_only { "springs of the surface" } else { "springs" };
        let negative = self.springs.iter().any(|(_, is_negative)| *is_negative);
        let mut entries: Vec<(&str, RGBColor, f64, &[i32])> =
            vec![(surface, COLORS[0], 0.6, &[]), ("k < 0", COLORS[4], 1.2, &[2, 2])];
        entries.truncate(if negative { 2 } else { 1 });
        entries.push(("finite elements", BLACK, 1.6 * OUTLINE, &[]));
        entries.push(("at rest", SOFT, 0.8, &[3, 2]));
        let first = if is_wide { left + long.max(190.0) + 22.0 } else { left };
        let begin = if is_wide { top + 10.0 } else { top + 70.0 };
        let (mut x, mut y) = (first, begin);
        for (name, color, thick, dashes) in entries {
            let own = 24.0 + super::sheet::width(name) + 8.0;
            if x > first && x + own > width {
                (x, y) = (first, y + LINE);
            }
            document = document.add(line(&[[x, y], [x + 18.0, y]], color, thick, dashes));
            document = document.add(words(name, [x + 23.0, y + 4.0], "start"));
            x += own;
        }
        document
    }
}

impl Scale {
    fn place(&self, at: [f64; 2]) -> [f64; 2] {
        [self.size * (at[0] - self.corner[0]), self.size * (self.corner[1] - at[1])]
    }
}

/// What is farther first.
fn drawn(document: Document, mut parts: Vec<Part>) -> Document {
    // What is far is drawn first, and what is nearer covers it.
    parts.sort_by(|a, b| a.0.total_cmp(&b.0));
    parts.into_iter().fold(document, |document, (_, path)| document.add(path))
}
