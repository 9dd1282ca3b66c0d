//! A body seen from a direction, in parallel projection.

use crate::mesh::Mesh;
use crate::springs::cross;
use std::collections::HashMap;

/// Degrees above the horizon, and around the vertical from the axis that lies across the view.
const ELEVATION: f64 = 24.0;
const TURN: f64 = 28.0;

/// The directions of a view; orthonormal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    across: [f64; 3],
    up: [f64; 3],
    /// Towards the viewer.
    toward: [f64; 3],
}

/// A point that is seen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Seen {
    /// Across and up, m.
    pub at: [f64; 2],
    /// How near it is, m.
    pub near: f64,
}

impl Camera {
    /// From the front, right and above of a solid, so that the longer of its horizontal axes lies across; straight at a plane.
    pub fn of(mesh: &Mesh) -> Camera {
        let d = mesh.dimension;
        if d < 3 {
            return Camera::straight();
        }
        let size = mesh.extent();
        // A body that is long along y is turned until y, not x, lies across the view.
        let turn = if size[1] > 1.5 * size[0] { 90.0 - TURN } else { TURN };
        Camera::turned(turn, ELEVATION)
    }

    /// Straight at the plane of the first two axes.
    pub fn straight() -> Camera {
        Camera { across: [1.0, 0.0, 0.0], up: [0.0, 1.0, 0.0], toward: [0.0, 0.0, 1.0] }
    }

    /// From the front, turned around the vertical to the right and raised above the horizon by these degrees.
    pub fn turned(turn: f64, elevation: f64) -> Camera {
        let (turn, elevation) = (turn.to_radians(), elevation.to_radians());
        let across = [turn.cos(), turn.sin(), 0.0];
        let toward = [turn.sin() * elevation.cos(), -turn.cos() * elevation.cos(), elevation.sin()];
        Camera { across, up: cross(toward, across), toward }
    }

    /// Points, `[points × dimension]`, as they are seen.
    pub fn see(&self, points: &[f64], dimension: usize) -> Vec<Seen> {
        let along = |x: &[f64], direction: [f64; 3]| x.iter().zip(direction).map(|(x, d)| x * d).sum::<f64>();
        let seen = |x: &[f64]| Seen { at: [along(x, self.across), along(x, self.up)], near: along(x, self.toward) };
        points.chunks_exact(dimension).map(seen).collect()
    }
}

/// Twice the area of a face as it is seen, positive if its corners follow each other counterclockwise.
pub fn turning(face: &[usize], points: &[Seen]) -> f64 {
    let corner = |i: usize| points[face[i % face.len()]].at;
    (0..face.len()).map(|i| corner(i)[0] * corner(i + 1)[1] - corner(i)[1] * corner(i + 1)[0]).sum()
}

/// How near the middle of some points is.
pub fn nearness(places: &[usize], points: &[Seen]) -> f64 {
    places.iter().map(|&p| points[p].near).sum::<f64>() / places.len() as f64
}

/// The edges between faces that are turned to the viewer and others, and those of one face: the outline of a body.
pub fn silhouette(faces: &[Vec<usize>], points: &[Seen], is_solid: bool) -> Vec<[usize; 2]> {
    let mut sides: HashMap<[usize; 2], (usize, usize)> = HashMap::new();
    for face in faces {
        let is_front = turning(face, points) > 0.0;
        for i in 0..face.len() {
            let (a, b) = (face[i], face[(i + 1) % face.len()]);
            let count = sides.entry([a.min(b), a.max(b)]).or_default();
            if is_front || !is_solid { count.0 += 1 } else { count.1 += 1 }
        }
    }
    // The contour of a solid is between a face in front and one behind. A side with a single face is a border, on
    // sheets as well.
    let is_edge = |(front, back): (usize, usize)| front == 1 && (back == 1 || !is_solid) || front + back == 1;
    let mut edges: Vec<[usize; 2]> = sides.into_iter().filter(|(_, count)| is_edge(*count)).map(|(e, _)| e).collect();
    // The order of a hash map differs from run to run, and the picture must not.
    edges.sort_unstable();
    edges
}
