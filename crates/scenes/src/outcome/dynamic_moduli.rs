//! Storage and loss moduli over frequency.

use nalgebra::Complex;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Storage and loss moduli of the models of a scene under harmonic stress, without inertia.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct DynamicModuliOutcome {
    /// The stress changes with these frequencies, Hz.
    pub frequency: Vec<f64>,
    /// The moduli of the material are those of its Prony series and of Rayleigh's β; they are null where the material is not the same in all cells, or
    /// springs have dampers.
    pub material: Option<DynamicModuli>,
    /// Each entry has the moduli of the finite elements, or of a network.
    pub models: Vec<DynamicModuliOfModel>,
}

/// The moduli of one model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct DynamicModuliOfModel {
    /// The model is the fit of this name, or `finite elements`.
    pub name: String,
    /// The moduli are null where the model has none.
    pub moduli: Option<DynamicModuli>,
    /// A sentence says why there are no moduli; it is null if there are.
    pub reason: Option<String>,
}

/// Moduli of tension, shear and bulk.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct DynamicModuli {
    /// Young's modulus is the stress of a tension over its strain, with free sides, in Pa, mean over the axes; in plane strain it is that of the plane.
    pub young: ComplexModulus,
    /// The shear modulus is the stress of a shear over its angle, in Pa, mean over pairs of axes.
    pub shear: ComplexModulus,
    /// The bulk modulus is an even pressure over the loss of volume, in Pa; it is null in the plane.
    pub bulk: Option<ComplexModulus>,
}

/// A modulus at each frequency.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct ComplexModulus {
    /// The storage modulus, in phase with the strain, is in Pa.
    pub storage: Vec<f64>,
    /// The loss modulus, a quarter of a period ahead of the strain, is in Pa.
    pub loss: Vec<f64>,
}

impl ComplexModulus {
    /// Adds the modulus at the next frequency, with its real and its imaginary part.
    pub fn add(&mut self, modulus: Complex<f64>) {
        self.storage.push(modulus.re);
        self.loss.push(modulus.im);
    }
}
