//! Closed surfaces of triangles.

use super::edges::{by_edge, counts, open, passes};
use super::place::{length, place};
use super::repair::weld;
use super::triangles::Triangles;
use crate::error::{Error, Result};

/// Triangles that close one or several volumes, with their normals outwards.
pub(super) struct Surface {
    /// The coordinates, m.
    pub points: Vec<[f64; 3]>,
    pub triangles: Vec<[usize; 3]>,
    /// The place among the faces of the file of each triangle, as in [`Triangles`].
    pub faces: Vec<u32>,
    /// The enclosed volume by the divergence theorem, `∫ x·n dA / 3`, m³.
    pub volume: f64,
    /// m².
    pub area: f64,
    pub low: [f64; 3],
    pub high: [f64; 3],
    /// Whether all normals were inwards and have been turned.
    pub is_turned: bool,
    /// Triangles without an area, which were left out.
    pub flat: usize,
    /// Edges with more than two triangles, and the middle of one.
    pub branched: Option<(usize, [f64; 3])>,
}

impl Surface {
    /// The surface of triangles as they were given; `scale` is the unit of the file, by which an error names places.
    ///
    /// # Errors
    /// It is not closed, or its triangles are not turned alike.
    pub fn given(triangles: Triangles, scale: f64) -> Result<Surface> {
        check(&triangles, scale)?;
        Surface::closed(triangles)
    }

    /// The surface of triangles that pass each edge as often in one direction as in the other.
    ///
    /// # Errors
    /// It encloses no volume.
    pub fn closed(triangles: Triangles) -> Result<Surface> {
        let [low, high] = triangles.ends();
        // From a corner of its box: from a distant origin large parts would cancel each other.
        let volume = triangles.corners.iter().map(|&t| triangles.volume(t, low)).sum::<f64>();
        let area = triangles.corners.iter().map(|&t| triangles.area(t)).sum();
        let branched = branched(&triangles);
        let Triangles { points, corners: mut triangles, faces, flat } = triangles;
        let is_turned = volume < 0.0;
        if is_turned {
            triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        let volume = volume.abs();
        if !(volume > 0.0) {
            return Err(Error::expected("surface", "a surface that encloses a volume", format!("{volume} m³")));
        }
        Ok(Surface { points, triangles, faces, volume, area, low, high, is_turned, flat, branched })
    }
}

/// Edges with more than two triangles, and the middle of one.
fn branched(triangles: &Triangles) -> Option<(usize, [f64; 3])> {
    let passes = passes(&triangles.corners);
    let mut edges = by_edge(&passes).filter(|of_edge| of_edge.len() > 2).map(|of_edge| of_edge[0].edge);
    let one = edges.next()?;
    Some((1 + edges.count(), triangles.middle(one)))
}

/// That each edge is passed as often in one direction as in the other.
///
/// # Errors
/// An edge is not. The error counts such edges and gives the ends of one.
fn check(triangles: &Triangles, scale: f64) -> Result<()> {
    let passes = passes(&triangles.corners);
    let at = |point: usize| place(triangles.points[point], scale);
    let fault = |what: &str, expected: &str, is_such: &dyn Fn([usize; 2]) -> bool| {
        let mut such = by_edge(&passes).filter(|of_edge| is_such(counts(of_edge)));
        let [a, b] = such.next()?[0].edge;
        let found = format!("{} {what}, one from {} to {}", 1 + such.count(), at(a), at(b));
        Some(Error::expected("surface", expected, found))
    };
    let faults = [
        unwelded(triangles, scale),
        fault("edges of one triangle alone: holes", "a closed surface", &|[a, b]| a + b == 1),
        fault("edges between triangles that are turned differently", "normals that all point outwards", &|[a, b]| {
            a + b == 2 && a != b
        }),
        fault("edges of three or more triangles that do not close", "a closed surface", &|[a, b]| a != b),
    ];
    match faults.into_iter().flatten().next() {
        Some(error) => Err(error.followed_by("; repair = true (--repair) mends what can be mended, with notes")),
        None => Ok(()),
    }
}

/// That most of the open edges are there because corners at one place differ by rounding.
fn unwelded(triangles: &Triangles, scale: f64) -> Option<Error> {
    let edges = open(&triangles.corners).len();
    if edges == 0 {
        return None;
    }
    let mut welded = triangles.clone();
    let weld = weld(&mut welded);
    let holes = open(&welded.corners).len();
    // Most edges stay open: they are holes, and welding is not what is missing.
    if 2 * holes > edges {
        return None;
    }
    let rest = if holes == 0 { String::new() } else { format!(", and {holes} are holes") };
    let found = format!(
        "{edges} edges of one triangle alone, of which {} meet another one within {}: their corners are not welded{rest}",
        edges - holes,
        length(weld.distance, scale)
    );
    Some(Error::expected("surface", "triangles that share their corners", found))
}
