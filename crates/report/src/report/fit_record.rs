//! Fits in `report.json`.

use super::verdict::verdict;
use crate::fit::Spread;
use crate::fit::published::Unmet;
use crate::number::finite;
use crate::positive::PositiveOutcome;
use crate::study::{
    EngineOutcome, FitOutcome, FitTimes, KindRecord, LoadOutcome, ModelTimes, NetworkMaterial, Outcome, SampledOutcome,
    TensionOutcome, WholeOutcome,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A fit: the settings of its kind, its network and its errors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FitRecord {
    /// The kind of fit with its settings.
    #[serde(flatten)]
    pub kind: KindRecord,
    /// Tables and files call the fit by this name.
    pub name: String,
    /// These spring groups are used; the list is null if they are all that are not optional.
    pub groups: Option<Vec<String>>,
    /// The network is `fitted`, `stable`, `near-mechanism`, `indefinite` or a `mechanism`; at large deformation it is `converged` or
    /// `stalled`.
    pub status: String,
    /// What must be known first of the network: `not trusted`, its status where that is not well, `inverted cells`, `not the optimum`, `locks`,
    /// `too stiff`, `not the material` with the percentage, or its status.
    #[serde(default)]
    pub verdict: String,
    /// The network has this number of springs.
    pub springs: usize,
    /// The constants of all elements took this processor time in s without assembly, in the pass that made them.
    pub seconds: f64,
    /// The constants of each element that was fitted took this processor time in s: the median of repeated passes with `time = true` in
    /// `[output]`, otherwise that of the pass that made them. Elements that have the constants of another do not count.
    pub seconds_per_element: f64,
    /// The sum of the springs of the cells into the network took this processor time in s, in the same pass.
    pub seconds_assembly: f64,
    /// This number of elements was fitted; the others have the constants of one of them.
    #[serde(default)]
    pub fitted_elements: usize,
    /// `times` has what the fit costs on one thread, repeated; it is null without `time = true` in `[output]`.
    #[serde(default)]
    pub times: Option<FitTimes>,
    /// `model_times` has what the network costs on one thread, repeated; it is null without `time = true` in `[output]`.
    #[serde(default)]
    pub model_times: Option<ModelTimes>,
    /// The elements have these errors `‖R − K‖/‖R‖` in the Frobenius norm; they are null where springs belong to no single element.
    pub relative_frobenius: Spread,
    /// The elements have these errors `‖R − K‖/‖R‖` in the induced 2-norm; they are null where springs belong to no single element.
    pub relative_spectral: Spread,
    /// This number of springs has a constant below zero.
    pub negative_springs: usize,
    /// This number of elements has springs that are linearly dependent; the optimum of least norm is used.
    pub undetermined_elements: usize,
    /// The energy of the network is between these multiples of that of the body. For exact networks with volume springs on patches, or on
    /// cells that have several quadrature points, the body is one that does not lock: λ is at most 2 μ. Where moduli are found from
    /// measured displacements, it has those of the scene times the least factor.
    pub energy_ratio: Option<[Option<f64>; 2]>,
    /// These points, from 0, move most in the softest motion.
    pub loose_nodes: Vec<usize>,
    /// The relative duality gap is at most this.
    pub certificate_gap: Option<f64>,
    /// This number of elements has the constants of another of the same shape.
    pub reused_elements: usize,
    /// This number of elements has an optimum that is not unique.
    pub ambiguous_elements: usize,
    /// This number of elements has an iteration that stopped short of the optimum.
    pub unreached_elements: usize,
    /// The relative error of the energy of the whole body is at most this in every motion, from the worst element; it is null where there
    /// is no bound.
    pub energy_error_bound: Option<f64>,
    /// `as_material` has what the network is as a material, at rest.
    pub as_material: NetworkMaterial,
    /// The whole network has this Young's modulus in Pa, if the scene asks for `moduli`. In plane strain it is that of the solid.
    pub effective_young: Option<f64>,
    /// The whole network has this Poisson's ratio, if the scene asks for `moduli`. In plane strain it is that of the solid.
    pub effective_poisson: Option<f64>,
    /// The whole network has Zener's ratio of anisotropy, if the scene asks for `moduli`.
    pub zener: Option<f64>,
    /// Each entry has the errors under a load.
    pub loads: Vec<LoadOutcome>,
    /// `engine` has what the network answers in the engine that its constants are for; it is null where equations are solved to the end.
    pub engine: Option<EngineOutcome>,
    /// `unmet` has the assumptions of a published formula that the body violates; it is null with others.
    pub unmet: Option<Unmet>,
    /// `whole` has the outcome of a whole-object fit; it is null with others.
    pub whole: Option<WholeOutcome>,
    /// `sampled` has the outcome of a sampled fit; it is null with others.
    pub sampled: Option<SampledOutcome>,
    /// `positive` has the outcome of an exact network that was to have no negative springs; it is null with others.
    pub positive: Option<PositiveOutcome>,
    /// `tension` has the outcome of a fit with rest measures of its own; it is null with others.
    pub tension: Option<TensionOutcome>,
}

impl FitRecord {
    /// The name, with the status of a network that does not stand: figures and tables by themselves say it there.
    pub(super) fn marked(&self) -> String {
        match ["fitted", "stable", "converged"].contains(&&*self.status) {
            true => self.name.clone(),
            false => format!("{} ({})", self.name, self.status),
        }
    }
}

impl FitRecord {
    /// Makes the record of a fit of a run.
    pub(super) fn of(run: &Outcome, outcome: &FitOutcome) -> FitRecord {
        let elements = run.mesh.cell_count();
        // It is none if the thicknesses of the elements differ.
        let thickness = run.material.thicknesses().uniform().copied();
        let certificate = outcome.kind.stiffness();
        let moduli = outcome.moduli.as_ref();
        FitRecord {
            kind: outcome.fit.recipe.kind().record(),
            name: outcome.fit.name.clone(),
            groups: outcome.fit.springs.clone(),
            status: outcome.status().into(),
            verdict: verdict(run, outcome),
            springs: outcome.network.len(),
            seconds: outcome.seconds,
            seconds_per_element: outcome.seconds_per_element(elements),
            seconds_assembly: outcome.seconds_assembly,
            fitted_elements: elements.saturating_sub(outcome.reused),
            times: outcome.times.clone(),
            model_times: outcome.model_times.clone(),
            relative_frobenius: outcome.frobenius().unwrap_or(Spread::UNKNOWN),
            relative_spectral: outcome.spectral().unwrap_or(Spread::UNKNOWN),
            negative_springs: outcome.network.negative(),
            undetermined_elements: outcome.deficient,
            energy_ratio: outcome.stability.as_ref().map(|stability| stability.energy_ratio.map(finite)),
            loose_nodes: outcome.loose_points.clone(),
            certificate_gap: certificate.and_then(|certificate| certificate.gap),
            reused_elements: outcome.reused,
            ambiguous_elements: certificate.map_or(0, |certificate| certificate.ambiguous),
            unreached_elements: outcome.unreached,
            energy_error_bound: certificate.and_then(|certificate| certificate.energy_error),
            as_material: outcome.as_material.clone(),
            effective_young: moduli.and_then(|moduli| finite(moduli.young / thickness?)),
            effective_poisson: moduli.and_then(|moduli| finite(moduli.poisson)),
            zener: moduli.and_then(|moduli| finite(moduli.zener)),
            loads: outcome.loads.clone(),
            engine: outcome.engine.clone(),
            unmet: outcome.kind.published().map(|published| published.unmet),
            whole: outcome.kind.whole().cloned(),
            sampled: outcome.kind.sampled().cloned(),
            positive: outcome.kind.exact().and_then(|exact| exact.positive),
            tension: certificate.and_then(|outcome| outcome.tension),
        }
    }
}
