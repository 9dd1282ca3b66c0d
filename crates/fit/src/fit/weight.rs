//! The weight of each part of `R − K` in a norm, and how the equations under a weight are set up.
//!
//! Theory: page *Modal weights* of the book.

use crate::error::{Error, ErrorKind, Result};
use std::fmt;

/// A weight of a norm of the entries of `R − K`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Weight {
    /// All entries have the same weight.
    None,
    /// Only the blocks of different nodes count; with length springs alone, `k_s = −nᵀ R_ij n`. This is not a weight of
    /// motions.
    OffDiagonal,
    /// `W = C Cᵀ + h · H Hᵀ`, with C an orthonormal basis of the constant-strain motions and H of all other
    /// deformations.
    Modal(Higher),
    /// `W = R^(−1/2)` on the deformations: the relative error of the energy.
    Relative,
}

/// A weight W of motions, for which `W (R − K) W` has eigenvalues.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MotionWeight {
    /// All motions have the same weight.
    None,
    /// See [`Weight::Modal`].
    Modal(Higher),
    /// See [`Weight::Relative`].
    Relative,
}

crate::named!(Weight {
    "none" => None,
    "offdiag" => OffDiagonal,
    "modal" => Modal { 0: Higher::DEFAULT },
    "relative" => Relative,
});

crate::named!(MotionWeight { "none" => None, "modal" => Modal { 0: Higher::DEFAULT }, "relative" => Relative });

/// The scale h of the motions beyond constant strain, `0 < h ≤ 1`; constant strain has the scale 1.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Higher(f64);

impl Higher {
    /// h = 0.316 ≈ 10^(−1/2): chosen by comparing the errors of whole bodies of hexahedra and quadrilaterals (page *How
    /// to choose* of the book).
    pub const DEFAULT: Higher = Higher(0.316);

    /// The scale `scale`.
    ///
    /// # Errors
    /// The scale is not above 0 and at most 1.
    pub fn new(scale: f64) -> Result<Higher> {
        if !(scale > 0.0 && scale <= 1.0) {
            return Err(Error::expected("higher", "a scale above 0 and at most 1", scale));
        }
        Ok(Higher(scale))
    }

    /// The number h.
    pub const fn value(self) -> f64 {
        self.0
    }
}

impl fmt::Display for Higher {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// A weight whose normal equations follow from the node positions alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ClosedWeight {
    None,
    OffDiagonal,
    Modal(Higher),
}

/// How the equations of one element are set up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Route {
    /// Normal equations from the node positions alone.
    Closed(ClosedWeight),
    /// Normal equations of the blocks of different nodes, from R and the gradients of the springs, one cell at a time.
    Blocks,
    /// R and the gradients of the springs reduced to the deformations, seen through the weight.
    Reduced(MotionWeight),
}

impl Weight {
    /// How the normal equations are set up. The closed form does not include springs that measure a function of some
    /// nodes.
    pub(super) fn route(self, has_functions: bool) -> Route {
        match (self, has_functions) {
            (Weight::None, false) => Route::Closed(ClosedWeight::None),
            (Weight::None, true) => Route::Reduced(MotionWeight::None),
            (Weight::OffDiagonal, false) => Route::Closed(ClosedWeight::OffDiagonal),
            (Weight::OffDiagonal, true) => Route::Blocks,
            (Weight::Modal(higher), false) => Route::Closed(ClosedWeight::Modal(higher)),
            (Weight::Modal(higher), true) => Route::Reduced(MotionWeight::Modal(higher)),
            (Weight::Relative, _) => Route::Reduced(MotionWeight::Relative),
        }
    }

    /// The weight of the closed form.
    ///
    /// # Errors
    /// There is no closed form with this weight, or with springs that measure a function of some nodes.
    pub(super) fn closed(self, has_functions: bool) -> Result<ClosedWeight> {
        let Route::Closed(weight) = self.route(has_functions) else {
            let springs = if has_functions { " with springs on lengths and contents" } else { "" };
            let error = Error::expected("weight", format!("a closed form{springs}"), format!("\"{}\"", self.name()));
            return Err(error.of_kind(ErrorKind::Unsupported));
        };
        Ok(weight)
    }

    /// Whether the name of the weight is short for the objective `frobenius` with it.
    pub(super) fn names_objective(self) -> bool {
        match self {
            Weight::OffDiagonal | Weight::Modal(_) => true,
            Weight::None | Weight::Relative => false,
        }
    }

    /// The name with its number, such as `modal 0.316`.
    pub(super) fn title(self) -> String {
        match self.higher() {
            Some(higher) => format!("{} {higher}", self.name()),
            None => self.name().into(),
        }
    }

    /// Whether a cell takes microseconds instead of nanoseconds.
    pub(super) fn is_costly(self) -> bool {
        match self {
            Weight::None | Weight::OffDiagonal | Weight::Modal(_) => false,
            Weight::Relative => true,
        }
    }

    /// The scale of the motions beyond constant strain, if the weight has one.
    pub fn higher(self) -> Option<Higher> {
        match self {
            Weight::Modal(higher) => Some(higher),
            Weight::None | Weight::OffDiagonal | Weight::Relative => None,
        }
    }

    /// Whether the weight differs from no weight only on motions beyond constant strain.
    pub(super) fn needs_higher_modes(self) -> bool {
        match self {
            Weight::Modal(_) => true,
            Weight::None | Weight::OffDiagonal | Weight::Relative => false,
        }
    }

    /// The weight of motions.
    ///
    /// # Errors
    /// The weight is that of blocks, which is not a weight of motions.
    pub(super) fn of_motions(self) -> Result<MotionWeight> {
        match self {
            Weight::None => Ok(MotionWeight::None),
            Weight::Modal(higher) => Ok(MotionWeight::Modal(higher)),
            Weight::Relative => Ok(MotionWeight::Relative),
            Weight::OffDiagonal => {
                let expected =
                    format!("one of {}: the largest eigenvalue has no blocks", MotionWeight::NAMES.join(", "));
                Err(Error::expected("weight", expected, format!("\"{}\"", self.name())))
            }
        }
    }

    /// Replaces the scale of the motions beyond constant strain, if the weight has one.
    pub(super) fn with_higher(self, higher: Higher) -> Weight {
        match self {
            Weight::Modal(_) => Weight::Modal(higher),
            Weight::None | Weight::OffDiagonal | Weight::Relative => self,
        }
    }
}

impl MotionWeight {
    /// Whether the weight divides by R.
    pub(super) fn divides_by_stiffness(self) -> bool {
        match self {
            MotionWeight::None | MotionWeight::Modal(_) => false,
            MotionWeight::Relative => true,
        }
    }

    /// The scale of the motions beyond constant strain, if the weight has one.
    pub fn higher(self) -> Option<Higher> {
        Weight::from(self).higher()
    }
}

impl From<MotionWeight> for Weight {
    fn from(weight: MotionWeight) -> Weight {
        match weight {
            MotionWeight::None => Weight::None,
            MotionWeight::Modal(higher) => Weight::Modal(higher),
            MotionWeight::Relative => Weight::Relative,
        }
    }
}
