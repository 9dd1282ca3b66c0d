//! The springs on content of an exact network, whose tensions may change.

use crate::error::{Error, ErrorKind, Result};
use crate::mesh::Mesh;
use crate::model::{MeasureSpring, Network};
use crate::springs::Measure;
use crate::stiffness::gathered;

/// The largest relative difference between the force of a law at rest and minus its first parameter.
const ROUNDING: f64 = 1e-12;

/// The springs on content, which push at rest.
#[derive(Debug, Clone, Default)]
pub(super) struct Contents {
    /// Their indices in the network.
    pub places: Vec<usize>,
    /// Their measures at rest.
    pub rests: Vec<f64>,
    /// Their gradients at rest, `[points × dimension]` each.
    pub gradients: Vec<Vec<f64>>,
}

impl Contents {
    /// The springs on content of the network.
    ///
    /// # Errors
    /// A spring has a law that belongs to no exact energy; the kind is `Unsupported`.
    pub fn new(mesh: &Mesh, network: &Network) -> Result<Contents> {
        let mut contents = Contents::default();
        for (place, spring) in network.others.iter().enumerate() {
            let x = positions(mesh, spring);
            let c = spring.measure.value(&x, mesh.dimension);
            let tension = spring.tension(c);
            let is_content = match spring.measure {
                Measure::Content(_) | Measure::PointContent(..) | Measure::Function(_) => true,
                Measure::Length | Measure::Patch(_) | Measure::Span(_) | Measure::Turns(_) | Measure::Squares(_) => {
                    false
                }
            };
            // Springs that do not push at rest, such as those that carry λ alone, have no part in the shear modulus and
            // keep their tension.
            if !is_content || tension >= 0.0 {
                continue;
            }
            let is_known = spring.law.as_ref().is_none_or(|own| {
                own.law.parameters.first().is_some_and(|name| name == "a")
                    && (tension + own.parameters[0]).abs() <= -ROUNDING * tension
            });
            if !is_known {
                let expected = "springs on content whose law at rest is minus its parameter a";
                let found = spring.law.as_ref().map_or("", |own| &own.law.text);
                return Err(Error::expected("nonnegative", expected, found).of_kind(ErrorKind::Unsupported));
            }
            contents.places.push(place);
            contents.rests.push(c);
            contents.gradients.push(spring.measure.gradient(&x, mesh.dimension));
        }
        Ok(contents)
    }

    /// The change of twice the energy of small displacements u per unit of additional tension, with λ unchanged:
    /// `uᵀ H u − (g·u)²/c`.
    pub fn energies(&self, mesh: &Mesh, network: &Network, u: &[f64]) -> Vec<f64> {
        let energy = |(place, rest): (&usize, &f64)| {
            let spring = &network.others[*place];
            let jet = spring.measure.jet(&positions(mesh, spring), mesh.dimension);
            let local = gathered(u, mesh.dimension, &spring.points);
            let along: f64 = jet.gradient.iter().zip(&local).map(|(g, u)| g * u).sum();
            let rows = jet.hessian.chunks_exact(local.len()).zip(&local);
            let bend: f64 = rows.map(|(row, u)| u * row.iter().zip(&local).map(|(h, u)| h * u).sum::<f64>()).sum();
            bend - along * along / rest
        };
        self.places.iter().zip(&self.rests).map(energy).collect()
    }
}

/// The spring with `more` additional tension at rest, where it measures c, and the same λ; `None` if its stiffness is
/// not positive.
pub(super) fn tightened(spring: &MeasureSpring, c: f64, more: f64) -> Option<MeasureSpring> {
    let mut spring = spring.clone();
    let tension = spring.tension(c) + more;
    match &mut spring.law {
        None => {
            // T = −μ V/c, and the constant is (μ + λ) V/c², with V the content: λ is unchanged.
            spring.constant -= more / c;
            spring.rest = c - tension / spring.constant;
        }
        Some(law) => {
            law.parameters[0] -= more;
            spring.constant = law.slope(c, spring.rest);
        }
    }
    (spring.constant > 0.0 && spring.constant.is_finite()).then_some(spring)
}

/// The positions of the points of the spring, `[points × dimension]`.
pub(super) fn positions(mesh: &Mesh, spring: &MeasureSpring) -> Vec<f64> {
    gathered(&mesh.points, mesh.dimension, &spring.points)
}
