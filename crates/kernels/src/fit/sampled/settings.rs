//! What a fit to forces is asked for.

use super::shapes::Sampling;
use crate::fit::norms::Norm;
use crate::springs::Force;

/// How much each shape counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Weights {
    #[default]
    Alike,
    /// `1/‖f‖²`: each for the error relative to its own force.
    Relative,
}

crate::named!(Weights { "none" => Alike, "relative" => Relative });

/// A fit to forces.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledFit {
    pub sampling: Sampling,
    pub force: Force,
    pub weights: Weights,
    /// Scale of the forces that do no work on homogeneous deformations of the cell, from 0 to 1; the others have 1.
    pub higher: f64,
    /// The same parameters for all springs of a group.
    pub tied: bool,
    /// No parameter below zero. Springs with rest measures of their own never have one.
    pub nonnegative: bool,
    /// Of the residual forces. Of a law that is not linear in its parameters only `Norm::Two` is known.
    pub norm: Norm,
    /// Bounds of parameters of the laws, by name.
    pub bounds: Vec<(String, [f64; 2])>,
    /// Starts of the search, where the law is not linear in its parameters.
    pub starts: usize,
}

impl Default for SampledFit {
    fn default() -> SampledFit {
        SampledFit {
            sampling: Sampling::default(),
            force: Force::Linear,
            weights: Weights::Alike,
            higher: 1.0,
            tied: false,
            nonnegative: false,
            norm: Norm::Two,
            bounds: Vec::new(),
            starts: 4,
        }
    }
}
