//! What a fit minimises, stated once: a measure of `R − K(k)`, `K(k) = Σ_s k_s g_s g_sᵀ`, seen through a weight.

use crate::error::{Error, Result};

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Objective {
    /// `‖W (R − K) W‖_F`: normal equations.
    Frobenius(Weight),
}

/// How much each part of `R − K` counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Weight {
    /// All entries alike.
    None,
    /// The blocks of different nodes only; with length springs alone, `k_s = −nᵀ R_ij n`.
    OffDiagonal,
    /// `W = C Cᵀ + higher · H Hᵀ`: C an orthonormal basis of the constant-strain motions, H of all other deformations.
    Modal { higher: f64 },
}

impl Objective {
    pub const NAMES: [&'static str; 3] = ["frobenius", "offdiag", "modal"];
    /// The scale of the higher modes where none is given; chosen by the study in the README.
    pub const DEFAULT_HIGHER: f64 = 0.316;

    /// The objective called `name`; `higher` belongs to `modal`.
    ///
    /// # Errors
    /// The name is unknown, or `higher` is not in (0, 1] or given to another objective.
    pub fn named(name: &str, higher: Option<f64>) -> Result<Objective> {
        let weight = match name {
            "frobenius" => Weight::None,
            "offdiag" => Weight::OffDiagonal,
            "modal" => Weight::Modal { higher: higher.unwrap_or(Objective::DEFAULT_HIGHER) },
            _ => {
                let expected = format!("one of {}", Objective::NAMES.join(", "));
                return Err(Error::expected("objective", expected, format!("\"{name}\"")));
            }
        };
        match (weight, higher) {
            (Weight::Modal { higher }, _) if !(higher > 0.0 && higher <= 1.0) => {
                Err(Error::expected("higher", "a scale above 0 and at most 1", higher))
            }
            (Weight::None | Weight::OffDiagonal, Some(_)) => {
                Err(Error::at("higher", format!("belongs to the objective \"modal\", found with \"{name}\"")))
            }
            _ => Ok(Objective::Frobenius(weight)),
        }
    }

    pub fn name(&self) -> &'static str {
        match self {
            Objective::Frobenius(Weight::None) => "frobenius",
            Objective::Frobenius(Weight::OffDiagonal) => "offdiag",
            Objective::Frobenius(Weight::Modal { .. }) => "modal",
        }
    }

    /// The scale of the higher modes, where the objective has one.
    pub fn higher(&self) -> Option<f64> {
        match self {
            Objective::Frobenius(Weight::Modal { higher }) => Some(*higher),
            _ => None,
        }
    }
}
