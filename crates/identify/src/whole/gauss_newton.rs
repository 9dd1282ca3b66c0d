//! The Gauss–Newton method without matrices: conjugate gradients on the linearised residuals within a trust region.
//!
//! Theory: page *Whole-object fits* of the book.

use super::descent::Descent;
use super::linearized::{LeastSquares, Linearized};
use crate::error::Result;
use crate::springs::{dot, norm};

/// The settings of the Gauss–Newton steps (Nocedal and Wright 2006, algorithms 4.1 and 7.2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GaussNewton {
    /// The largest number of products with the Jacobian and its transpose for one step.
    pub products: usize,
    /// The relative residual of the linear equations at which a step is accurate enough.
    pub accuracy: f64,
    /// The iteration ends if a step lowers the objective by a smaller share than this.
    pub decrease: f64,
}

impl Default for GaussNewton {
    fn default() -> GaussNewton {
        // An inexact step is enough far from the optimum (Nocedal and Wright 2006, 7.1), and each product takes a
        // solution for every load.
        GaussNewton { products: 40, accuracy: 0.1, decrease: 1e-2 }
    }
}

/// The relative error of the products of a step where equations are solved by iterations: well below the accuracy of the step.
const STEP: f64 = 1e-3;
/// The first radius of the trust region: the root mean square of a step in θ, which is a logarithm.
// Radii from 0.1 to 4 lead to the same errors to 0.5 %, in as many steps to three.
const RADIUS: f64 = 1.0;
/// A smaller radius ends the search. It is a relative change of the constants that no error of displacements shows.
const LEAST_RADIUS: f64 = 1e-6;
/// The least share of the predicted decrease that a step must achieve.
// The η of algorithm 4.1 may be any number from 0 to 1/4 (Nocedal and Wright 2006). Above zero it keeps the search from
// steps that lower the objective by rounding.
const ACCEPTED: f64 = 1e-3;

impl GaussNewton {
    /// For few unknowns, which are found to the last digits.
    pub const PRECISE: GaussNewton = GaussNewton { products: 100, accuracy: 1e-6, decrease: 1e-9 };

    /// Minimises from θ in at most `iterations` steps, to the lowest point. `visit` is called with each point and may end
    /// the search by returning false.
    pub(super) fn descend(
        &self,
        problem: &dyn LeastSquares,
        rho: f64,
        theta: &[f64],
        iterations: usize,
        visit: &mut dyn FnMut(&[f64], f64) -> bool,
    ) -> Result<Descent> {
        let mut theta = theta.to_vec();
        let Some(mut now) = problem.at(&theta)? else {
            return Ok(Descent { theta, objective: Vec::new(), is_finished: true });
        };
        let (mut value, mut gradient) = now.objective(rho)?;
        let mut objective = vec![value];
        // The norm of θ over this is a root mean square, so that the radii mean the same for any number of unknowns.
        let root = (theta.len().max(1) as f64).sqrt();
        let mut radius = RADIUS * root;
        let mut is_finished = false;
        for _ in 0..iterations {
            let path = self.path(&now, rho, &gradient, radius)?;
            // A step that is refused is shortened along the same path, without further products.
            let (lowered, found) = loop {
                let (step, promised) = path.within(radius);
                // If the gradient is zero there is no direction to go.
                if !(promised > 0.0) {
                    break (0.0, None);
                }
                let length = norm(&step);
                let tried: Vec<f64> = theta.iter().zip(&step).map(|(t, s)| t + s).collect();
                let next = problem.at(&tried)?;
                let share = rho / root.powi(2);
                let after = next.as_ref().map(|next| next.square() + share * dot(&tried, &tried));
                // A network that is unstable has no residuals: a step to it is too long.
                let after = after.filter(|after| after.is_finite()).unwrap_or(f64::INFINITY);
                let kept = (value - after) / promised;
                // The shares and factors are those of algorithm 4.1.
                if kept < 0.25 {
                    radius = 0.25 * length;
                // A step that the radius has cut has its length but for rounding.
                } else if kept > 0.75 && length > 0.99 * radius {
                    radius *= 2.0;
                }
                match next.filter(|_| kept > ACCEPTED) {
                    Some(next) => break (value - after, Some((tried, next))),
                    None if !(radius > LEAST_RADIUS * root) => break (0.0, None),
                    None => {}
                }
            };
            let Some((tried, next)) = found else {
                is_finished = true;
                break;
            };
            (theta, now) = (tried, next);
            let enough = lowered <= self.decrease * value;
            (value, gradient) = now.objective(rho)?;
            objective.push(value);
            is_finished = enough;
            if !visit(&theta, value) || enough {
                break;
            }
        }
        Ok(Descent { theta, objective, is_finished })
    }

    /// The path of conjugate gradients towards the minimum of `gᵀd + dᵀ(JᵀJ + ρ/m)d`, up to the part that leaves the radius.
    fn path(&self, at: &Linearized, rho: f64, gradient: &[f64], radius: f64) -> Result<StepPath> {
        let share = rho / gradient.len().max(1) as f64;
        let mut step = vec![0.0; gradient.len()];
        // The gradient is `2 (Jᵀ r + ρ/m θ)`; the normal equations have its half.
        let mut residual: Vec<f64> = gradient.iter().map(|g| -0.5 * g).collect();
        let mut direction = residual.clone();
        let mut square = dot(&residual, &residual);
        let first = square;
        let mut path = StepPath { size: gradient.len(), parts: Vec::new() };
        for _ in 0..self.products {
            // It ends also where the gradient is zero, for which the quotients below would be 0/0.
            if !(square > self.accuracy * self.accuracy * first) {
                break;
            }
            let moved = at.forward(&direction, STEP)?;
            let curvature = moved.iter().flatten().map(|r| r * r).sum::<f64>() + share * dot(&direction, &direction);
            let length = square / curvature;
            // A direction that changes nothing has no curvature: its length is infinite or undefined, and it ends at
            // the radius too.
            let ends = !(length < edge(&step, &direction, radius));
            path.parts.push(PathPart { direction: direction.clone(), length, square, curvature });
            if ends {
                break;
            }
            step.iter_mut().zip(&direction).for_each(|(s, d)| *s += length * d);
            let back = at.adjoint(&moved, STEP)?;
            for ((r, b), d) in residual.iter_mut().zip(&back).zip(&direction) {
                *r -= length * (b + share * d);
            }
            let next = dot(&residual, &residual);
            direction.iter_mut().zip(&residual).for_each(|(d, r)| *d = r + next / square * *d);
            square = next;
        }
        Ok(path)
    }
}

/// The path of conjugate gradients from zero. The distance from zero grows along it, and the objective falls (Steihaug 1983).
struct StepPath {
    size: usize,
    parts: Vec<PathPart>,
}

/// A straight part of the path.
struct PathPart {
    direction: Vec<f64>,
    /// In units of the direction.
    length: f64,
    /// Half of the slope against the direction where the part begins.
    square: f64,
    curvature: f64,
}

impl StepPath {
    /// The last point with `‖d‖ ≤ radius`, and the predicted decrease.
    fn within(&self, radius: f64) -> (Vec<f64>, f64) {
        let (mut step, mut promised) = (vec![0.0; self.size], 0.0);
        for PathPart { direction, length, square, curvature } in &self.parts {
            let edge = edge(&step, direction, radius);
            // A length that is infinite or NaN, as without curvature, ends at the edge.
            let ends = !(*length < edge);
            let length = if ends { edge } else { *length };
            promised += 2.0 * length * square - length * length * curvature;
            step.iter_mut().zip(direction).for_each(|(s, d)| *s += length * d);
            if ends {
                break;
            }
        }
        (step, promised)
    }
}

/// The distance from a step along a direction to the boundary of the trust region, in units of the direction.
fn edge(step: &[f64], direction: &[f64], radius: f64) -> f64 {
    let (a, b, c) = (dot(direction, direction), dot(step, direction), dot(step, step) - radius * radius);
    // The root of `|s + t d| = radius` with t ≥ 0. A step that rounding has put beyond the radius has no real one.
    ((b * b - a * c).max(0.0).sqrt() - b) / a
}
