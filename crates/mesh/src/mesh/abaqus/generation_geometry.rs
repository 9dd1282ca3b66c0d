//! What keywords such as `*NGEN` make, and its geometry: points on arcs, and images of points. The keywords are read in
//! `generation_keywords.rs`.

use super::placement::Turn;
use crate::mesh::space::minus;
use crate::springs::{cross, dot, norm};

/// How far the distances of the ends of an arc from its middle may differ, relative to them: decks write few digits.
const ROUND: f64 = 1e-3;

/// What the data lines of a keyword make.
pub(super) enum Generation {
    /// Nodes on a line between two nodes, or on an arc; and their set.
    NodesBetween { is_arc: bool, set: Option<usize> },
    /// Nodes on straight lines between those of two sets; and their set.
    NodesFilled { set: Option<usize> },
    /// Nodes that are images of those of a set: what is added to their numbers, how often, their set, and the numbers of the data lines.
    NodesCopied { of: usize, add: i64, times: u64, image: Image, set: Option<usize>, numbers: Vec<f64> },
    /// Rows of elements; and their set.
    Elements { set: Option<usize> },
}

/// An arc of a circle of less than 180°.
pub(super) struct Arc {
    center: [f64; 3],
    /// The distances of both ends from the middle, which rounding makes differ.
    radii: [f64; 2],
    /// Unit vectors: towards the first end, and across it towards the second.
    axes: [[f64; 3]; 2],
    angle: f64,
}

impl Arc {
    /// The arc from a to b; `None` if their distances from the middle differ, or the three are on one line.
    pub fn between(a: [f64; 3], b: [f64; 3], center: [f64; 3]) -> Option<Arc> {
        let (u, v) = (minus(&a, &center), minus(&b, &center));
        let radii = [norm(&u), norm(&v)];
        let is_round = (radii[0] - radii[1]).abs() <= ROUND * radii[0];
        let (cosine, across) = (dot(&u, &v), norm(&cross(u, v)));
        // The sine of the angle between both radii tells whether they span a plane. Below 1.5e-8, the square root of a
        // rounding, the radii are in line to rounding.
        if !is_round || !(across > f64::EPSILON.sqrt() * radii[0] * radii[1]) {
            return None;
        }
        let first = u.map(|x| x / radii[0]);
        let along = dot(&first, &v);
        let second: [f64; 3] = std::array::from_fn(|k| v[k] - along * first[k]);
        let length = norm(&second);
        // The arc tangent of sine and cosine has all digits at every angle, where an arc cosine loses half of them near
        // 0° and 180°.
        Some(Arc { center, radii, axes: [first, second.map(|x| x / length)], angle: across.atan2(cosine) })
    }

    /// The point at the share t of the angle.
    pub fn at(&self, t: f64) -> [f64; 3] {
        let (sine, cosine) = (t * self.angle).sin_cos();
        // Radii that differ in the digits of a deck go over into each other, so that both ends are met.
        let radius = (1.0 - t) * self.radii[0] + t * self.radii[1];
        std::array::from_fn(|k| self.center[k] + radius * (cosine * self.axes[0][k] + sine * self.axes[1][k]))
    }
}

/// What a copy of a node is.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Image {
    /// Translated, or turned about an axis.
    Shift,
    /// Reflected in a line through two points, which is a turn of 180° about it.
    InLine,
    /// Reflected in a plane through three points.
    InPlane,
    /// Reflected in a point.
    InPoint,
}

/// Where a point is taken.
pub(super) type Map = Box<dyn Fn([f64; 3]) -> [f64; 3]>;

impl Image {
    /// The image that the numbers of the data lines state.
    ///
    /// # Errors
    /// What was expected, if there are other numbers.
    pub fn map(self, numbers: &[f64]) -> Result<Map, &'static str> {
        let at = |first: usize| [numbers[first], numbers[first + 1], numbers[first + 2]];
        match (self, numbers.len()) {
            (Image::Shift, 3) => {
                let by = at(0);
                Ok(Box::new(move |p| std::array::from_fn(|k| p[k] + by[k])))
            }
            (Image::Shift, 10) if numbers[9] == 0.0 => Image::Shift.map(&numbers[..3]),
            (Image::Shift, 10) if at(0) == [0.0; 3] => Image::Shift.map(&numbers[3..]),
            // A blank line before the axis is no translation.
            (Image::Shift, 7) => {
                let turn = Turn::of(numbers).ok_or("two points of an axis")?;
                Ok(Box::new(move |p| turn.apply(p)))
            }
            (Image::Shift, _) => Err("a translation, or zeros and two points of an axis with an angle"),
            (Image::InLine, 6) => {
                // A reflection in a line of space is half a turn about it.
                let turn = Turn::of(&[numbers, &[180.0]].concat()).ok_or("two points of a line")?;
                Ok(Box::new(move |p| turn.apply(p)))
            }
            (Image::InLine, _) => Err("two points of a line"),
            (Image::InPlane, 9) => {
                let origin = at(0);
                let across = cross(minus(&at(3), &origin), minus(&at(6), &origin));
                let length = norm(&across);
                if !(length > 0.0) {
                    return Err("three points that are not on one line");
                }
                let normal = across.map(|x| x / length);
                Ok(Box::new(move |p| {
                    let distance = dot(&normal, &minus(&p, &origin));
                    std::array::from_fn(|k| p[k] - 2.0 * distance * normal[k])
                }))
            }
            (Image::InPlane, _) => Err("three points of a plane"),
            (Image::InPoint, 3) => {
                let center = at(0);
                Ok(Box::new(move |p| std::array::from_fn(|k| 2.0 * center[k] - p[k])))
            }
            (Image::InPoint, _) => Err("a point"),
        }
    }
}
