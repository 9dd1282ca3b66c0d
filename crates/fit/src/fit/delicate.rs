//! Cells that require more digits than `f64` has, such as slivers and needles. They are fitted in double-double
//! numbers.
//!
//! Theory: page *Precision* of the book.

use super::constrained::solve_precisely;
use super::least_squares::normal_equations;
use super::method::Verdict;
use super::normal::Normal;
use super::precision::{differences, measured, solved};
use super::rows::Rows;
use super::settings::Fit;
use super::weight::{ClosedWeight, Route};
use crate::element::Element;
use crate::material::Hooke;
use crate::scalar::{DoubleDouble, Scalar};
use crate::springs::{Springs, dot};
use crate::stiffness::Geometry;

/// What the cells of a block have in common.
pub struct DelicateCells<'a> {
    pub element: &'a Element,
    pub springs: &'a Springs,
    pub hooke: &'a Hooke,
    pub fit: &'a Fit,
}

impl DelicateCells<'_> {
    /// Writes the constants of the cell with nodes at `x`, `[nodes × dimension]`, m. `plain` and `shape` are the
    /// positions relative to the first node and the geometry, in `f64`. None if the Jacobian vanishes or a spring has no
    /// gradient.
    pub fn constants(&self, x: &[f64], (plain, shape): (&[f64], &Geometry), constants: &mut [f64]) -> Option<Verdict> {
        let DelicateCells { element, springs, hooke, fit } = *self;
        let any = DoubleDouble::from(0.0);
        let x = differences(&any, element.dimension(), x);
        let mut geometry = Geometry::like(&any, &element.tabulation);
        if !geometry.update(&element.tabulation, &x) {
            return None;
        }
        let route = fit.objective.route(springs.need_matrix());
        let mut normal = Normal::default();
        match route {
            Route::Closed(weight) => {
                normal_equations(weight, springs, &x, &geometry, &hooke.of_kind(&any), &mut normal);
            }
            Route::Blocks => {
                let rows = Rows::of_gradients(springs, &x, &geometry, measured(springs, &x)?);
                normal = rows.normal(ClosedWeight::OffDiagonal, &x, &geometry.entries(&hooke.of_kind(&any)));
            }
            Route::Reduced(_) => {
                let measured = measured(springs, &x)?;
                let method = solved(springs, &x, &geometry, hooke, &measured, fit)?;
                return Some(method.finish_alone(|| are_independent(springs, fit.tied, plain, shape), constants));
            }
        }
        let normal = normal.by_unknowns(springs, fit.tied);
        // The coordinates are doubles: what differs by less than their rounding is not known, however many digits are computed.
        let (k, rank, _) = solve_precisely(&normal, fit.nonnegative, DoubleDouble::given());
        fit.spread(springs, constants, &k);
        Some(Verdict { certificate: None, rank, reached: true, delicate: false })
    }
}

/// Whether the matrix of no spring is a linear combination of those of the others, up to rounding: then the optimum is
/// unique whatever the stiffness is.
fn are_independent(springs: &Springs, tied: bool, x: &[f64], geometry: &Geometry) -> bool {
    let (m, size) = (springs.len(), x.len());
    let mut g = Vec::new();
    springs.gradients(x, geometry, &mut g);
    let row = |s: usize| &g[s * size..(s + 1) * size];
    let entries = (0..m * m).map(|st| dot(row(st / m), row(st % m)).powi(2));
    Normal::new(entries.collect(), vec![0.0; m]).by_unknowns(springs, tied).solve_regular()
}
