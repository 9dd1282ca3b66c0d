//! The springs of domains that consist of shares of several cells and have one deformation gradient, the mean of those
//! cells.
//!
//! With `F = Σ_a x_a ⊗ G_a` and `Σ_a G_a = 0` the identity of exact networks holds for any such gradients, not only those
//! of shape functions: `w |F|² = −w Σ_{a<b} G_a·G_b |x_a − x_b|²`.
//!
//! Theory: page *Exact networks and patches* of the book.

use super::ExactFit;
use super::energy::{Coefficients, Form};
use super::kernel::{content_spring, edges};
use super::shear::ShearSprings;
use super::volume::Shares;
use crate::element::Tabulation;
use crate::error::{Error, Result};
use crate::material::Material;
use crate::springs::Law;
use crate::stiffness::Geometry;
use std::sync::Arc;

/// What the domains of a body have in common.
#[derive(Debug, Clone)]
pub struct ExactDomains {
    /// `[materials]`.
    coefficients: Vec<Coefficients>,
    form: Form,
    shares: Shares,
}

/// The springs of one domain.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct DomainSprings {
    /// The constants of the springs of rest length zero between all pairs of nodes, in the order 0-1, 0-2, …, 1-2, …,
    /// N/m.
    pub pairs: Vec<f64>,
    /// The constant of the springs of rest area zero on the three columns of `cof F`, N/m³; zero for most energies.
    pub areas: f64,
    /// The constant of the spring on the content, in J divided by the square of the content.
    pub constant: f64,
    /// Its rest content, in m² or m³.
    pub rest: f64,
    /// The parameters of its law, if it has one.
    pub parameters: Vec<f64>,
}

impl DomainSprings {
    /// The springs with all forces multiplied by `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> DomainSprings {
        let times = |values: &[f64]| values.iter().map(|k| factor * k).collect();
        DomainSprings {
            pairs: times(&self.pairs),
            areas: factor * self.areas,
            constant: factor * self.constant,
            rest: self.rest,
            parameters: times(&self.parameters),
        }
    }

    /// The springs with the forces of these and `factor` times those of others of the same domain and form.
    #[must_use]
    pub fn sum(&self, others: &DomainSprings, factor: f64) -> DomainSprings {
        let add = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + factor * b).collect();
        let constant = self.constant + factor * others.constant;
        // Two linear springs on one content are one, whose pull at the content zero is the sum of theirs.
        let pull = self.constant * self.rest + factor * others.constant * others.rest;
        DomainSprings {
            pairs: add(&self.pairs, &others.pairs),
            areas: self.areas + factor * others.areas,
            constant,
            // Equal rest contents, of laws or of springs that cancel, stay as they are.
            rest: if self.rest == others.rest { self.rest } else { pull / constant },
            parameters: add(&self.parameters, &others.parameters),
        }
    }
}

impl ExactDomains {
    /// The network of this fit for bodies of these materials, which are all in the same state.
    ///
    /// # Errors
    /// There is no material; or the energy has no form with springs in this state, or λ has springs on cells (kind
    /// `Unsupported`).
    pub fn new(fit: &ExactFit, materials: &[Material]) -> Result<ExactDomains> {
        let Some(first) = materials.first() else {
            return Err(Error::expected("material", "that of at least one cell", "none"));
        };
        ShearSprings::Edges.check(fit.volume)?;
        let form = Form::of(fit.energy, first.state(), fit.large)?;
        let coefficients = materials.iter().map(|material| Coefficients::of(fit.energy, *material, fit.large));
        Ok(ExactDomains { coefficients: coefficients.collect::<Result<_>>()?, form, shares: fit.volume.shares(false) })
    }

    /// The law of the springs on content, if they are not linear.
    pub fn law(&self) -> Option<&Arc<Law>> {
        self.form.law.as_ref()
    }

    /// The springs of a domain. `table` has a single point, whose weight is the content of the domain at rest and whose
    /// gradients `G_a` are those in the positions at rest. `parts` are the materials of its cells, as indices, with their
    /// shares of the content, which add up to one.
    ///
    /// # Panics
    /// A material has no such index, or the table has no point.
    pub fn springs(&self, table: &Tabulation, parts: &[(usize, f64)]) -> DomainSprings {
        let mean = Coefficients::mean(parts.iter().map(|(material, share)| (&self.coefficients[*material], *share)));
        let weight = table.weights[0];
        let geometry = Geometry {
            dimension: table.dimension,
            nodes: table.nodes,
            gradients: table.gradients.clone(),
            volumes: vec![weight],
            volumetric: Vec::new(),
            modes: Vec::new(),
            mode_count: 0,
        };
        let mut constant = 0.0;
        let mut parameters = vec![0.0; if self.form.law.is_some() { 2 } else { 1 }];
        content_spring(&mean, self.shares.points, &weight, [&weight, &weight], &mut constant, &mut parameters);
        // The kernel writes `k c₀`. Laws measure the content against that at rest.
        let rest = if self.form.law.is_some() { weight } else { parameters.remove(0) / constant };
        DomainSprings { pairs: edges(&geometry, mean.lengths), areas: mean.areas * weight, constant, rest, parameters }
    }
}
