//! How springs pull on each other at rest.

use super::body::forces;
use crate::analysis::tensor::basis;
use crate::model::{Network, Specimen, is_balanced};
use crate::springs::distance;
use crate::stiffness::gathered;
use nalgebra::DMatrix;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A pull below this share of `k c` is the rounding of lengths in files.
const ROUNDING: f64 = 1e-9;

/// How springs pull on each other in the shape in which a network is given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Tension {
    /// This number of springs has a rest measure that is not what it measures, beyond 1e-9 of it.
    pub springs: usize,
    /// A spring pulls one of its points with this force in N at most.
    pub largest: f64,
    /// The largest sum of forces at a point that is free, relative to the largest sum of their sizes: 0 where the network is at rest, 1 where
    /// some point is pulled in one direction alone.
    pub unbalanced: f64,
    /// The mean stress in Kelvin's notation in Pa: 0 of a body in equilibrium, and in a network that repeats itself what its surroundings
    /// pull with.
    pub stress: Vec<f64>,
}

impl Tension {
    /// The pull of the springs of a network of this volume, m³. `None` where some spring has no direction.
    pub fn of(specimen: &Specimen, volume: f64) -> Option<Tension> {
        let d = specimen.network.dimension;
        let all = forces(specimen)?;
        let (mut springs, mut largest) = (0, 0.0f64);
        let mut sizes = vec![0.0; specimen.count()];
        each_pull(&specimen.network, &specimen.points, |points, pull, constant, measure, gradient| {
            // The comparison is negated so that a pull that is not a number is left to the sums, where it shows.
            if !(pull.abs() > ROUNDING * (constant * measure).abs()) {
                return;
            }
            springs += 1;
            for (&p, own) in points.iter().zip(gradient.chunks_exact(d)) {
                let size = pull.abs() * own.iter().map(|g| g * g).sum::<f64>().sqrt();
                largest = largest.max(size);
                sizes[specimen.owner(p)] += size;
            }
        });
        let mut sums = vec![0.0; sizes.len() * d];
        all.iter().enumerate().for_each(|(dof, f)| sums[specimen.owner(dof / d) * d + dof % d] += f);
        let is_held = |dof: usize| specimen.support.as_ref().is_some_and(|support| support.is_fixed(dof));
        let left = |p: usize| {
            (p * d..(p + 1) * d).filter(|dof| !is_held(*dof)).map(|dof| sums[dof] * sums[dof]).sum::<f64>().sqrt()
        };
        let unbalanced = (0..sizes.len()).map(left).fold(0.0, f64::max);
        let most = sizes.iter().copied().fold(0.0, f64::max);
        // σ = 1/V Σ_p g_p ⊗ x_p, over all points and images: the gradients g of the energy are opposite to the forces of the springs.
        let virial = DMatrix::from_fn(d, d, |k, l| {
            let at = |p: usize| specimen.points[p * d + l] - specimen.points[l];
            (0..all.len() / d).map(|p| all[p * d + k] * at(p)).sum::<f64>() / volume
        });
        let stress = basis(d).iter().map(|strain| virial.component_mul(strain).sum()).collect();
        // Without a pull at rest there is nothing that could be unbalanced, and 0/0 otherwise.
        let unbalanced = if springs > 0 && most > 0.0 { unbalanced / most } else { 0.0 };
        Some(Tension { springs, largest, unbalanced, stress })
    }

    /// Whether the forces balance each other, to the digits of files.
    pub fn is_balanced(&self) -> bool {
        is_balanced(self.unbalanced)
    }
}

/// Calls `visit(points, pull, constant, measure, gradient)` for each spring.
fn each_pull(network: &Network, points: &[f64], mut visit: impl FnMut(&[usize], f64, f64, f64, &[f64])) {
    let d = network.dimension;
    for spring in &network.lengths {
        let [a, b] = spring.points.map(|p| &points[p * d..(p + 1) * d]);
        let length = distance(a, b);
        // Two points at one place have no direction: the spring pulls neither of them.
        let n: Vec<f64> = a.iter().zip(b).map(|(a, b)| if length > 0.0 { (b - a) / length } else { 0.0 }).collect();
        let gradient: Vec<f64> = n.iter().map(|n| -n).chain(n.iter().copied()).collect();
        visit(&spring.points, spring.pull(length)[1], spring.constant, length, &gradient);
    }
    for spring in &network.others {
        let x = gathered(points, d, &spring.points);
        let c = spring.measure.value(&x, d);
        visit(&spring.points, spring.tension(c), spring.constant, c, &spring.measure.gradient(&x, d));
    }
}
