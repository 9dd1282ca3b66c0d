//! Places in words, in the unit of the file.

use crate::quantity::Quantity;
use crate::text::rounded;

/// The digits of a coordinate, which find a place in a program that shows the file.
const DIGITS: usize = 4;

/// A place in m as words in the unit of the file, with `scale` metres per unit: `(-58.25, 1.2, 0.1234) mm`.
pub(super) fn place(at: [f64; 3], scale: f64) -> String {
    // Zero is added so that −0 is printed as 0.
    let [x, y, z] = at.map(|x| rounded(x / scale + 0.0, DIGITS));
    format!("({x}, {y}, {z}) {}", unit(scale))
}

/// A length in m as words in the unit of the file.
pub(super) fn length(value: f64, scale: f64) -> String {
    format!("{} {}", rounded(value / scale, DIGITS), unit(scale))
}

/// A number of things, `1 cell` or `2 cells`.
pub(super) fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

/// The name of the unit, or its size in words where it has none.
fn unit(scale: f64) -> String {
    let name = Quantity::MeshUnit.unit_of(scale);
    name.map_or_else(|| format!("in units of {} m", rounded(scale, DIGITS)), String::from)
}
