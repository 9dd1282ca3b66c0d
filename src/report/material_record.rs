//! What a network is as a material, in `report.json`.

use crate::number::finite;
use crate::study::NetworkMaterial;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a network is as a material, from samples of its cells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NetworkMaterialRecord {
    /// The harmonic mean of Young's modulus over all directions is in Pa; it is null if some strain meets no resistance.
    pub young: Option<f64>,
    /// The mean of Poisson's ratio over all directions is null as `young` is, and for a rod.
    pub poisson: Option<f64>,
    /// The material has this Young's modulus in Pa. Where it differs from cell to cell, it is that of the finite elements of the samples,
    /// to which `young` belongs.
    pub asked_young: Option<f64>,
    /// The material has this Poisson's ratio. Where it differs from cell to cell, it is that of the finite elements of the samples, to
    /// which `poisson` belongs.
    pub asked_poisson: Option<f64>,
    /// The elasticity tensors have the distance `‖C − C₀‖/‖C₀‖`, root mean square over the samples; it is null where it is not finite.
    pub tensor_distance: Option<f64>,
    /// The mean of the samples' tensors has this distance.
    pub mean_tensor_distance: Option<f64>,
    /// The worst sample has this distance.
    pub largest_tensor_distance: Option<f64>,
    /// The mean of the samples' tensors is in Kelvin's notation, Pa; it is times the thickness in the plane, and times the cross-section
    /// for a rod. Rows are those of the stresses xx, yy, (zz,) √2 xy, (√2 xz, √2 yz).
    pub stiffness: Vec<Vec<Option<f64>>>,
    /// This number of cells or patches was measured.
    pub samples: usize,
    /// The computation took this time in s.
    pub seconds: f64,
}

impl NetworkMaterialRecord {
    pub(super) fn of(material: &NetworkMaterial) -> NetworkMaterialRecord {
        let row = |i: usize| material.stiffness.row(i).iter().map(|c| finite(*c)).collect();
        NetworkMaterialRecord {
            young: material.young,
            poisson: material.poisson,
            asked_young: material.asked_young,
            asked_poisson: material.asked_poisson,
            tensor_distance: finite(material.distance),
            mean_tensor_distance: finite(material.mean_distance),
            largest_tensor_distance: finite(material.largest_distance),
            stiffness: (0..material.stiffness.nrows()).map(row).collect(),
            samples: material.samples,
            seconds: material.seconds,
        }
    }
}
