//! The residual forces at the target displacements.

use super::displacements::Displacements;
use super::linearized::{LeastSquares, Linearized, PRODUCT, Tangent};
use super::object::Object;
use super::parts::PartVectors;
use super::target::Target;
use crate::error::{Error, ErrorKind, Result};
use crate::model::{Support, displaced};
use crate::solve::Equations;
use std::sync::Arc;

/// The residuals `r_l = √w_l R⁻¹ (f_l − F(ū_l; θ))/‖ū_l‖`, with R the stiffness of the finite elements at rest. They
/// are linear in the constants, so that the sum of squares without regularization has only one minimum.
#[derive(Debug)]
pub struct ResidualForces<'a> {
    object: &'a Object<'a>,
    scales: Vec<Vec<f64>>,
    targets: Vec<&'a Target>,
    /// The tangents, with the forces of the springs at the target displacements.
    tangents: Vec<Tangent>,
}

impl<'a> ResidualForces<'a> {
    /// `body` has the equations of the finite elements under each support.
    ///
    /// # Errors
    /// They lack a support, a load moves nothing, or a displacement is not known at every point.
    pub fn new(
        object: &'a Object<'a>,
        targets: Vec<&'a Target>,
        body: &[(Support, Equations)],
    ) -> Result<ResidualForces<'a>> {
        let displacements = Displacements::new(object, targets, None)?;
        let Displacements { targets, scales, groups, .. } = displacements;
        if let Some(target) = targets.iter().find(|target| target.weights.contains(&0.0)) {
            let expected = "loads whose displacements are known at every point, for the residual of forces";
            return Err(Error::expected("loads", expected, format!("\"{}\"", target.name)));
        }
        let mut all = Vec::new();
        for group in groups {
            let missing = || Error::new("the finite elements do not stand").of_kind(ErrorKind::Infeasible);
            let held = body.iter().find(|(support, _)| *support == targets[group[0]].support);
            let equations = held.ok_or_else(missing)?.1.clone();
            let forces = |l: usize| match object.newton {
                None => object.forces(&targets[l].displacement),
                Some(_) => object.forces_at(&displaced(object.points, &targets[l].displacement)),
            };
            let loads = group.iter().map(|&l| (l, Arc::new(forces(l)))).collect();
            all.push(Tangent { equations, loads });
        }
        Ok(ResidualForces { object, scales, targets, tangents: all })
    }
}

impl LeastSquares for ResidualForces<'_> {
    fn unknowns(&self) -> usize {
        self.object.unknowns.count()
    }

    fn at(&self, theta: &[f64]) -> Result<Option<Linearized<'_>>> {
        let factors = self.object.unknowns.factors(theta);
        let mut residuals = vec![Vec::new(); self.targets.len()];
        for tangent in &self.tangents {
            let rest = |(l, forces): &(usize, Arc<PartVectors>)| {
                let mut rest = forces.sum(factors.iter().map(|c| -c), self.scales[*l].len());
                rest.iter_mut().zip(&self.targets[*l].forces).for_each(|(r, f)| *r += f);
                rest
            };
            let forces: Vec<Vec<f64>> = tangent.loads.iter().map(rest).collect();
            for ((l, _), mut r) in tangent.loads.iter().zip(tangent.equations.respond_all(&forces, PRODUCT)?) {
                r.iter_mut().zip(&self.scales[*l]).for_each(|(r, s)| *r *= s);
                residuals[*l] = r;
            }
        }
        let tangents = self.tangents.clone();
        let (unknowns, scales) = (&self.object.unknowns, &self.scales[..]);
        Ok(Some(Linearized { residuals, theta: theta.to_vec(), unknowns, tangents, scales, rows: Vec::new() }))
    }
}
