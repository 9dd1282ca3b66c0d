//! The objectives whose constants are computed directly, and why others are not.

use super::cell::LeastSquares;
use crate::element::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::fit::published::Method;
use crate::fit::{Choices, ExactFit, Fit, Objective, VolumeSprings, Weight, fit_cells, fit_exact};
use crate::material::Material;
use crate::springs::Springs;
use crate::unknown;

/// An objective with a direct solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Recipe {
    /// A network that is equal to the finite element.
    Exact(VolumeSprings),
    /// A fit to the stiffness by normal equations.
    Frobenius(Weight),
}

/// How the constants are computed.
pub(super) enum Constants {
    Exact(VolumeSprings),
    LeastSquares(LeastSquares),
}

impl Recipe {
    /// The names of the objectives for which code can be written.
    pub const NAMES: [&'static str; 4] = ["exact", "offdiag", "frobenius", "modal"];

    /// The recipe of an objective with its options.
    ///
    /// # Errors
    /// There is no such objective, it has no direct solution, or an option belongs to another one.
    pub fn named(objective: &str, volume: Option<&str>, higher: Option<f64>) -> Result<Recipe> {
        let direct = "of the objectives with a direct solution, exact, offdiag, frobenius and modal";
        let refused = |why: &str| {
            let error = Error::at("objective", format!("\"{objective}\" is not one {direct}: {why}"));
            Err(error.of_kind(ErrorKind::Unsupported))
        };
        match objective {
            "exact" => {
                if higher.is_some() {
                    return Err(Error::at("higher", "belongs to the objective \"modal\", found with \"exact\""));
                }
                let volume = volume.map(VolumeSprings::named).transpose().map_err(|e| e.at_key("volume"))?;
                match volume.unwrap_or_default() {
                    VolumeSprings::Patches => {
                        let problem =
                            "\"patches\" has springs on several cells; expected points or cells, which are of one cell";
                        Err(Error::at("volume", problem).of_kind(ErrorKind::Unsupported))
                    }
                    volume => Ok(Recipe::Exact(volume)),
                }
            }
            _ if volume.is_some() => {
                Err(Error::at("volume", format!("belongs to the objective \"exact\", found with \"{objective}\"")))
            }
            "frobenius" | "offdiag" | "modal" => {
                match Objective::named(objective, Choices { higher, ..Choices::default() })? {
                    Objective::Frobenius(weight) => Ok(Recipe::Frobenius(weight)),
                    Objective::Spectral(_) | Objective::Divergence(_) => refused("it is iterated"),
                }
            }
            "spectral" => refused("it is a semidefinite programme; \"modal\" and \"offdiag\" come near it"),
            "divergence" => refused(
                "its optimum is iterated; \"offdiag\" is direct, and \"exact\" is definite wherever the finite element is",
            ),
            "sampled" => refused("it is fitted to forces at many shapes; \"exact\" has them at any deformation"),
            "whole" => refused("it depends on the whole body; fit the body once with springfit fit"),
            "nonnegative" => refused("constants above zero need a search for each cell; springfit fit has it"),
            name if Method::ALL.iter().any(|method| method.name() == name) => {
                refused("published formulas are in their papers; \"offdiag\" has no more terms")
            }
            other => {
                let expected = format!("one {direct}");
                Err(unknown(expected, Recipe::NAMES, other).at_key("objective"))
            }
        }
    }

    /// The name in options.
    pub fn name(self) -> &'static str {
        match self {
            Recipe::Exact(VolumeSprings::Cells) => "exact cells",
            Recipe::Exact(_) => "exact",
            Recipe::Frobenius(weight) => Objective::Frobenius(weight).name(),
        }
    }

    /// The name with its numbers.
    pub fn title(self) -> String {
        match self {
            Recipe::Exact(volume) => format!("exact, volume {}", volume.name()),
            Recipe::Frobenius(weight) => Objective::Frobenius(weight).title(),
        }
    }

    pub(super) fn constants(self) -> Constants {
        match self {
            Recipe::Exact(volume) => Constants::Exact(volume),
            Recipe::Frobenius(weight) => Constants::LeastSquares(match LeastSquares::of(weight) {
                Some(weight) => weight,
                None => LeastSquares::All,
            }),
        }
    }

    /// The springs of the element that the recipe uses.
    pub(super) fn springs(self, element: &Element, groups: Option<&[String]>) -> Result<Springs> {
        let (d, connectivity): (usize, Vec<usize>) = (element.dimension(), (0..element.nodes()).collect());
        let material = Material::for_body(d, 1.0, 0.25, None, None)?;
        let x = &element.positions;
        match self {
            Recipe::Exact(volume) => {
                if groups.is_some() {
                    let problem =
                        "belongs to fits to the stiffness; an exact network has springs between all pairs of nodes";
                    return Err(Error::at("springs", problem));
                }
                let fit = ExactFit { volume, ..ExactFit::default() };
                Ok(fit_exact(element, x, &connectivity, material, &fit, &mut |_| {})?.springs)
            }
            Recipe::Frobenius(weight) => {
                let springs = Springs::select(element, groups)?;
                let fit = Fit::new(Objective::Frobenius(weight));
                let fits = fit_cells(element, &springs, x, &connectivity, material.moduli(), &fit, &mut |_| {})?;
                if springs.is_empty() {
                    return Err(Error::expected("springs", "groups with springs", "none"));
                }
                if fits.deficient > 0 {
                    let problem = format!(
                        "the springs of {} are linearly dependent under {}; expected fewer groups, or offdiag or exact",
                        element.name,
                        self.title()
                    );
                    return Err(Error::at("springs", problem).of_kind(ErrorKind::Infeasible));
                }
                Ok(springs)
            }
        }
    }
}
