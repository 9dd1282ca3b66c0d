//! The joints of rods that bend: two directors at each point, which say how the joint is turned.
//!
//! Theory: page *Rods that bend* of the book.

use super::mesh::{Directors, Mesh};
use crate::error::{Error, ErrorKind, Result};
use crate::springs::{cross, distance, dot, norm};

/// The least share of a rod along the third axis of its joint. The first two axes see how the rod is inclined by what they see of it beside their plane, so a rod
/// in this plane could turn without being seen. Three rods at right angles have 0.58.
const LEAST_SHARE: f64 = 0.05;
/// The share that is good enough to take the mean direction of the rods, which keeps the joints of a line alike.
const GOOD_SHARE: f64 = 0.5;
/// The directions that are tried for a joint of many rods, evenly on half of a sphere: neighbours are 5° apart.
const DIRECTIONS: usize = 512;
/// How far a director is from its joint at least, in radii of gyration of the rods. The masses of directors, which have the rotary inertia, stand beside the joint; they
/// draw it aside by the square of the inverse of that, when it twists.
const REACH: f64 = 20.0;
/// The least radius of gyration of a rod relative to its length. The bending of a thinner one is lost in the rounding of its stretch.
const THINNEST: f64 = 1e-5;

impl Mesh {
    /// Rods with two directors for each point, its joint. They stand at right angles on each other and on the mean direction of the rods, as far from the joint as its rods
    /// are long on average, or some diameters if that is more. `gyration` is `I/A` of each rod and `torsion` its `G J/(E A)`, m².
    ///
    /// # Errors
    /// The mesh is not of bars of two nodes in space, or a joint has rods in so many directions that none of its axes is beside all: kind `Unsupported`. A rod is too
    /// thin to be computed: kind `Limit`.
    pub fn with_joints(mut self, gyration: Vec<f64>, torsion: Vec<f64>) -> Result<Mesh> {
        let unsupported = |expected: &str, found: String| {
            Err(Error::expected("bending", expected, found).of_kind(ErrorKind::Unsupported))
        };
        let expected = "bars of two nodes in space, which bend as a \"rod\"";
        let [block] = &self.blocks[..] else {
            return unsupported(expected, format!("cells of {} elements", self.blocks.len()));
        };
        if self.dimension != 3 || block.element.dimension() != 1 || block.element.nodes() != 2 {
            return unsupported(expected, format!("cells of {} in {} dimensions", block.element.name, self.dimension));
        }
        let first = self.point_count();
        let (mut rods, mut radii): (Vec<Vec<[f64; 3]>>, _) = (vec![Vec::new(); first], vec![0.0f64; first]);
        for (nodes, gyration) in block.cells().zip(&gyration) {
            let along: [f64; 3] = std::array::from_fn(|k| self.point(nodes[1])[k] - self.point(nodes[0])[k]);
            let radius = gyration.sqrt();
            // The comparison is negated so that a radius that is not a number is refused.
            if !(radius >= THINNEST * norm(&along)) {
                let problem = format!(
                    "expected a rod whose radius of gyration is at least {THINNEST:e} of its length, found {radius:.3e} m of {:.3e} m: its bending is lost in rounding \
                     errors of its stretch",
                    norm(&along)
                );
                return Err(Error::at("bending", problem).of_kind(ErrorKind::Limit));
            }
            for &p in nodes {
                rods[p].push(along);
                radii[p] = radii[p].max(radius);
            }
        }
        let of_cells =
            block.cells().flat_map(|nodes| [0, 1].map(|end| first + 2 * nodes[end])).flat_map(|d| [d, d + 1]).collect();
        for (joint, own) in rods.iter().enumerate() {
            let Some(axes) = axes_of(own) else {
                let found = format!("a joint of {} rods in all directions at {:?} m", own.len(), self.point(joint));
                return unsupported("joints of rods that leave one direction beside all of them", found);
            };
            let mean = own.iter().map(|along| norm(along)).sum::<f64>() / own.len() as f64;
            let reach = mean.max(REACH * radii[joint]);
            for axis in axes {
                let place: [f64; 3] = std::array::from_fn(|k| self.points[3 * joint + k] + reach * axis[k]);
                self.points.extend(place);
            }
        }
        let edges = (0..first).flat_map(|joint| [[joint; 2]; 2]).collect();
        Ok(self.directed(Directors { edges, of_cells, gyration, torsion, flat: false }))
    }

    /// The length of a rod with these ends, m.
    pub fn rod_length(&self, nodes: &[usize]) -> f64 {
        distance(self.point(nodes[0]), self.point(nodes[1]))
    }
}

/// Two axes at right angles to each other and to the direction that has the largest share of each of these rods; none if some rod has almost no share.
fn axes_of(rods: &[[f64; 3]]) -> Option<[[f64; 3]; 2]> {
    let rods: Vec<[f64; 3]> = rods.iter().map(|rod| unit(*rod)).collect();
    let share = |d: &[f64; 3]| rods.iter().map(|rod| dot(rod, d).abs()).fold(1.0, f64::min);
    // The mean of the rods, each turned to the side of the first one.
    let mut mean = [0.0; 3];
    for rod in &rods {
        // A rod has no direction of its own: with the other sign two rods of one line would cancel.
        let sign = dot(rod, rods.first()?).signum();
        mean.iter_mut().zip(rod).for_each(|(m, r)| *m += sign * r);
    }
    let third = Some(unit(mean)).filter(|mean| share(mean) >= GOOD_SHARE);
    let third = third.or_else(|| (0..DIRECTIONS).map(direction).max_by(|a, b| share(a).total_cmp(&share(b))))?;
    if !(share(&third) >= LEAST_SHARE) {
        return None;
    }
    Some(axes_across(third))
}

/// Two unit vectors at right angles to a unit vector and to each other.
pub fn axes_across(along: [f64; 3]) -> [[f64; 3]; 2] {
    // The axis of the space that is farthest from it.
    // The product with the axis that is nearly along the vector would be of rounding.
    let far = (0..3).min_by(|&a, &b| along[a].abs().total_cmp(&along[b].abs())).unwrap_or(0);
    let first = unit(cross(along, std::array::from_fn(|k| if k == far { 1.0 } else { 0.0 })));
    [first, cross(along, first)]
}

/// One of the directions, on a spiral from the pole to the equator whose turns are as far apart as its points (golden angle).
fn direction(index: usize) -> [f64; 3] {
    let golden = std::f64::consts::PI * (3.0 - 5.0f64.sqrt());
    let height = 1.0 - (index as f64 + 0.5) / DIRECTIONS as f64;
    let radius = (1.0 - height * height).sqrt();
    let (sin, cos) = (golden * index as f64).sin_cos();
    [radius * cos, radius * sin, height]
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let size = norm(&v);
    v.map(|x| x / size)
}
