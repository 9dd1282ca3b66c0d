//! The derivatives of spring constants in closed form with respect to node positions and moduli, as products with given weights.
//!
//! The kernels of the fits run on dual numbers: no formula is written a second time.
//!
//! Theory: page *Gradients of spring constants* of the book.

use super::closed::Closed;
use super::exact::{ExactFit, VolumeSprings, exact_constants};
use super::input::{check_cells, check_length, check_moduli};
use super::precision::no_answer;
use super::rest::Rest;
use super::settings::Fit;
use super::visit::cell_name;
use crate::element::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::material::{Hooke, Moduli};
use crate::scalar::Dual;
use crate::springs::Springs;
use crate::stiffness::Geometry;
use rayon::prelude::*;

/// Derivatives that are taken at once.
const AT_ONCE: usize = 8;

/// How the constants of a cell follow from its nodes and moduli.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GradientFit {
    /// By least squares with a closed form.
    Closed(Fit),
    /// Those of the exact network for small deformations, on lengths and on contents.
    Exact(ExactFit),
}

/// `Σ w ∂k/∂(·)` over all cells and springs.
#[derive(Debug, Clone, PartialEq)]
pub struct ConstantsGradient {
    /// With respect to the positions of the points, `[points × dimension]`, in units of w times N/m².
    pub points: Vec<f64>,
    /// With respect to λ and μ of all cells, `[2]`.
    pub moduli: [f64; 2],
}

/// The gradient of `Σ_cs w_cs k_cs` with the weights w, `[cells × springs]`.
///
/// `connectivity` is `[cells × nodes]` into `points`, `[points × dimension]`, m. The springs of an exact network are those
/// of [`fit_exact`](super::fit_exact).
///
/// # Errors
/// An array has a wrong length or a number is not finite; the fit has bounds or no closed form, or the cells do not fill their space (kind
/// `Unsupported`); or a cell has no stiffness or is so flat that digits are lost.
pub fn constants_gradient(
    element: &Element,
    springs: &Springs,
    points: &[f64],
    connectivity: &[usize],
    moduli: Moduli,
    fit: &GradientFit,
    weights: &[f64],
) -> Result<ConstantsGradient> {
    let (n, d, m) = (element.nodes(), element.dimension(), springs.len());
    check_cells(element, points, connectivity)?;
    springs.check(element)?;
    check_moduli(&moduli, d)?;
    check_length("weights", weights.len(), connectivity.len() / n * m)?;
    if element.space() != d {
        return Err(unsupported("cells that fill their space", "a surface or lines in space"));
    }
    let solver = match fit {
        GradientFit::Closed(fit) => {
            if fit.nonnegative || fit.rest != Rest::Mesh {
                return Err(unsupported("constants without bounds and rest lengths of the mesh", "others"));
            }
            let closed = Closed::<Dual<AT_ONCE>>::of(springs, fit);
            let closed = closed.filter(|_| springs.functions().is_empty());
            Some(closed.ok_or_else(|| unsupported("a fit with a closed form", &fit.objective.title()))?)
        }
        GradientFit::Exact(exact) => {
            if exact.large || exact.volume == VolumeSprings::Patches || !springs.areas().is_empty() {
                let expected = "an exact network for small deformations, with springs on lengths and on contents of points or cells";
                return Err(unsupported(expected, "another"));
            }
            None
        }
    };
    let inputs = n * d + 2;
    let of_cell = |solver: &mut Option<Closed<Dual<AT_ONCE>>>,
                   (cell, (nodes, weights)): (usize, (&[usize], &[f64]))| {
        let mut gradient = vec![0.0; inputs];
        let any = Dual::steady(0.0);
        let mut geometry = Geometry::like(&any, &element.tabulation);
        for first in (0..inputs).step_by(AT_ONCE) {
            let seed = |value: f64, input: usize| {
                let mut number = Dual::steady(value);
                if let Some(slope) = input.checked_sub(first).and_then(|i| number.slopes.get_mut(i)) {
                    *slope = 1.0;
                }
                number
            };
            // Relative to the first node, as the fits have them.
            let at = |i: usize| points[nodes[i / d] * d + i % d] - points[nodes[0] * d + i % d];
            let x: Vec<Dual<AT_ONCE>> = (0..n * d).map(|i| seed(at(i), i)).collect();
            let moduli = Moduli { lambda: seed(moduli.lambda, n * d), mu: seed(moduli.mu, n * d + 1) };
            let add = |constants: &mut dyn Iterator<Item = Dual<AT_ONCE>>, gradient: &mut [f64]| {
                for (k, w) in constants.zip(weights) {
                    gradient[first..].iter_mut().zip(k.slopes).for_each(|(sum, slope)| *sum += w * slope);
                }
            };
            let found = match (fit, &mut *solver) {
                (GradientFit::Exact(fit), _) => exact_constants(element, springs, &x, moduli, fit)
                    .map(|constants| add(&mut constants.into_iter(), &mut gradient)),
                (GradientFit::Closed(_), Some(closed)) => closed
                    .solve(&element.tabulation, springs, &x, &mut geometry, &Hooke::Isotropic(moduli))
                    .then(|| add(&mut (0..m).map(|s| *closed.constant(springs, s)), &mut gradient)),
                (GradientFit::Closed(_), None) => None,
            };
            if found.is_none() || !gradient.iter().all(|slope| slope.is_finite()) {
                return Err(
                    no_answer("has no stiffness, or is too flat for derivatives").at_key(cell_name(element, cell))
                );
            }
        }
        Ok(gradient)
    };
    let cells = connectivity.par_chunks_exact(n).zip(weights.par_chunks_exact(m.max(1))).enumerate();
    let each: Vec<Vec<f64>> = cells.map_init(|| solver.clone(), of_cell).collect::<Result<_>>()?;
    let mut sum = ConstantsGradient { points: vec![0.0; points.len()], moduli: [0.0; 2] };
    for (nodes, gradient) in connectivity.chunks_exact(n).zip(&each) {
        for (node, own) in nodes.iter().zip(gradient.chunks_exact(d)) {
            sum.points[node * d..][..d].iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        }
        sum.moduli.iter_mut().zip(&gradient[n * d..]).for_each(|(sum, own)| *sum += own);
    }
    Ok(sum)
}

fn unsupported(expected: &str, found: &str) -> Error {
    Error::expected("objective", expected, found).of_kind(ErrorKind::Unsupported)
}
