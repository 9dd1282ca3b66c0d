//! The tetrahedra that fill the gaps between the pyramids of a divided pyramid.

use crate::element::{Cell, Element, SHIPPED};
use crate::error::{Error, ErrorKind, Result};
use std::sync::Arc;

/// The element with this cell whose triangles have the same nodes as those of `element`: one of `known`, or else a
/// shipped one.
///
/// # Errors
/// No element with this cell has these triangles.
pub fn filling(element: &Element, cell: Cell, known: &[Arc<Element>]) -> Result<Arc<Element>> {
    let wanted = triangle(element);
    let fits = |other: &Element| other.cell == cell && triangle(other) == wanted;
    if let Some(found) = known.iter().find(|other| fits(other)) {
        return Ok(found.clone());
    }
    let shipped = SHIPPED.iter().filter_map(|file| Element::shipped(file).ok());
    shipped.into_iter().find(fits).map(Arc::new).ok_or_else(|| {
        let expected = format!("an element of tetrahedra whose triangles have the nodes of those of {}", element.name);
        Error::expected("mesh", expected, "none").of_kind(ErrorKind::Unsupported)
    })
}

/// The positions of the nodes of the first triangular side, in units of 2⁻²⁰ of its legs, sorted.
fn triangle(element: &Element) -> Option<Vec<[i64; 2]>> {
    let side = element.cell.sides().iter().position(|side| side.cell == Cell::Triangle)?;
    let (origin, tangents) = element.cell.sides()[side].embedding(element.cell);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let [s, t] = [&tangents[0], &tangents[1]];
    let (ss, st, tt) = (dot(s, s), dot(s, t), dot(t, t));
    let place = |&a: &usize| {
        let d = element.dimension();
        let r: Vec<f64> = element.positions[a * d..(a + 1) * d].iter().zip(&origin).map(|(x, o)| x - o).collect();
        let (rs, rt) = (dot(&r, s), dot(&r, t));
        [rs * tt - rt * st, rt * ss - rs * st].map(|x| (x / (ss * tt - st * st) * (1u64 << 20) as f64).round() as i64)
    };
    let mut places: Vec<[i64; 2]> = element.sides()[side].nodes.iter().map(place).collect();
    places.sort_unstable();
    Some(places)
}
