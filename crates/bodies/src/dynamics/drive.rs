//! Forces, prescribed displacements and gravity as functions of time.

use crate::error::{Error, Result};
use crate::symbolic::{Expr, Program, Scope};
use std::fmt;
use std::sync::Arc;

/// A number as a function of time in s: a load curve.
#[derive(Clone)]
pub struct Curve(Arc<dyn Fn(f64) -> f64 + Send + Sync>);

impl Curve {
    /// The curve of a function of time.
    pub fn new(function: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Curve {
        Curve(Arc::new(function))
    }

    /// The curve with the same value at all times.
    pub fn constant(value: f64) -> Curve {
        Curve::new(move |_| value)
    }

    /// The curve of an expression in t, such as `0.01*sin(2*t)`.
    ///
    /// # Errors
    /// The text is not an expression in t.
    pub fn parse(text: &str) -> Result<Curve> {
        Curve::of(&Scope::new(&["t"]).expression(text)?)
    }

    /// The curve of an expression whose only variable is t.
    ///
    /// # Errors
    /// The expression has other variables.
    pub fn of(expression: &Expr) -> Result<Curve> {
        if uses_others(expression) {
            return Err(Error::expected("curve", "an expression of t alone", "one of more variables"));
        }
        let program = Program::of(expression);
        Ok(Curve::new(move |t| program.evaluate(&[t])))
    }

    /// The value at time t.
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

/// Forces and prescribed displacements over time. A degree of freedom has the number `point · dimension + direction`.
#[derive(Debug, Clone, Default)]
pub struct Drive {
    /// Nodal forces, in N per unit of the curve, with their curve.
    pub(super) forces: Vec<(Vec<(usize, f64)>, Curve)>,
    pub(super) displacements: Vec<(usize, Curve)>,
    /// The acceleration of gravity, m/s², `[dimension]`; empty if there is none.
    pub(super) gravity: Vec<f64>,
}

impl Drive {
    /// Adds a force on one degree of freedom, in N.
    pub fn force(mut self, dof: usize, curve: Curve) -> Drive {
        self.forces.push((vec![(dof, 1.0)], curve));
        self
    }

    /// Adds nodal forces, `[points · dimension]`, N, multiplied by a curve.
    pub fn forces(mut self, forces: &[f64], curve: Curve) -> Drive {
        // Loads act on few points of a body, and each step goes through the list.
        let acting = forces.iter().copied().enumerate().filter(|(_, f)| *f != 0.0);
        self.forces.push((acting.collect(), curve));
        self
    }

    /// Prescribes the displacement of one degree of freedom from its position at rest, in m, whether the support holds
    /// it or not.
    pub fn displacement(mut self, dof: usize, curve: Curve) -> Drive {
        self.displacements.push((dof, curve));
        self
    }

    /// Sets an acceleration that acts on every mass, m/s², `[dimension]`.
    pub fn gravity(mut self, acceleration: &[f64]) -> Drive {
        self.gravity = acceleration.to_vec();
        self
    }

    /// Checks the drive.
    ///
    /// # Errors
    /// A degree of freedom is not below `dofs`, or gravity does not have one entry per direction.
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

    /// Whether the forces are the same at all times.
    pub(super) fn is_steady(&self) -> bool {
        // Gravity is constant, curves may be anything.
        self.forces.is_empty()
    }

    /// The forces `f(t)`, in N; `masses` are those of the degrees of freedom, in kg.
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
