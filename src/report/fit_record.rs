//! Fits in `report.json`.

use super::load_record::LoadRecord;
use super::material_record::NetworkMaterialRecord;
use super::number::finite;
use crate::study::{
    FitOutcome, KindRecord, PositiveRecord, PublishedOutcomeRecord, SampledOutcomeRecord, SpreadRecord, TensionRecord,
    WholeOutcomeRecord,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A fit: the settings of its kind, its network and its errors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FitRecord {
    /// The kind of fit with its settings.
    #[serde(flatten)]
    pub kind: KindRecord,
    /// The name in tables and files.
    pub name: String,
    /// The spring groups, if not all that are not optional.
    pub groups: Option<Vec<String>>,
    /// `fitted`, `stable`, `near-mechanism`, `indefinite` or `mechanism`; at large deformation `converged` or `stalled`.
    pub status: String,
    /// The number of springs of the network.
    pub springs: usize,
    /// For the constants, without assembly.
    pub seconds: f64,
    /// Time of the fit for each element, s.
    pub seconds_per_element: f64,
    /// Time to sum the springs of the cells into the network, s.
    pub seconds_assembly: f64,
    /// `‖R − K‖/‖R‖` of the elements; null for whole-object fits.
    pub relative_frobenius: SpreadRecord,
    /// `‖R − K‖/‖R‖` in the induced 2-norm over the elements.
    pub relative_spectral: SpreadRecord,
    /// Springs with a constant below zero.
    pub negative_springs: usize,
    /// Elements whose equations do not determine all constants.
    pub undetermined_elements: usize,
    /// The least and the largest energy of the network over the body's; of exact networks with volume springs on patches, or on
    /// cells of several quadrature points, over that of finite elements with λ at most 2 μ, which do not lock.
    pub energy_ratio: Option<[Option<f64>; 2]>,
    /// Points that move most in the softest motion, from 0.
    pub loose_nodes: Vec<usize>,
    /// The largest relative duality gap.
    pub certificate_gap: Option<f64>,
    /// Elements with the constants of another of the same shape.
    pub reused_elements: usize,
    /// Elements whose optimum is not unique.
    pub ambiguous_elements: usize,
    /// Elements whose iteration stopped short of the optimum.
    pub unreached_elements: usize,
    /// A bound of the error of the energy of every motion, from the worst element; null where there is none.
    pub energy_error_bound: Option<f64>,
    /// What the network is as a material, at rest.
    pub as_material: NetworkMaterialRecord,
    /// Of the whole network, where the scene asks for `moduli`; Pa. In plane strain that of the solid.
    pub effective_young: Option<f64>,
    /// Poisson's ratio of the network where it was measured (`[output] moduli`).
    pub effective_poisson: Option<f64>,
    /// Zener's ratio of anisotropy where it was measured.
    pub zener: Option<f64>,
    /// The errors under each load.
    pub loads: Vec<LoadRecord>,
    /// Of a published method.
    pub unmet: Option<PublishedOutcomeRecord>,
    /// Of a whole-object fit.
    pub whole: Option<WholeOutcomeRecord>,
    /// Of a sampled fit.
    pub sampled: Option<SampledOutcomeRecord>,
    /// Of an exact network that was to have no negative springs.
    pub positive: Option<PositiveRecord>,
    /// Of a fit with rest measures of its own.
    pub tension: Option<TensionRecord>,
}

impl FitRecord {
    /// Of a body of `elements` elements of this thickness, if they have the same.
    pub(super) fn of(outcome: &FitOutcome, elements: usize, thickness: Option<f64>) -> FitRecord {
        let certificate = outcome.kind.stiffness();
        let moduli = outcome.moduli.as_ref();
        FitRecord {
            kind: outcome.fit.recipe.kind().record(),
            name: outcome.fit.name.clone(),
            groups: outcome.fit.springs.clone(),
            status: outcome.status().into(),
            springs: outcome.network.len(),
            seconds: outcome.seconds,
            seconds_per_element: outcome.seconds / elements.max(1) as f64,
            seconds_assembly: outcome.seconds_assembly,
            relative_frobenius: outcome.frobenius().into(),
            relative_spectral: outcome.spectral().into(),
            negative_springs: outcome.network.negative(),
            undetermined_elements: outcome.deficient,
            energy_ratio: outcome.stability.as_ref().map(|stability| stability.energy_ratio.map(finite)),
            loose_nodes: outcome.loose_points.clone(),
            certificate_gap: certificate.and_then(|certificate| certificate.gap),
            reused_elements: outcome.reused,
            ambiguous_elements: certificate.map_or(0, |certificate| certificate.ambiguous),
            unreached_elements: outcome.unreached,
            energy_error_bound: certificate.and_then(|certificate| certificate.energy_error),
            as_material: NetworkMaterialRecord::of(&outcome.as_material),
            effective_young: moduli.and_then(|moduli| finite(moduli.young / thickness?)),
            effective_poisson: moduli.and_then(|moduli| finite(moduli.poisson)),
            zener: moduli.and_then(|moduli| finite(moduli.zener)),
            loads: outcome.loads.iter().map(LoadRecord::from).collect(),
            unmet: outcome.kind.published().map(|published| PublishedOutcomeRecord::of(&published.unmet)),
            whole: outcome.kind.whole().map(WholeOutcomeRecord::of),
            sampled: outcome.kind.sampled().map(SampledOutcomeRecord::of),
            positive: outcome.kind.exact().and_then(|exact| exact.positive.as_ref()).map(PositiveRecord::of),
            tension: certificate.and_then(|outcome| outcome.tension.as_ref()).map(TensionRecord::from),
        }
    }
}
