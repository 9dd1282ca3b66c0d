//! The objectives whose constants are computed directly, and why others are not.

use crate::element::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::fit::published::{Elasticity, Method, constants_of_cell};
use crate::fit::{Choices, ExactFit, Fit, Objective, VolumeSprings, Weight, fit_cells, fit_exact};
use crate::material::Material;
use crate::springs::{Springs, distance};
use crate::unknown;

/// An objective with a direct solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Recipe {
    /// A network that is equal to the finite element.
    Exact(VolumeSprings),
    /// A fit to the stiffness by normal equations.
    Frobenius(Weight),
    /// A published formula.
    Published(Method),
}

impl Recipe {
    /// The names of the objectives for which code can be written, without those of published methods.
    const NAMES: [&'static str; 4] = ["exact", "offdiag", "frobenius", "modal"];

    /// The recipe of an objective with its options.
    ///
    /// # Errors
    /// There is no such objective, it has no direct solution, or an option belongs to another one.
    pub fn named(objective: &str, volume: Option<&str>, higher: Option<f64>) -> Result<Recipe> {
        let refused = |why: &str| {
            let expected =
                "an objective with a direct solution: exact, offdiag, frobenius, modal or a published formula";
            let error = Error::expected("objective", expected, format!("\"{objective}\", which {why}"));
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
                match Objective::named(objective, Choices { higher, ..Choices::default() })?.least_squares() {
                    Some(weight) => Ok(Recipe::Frobenius(weight)),
                    None => refused("is iterated"),
                }
            }
            "spectral" => refused("is a semidefinite programme; \"modal\" and \"offdiag\" are direct"),
            "divergence" => refused(
                "is found by Newton steps; \"offdiag\" is direct, and \"exact\" is definite like the finite element",
            ),
            "sampled" => refused("is fitted to forces at many shapes; \"exact\" has those of the finite element"),
            "whole" => refused("depends on the whole body; springfit fit fits it once"),
            "nonnegative" => refused("needs a search for each cell; springfit fit has it"),
            other => match Method::all().find(|method| method.name() == other) {
                Some(Method::MacielUniform) => {
                    refused("scales its constant with the whole body; \"van-gelder\" has one constant on regular cells")
                }
                Some(_) if higher.is_some() => {
                    Err(Error::at("higher", format!("belongs to the objective \"modal\", found with \"{other}\"")))
                }
                Some(method) => Ok(Recipe::Published(method)),
                None => {
                    let names = || Recipe::NAMES.into_iter().chain(Method::NAMES.iter().copied());
                    let listed = names().filter(|name| *name != Method::MacielUniform.name());
                    let expected = format!("one of {}", listed.collect::<Vec<_>>().join(", "));
                    Err(unknown(expected, names(), other).at_key("objective"))
                }
            },
        }
    }

    /// The name in options.
    pub fn name(self) -> &'static str {
        match self {
            Recipe::Exact(VolumeSprings::Cells) => "exact cells",
            Recipe::Exact(_) => "exact",
            Recipe::Frobenius(weight) => Objective::Frobenius(weight).name(),
            Recipe::Published(method) => method.name(),
        }
    }

    /// The name with its numbers.
    pub fn title(self) -> String {
        match self {
            Recipe::Exact(volume) => format!("exact, volume {}", volume.name()),
            Recipe::Frobenius(weight) => Objective::Frobenius(weight).title(),
            Recipe::Published(method) => method.name().into(),
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
            Recipe::Published(method) => {
                let bulk = Elasticity::of(element, material)?;
                let x = |a: usize| &x[a * d..(a + 1) * d];
                let length = |[i, j]: [usize; 2]| distance(x(i), x(j));
                let offered = Springs::select(element, groups)?;
                Ok(constants_of_cell(method, element, &offered, length, element.cell.content(), &bulk)?.0)
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
                    let key = if weight.higher().is_some() { "higher" } else { "springs" };
                    return Err(Error::at(key, problem).of_kind(ErrorKind::Infeasible));
                }
                Ok(springs)
            }
        }
    }
}
