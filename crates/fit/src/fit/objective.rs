//! What a fit of each element minimises: a measure of `R − K(k)`, `K(k) = Σ_s k_s g_s g_sᵀ`, seen through a weight.
//!
//! Theory: pages *Least squares*, *The 2-norm*, *The divergence* and *Modal weights* of the book.

use super::weight::{Higher, MotionWeight, Route, Weight};
use crate::error::{Error, Result};
use std::fmt;

/// The measure of `R − K(k)` that a fit minimises, with R the stiffness of the finite element and K that of its
/// springs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Objective {
    /// The Frobenius norm `‖W (R − K) W‖_F`: solved by normal equations, in closed form for most weights.
    Frobenius(Weight),
    /// The induced 2-norm `‖W (R − K) W‖₂`, the largest absolute eigenvalue: a semidefinite programme, solved with a
    /// certificate.
    Spectral(MotionWeight),
    /// The divergence `tr A + c tr A⁻¹ − (1 − c) log det A`, `A = R^(−1/2) K R^(−1/2)`: K stays positive definite on
    /// deformations.
    Divergence(Balance),
}

/// The balance c of the divergence, `0 ≤ c ≤ 1`. At 0 the springs tend to be too soft, at 1 too stiff.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Balance(f64);

impl Balance {
    /// c = 0.25: of the values that were compared on whole bodies, a compromise between the errors in tension and in
    /// shear (page *How to choose* of the book).
    pub const DEFAULT: Balance = Balance(0.25);

    /// The balance `balance`.
    ///
    /// # Errors
    /// The number is not from 0 to 1.
    pub fn new(balance: f64) -> Result<Balance> {
        if !(0.0..=1.0).contains(&balance) {
            return Err(Error::expected("balance", "a number from 0 to 1", balance));
        }
        Ok(Balance(balance))
    }

    /// The number c.
    pub const fn value(self) -> f64 {
        self.0
    }
}

impl fmt::Display for Balance {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// The weight and the numbers that may be given with the name of an objective; `None` stands for the default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Choices<'a> {
    /// The name of the weight.
    pub weight: Option<&'a str>,
    /// The scale of the motions beyond constant strain, for the weight `modal`.
    pub higher: Option<f64>,
    /// The balance of the divergence.
    pub balance: Option<f64>,
}

/// The name of an objective in files and options.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Name {
    Frobenius,
    OffDiagonal,
    Modal,
    Spectral,
    Divergence,
}

crate::named!(Name {
    "frobenius" => Frobenius,
    "offdiag" => OffDiagonal,
    "modal" => Modal,
    "spectral" => Spectral,
    "divergence" => Divergence,
});

impl Objective {
    /// The names of the objectives. Besides these, `offdiag` and `modal` are short for `frobenius` with that weight.
    pub const NAMES: &'static [&'static str] = Name::NAMES;

    /// Every objective with its default numbers; modal ones only if the element has motions beyond constant strain.
    pub fn all(higher_modes: bool) -> Vec<Objective> {
        let fits = |weight: &Weight| higher_modes || !weight.needs_higher_modes();
        let named = |name: Name| match name {
            Name::Frobenius => Weight::all().filter(fits).map(Objective::Frobenius).collect(),
            Name::Spectral => {
                MotionWeight::all().filter(|weight| fits(&(*weight).into())).map(Objective::Spectral).collect()
            }
            Name::Divergence => vec![Objective::Divergence(Balance::DEFAULT)],
            // Short for the first.
            Name::OffDiagonal | Name::Modal => Vec::new(),
        };
        Name::all().flat_map(named).collect()
    }

    /// The objective called `name`.
    ///
    /// # Errors
    /// The name is unknown, a number is out of its range, or a choice belongs to another objective.
    pub fn named(name: &str, choices: Choices) -> Result<Objective> {
        let known = Name::named(name).map_err(|e| e.at_key("objective"))?;
        let implied = match known {
            Name::OffDiagonal => Some(Weight::OffDiagonal),
            Name::Modal => Some(Weight::Modal(Higher::DEFAULT)),
            Name::Frobenius | Name::Spectral | Name::Divergence => None,
        };
        if let (Some(weight), Some(_)) = (choices.weight, implied) {
            let problem = format!("belongs to \"frobenius\" and \"spectral\", found \"{weight}\" with \"{name}\"");
            return Err(Error::at("weight", problem));
        }
        let weight = || {
            if choices.balance.is_some() {
                let problem = format!("belongs to the objective \"divergence\", found with \"{name}\"");
                return Err(Error::at("balance", problem));
            }
            let chosen = choices.weight.map(|weight| Weight::named(weight).map_err(|e| e.at_key("weight")));
            Ok(chosen.transpose()?.or(implied).unwrap_or(Weight::None))
        };
        let scaled = |weight: Weight| {
            let Some(higher) = choices.higher else { return Ok(weight) };
            if weight.higher().is_none() {
                let problem = format!("belongs to the objective \"modal\", found with \"{name}\"");
                return Err(Error::at("higher", problem));
            }
            Ok(weight.with_higher(Higher::new(higher)?))
        };
        match known {
            Name::Frobenius | Name::OffDiagonal | Name::Modal => Ok(Objective::Frobenius(scaled(weight()?)?)),
            Name::Spectral => {
                let weight = weight()?.of_motions()?;
                Ok(Objective::Spectral(scaled(weight.into())?.of_motions()?))
            }
            Name::Divergence => Objective::divergence(choices),
        }
    }

    fn divergence(choices: Choices) -> Result<Objective> {
        for (key, found) in [("weight", choices.weight.is_some()), ("higher", choices.higher.is_some())] {
            if found {
                let problem = "does not go with \"divergence\": no weight changes it";
                return Err(Error::at(key, problem));
            }
        }
        let balance = choices.balance.map_or(Ok(Balance::DEFAULT), Balance::new)?;
        Ok(Objective::Divergence(balance))
    }

    /// The shortest name: `offdiag` and `modal` for `frobenius` with that weight.
    pub fn name(&self) -> &'static str {
        match self {
            Objective::Frobenius(weight) if weight.names_objective() => weight.name(),
            Objective::Frobenius(_) => Name::Frobenius.name(),
            Objective::Spectral(_) => Name::Spectral.name(),
            Objective::Divergence(_) => Name::Divergence.name(),
        }
    }

    /// The name with its weight and numbers, such as `spectral modal 0.316`.
    pub fn title(&self) -> String {
        let name = self.name();
        let weighted = |weight: Weight| {
            if weight == Weight::None {
                name.into()
            } else if weight.name() == name {
                weight.title()
            } else {
                format!("{name} {}", weight.title())
            }
        };
        match self {
            Objective::Frobenius(weight) => weighted(*weight),
            Objective::Spectral(weight) => weighted((*weight).into()),
            Objective::Divergence(balance) => format!("{name} {balance}"),
        }
    }

    /// The weight of a norm; none for the divergence.
    pub fn weight(&self) -> Option<Weight> {
        match self {
            Objective::Frobenius(weight) => Some(*weight),
            Objective::Spectral(weight) => Some((*weight).into()),
            Objective::Divergence(_) => None,
        }
    }

    /// The weight of an objective that is a sum of squares, whose optimum is that of linear equations; none for those that are iterated.
    pub fn least_squares(&self) -> Option<Weight> {
        match self {
            Objective::Frobenius(weight) => Some(*weight),
            Objective::Spectral(_) | Objective::Divergence(_) => None,
        }
    }

    /// The name of the method that solves it, without tensions, with or without the bound k ≥ 0.
    pub fn method_name(&self, nonnegative: bool) -> &'static str {
        match self {
            Objective::Frobenius(_) if nonnegative => "block principal pivoting",
            Objective::Frobenius(_) => "normal equations",
            Objective::Spectral(_) => "barrier",
            Objective::Divergence(_) => "newton",
        }
    }

    /// The scale of the motions beyond constant strain, if the objective has one.
    pub fn higher(&self) -> Option<f64> {
        self.weight().and_then(Weight::higher).map(Higher::value)
    }

    /// The balance of the divergence; none for the norms.
    pub fn balance(&self) -> Option<f64> {
        match self {
            Objective::Divergence(balance) => Some(balance.value()),
            Objective::Frobenius(_) | Objective::Spectral(_) => None,
        }
    }

    /// How the equations are set up; `has_functions` tells whether springs measure a function of some nodes.
    pub(super) fn route(&self, has_functions: bool) -> Route {
        match *self {
            Objective::Frobenius(weight) => weight.route(has_functions),
            Objective::Spectral(weight) => Route::Reduced(weight),
            Objective::Divergence(_) => Route::Reduced(MotionWeight::Relative),
        }
    }

    /// The weight through which the objective is a function of the reduced element.
    ///
    /// # Errors
    /// The objective is that of the blocks, which the reduced element does not have.
    pub(super) fn of_motions(&self) -> Result<MotionWeight> {
        match *self {
            Objective::Frobenius(weight) => weight.of_motions(),
            Objective::Spectral(weight) => Ok(weight),
            Objective::Divergence(_) => Ok(MotionWeight::Relative),
        }
    }

    /// Whether a cell takes microseconds instead of nanoseconds.
    pub(super) fn is_costly(&self) -> bool {
        match self {
            Objective::Frobenius(weight) => weight.is_costly(),
            Objective::Spectral(_) | Objective::Divergence(_) => true,
        }
    }
}
