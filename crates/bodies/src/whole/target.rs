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
    /// Known everywhere alike.
    pub fn new(name: String, support: Support, forces: Vec<f64>, displacement: Vec<f64>) -> Target {
        let weights = vec![1.0; displacement.len()];
        Target { name, support, forces, displacement, weights, weight: 1.0 }
    }

    /// `√(w_l W)/‖ū_l‖_W`; `None` where nothing that is free to move is known to.
    pub(super) fn scale(&self) -> Option<Vec<f64>> {
        let known = || self.displacement.iter().zip(&self.weights).map(|(u, w)| w.sqrt() * u);
        // Its square may be beyond the range of numbers.
        let largest = known().fold(0.0, |a: f64, u| a.max(u.abs()));
        let size = largest * known().map(|u| (u / largest).powi(2)).sum::<f64>().sqrt();
        let free = self.weights.iter().zip(&self.support.prescribed).any(|(w, p)| *w > 0.0 && p.is_none());
        let scale = |w: &f64| self.weight.sqrt() / size * w.sqrt();
        (free && size > 0.0 && size.is_finite()).then(|| self.weights.iter().map(scale).collect())
    }
}
