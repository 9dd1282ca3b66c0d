//! Cells that take more digits than `f64` has, slivers and needles: in numbers of twice as many.

use super::Fit;
use super::constrained::solve_nonnegative;
use super::least_squares::normal_equations;
use super::method::{Method, Verdict};
use super::normal::{Normal, Rank};
use crate::element::Element;
use crate::material::Moduli;
use crate::scalar::{Real, Scalar, Twofold};
use crate::springs::Springs;
use crate::stiffness::Geometry;

/// What the cells of a block have in common.
pub struct Careful<'a> {
    pub element: &'a Element,
    pub springs: &'a Springs,
    pub moduli: &'a Moduli,
    pub fit: &'a Fit,
}

impl Careful<'_> {
    /// Writes the constants of the cell with nodes at `x`, `[nodes × dimension]`, m; `measured` as [`Method::solve`] needs it. None where
    /// the Jacobian vanishes, or springs on functions are seen block by block, which is known in `f64` alone.
    pub fn constants(&self, x: &[Twofold], measured: &[f64], constants: &mut [f64]) -> Option<Verdict> {
        let Careful { element, springs, moduli, fit } = *self;
        let any = Twofold::from(0.0);
        let mut geometry = Geometry::of_kind(&any, &element.tabulation);
        if !geometry.update(&element.tabulation, x) {
            return None;
        }
        if let Some(mut method) = Method::of_kind(&any, springs, fit) {
            let measured: Vec<Twofold> = measured.iter().map(|g| Twofold::from(*g)).collect();
            any.vectorize(
                #[inline(always)]
                || method.solve(springs, x, &geometry, moduli, &measured),
            );
            return Some(method.finish_alone(constants));
        }
        if !springs.functions.is_empty() {
            return None;
        }
        let mut normal = Normal::default();
        normal_equations(fit.objective.weight()?, springs, x, &geometry, moduli, &mut normal);
        if fit.tied {
            let mut tied = Normal::default();
            normal.tied(&springs.groups, springs.names.len(), &mut tied);
            normal = tied;
        }
        let (k, rank) = match fit.nonnegative {
            true => solve_nonnegative(&normal.rounded()),
            false => {
                let equations = normal.rounded();
                match normal.solve_regular() {
                    true => (normal.rounded().rhs, Rank::Full),
                    false => (equations.least_norm(), Rank::Deficient),
                }
            }
        };
        for (s, constant) in constants.iter_mut().enumerate() {
            *constant = k[if fit.tied { springs.groups[s] } else { s }];
        }
        Some(Verdict { certificate: None, rank, reached: true, delicate: false })
    }
}

impl<T: Scalar + Real> Normal<T> {
    /// The equations in `f64`.
    pub(super) fn rounded(&self) -> Normal {
        let all = |values: &[T]| values.iter().map(Real::rounded).collect();
        Normal::new(all(&self.gram), all(&self.rhs))
    }
}
