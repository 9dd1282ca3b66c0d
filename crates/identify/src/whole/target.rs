//! The loads and frequencies that a whole-object fit should reproduce.

use crate::model::Support;

/// A load, and the displacements of the object under it.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// The name in reports.
    pub name: String,
    /// The support.
    pub support: Support,
    /// The forces, `[points · dimension]`, N.
    pub forces: Vec<f64>,
    /// The displacements of the finite elements or of a measurement, `[points · dimension]`, m.
    pub displacement: Vec<f64>,
    /// The weights W of the degrees of freedom, `[points · dimension]`; zero where the displacement is not known.
    pub weights: Vec<f64>,
    /// The weight w_l of the load.
    pub weight: f64,
    /// Whether the weight stays where those of others fall with their errors, see [`Balanced`](super::Balanced).
    pub is_firm: bool,
    /// Whether the load was made from the mesh, and may be left out where the network has no equilibrium under it.
    pub is_made: bool,
}

/// Natural frequencies that the network should have.
#[derive(Debug, Clone, PartialEq)]
pub struct Frequencies {
    /// The support.
    pub support: Support,
    /// The masses, `[points]`, kg.
    pub masses: Vec<f64>,
    /// The squares ω², rad²/s², ascending.
    pub squares: Vec<f64>,
    /// The weight w_ω.
    pub weight: f64,
}

impl Target {
    /// A load with displacements that are known everywhere with equal weight.
    pub fn new(name: String, support: Support, forces: Vec<f64>, displacement: Vec<f64>) -> Target {
        let weights = vec![1.0; displacement.len()];
        Target { name, support, forces, displacement, weights, weight: 1.0, is_firm: false, is_made: false }
    }

    /// `√(w_l W)/‖ū_l‖_W`; `None` if no displacement is known that is free to change.
    pub fn scale(&self) -> Option<Vec<f64>> {
        let known = || self.displacement.iter().zip(&self.weights).map(|(u, w)| w.sqrt() * u);
        // The square may overflow.
        let largest = known().fold(0.0, |a: f64, u| a.max(u.abs()));
        let size = largest * known().map(|u| (u / largest).powi(2)).sum::<f64>().sqrt();
        let free = self.weights.iter().zip(&self.support.prescribed).any(|(w, p)| *w > 0.0 && p.is_none());
        let scale = |w: &f64| self.weight.sqrt() / size * w.sqrt();
        // Without any displacement the size is 0/0, and NaN is refused as well.
        (free && size > 0.0 && size.is_finite()).then(|| self.weights.iter().map(scale).collect())
    }
}
