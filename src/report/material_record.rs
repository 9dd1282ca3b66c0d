//! What a network is as a material, in `report.json`.

use super::number::finite;
use crate::study::NetworkMaterial;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a network is as a material, from samples of its cells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NetworkMaterialRecord {
    /// Young's modulus, Pa, harmonic mean over all directions; null where some strain meets no resistance.
    pub young: Option<f64>,
    /// Poisson's ratio, mean over all directions; null as `young`, and of a rod.
    pub poisson: Option<f64>,
    /// Young's modulus of the material there, Pa, as `young`: where it differs from cell to cell that of the finite elements of the samples.
    pub asked_young: Option<f64>,
    /// Poisson's ratio of the material there, as `poisson`.
    pub asked_poisson: Option<f64>,
    /// `‖C − C₀‖/‖C₀‖` of the elasticity tensors, root mean square over the samples; null where it is not finite.
    pub tensor_distance: Option<f64>,
    /// The same of the mean of the samples' tensors.
    pub mean_tensor_distance: Option<f64>,
    /// The same of the worst sample.
    pub largest_tensor_distance: Option<f64>,
    /// The mean of the samples' tensors, in Kelvin's notation, Pa; in the plane times the thickness, of a rod times its
    /// cross-section. Rows of the stresses xx, yy, (zz,) √2 xy, (√2 xz, √2 yz).
    pub stiffness: Vec<Vec<Option<f64>>>,
    /// Cells or patches that were measured.
    pub samples: usize,
    /// For this.
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
