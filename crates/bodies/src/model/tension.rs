//! The tension of the springs of a network at rest.

use super::network::Network;
use super::numbering::dofs;
use crate::fit::Spread;
use crate::springs::{distance, norm};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How far the rest lengths of a network differ from the lengths in the mesh, and how well the springs are in
/// equilibrium there.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct RestTension {
    /// Rest lengths deviate by the shares `|rest length / length in the mesh − 1|`, for springs between two points.
    pub rest_lengths: Spread,
    /// This number of springs has a rest length below zero.
    #[serde(rename = "negative_rest_lengths")]
    pub negative: usize,
    /// This number of springs has a force that does not depend on what they measure, up to rounding.
    #[serde(rename = "constant_forces")]
    pub steady: usize,
    /// The largest force on a node at rest is this share of the largest force of a spring; it is 0 if no spring pulls.
    pub unbalanced: f64,
}

/// Forces at rest balance each other where what is left of them is below this share: files of networks have six digits and more.
const BALANCED: f64 = 1e-5;
/// Says whether forces balance each other, if this share of the largest one is left at some point. NaN is no balance.
pub fn is_balanced(left: f64) -> bool {
    left <= BALANCED
}

/// A pull below this share of the constant times the length is that of rounding.
// A length is rounded by 1.1e-16 of the distance from the origin, which is less up to 1e4 lengths. The share that is left of such
// pulls would be that of rounding in rounding.
const ROUNDING: f64 = 1e-12;

impl RestTension {
    /// The tension of a network with its points at `points`, `[points × dimension]`, m.
    pub fn of(network: &Network, points: &[f64]) -> RestTension {
        let changes = network.lengths.iter().map(|s| (s.rest / network.distance(points, s.points) - 1.0).abs());
        RestTension {
            rest_lengths: Spread::of(&changes.collect::<Vec<f64>>()),
            negative: network.lengths.iter().filter(|s| s.rest < 0.0).count(),
            steady: network.others.iter().filter(|s| s.law.is_some()).count(),
            unbalanced: network.unbalanced(points),
        }
    }
}

impl Network {
    /// The share [`RestTension::unbalanced`] with the points at `points`, `[points × dimension]`, m.
    pub fn unbalanced(&self, points: &[f64]) -> f64 {
        let d = self.dimension;
        let mut force = vec![0.0; points.len()];
        // The largest pull of a spring between two points, and the largest of one that pulls with its whole length.
        let [mut largest, whole] = self.compare_lengths(points, &mut force);
        self.each_tension(&self.others, points, |spring, tension, gradient| {
            // What a spring on another measure pulls has another unit; its largest force on a point is in N.
            largest = largest.max(tension.abs() * longest(gradient, d));
            dofs(&spring.points, d).zip(gradient).for_each(|(dof, g)| force[dof] += tension * g);
        });
        // What springs pull by the rounding of their rest lengths is nothing.
        if largest > ROUNDING * whole { longest(&force, d) / largest } else { 0.0 }
    }

    /// The distance of two points, m.
    fn distance(&self, points: &[f64], [i, j]: [usize; 2]) -> f64 {
        let d = self.dimension;
        distance(&points[i * d..(i + 1) * d], &points[j * d..(j + 1) * d])
    }
}

/// The length of the longest vector.
fn longest(vectors: &[f64], dimension: usize) -> f64 {
    vectors.chunks_exact(dimension).map(norm).fold(0.0, f64::max)
}
