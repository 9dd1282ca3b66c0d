//! The gradients of the measures of all springs at given positions.

use crate::model::Network;
use crate::springs::Measure;
use crate::stiffness::gather;

/// `∇c_s` of every spring at given positions, on the degrees of freedom of the spring.
#[derive(Debug)]
pub struct SpringGradients {
    /// The index at which each spring begins in the other lists, `[springs + 1]`.
    starts: Vec<usize>,
    dofs: Vec<usize>,
    values: Vec<f64>,
}

impl SpringGradients {
    /// The gradients at the positions `x`, `[points × dimension]`, m; and the force of each spring there, in N if it
    /// measures a length.
    pub fn at(network: &Network, x: &[f64]) -> (SpringGradients, Vec<f64>) {
        let d = network.dimension;
        let (mut starts, mut dofs, mut values) = (vec![0], Vec::new(), Vec::new());
        let mut local = Vec::new();
        let mut add = |measure: &Measure, points: &[usize], pull: &dyn Fn(f64) -> [f64; 3]| {
            local.resize(points.len() * d, 0.0);
            gather(x, d, points, &mut local);
            dofs.extend(points.iter().flat_map(|&p| p * d..(p + 1) * d));
            values.extend(measure.gradient(&local, d));
            starts.push(dofs.len());
            pull(measure.value(&local, d))[1]
        };
        let mut pulls = Vec::with_capacity(network.len());
        pulls.extend(network.lengths.iter().map(|s| add(&Measure::Length, &s.points, &|c| s.pull(c))));
        pulls.extend(network.others.iter().map(|s| add(&s.measure, &s.points, &|c| s.pull(c))));
        (SpringGradients { starts, dofs, values }, pulls)
    }

    /// `∇c_s·v` of every spring.
    pub fn along<'a>(&'a self, v: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.each().map(|(dofs, values)| dofs.iter().zip(values).map(|(&i, g)| v[i] * g).sum())
    }

    /// `‖∇c_s‖²` of every spring.
    pub fn squares(&self) -> impl Iterator<Item = f64> + '_ {
        self.each().map(|(_, values)| values.iter().map(|g| g * g).sum())
    }

    /// `Σ_s p_s ∇c_s` over `size` degrees of freedom.
    pub fn sum(&self, pulls: impl Iterator<Item = f64>, size: usize) -> Vec<f64> {
        let mut total = vec![0.0; size];
        for ((dofs, values), pull) in self.each().zip(pulls) {
            dofs.iter().zip(values).for_each(|(&i, g)| total[i] += pull * g);
        }
        total
    }

    fn each(&self) -> impl Iterator<Item = (&[usize], &[f64])> {
        self.starts.windows(2).map(|at| (&self.dofs[at[0]..at[1]], &self.values[at[0]..at[1]]))
    }
}
