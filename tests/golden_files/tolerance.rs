//! How far two numbers may be apart, and what may be farther, with the reason.

use super::case::fits;
use super::compare::has_seven_digits;

/// Ten digits.
const TEN_DIGITS: f64 = 1e-10;
/// The rounding errors of the largest number of a group, with some hundred operations.
const ROUNDING: f64 = 1e-13;
/// Half a unit of the 24 bits of a number with seven digits, on both sides.
const SEVEN: f64 = 1.3e-7;

/// Groups whose zeros are rounding errors of something larger: the name of the output, the keys, what the numbers are shares of, and why.
const SCALES: [(&str, &str, f64, &str); 5] = [
    (
        "*",
        "*e_*",
        100.0,
        "errors are percent of the largest displacement; that of an exact network is a rounding error",
    ),
    ("*", "*/relative_*", 1.0, "a share of the stiffness"),
    ("*", "*tensor_distance", 1.0, "a share of the elasticity tensor"),
    ("*", "*lacking_energy", 1.0, "a share of the energy; that of a uniform strain is the square of a rounding error"),
    ("*", "*drift*", 1.0, "a share of the largest energy; that of an exact integrator is a rounding error"),
];

/// Groups that agree at fewer digits, also of the largest number of the group.
const LOOSER: [(&str, &str, f64, &str); 2] = [
    ("*", "*momentum*", 1e-8, "sums over all points that cancel each other, after some hundred steps"),
    ("*", "*/curve/*", 0.1, "a search of hundreds of steps for an objective of 1e-6, in which rounding errors grow"),
];

pub struct Tolerance {
    relative: f64,
    rounding: f64,
    /// The least scale.
    scale: f64,
}

impl Tolerance {
    /// Of a group of numbers of an output.
    pub fn of(name: &str, group: &str, is_exact: bool) -> Tolerance {
        if is_exact {
            return Tolerance { relative: 0.0, rounding: 0.0, scale: 0.0 };
        }
        let is = |(output, keys): (&str, &str)| fits(name, output) && fits(group, keys);
        let scale = SCALES.iter().find(|(output, keys, ..)| is((output, keys))).map_or(0.0, |row| row.2);
        let looser = LOOSER.iter().find(|(output, keys, ..)| is((output, keys))).map(|row| row.2);
        let relative = looser.unwrap_or(if has_seven_digits(group) { SEVEN } else { TEN_DIGITS });
        Tolerance { relative, rounding: ROUNDING.max(if relative > TEN_DIGITS { relative } else { 0.0 }), scale }
    }

    pub fn allows(&self, a: f64, b: f64, scale: f64) -> bool {
        let apart = (a - b).abs();
        a == b || apart <= self.relative * a.abs().max(b.abs()) || apart <= self.rounding * scale.max(self.scale)
    }
}
