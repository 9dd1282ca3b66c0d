//! Statics of a cavity that is filled to a given volume, whose pressure is found.

use super::applied::Applied;
use super::internal::{Form, Internal, Rest, masked};
use super::linear::System;
use super::newton::{Equilibrium, ForceBalance, Newton, ROUGHEST, raised, with};
use crate::error::Result;
use crate::model::{Cavity, Elastic, Support, displaced};
use crate::springs::{dot, norm};

/// The volume is reached to this share of it. The volume is a sum over the sides of the cavity, whose rounding is below
/// that.
const FILLED: f64 = 1e-12;
/// While more than this share of the volume is missing, the forces need not balance better than before: the first step changes the shape.
const FILLING: f64 = 1e-6;
/// The largest number of halvings of a step. A step that is 2⁻²⁰ times as long changes no digit that counts.
const SHORTER: usize = 20;

impl Newton {
    /// Fills a cavity from its volume at rest at `points`, `[points × dimension]`, m, to that which it shall have. Equal steps add equal volumes, so
    /// that a body whose pressure passes a maximum is followed beyond it.
    ///
    /// Unknown are the displacements u and the pressure p: `g(u) = p f(u)` and `V(u) = V̄`, where `f = ∂V/∂x`. With `T = ∂(g − p f)/∂x` a step is
    /// `δu = T⁻¹ (p f − g) + δp T⁻¹ f`, and δp is such that the volume is right to first order.
    ///
    /// # Errors
    /// The tangent does not fit into memory.
    pub fn fill(&self, model: &dyn Elastic, points: &[f64], support: &Support, cavity: &Cavity) -> Result<Equilibrium> {
        let mut inflation = Inflation {
            newton: *self,
            rest: Rest { model, points, support },
            cavity,
            start: cavity.volume_at(points),
            pressure: 0.0,
            known: None,
            shifted: 0,
        };
        let mut pressures = Vec::new();
        let mut found = self.stepped(points.len(), &mut |share, u| {
            let settled = inflation.settle(share, u)?;
            if settled.1 != ForceBalance::None {
                pressures.push(inflation.pressure);
            }
            Ok(settled)
        })?;
        (found.shifted, found.pressures) = (inflation.shifted, pressures);
        Ok(found)
    }
}

struct Inflation<'a> {
    newton: Newton,
    rest: Rest<'a>,
    cavity: &'a Cavity,
    /// The volume at rest, m³.
    start: f64,
    /// The pressure at the last volume that was reached, Pa.
    pressure: f64,
    /// The equations of the last tangent; all tangents have the same pattern.
    known: Option<System>,
    /// The number of iterations whose tangent was not positive definite, as it is beyond the maximum of the pressure.
    shifted: usize,
}

/// How far a state is from the equilibrium.
struct Lack {
    /// The forces that are not balanced, `[points · dimension]`, N.
    forces: Vec<f64>,
    /// Their norm over the free degrees of freedom, relative to the forces that act.
    size: f64,
    /// The norm of the forces that act, N.
    acting: f64,
    /// The volume that is missing, m³.
    volume: f64,
    /// `∂V/∂x`, m².
    gradient: Vec<f64>,
}

impl Inflation<'_> {
    fn lack(&self, now: &Internal, u: &[f64], pressure: f64, target: f64) -> Lack {
        let x = displaced(self.rest.points, u);
        let gradient = self.cavity.sides.forces(&x);
        let forces: Vec<f64> = gradient.iter().zip(&now.force).map(|(f, g)| pressure * f - g).collect();
        let acting = norm(&now.force).max(pressure.abs() * norm(&gradient));
        let size = if acting > 0.0 { self.rest.free(&forces) / acting } else { 0.0 };
        Lack { forces, size, acting, volume: target - self.cavity.volume_at(&x), gradient }
    }

    /// Newton's method at the share `share` of the change of volume; returns the residuals, and whether the forces are in equilibrium.
    fn settle(&mut self, share: f64, u: &mut Vec<f64>) -> Result<(Vec<f64>, ForceBalance)> {
        let target = self.start + share * (self.cavity.volume - self.start);
        let support = self.rest.support;
        // The pressure of the last volume that was reached: one that failed leaves no trace.
        let (mut history, mut pressure) = (Vec::new(), self.pressure);
        let Some(mut now) = self.rest.at(u, Form::Position) else { return Ok((history, ForceBalance::None)) };
        let mut lack = self.lack(&now, u, pressure, target);
        for _ in 0..self.newton.iterations {
            history.push(lack.size.max(lack.volume.abs() / target));
            if lack.volume.abs() <= FILLED * target {
                let is_small = self.rest.free(&lack.forces) <= now.rounding;
                let hidden = is_small && now.rounding <= ROUGHEST * lack.acting;
                // At the volume at rest nothing acts but rounding errors.
                let at_rest = is_small && lack.acting <= now.rounding / ROUGHEST;
                let balance = match (lack.size <= self.newton.tolerance || at_rest, hidden) {
                    (true, _) => ForceBalance::Exact,
                    (false, true) => ForceBalance::Rounded,
                    (false, false) => ForceBalance::None,
                };
                if balance != ForceBalance::None {
                    self.pressure = pressure;
                    return Ok((history, balance));
                }
            }
            let sides = Applied { forces: &lack.gradient, pressed: Some(&self.cavity.sides) };
            let following = sides.stiffness(self.rest.points, u, pressure);
            // Without a shift, but with its places: the pattern is that of the other tangents of Newton's method.
            let entries = raised(&with(&now.response.tangent, &following), u.len(), 0.0);
            // A step moves no support: what is prescribed is held.
            let still = Support { prescribed: support.prescribed.iter().map(|held| held.map(|_| 0.0)).collect() };
            let system = match self.known.take() {
                Some(known) => known.renewed(&entries, &still)?,
                None => System::new(&entries, &still)?,
            };
            let system = self.known.insert(system);
            // Beyond the maximum of the pressure the tangent is not positive definite, although the body is stable at
            // its volume.
            let Some(factor) = system.factorize()? else { return Ok((history, ForceBalance::None)) };
            self.shifted += usize::from(!factor.is_positive_definite());
            let (by_forces, _) = system.solve(&factor, &lack.forces);
            let (by_pressure, _) = system.solve(&factor, &lack.gradient);
            let gradient = masked(&lack.gradient, support);
            let change = (lack.volume - dot(&gradient, &by_forces)) / dot(&gradient, &by_pressure);
            let step: Vec<f64> = by_forces.iter().zip(&by_pressure).map(|(r, f)| r + change * f).collect();
            // A pressure that changes no volume to first order has no step: the quotient above is then 0/0 or infinite.
            if !step.iter().all(|s| s.is_finite()) {
                return Ok((history, ForceBalance::None));
            }
            let fills = lack.volume.abs() > FILLING * target;
            let worst = |lack: &Lack| lack.size.max(lack.volume.abs() / target);
            let before = worst(&lack);
            let mut length = 1.0;
            let accepted = (0..SHORTER).find_map(|_| {
                let tried: Vec<f64> = u.iter().zip(&step).map(|(u, s)| u + length * s).collect();
                let reached = pressure + length * change;
                length /= 2.0;
                let internal = self.rest.at(&tried, Form::Position)?;
                let left = self.lack(&internal, &tried, reached, target);
                (fills || worst(&left) < before).then_some((tried, reached, internal, left))
            });
            let Some(better) = accepted else { return Ok((history, ForceBalance::None)) };
            (*u, pressure, now, lack) = better;
        }
        Ok((history, ForceBalance::None))
    }
}
