//! A fit: its springs, their errors, and how the network answers to loads.

use super::load::LoadOutcome;
use crate::fit::Spread;
use crate::model::Network;
use crate::solve::{Ending, Stability, Standing};
use crate::study::fits::{FittedKind, NamedFit};
use crate::study::moduli::EffectiveModuli;
use crate::study::tensor::NetworkMaterial;

/// A fit with its network.
#[derive(Debug)]
pub struct FitOutcome {
    pub fit: NamedFit,
    pub network: Network,
    /// For the constants of all cells, without assembly.
    pub seconds: f64,
    pub seconds_assembly: f64,
    /// Cells whose springs the objective does not determine.
    pub deficient: usize,
    /// Cells whose iteration did not reach its end.
    pub unreached: usize,
    /// Cells that took over the constants of one of the same shape.
    pub reused: usize,
    /// Of the elements' matrices; `None` for whole-object fits, whose springs belong to no element.
    pub frobenius: Option<Spread>,
    pub spectral: Option<Spread>,
    /// What the network is as a material, from samples of its cells.
    pub as_material: NetworkMaterial,
    /// The moduli of the whole network, where the scene asks for them: under linear displacements of its boundary.
    pub moduli: Option<EffectiveModuli>,
    /// What only the kind of the fit knows.
    pub kind: FittedKind,
    /// With the support of the first load; `None` without loads.
    pub stability: Option<Stability>,
    /// Points that move in the softest motion, at least half as far as the one that moves most.
    pub loose_points: Vec<usize>,
    pub loads: Vec<LoadOutcome>,
}

impl FitOutcome {
    /// One word for the state of the network.
    pub fn status(&self) -> &'static str {
        let mut followed = self.loads.iter().filter_map(|load| load.followed).peekable();
        if followed.peek().is_some() {
            return if followed.all(|f| f.ending == Ending::Converged) { "converged" } else { "stalled" };
        }
        match self.stability.as_ref().map(|s| s.standing) {
            None => "fitted",
            Some(Standing::Stable) => "stable",
            Some(Standing::Soft) => "near-mechanism",
            Some(Standing::Indefinite) => "indefinite",
            Some(Standing::Singular) => "mechanism",
        }
    }
}
