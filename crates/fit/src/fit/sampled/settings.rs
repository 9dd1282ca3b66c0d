//! The settings of a fit to forces.

use super::objective::ResidualObjective;
use super::sampling::Sampling;
use crate::fit::regression::Norm;
use crate::springs::Force;

/// The weight of each shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Weights {
    /// All shapes have the same weight.
    #[default]
    Alike,
    /// `1/‖f‖²`: the error of each shape is relative to its own force.
    Relative,
}

crate::named!(Weights { "none" => Alike, "relative" => Relative });

/// The settings of a fit to forces.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledFit {
    /// The deformed shapes.
    pub sampling: Sampling,
    /// Further sets of shapes. Each set counts by its weight, however many shapes it has.
    pub beside: Vec<Sampling>,
    /// The force law of the springs.
    pub force: Force,
    /// The weights of the shapes.
    pub weights: Weights,
    /// The scale, from 0 to 1, of the forces that do no work on homogeneous deformations of the cell. The others have
    /// the scale 1.
    pub higher: f64,
    /// Whether all springs of a group have the same parameters.
    pub tied: bool,
    /// Whether no parameter may be negative. Springs with rest measures of their own never have negative constants.
    pub nonnegative: bool,
    /// The norm of the residual forces. Laws that are not linear in their parameters allow only `Norm::Two`.
    pub norm: Norm,
    /// What is minimised in place of a norm of the residual forces, for laws that are linear in their parameters.
    pub objective: Option<ResidualObjective>,
    /// Lower and upper bounds of parameters of the laws, by name.
    pub bounds: Vec<(String, [f64; 2])>,
    /// The number of starts of the search, for laws that are not linear in their parameters.
    pub starts: usize,
    /// Whether the error of each shape and the end of each start are kept, of one cell of each shape.
    pub data: bool,
}

impl SampledFit {
    /// All sets of shapes.
    pub fn sets(&self) -> impl Iterator<Item = &Sampling> {
        std::iter::once(&self.sampling).chain(&self.beside)
    }
}

impl Default for SampledFit {
    fn default() -> SampledFit {
        SampledFit {
            sampling: Sampling::default(),
            beside: Vec::new(),
            force: Force::Linear,
            weights: Weights::Alike,
            higher: 1.0,
            tied: false,
            nonnegative: false,
            norm: Norm::Two,
            objective: None,
            bounds: Vec::new(),
            starts: 4,
            data: false,
        }
    }
}
