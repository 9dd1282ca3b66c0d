//! The results of a fit: its springs, their errors, and the response of the network to loads.

use super::load::LoadOutcome;
use crate::analysis::moduli::EffectiveModuli;
use crate::analysis::tensor::NetworkMaterial;
use crate::fit::Spread;
use crate::fits::{EngineOutcome, FittedKind, NamedFit};
use crate::mesh::Mesh;
use crate::model::Network;
use crate::solve::{Ending, Stability, Standing};
use crate::springs::Springs;
use crate::timing::{FitTimes, ModelTimes};
use std::sync::OnceLock;

/// The relative errors `‖R − K‖/‖R‖` of the elements' matrices.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MatrixErrors {
    /// In the Frobenius norm; `None` where springs belong to no single element.
    pub frobenius: Option<Spread>,
    /// In the induced 2-norm.
    pub spectral: Option<Spread>,
}

/// A fit with its network and its errors.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct FitOutcome {
    /// The fit.
    pub fit: NamedFit,
    /// The springs of each block of cells, with their groups.
    pub springs: Vec<Springs>,
    /// The network.
    pub network: Network,
    /// The processor time for the constants of all cells without assembly, s, in the one pass that made them.
    pub seconds: f64,
    /// The processor time of the assembly, s, in the same pass.
    pub seconds_assembly: f64,
    /// The costs of the fit, repeated on one thread, if the scene asks for them.
    pub times: Option<FitTimes>,
    /// The costs of the network, if the scene asks for them.
    pub model_times: Option<ModelTimes>,
    /// The number of cells whose springs the objective does not determine.
    pub deficient: usize,
    /// The number of cells whose iteration did not converge.
    pub unreached: usize,
    /// The number of cells that received the constants of a congruent cell.
    pub reused: usize,
    /// The relative errors of the elements' matrices, once they are computed.
    pub errors: OnceLock<MatrixErrors>,
    /// What [`Network::unbalanced`] gives in the mesh, once it is computed.
    pub unbalanced: OnceLock<f64>,
    /// The network as a material, from samples of its cells.
    pub as_material: NetworkMaterial,
    /// The moduli of the whole network under linear displacements of its boundary, in plane strain those of the solid, if the scene
    /// requests them.
    pub moduli: Option<EffectiveModuli>,
    /// What the network answers in the engine that its constants are for; `None` where equations are solved to the end.
    pub engine: Option<EngineOutcome>,
    /// The results that only the kind of the fit has.
    pub kind: FittedKind,
    /// The stability with the support of the first load; `None` without loads.
    pub stability: Option<Stability>,
    /// The points whose displacement in the softest motion is at least half of the largest.
    pub loose_points: Vec<usize>,
    /// The results under the loads, in their order.
    pub loads: Vec<LoadOutcome>,
}

impl FitOutcome {
    /// The relative errors of the elements' matrices in the Frobenius norm; `None` if they were not computed, and where springs
    /// belong to no single element, such as those of whole-object fits.
    pub fn frobenius(&self) -> Option<Spread> {
        self.errors.get()?.frobenius
    }

    /// The relative errors of the elements in the induced 2-norm, as mean and maximum; `None` if they are not computed.
    pub fn spectral(&self) -> Option<Spread> {
        self.errors.get()?.spectral
    }

    /// The share of the largest pull that is left at some point of the mesh, where the fit was made, without a load.
    pub fn unbalanced(&self, mesh: &Mesh) -> f64 {
        *self.unbalanced.get_or_init(|| self.network.unbalanced(&mesh.points))
    }

    /// The masses of the network, `[points]`, kg, if they were fitted.
    pub fn masses(&self) -> Option<&[f64]> {
        self.kind.whole()?.masses.as_ref().map(|found| &found.masses[..])
    }

    /// The processor time for the constants of each cell of `cells` that was fitted, s: the median of repeated passes where there are
    /// some, otherwise that of the one pass that made them.
    pub fn seconds_per_element(&self, cells: usize) -> f64 {
        let of_one_pass = || self.seconds / cells.saturating_sub(self.reused).max(1) as f64;
        self.times.as_ref().map_or_else(of_one_pass, |times| times.element.median)
    }

    /// One word for the state of the network.
    pub fn status(&self) -> &'static str {
        let mut followed = self.loads.iter().filter_map(|load| load.followed).peekable();
        if followed.peek().is_some() {
            return if followed.all(|f| f.ending == Ending::Converged) { "converged" } else { "stalled" };
        }
        self.stability.as_ref().map_or("fitted", |stability| standing_word(stability.standing))
    }
}

/// The word for how a network stands in [`FitOutcome::status`].
pub fn standing_word(standing: Standing) -> &'static str {
    match standing {
        Standing::Stable => "stable",
        Standing::Soft => "near-mechanism",
        Standing::Indefinite => "indefinite",
        Standing::Singular => "mechanism",
    }
}
