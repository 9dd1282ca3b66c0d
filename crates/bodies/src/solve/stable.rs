//! Equilibria at large deformation that are stable: their tangent is positive definite.
//!
//! Theory: page *Precision* of the book.

use super::equations::Equations;
use super::linear::System;
use super::newton::{Ending, Newton};
use crate::error::Result;
use crate::model::{Elastic, Support, displaced};
use std::sync::Arc;

impl Newton {
    /// The stable equilibrium near the displacements `guess`, as [`Newton::settle`] finds it, and the equations of the tangent there.
    ///
    /// # Errors
    /// The tangent does not fit into memory.
    pub fn settle_stable(
        &self,
        model: &dyn Elastic,
        points: &[f64],
        support: &Support,
        forces: &[f64],
        guess: &[f64],
        pattern: &System,
    ) -> Result<Option<(Vec<f64>, Equations)>> {
        let Some(u) = self.settle(model, points, support, forces, guess, Some(pattern))? else { return Ok(None) };
        self.stable(model, points, support, u, pattern)
    }

    /// The stable equilibrium near the displacements `guess`, or the one to which the load leads from rest.
    ///
    /// # Errors
    /// The tangent does not fit into memory.
    pub fn reach_stable(
        &self,
        model: &dyn Elastic,
        points: &[f64],
        support: &Support,
        forces: &[f64],
        guess: Option<&[f64]>,
        pattern: &System,
    ) -> Result<Option<(Vec<f64>, Equations)>> {
        if let Some(guess) = guess
            && let Some(found) = self.settle_stable(model, points, support, forces, guess, pattern)?
        {
            return Ok(Some(found));
        }
        // The guess may lie beyond a fold, or where Newton's method goes astray; the path from rest knows neither.
        let found = self.solve_with(model, points, support, forces.into(), Some(pattern))?;
        if found.ending == Ending::Stalled {
            return Ok(None);
        }
        self.stable(model, points, support, found.displacement, pattern)
    }

    fn stable(
        &self,
        model: &dyn Elastic,
        points: &[f64],
        support: &Support,
        u: Vec<f64>,
        pattern: &System,
    ) -> Result<Option<(Vec<f64>, Equations)>> {
        let Some(response) = model.respond(&displaced(points, &u)) else { return Ok(None) };
        let system = Newton::equations(pattern, &response.tangent, support)?;
        Ok(Equations::of_system(Arc::new(system))?.map(|equations| (u, equations)))
    }
}
