//! What acts on a model in the course of time.

use crate::error::{Error, Result};
use crate::symbolic::{Expr, Program, Scope};
use std::fmt;
use std::sync::Arc;

/// A number as a function of time, s: a load curve.
#[derive(Clone)]
pub struct Curve(Arc<dyn Fn(f64) -> f64 + Send + Sync>);

impl Curve {
    pub fn new(function: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Curve {
        Curve(Arc::new(function))
    }

    pub fn constant(value: f64) -> Curve {
        Curve::new(move |_| value)
    }

    /// An expression of t, such as `0.01*sin(2*t)`.
    ///
    /// # Errors
    /// The text is no expression of t.
    pub fn parse(text: &str) -> Result<Curve> {
        Curve::of(&Scope::new(&["t"]).expression(text)?)
    }

    /// An expression whose one variable is t.
    ///
    /// # Errors
    /// It has other variables.
    pub fn of(expression: &Expr) -> Result<Curve> {
        if uses_others(expression) {
            return Err(Error::expected("curve", "an expression of t alone", "one of more variables"));
        }
        let program = Program::of(expression);
        Ok(Curve::new(move |t| program.evaluate(&[t])))
    }

    pub fn at(&self, t: f64) -> f64 {
        (self.0)(t)
    }
}

impl fmt::Debug for Curve {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("Curve(t)")
    }
}

fn uses_others(expression: &Expr) -> bool {
    match expression {
        Expr::Number(_) => false,
        Expr::Variable(v) => *v > 0,
        Expr::Sum(inner) | Expr::Product(inner) => inner.iter().any(uses_others),
        Expr::Power(inner, _) | Expr::Call(_, inner) => uses_others(inner),
    }
}

/// Forces and prescribed displacements over time; degree of freedom `point · dimension + direction`.
#[derive(Debug, Clone, Default)]
pub struct Drive {
    /// Nodal forces, N per unit of the curve, and their curve.
    pub(super) forces: Vec<(Vec<(usize, f64)>, Curve)>,
    pub(super) displacements: Vec<(usize, Curve)>,
    /// m/s², `[dimension]`; empty for none.
    pub(super) gravity: Vec<f64>,
}

impl Drive {
    /// Adds a force on one degree of freedom, N.
    pub fn force(mut self, dof: usize, curve: Curve) -> Drive {
        self.forces.push((vec![(dof, 1.0)], curve));
        self
    }

    /// Adds nodal forces, `[points · dimension]`, N, times a curve.
    pub fn forces(mut self, forces: &[f64], curve: Curve) -> Drive {
        let acting = forces.iter().copied().enumerate().filter(|(_, f)| *f != 0.0);
        self.forces.push((acting.collect(), curve));
        self
    }

    /// Moves one degree of freedom, m from its place at rest. It is held there, whether the support holds it or not.
    pub fn displacement(mut self, dof: usize, curve: Curve) -> Drive {
        self.displacements.push((dof, curve));
        self
    }

    /// An acceleration that acts on every mass, m/s², `[dimension]`.
    pub fn gravity(mut self, acceleration: &[f64]) -> Drive {
        self.gravity = acceleration.to_vec();
        self
    }

    /// # Errors
    /// A degree of freedom is none of `dofs`, or gravity has not one entry per direction.
    pub(super) fn check(&self, dofs: usize, dimension: usize) -> Result<()> {
        let forces = self.forces.iter().flat_map(|(places, _)| places.iter().map(|(dof, _)| *dof));
        let mut named = forces.chain(self.displacements.iter().map(|(dof, _)| *dof));
        if let Some(dof) = named.find(|dof| *dof >= dofs) {
            return Err(Error::expected("drive", format!("degrees of freedom below {dofs}"), dof));
        }
        let sound = self.gravity.iter().all(|g| g.is_finite());
        if !(self.gravity.is_empty() || self.gravity.len() == dimension && sound) {
            let found = format!("{:?}", self.gravity);
            return Err(Error::expected("gravity", format!("{dimension} finite numbers in m/s²"), found));
        }
        Ok(())
    }

    /// `f(t)`, N; `masses` of the degrees of freedom, kg.
    pub(super) fn forces_at(&self, t: f64, masses: &[f64], forces: &mut [f64]) {
        match self.gravity.len() {
            0 => forces.fill(0.0),
            d => forces.iter_mut().zip(masses).enumerate().for_each(|(dof, (f, m))| *f = m * self.gravity[dof % d]),
        }
        for (places, curve) in &self.forces {
            let now = curve.at(t);
            places.iter().for_each(|(dof, f)| forces[*dof] += f * now);
        }
    }
}
