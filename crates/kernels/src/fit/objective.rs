//! What a fit minimises, stated once: a measure of `R − K(k)`, `K(k) = Σ_s k_s g_s g_sᵀ`, seen through a weight.

use crate::error::{Error, Result};

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Objective {
    /// `‖W (R − K) W‖_F`: normal equations.
    Frobenius(Weight),
    /// `‖W (R − K) W‖₂`, the largest eigenvalue: a semidefinite programme, solved with a certificate.
    Spectral(Weight),
    /// `tr A + c tr A⁻¹ − (1 − c) log det A`, `A = R^(−1/2) K R^(−1/2)`, c = `balance`: K stays positive.
    Divergence { balance: f64 },
}

/// How much each part of `R − K` counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Weight {
    /// All entries alike.
    None,
    /// The blocks of different nodes only; with length springs alone, `k_s = −nᵀ R_ij n`. Of a norm of entries only.
    OffDiagonal,
    /// `W = C Cᵀ + higher · H Hᵀ`: C an orthonormal basis of the constant-strain motions, H of all other deformations.
    Modal { higher: f64 },
    /// `W = R^(−1/2)` on the deformations: what counts is the relative error of the energy.
    Relative,
}

/// The numbers and the weight that may go with an objective's name.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Choices<'a> {
    pub weight: Option<&'a str>,
    pub higher: Option<f64>,
    pub balance: Option<f64>,
}

impl Weight {
    pub const NAMES: [&'static str; 4] = ["none", "offdiag", "modal", "relative"];

    pub fn name(&self) -> &'static str {
        match self {
            Weight::None => "none",
            Weight::OffDiagonal => "offdiag",
            Weight::Modal { .. } => "modal",
            Weight::Relative => "relative",
        }
    }
}

impl Objective {
    /// Besides these, `offdiag` and `modal` are short for `frobenius` with that weight.
    pub const NAMES: [&'static str; 5] = ["frobenius", "offdiag", "modal", "spectral", "divergence"];
    /// The scale of the higher modes where none is given; chosen by the study in the README.
    pub const DEFAULT_HIGHER: f64 = 0.316;
    /// The balance of the divergence where none is given; chosen by the study in the README.
    pub const DEFAULT_BALANCE: f64 = 0.25;

    /// Every objective with its default numbers; modal ones where the element has motions beyond constant strain.
    pub fn all(higher_modes: bool) -> Vec<Objective> {
        let modal = Weight::Modal { higher: Objective::DEFAULT_HIGHER };
        let mut all = vec![Objective::Frobenius(Weight::None), Objective::Frobenius(Weight::OffDiagonal)];
        all.extend(higher_modes.then_some(Objective::Frobenius(modal)));
        all.extend([Objective::Frobenius(Weight::Relative), Objective::Spectral(Weight::None)]);
        all.extend(higher_modes.then_some(Objective::Spectral(modal)));
        all.push(Objective::Spectral(Weight::Relative));
        all.push(Objective::Divergence { balance: Objective::DEFAULT_BALANCE });
        all
    }

    /// The objective called `name`.
    ///
    /// # Errors
    /// A name is unknown, a number out of its range, or a choice belongs to another objective.
    pub fn named(name: &str, choices: Choices) -> Result<Objective> {
        let (family, implied) = match name {
            "offdiag" | "modal" => ("frobenius", Some(name)),
            "frobenius" | "spectral" | "divergence" => (name, None),
            _ => {
                let expected = format!("one of {}", Objective::NAMES.join(", "));
                return Err(Error::expected("objective", expected, format!("\"{name}\"")));
            }
        };
        if let (Some(weight), Some(_)) = (choices.weight, implied) {
            let problem = format!("belongs to \"frobenius\" and \"spectral\", found \"{weight}\" with \"{name}\"");
            return Err(Error::at("weight", problem));
        }
        if family == "divergence" {
            return Objective::divergence(choices);
        }
        if choices.balance.is_some() {
            return Err(Error::at(
                "balance",
                format!("belongs to the objective \"divergence\", found with \"{name}\""),
            ));
        }
        let weight = match choices.weight.or(implied).unwrap_or("none") {
            "none" => Weight::None,
            "offdiag" if family == "spectral" => {
                let expected = "one of none, modal, relative: the largest eigenvalue has no blocks";
                return Err(Error::expected("weight", expected, "\"offdiag\""));
            }
            "offdiag" => Weight::OffDiagonal,
            "modal" => Weight::Modal { higher: choices.higher.unwrap_or(Objective::DEFAULT_HIGHER) },
            "relative" => Weight::Relative,
            other => {
                let expected = format!("one of {}", Weight::NAMES.join(", "));
                return Err(Error::expected("weight", expected, format!("\"{other}\"")));
            }
        };
        match (weight, choices.higher) {
            (Weight::Modal { higher }, _) if !(higher > 0.0 && higher <= 1.0) => {
                Err(Error::expected("higher", "a scale above 0 and at most 1", higher))
            }
            (Weight::None | Weight::OffDiagonal | Weight::Relative, Some(_)) => {
                Err(Error::at("higher", format!("belongs to the objective \"modal\", found with \"{name}\"")))
            }
            _ if family == "spectral" => Ok(Objective::Spectral(weight)),
            _ => Ok(Objective::Frobenius(weight)),
        }
    }

    fn divergence(choices: Choices) -> Result<Objective> {
        for (key, found) in [("weight", choices.weight.is_some()), ("higher", choices.higher.is_some())] {
            if found {
                let problem = "does not go with \"divergence\": no weight changes it";
                return Err(Error::at(key, problem));
            }
        }
        let balance = choices.balance.unwrap_or(Objective::DEFAULT_BALANCE);
        if !(0.0..=1.0).contains(&balance) {
            return Err(Error::expected("balance", "a number from 0 to 1", balance));
        }
        Ok(Objective::Divergence { balance })
    }

    /// The shortest name: `offdiag` and `modal` for `frobenius` with that weight.
    pub fn name(&self) -> &'static str {
        match self {
            Objective::Frobenius(Weight::OffDiagonal) => "offdiag",
            Objective::Frobenius(Weight::Modal { .. }) => "modal",
            Objective::Frobenius(_) => "frobenius",
            Objective::Spectral(_) => "spectral",
            Objective::Divergence { .. } => "divergence",
        }
    }

    /// The weight of a norm.
    pub fn weight(&self) -> Option<Weight> {
        match self {
            Objective::Frobenius(weight) | Objective::Spectral(weight) => Some(*weight),
            Objective::Divergence { .. } => None,
        }
    }

    /// The scale of the higher modes, where the objective has one.
    pub fn higher(&self) -> Option<f64> {
        match self.weight() {
            Some(Weight::Modal { higher }) => Some(higher),
            _ => None,
        }
    }

    /// The name with what goes with it, such as `spectral modal 0.316`.
    pub fn title(&self) -> String {
        match self {
            Objective::Frobenius(Weight::Relative) => "frobenius relative".into(),
            Objective::Spectral(Weight::Relative) => "spectral relative".into(),
            Objective::Spectral(Weight::Modal { higher }) => format!("spectral modal {higher}"),
            Objective::Frobenius(Weight::Modal { higher }) => format!("modal {higher}"),
            Objective::Divergence { balance } => format!("divergence {balance}"),
            _ => self.name().into(),
        }
    }
}
