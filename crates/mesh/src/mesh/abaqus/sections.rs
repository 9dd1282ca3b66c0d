//! Materials, and the sections that give them to sets of elements.

use super::keyword::fields;
use crate::mesh::annotations::{Annotations, Section};
use crate::mesh::lines::real;
use std::collections::HashMap;

/// The isotropic constants of a material, in the units of the file.
#[derive(Default, Clone, Copy)]
struct Constants {
    young: Option<f64>,
    poisson: Option<f64>,
    density: Option<f64>,
}

/// What a data line of materials and sections states.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Datum {
    Elastic,
    Density,
    /// The thickness of a surface, or the area of a rod, of the last section.
    Size,
    /// The lengths of a cross-section of beams, which give the area of the last section.
    Profile(Profile),
}

/// A cross-section of beams.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Profile {
    /// The radius.
    Circle,
    /// The radius and the thickness of the wall.
    Pipe,
    /// Both sides.
    Rectangle,
    /// Both sides, and the thicknesses of the four walls.
    Box,
}

impl Profile {
    /// The profile of this name; `None` for one whose area has no formula here.
    pub fn named(name: &str) -> Option<Profile> {
        match name.to_ascii_uppercase().as_str() {
            "CIRC" => Some(Profile::Circle),
            "PIPE" => Some(Profile::Pipe),
            "RECT" => Some(Profile::Rectangle),
            "BOX" => Some(Profile::Box),
            _ => None,
        }
    }

    fn area(self, lengths: &[f64]) -> Option<f64> {
        let circle = |radius: f64| std::f64::consts::PI * radius * radius;
        match (self, lengths) {
            (Profile::Circle, [radius, ..]) => Some(circle(*radius)),
            (Profile::Pipe, [radius, wall, ..]) => Some(circle(*radius) - circle(radius - wall)),
            (Profile::Rectangle, [a, b, ..]) => Some(a * b),
            (Profile::Box, [a, b, right, top, left, bottom, ..]) => {
                Some(a * b - (a - right - left) * (b - top - bottom))
            }
            _ => None,
        }
    }
}

/// The materials and sections of a file, as they are read.
#[derive(Default)]
pub(super) struct Sections {
    materials: HashMap<String, Constants>,
    /// The material that is described.
    open: String,
    /// The set of elements, the name of the material and the size.
    sections: Vec<(String, String, Option<f64>)>,
}

impl Sections {
    pub fn material(&mut self, name: &str) {
        self.open = name.to_uppercase();
        self.materials.entry(self.open.clone()).or_default();
    }

    pub fn section(&mut self, set: &str, material: &str) {
        self.sections.push((set.to_string(), material.to_uppercase(), None));
    }

    /// Reads a data line. A line that is no number says nothing: it is of no use for a mesh.
    pub fn read(&mut self, datum: Datum, line: &[u8]) {
        let mut numbers = fields(line).map(real);
        let first = numbers.next().flatten();
        let of_open = self.materials.entry(self.open.clone()).or_default();
        match datum {
            // Further lines are of other temperatures.
            Datum::Elastic if of_open.young.is_none() => {
                (of_open.young, of_open.poisson) = (first, numbers.next().flatten());
            }
            Datum::Density if of_open.density.is_none() => of_open.density = first,
            Datum::Size => {
                if let Some((.., size @ None)) = self.sections.last_mut() {
                    *size = first;
                }
            }
            Datum::Profile(profile) => {
                let lengths: Option<Vec<f64>> = std::iter::once(first).chain(numbers).collect();
                if let Some((.., size @ None)) = self.sections.last_mut() {
                    *size = lengths.and_then(|lengths| profile.area(&lengths)).filter(|area| *area > 0.0);
                }
            }
            Datum::Elastic | Datum::Density => {}
        }
    }

    /// Adds the sections to what the file says; `is_line` is whether the elements of a set are rods.
    pub fn annotate(self, annotations: &mut Annotations, is_line: impl Fn(&str) -> bool) {
        for (set, material, size) in self.sections {
            let Constants { young, poisson, density } = self.materials.get(&material).copied().unwrap_or_default();
            let (thickness, area) = if is_line(&set) { (None, size) } else { (size, None) };
            annotations.sections.push(Section { group: set, young, poisson, density, thickness, area });
        }
    }
}
