//! The forces of the parts of which a model is the sum, and where they act.

/// The degrees of freedom of each part.
#[derive(Debug, PartialEq)]
pub struct Places {
    /// The index at which each part begins in `dofs`, `[parts + 1]`.
    starts: Vec<usize>,
    dofs: Vec<usize>,
}

impl Places {
    /// No part.
    pub fn new() -> Places {
        Places { starts: vec![0], dofs: Vec::new() }
    }

    /// Adds a part.
    pub fn push(&mut self, dofs: impl IntoIterator<Item = usize>) {
        self.dofs.extend(dofs);
        self.starts.push(self.dofs.len());
    }

    /// The degrees of freedom of every part, and its share of values that are listed in the same order.
    pub fn each<'a>(&'a self, values: &'a [f64]) -> impl Iterator<Item = (&'a [usize], &'a [f64])> {
        self.starts.windows(2).map(|at| (&self.dofs[at[0]..at[1]], &values[at[0]..at[1]]))
    }

    /// The degrees of freedom of every part.
    pub fn dofs(&self) -> impl Iterator<Item = &[usize]> {
        self.starts.windows(2).map(|at| &self.dofs[at[0]..at[1]])
    }
}

impl Default for Places {
    fn default() -> Places {
        Places::new()
    }
}

/// The vectors of all parts, for example the forces `F_s = ∂F/∂c_s` of each part at factor 1.
#[derive(Debug, Clone)]
pub struct PartVectors {
    /// Where each part acts.
    pub places: std::sync::Arc<Places>,
    /// The vectors of the parts, one after another, in the order of their places.
    pub values: Vec<f64>,
}

impl PartVectors {
    /// `F_s·v` of every part.
    pub fn along<'a>(&'a self, v: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.places.each(&self.values).map(|(dofs, values)| dofs.iter().zip(values).map(|(&i, f)| v[i] * f).sum())
    }

    /// `Σ_s c_s F_s` over `size` degrees of freedom.
    pub fn sum(&self, factors: impl Iterator<Item = f64>, size: usize) -> Vec<f64> {
        let mut total = vec![0.0; size];
        for ((dofs, values), factor) in self.places.each(&self.values).zip(factors) {
            dofs.iter().zip(values).for_each(|(&i, f)| total[i] += factor * f);
        }
        total
    }
}
