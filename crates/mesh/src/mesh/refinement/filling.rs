//! Elements that take the place of others: the tetrahedra that fill the gaps between the pyramids of a divided pyramid, and elements
//! with quadratic functions.

use crate::element::{Cell, Element, SHIPPED, same_place};
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
    shipped(fits).ok_or_else(|| {
        let expected = format!("an element of tetrahedra whose triangles have the nodes of those of {}", element.name);
        Error::expected("mesh", expected, "none").of_kind(ErrorKind::Unsupported)
    })
}

/// The shipped element with the same cell whose nodes are the corners and the middles of the edges. On sides it has the same functions as that
/// of any other cell, so that cells of several kinds stay connected.
///
/// # Errors
/// The element has further nodes than its corners, or no shipped element is the quadratic one.
pub fn quadratic(element: &Element) -> Result<Arc<Element>> {
    let (cell, linear) = (element.cell, element.cell.corners().len());
    let expected = |words: &str| Error::expected("mesh", words, &element.name).of_kind(ErrorKind::Unsupported);
    if !element.has_corners_alone() {
        return Err(expected("cells whose nodes are their corners"));
    }
    let corners = cell.corners();
    let middle = |[a, b]: [usize; 2]| corners[a].iter().zip(corners[b]).map(|(a, b)| (a + b) / 2.0).collect();
    let edges: Vec<[usize; 2]> = if cell.dimension() == 1 { vec![[0, 1]] } else { cell.edges() };
    let middles: Vec<Vec<f64>> = edges.into_iter().map(middle).collect();
    let wanted = |at: &[f64]| {
        corners.iter().any(|place| same_place(place, at)) || middles.iter().any(|place| same_place(place, at))
    };
    let fits = |other: &Element| {
        let mut places = other.positions.chunks_exact(other.dimension());
        other.cell == cell && other.nodes() == linear + middles.len() && places.all(wanted)
    };
    let found =
        shipped(fits).ok_or_else(|| expected("cells of which an element with quadratic functions is shipped"))?;
    // Cells of a surface or curve stay in their space.
    Ok(if found.space() < element.space() { Arc::new(Element::clone(&found).in_space(element.space())) } else { found })
}

fn shipped(fits: impl Fn(&Element) -> bool) -> Option<Arc<Element>> {
    SHIPPED.iter().filter_map(|file| Element::shipped(file).ok()).find(fits).map(Arc::new)
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
        // Coordinates in the two tangents, which need not be at right angles, rounded to whole multiples of 2⁻²⁰, so
        // that equal places are equal keys.
        [rs * tt - rt * st, rt * ss - rs * st].map(|x| (x / (ss * tt - st * st) * (1u64 << 20) as f64).round() as i64)
    };
    let mut places: Vec<[i64; 2]> = element.sides()[side].nodes.iter().map(place).collect();
    places.sort_unstable();
    Some(places)
}
