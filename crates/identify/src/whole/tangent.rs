//! How the displacements under loads change with the factors on the parts of a model.
//!
//! Theory: page *Whole-object fits* of the book.

use crate::engine::Truncated;
use crate::error::Result;
use crate::model::PartVectors;
use crate::solve::Equations;

/// The loads whose displacements change by the same equations.
#[derive(Debug)]
pub(super) enum Tangent {
    /// At an equilibrium, `∂u_l/∂c_s = −K⁻¹ F_sl`.
    Equilibrium {
        equations: Equations,
        /// The index of each load, and its F_sl.
        loads: Vec<(usize, PartVectors)>,
    },
    /// At rest in an engine that ends its sweeps early.
    Engine {
        truncated: Box<Truncated>,
        loads: Vec<usize>,
        /// The prediction y of each load.
        predictions: Vec<Vec<f64>>,
        /// The factors c on the springs.
        factors: Vec<f64>,
    },
}

impl Tangent {
    /// The index of each load.
    pub fn loads(&self) -> Box<dyn Iterator<Item = usize> + '_> {
        match self {
            Tangent::Equilibrium { loads, .. } => Box::new(loads.iter().map(|(load, _)| *load)),
            Tangent::Engine { loads, .. } => Box::new(loads.iter().copied()),
        }
    }

    /// The changes of the displacements of each load where the factors change by `change`, `[parts]`.
    pub fn moves(&self, change: &[f64], tolerance: f64) -> Result<Vec<Vec<f64>>> {
        match self {
            Tangent::Equilibrium { equations, loads } => {
                let force =
                    |(_, forces): &(usize, PartVectors)| forces.sum(change.iter().map(|c| -c), equations.degrees());
                equations.respond_all(&loads.iter().map(force).collect::<Vec<_>>(), tolerance)
            }
            Tangent::Engine { truncated, predictions, factors, .. } => {
                // An engine takes changes of the logarithms of constants.
                let relative: Vec<f64> = change.iter().zip(factors).map(|(change, factor)| change / factor).collect();
                truncated.changes(predictions, &relative, tolerance)
            }
        }
    }

    /// `Σ_l w_l·∂u_l/∂c_s` of each part, for the weights w_l of the displacements of each load.
    pub fn pulled(&self, weights: &[Vec<f64>], tolerance: f64) -> Result<Vec<f64>> {
        match self {
            Tangent::Equilibrium { equations, loads } => {
                let adjoints = equations.respond_all(weights, tolerance)?;
                let mut total = Vec::new();
                for ((_, forces), adjoint) in loads.iter().zip(&adjoints) {
                    let own = forces.along(adjoint);
                    if total.is_empty() {
                        total = own.map(|along| -along).collect();
                    } else {
                        total.iter_mut().zip(own).for_each(|(t, along)| *t -= along);
                    }
                }
                Ok(total)
            }
            Tangent::Engine { truncated, predictions, factors, .. } => {
                let relative = truncated.gradient(predictions, weights, tolerance)?;
                Ok(relative.iter().zip(factors).map(|(slope, factor)| slope / factor).collect())
            }
        }
    }
}
