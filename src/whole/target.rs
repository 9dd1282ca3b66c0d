//! What a whole-object fit is to meet.

use crate::model::Support;

/// A load and how the object moves under it.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    pub name: String,
    pub support: Support,
    /// `[points · dimension]`, N.
    pub forces: Vec<f64>,
    /// Of the finite elements, or measured; `[points · dimension]`, m.
    pub displacement: Vec<f64>,
    /// W, of each degree of freedom: zero where the displacement is not known.
    pub weights: Vec<f64>,
    /// w_l.
    pub weight: f64,
}

/// Natural frequencies to be met.
#[derive(Debug, Clone, PartialEq)]
pub struct Frequencies {
    pub support: Support,
    /// `[points]`, kg.
    pub masses: Vec<f64>,
    /// ω², rad²/s², ascending.
    pub squares: Vec<f64>,
    /// w_ω.
    pub weight: f64,
}

impl Target {
    /// `‖ū_l‖²_W`.
    pub(super) fn size(&self) -> f64 {
        self.displacement.iter().zip(&self.weights).map(|(u, w)| w * u * u).sum()
    }

    /// `√(w_l W)/‖ū_l‖_W`.
    pub(super) fn scale(&self) -> Vec<f64> {
        let factor = self.weight / self.size();
        self.weights.iter().map(|w| (factor * w).sqrt()).collect()
    }
}
