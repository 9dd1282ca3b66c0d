//! The inputs and the results of spring constants as functions.
//!
//! Theory: page *Gradients of spring constants* of the book.

use crate::element::Element;
use crate::fit::exact::ExactFit;
use crate::fit::settings::Fit;
use crate::material::{BlockValues, Moduli};
use crate::springs::Springs;

/// How the constants of a cell follow from its nodes and moduli.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GradientFit {
    /// Least squares in closed form give the constants.
    Closed(Fit),
    /// The exact network for small deformations gives the constants on lengths and on contents.
    Exact(ExactFit),
}

/// The constants `k_cs` and the rest contents `c₀_cj` of the cells of one element: functions of the points and of λ and μ of each cell. The
/// springs on contents are the last ones of a cell; those of an exact network are as [`fit_exact`](crate::fit::fit_exact) has them.
#[derive(Debug, Clone)]
pub struct CellFunction<'a> {
    pub(super) element: &'a Element,
    pub(super) springs: &'a Springs,
    pub(super) points: &'a [f64],
    pub(super) connectivity: &'a [usize],
    pub(super) moduli: BlockValues<'a, Moduli>,
    pub(super) fit: GradientFit,
}

/// Numbers for each cell and each of its springs.
#[derive(Debug, Clone, PartialEq)]
pub struct CellNumbers {
    /// Numbers of the constants, `[cells × springs]`.
    pub constants: Vec<f64>,
    /// Numbers of the rest contents, `[cells × springs on contents]`.
    pub rests: Vec<f64>,
}

/// Numbers for each input of the constants.
#[derive(Debug, Clone, PartialEq)]
pub struct Inputs {
    /// Numbers of the points, `[points × dimension]`.
    pub points: Vec<f64>,
    /// Numbers of λ and μ of each cell, `[cells × 2]`.
    pub moduli: Vec<f64>,
}

impl CellFunction<'_> {
    /// The number of cells.
    pub(super) fn cells(&self) -> usize {
        self.connectivity.len() / self.element.nodes()
    }

    /// The number of springs of a cell, and that of its springs on contents.
    pub(super) fn counts(&self) -> [usize; 2] {
        [self.springs.len(), self.springs.len() - self.springs.pairs().len()]
    }
}
