//! The tension of the springs of a network at rest.

use super::elastic::Elastic;
use super::network::Network;
use crate::fit::Spread;
use crate::springs::{distance, norm};
use crate::stiffness::gather;
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
pub const BALANCED: f64 = 1e-5;
/// A pull below this share of the constant times the length is that of rounding.
const ROUNDING: f64 = 1e-12;

impl RestTension {
    /// Whether the forces balance each other, to the digits of files. A share that is not a number is none of a balance.
    pub fn is_balanced(&self) -> bool {
        self.unbalanced <= BALANCED
    }

    /// The tension of a network with its points at `points`, `[points × dimension]`, m.
    pub fn of(network: &Network, points: &[f64]) -> RestTension {
        let d = network.dimension;
        let at = |point: usize| &points[point * d..(point + 1) * d];
        let length = |[i, j]: [usize; 2]| distance(at(i), at(j));
        let changes: Vec<f64> = network.lengths.iter().map(|s| (s.rest / length(s.points) - 1.0).abs()).collect();
        let pulls = network.lengths.iter().map(|s| s.pull(length(s.points))[1].abs());
        let mut largest = pulls.fold(0.0, f64::max);
        // What springs pull by the rounding of their rest lengths is nothing.
        let lengths = network.lengths.iter().map(|s| (s.constant * length(s.points)).abs());
        let rounding = ROUNDING * lengths.fold(0.0, f64::max);
        for spring in &network.others {
            let mut x = vec![0.0; spring.points.len() * d];
            gather(points, d, &spring.points, &mut x);
            let pull = spring.tension(spring.measure.value(&x, d)).abs();
            // What a spring on another measure pulls has another unit; its largest force on a point is in N.
            let steepest = spring.measure.gradient(&x, d).chunks_exact(d).map(norm).fold(0.0, f64::max);
            largest = largest.max(pull * steepest);
        }
        let mut force = vec![0.0; points.len()];
        network.forces(points, &mut force);
        let left = force.chunks_exact(d).map(norm).fold(0.0, f64::max);
        RestTension {
            rest_lengths: Spread::of(&changes),
            negative: network.lengths.iter().filter(|s| s.rest < 0.0).count(),
            steady: network.others.iter().filter(|s| s.law.is_some()).count(),
            unbalanced: if largest > rounding { left / largest } else { 0.0 },
        }
    }
}
