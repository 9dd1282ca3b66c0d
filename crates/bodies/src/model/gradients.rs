//! The gradients of the measures of all springs at given positions.

use super::network::Network;
use super::parts::{PartVectors, Places};
use crate::springs::Measure;
use crate::stiffness::gather;
use std::sync::Arc;

/// `∇c_s` of every spring at given positions, on the degrees of freedom of the spring.
#[derive(Debug)]
pub struct SpringGradients(PartVectors);

impl SpringGradients {
    /// The gradients at the positions `x`, `[points × dimension]`, m; and the force of each spring there, in N if it
    /// measures a length.
    pub fn at(network: &Network, x: &[f64]) -> (SpringGradients, Vec<f64>) {
        let d = network.dimension;
        let (mut places, mut values) = (Places::new(), Vec::new());
        let mut local = Vec::new();
        let mut add = |measure: &Measure, points: &[usize], pull: &dyn Fn(f64) -> [f64; 3]| {
            local.resize(points.len() * d, 0.0);
            gather(x, d, points, &mut local);
            places.push(points.iter().flat_map(|&p| p * d..(p + 1) * d));
            values.extend(measure.gradient(&local, d));
            pull(measure.value(&local, d))[1]
        };
        let mut pulls = Vec::with_capacity(network.len());
        pulls.extend(network.lengths.iter().map(|s| add(&Measure::Length, &s.points, &|c| s.pull(c))));
        pulls.extend(network.others.iter().map(|s| add(&s.measure, &s.points, &|c| s.pull(c))));
        (SpringGradients(PartVectors { places: Arc::new(places), values }), pulls)
    }

    /// The degrees of freedom of every spring, and its gradient there.
    pub fn each(&self) -> impl Iterator<Item = (&[usize], &[f64])> {
        self.0.places.each(&self.0.values)
    }

    /// `∇c_s·v` of every spring.
    pub fn along<'a>(&'a self, v: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.0.along(v)
    }

    /// `‖∇c_s‖²` of every spring.
    pub fn squares(&self) -> impl Iterator<Item = f64> + '_ {
        self.0.places.each(&self.0.values).map(|(_, values)| values.iter().map(|g| g * g).sum())
    }

    /// The forces `T_s ∇c_s` of springs that pull with T_s.
    pub fn forces(&self, pulls: impl Iterator<Item = f64>) -> PartVectors {
        let mut values = self.0.values.clone();
        let mut rest = &mut values[..];
        for (dofs, pull) in self.0.places.dofs().zip(pulls) {
            let (own, others) = rest.split_at_mut(dofs.len());
            own.iter_mut().for_each(|g| *g *= pull);
            rest = others;
        }
        PartVectors { places: self.0.places.clone(), values }
    }
}
