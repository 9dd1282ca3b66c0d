//! One cell: its springs as columns of a least-squares problem, and its optimum as constants and rest measures.

use super::bounded::solve_bounded;
use super::problem::Problem;
use super::unknowns::{Sizes, unknowns};
use super::view::{View, deformations};
use crate::element::Element;
use crate::fit::objective::Objective;
use crate::fit::settings::Fit;
use crate::fit::weight::Weight;
use crate::material::Moduli;
use crate::springs::{Measure, Springs, norm};
use crate::stiffness::{Fault, Geometry};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// An unknown below this share of the largest of its sort is rounding.
const ROUNDING: f64 = 1e-13;
/// Tensions below this share of `k c` are: they are stored as `k c − T`, and what that leaves of them does not balance.
const UNSTORED: f64 = 1e-12;

/// What the cells of a block have in common.
pub struct Cells<'a> {
    springs: &'a Springs,
    measures: Vec<(Vec<usize>, Measure)>,
    moduli: Moduli,
    fit: Fit,
    weight: Weight,
}

/// The springs of one cell.
pub struct CellTension {
    pub constants: Vec<f64>,
    /// `k c₀`.
    pub parameters: Vec<f64>,
    pub deficient: bool,
    pub reached: bool,
}

/// A spring at rest.
struct Spring {
    /// Of its nodes' coordinates among those of the cell.
    dofs: Vec<usize>,
    measure: f64,
    hessian: DMatrix<f64>,
    /// `g/‖g‖`, `[nodes·dimension]`.
    direction: DVector<f64>,
}

impl<'a> Cells<'a> {
    /// The objective of the fit is a Frobenius norm.
    pub fn new(element: &Arc<Element>, springs: &'a Springs, moduli: Moduli, fit: &Fit) -> Cells<'a> {
        let weight = match fit.objective {
            Objective::Frobenius(weight) => weight,
            Objective::Spectral(weight) => weight.into(),
            Objective::Divergence(_) => Weight::Relative,
        };
        Cells { springs, measures: springs.measures(element), moduli, fit: *fit, weight }
    }

    /// The springs of the cell with nodes at `x`, `[nodes × dimension]`, m.
    ///
    /// # Errors
    /// What a spring measures has no gradient, R is singular where the weight divides by it, or only springs of no force are in
    /// equilibrium.
    pub fn fit(&self, x: &[f64], geometry: &Geometry) -> Result<CellTension, String> {
        let d = geometry.dimension;
        let mut rows = Vec::new();
        self.springs.gradients(x, geometry, &mut rows);
        let gradients: Vec<f64> = rows.chunks_exact(x.len()).map(norm).collect();
        let springs: Vec<Spring> =
            self.measures.iter().zip(rows.chunks_exact(x.len())).map(|(m, g)| spring(m, g, x, d)).collect();
        let is_measured = |(s, g): (&Spring, &f64)| {
            *g > 0.0 && g.is_finite() && s.measure.is_finite() && s.hessian.iter().all(|h| h.is_finite())
        };
        if !springs.iter().zip(&gradients).all(is_measured) {
            return Err(Fault::Unmeasured.to_string());
        }
        let basis = deformations(x, d);
        let mut r = geometry.stiffness(self.moduli);
        let size = r.norm();
        r /= size;
        let view = View::of(self.weight, x, d, &r, &basis).ok_or("its stiffness is not positive definite")?;
        let measures: Vec<f64> = springs.iter().map(|s| s.measure).collect();
        let extent = geometry.content().powf(1.0 / d as f64);
        let sizes = Sizes { stiffness: size, extent, gradients: &gradients, measures: &measures };
        let unknowns = unknowns(self.springs, self.fit.rest, self.fit.tied, &sizes);

        // ‖g‖²/size · k g gᵀ/‖g‖² + ‖g‖/(size L) · T L ∇∇c/‖g‖ and the force T g/(size L), unknown by unknown.
        let stretched: Vec<DVector<f64>> = springs.iter().map(|s| view.of_vector(&s.direction)).collect();
        let bent: Vec<DVector<f64>> = springs
            .iter()
            .zip(&gradients)
            .map(|(s, g)| view.of_matrix(&s.dofs, &(&s.hessian * (extent / g))))
            .collect();
        let forces: Vec<DVector<f64>> = springs.iter().map(|s| basis.tr_mul(&s.direction)).collect();
        let mut a = DMatrix::zeros(view.rows(), unknowns.len());
        let mut c = DMatrix::zeros(basis.ncols(), unknowns.len());
        for (j, unknown) in unknowns.iter().enumerate() {
            for term in &unknown.terms {
                let (s, g) = (term.spring, gradients[term.spring]);
                let pull = term.tension * g / (size * extent);
                a.column_mut(j).axpy(term.constant * g * g / size, &stretched[s], 1.0);
                a.column_mut(j).axpy(pull, &bent[s], 1.0);
                c.column_mut(j).axpy(pull, &forces[s], 1.0);
            }
        }
        let all: Vec<usize> = (0..r.nrows()).collect();
        let b = view.of_matrix(&all, &r);
        // Unknowns in the scaling in which each has a column of norm one.
        let scales: Vec<f64> =
            a.column_iter().map(|column| column.norm()).map(|n| if n > 0.0 { 1.0 / n } else { 1.0 }).collect();
        a.column_iter_mut().zip(&scales).for_each(|(mut column, scale)| column *= *scale);
        c.column_iter_mut().zip(&scales).for_each(|(mut column, scale)| column *= *scale);
        let problem = Problem { a, b, c };
        let every: Vec<usize> = (0..unknowns.len()).collect();
        if problem.basis(&every).ncols() == 0 {
            let problem = "only springs without force are in equilibrium with these rest measures: expected more springs, such as one on the content";
            return Err(problem.into());
        }
        let bounded: Vec<usize> = every.iter().copied().filter(|&j| unknowns[j].is_constant).collect();
        let (mut optimum, reached) = match self.fit.nonnegative {
            true => solve_bounded(&problem, &bounded),
            false => (problem.solve(&every), true),
        };
        let u = &mut optimum.unknowns;
        for sort in [true, false] {
            let own = || every.iter().copied().filter(|&j| unknowns[j].is_constant == sort);
            let largest = own().map(|j| u[j].abs()).fold(0.0, f64::max);
            own()
                .filter(|&j| u[j].abs() <= ROUNDING * largest)
                .collect::<Vec<_>>()
                .into_iter()
                .for_each(|j| u[j] = 0.0);
        }
        let (mut constants, mut tensions) = (vec![0.0; springs.len()], vec![0.0; springs.len()]);
        for (unknown, (u, scale)) in unknowns.iter().zip(u.iter().zip(&scales)) {
            for term in &unknown.terms {
                constants[term.spring] += term.constant * u * scale;
                tensions[term.spring] += term.tension * u * scale;
            }
        }
        let largest =
            |of: &dyn Fn(usize) -> f64| (0..springs.len()).map(|s| of(s).abs() * gradients[s]).fold(0.0, f64::max);
        if largest(&|s| tensions[s]) <= UNSTORED * largest(&|s| constants[s] * measures[s]) {
            tensions.fill(0.0);
        }
        // T = k (c − c₀)
        let parameters = (0..springs.len()).map(|s| constants[s] * measures[s] - tensions[s]).collect();
        Ok(CellTension { constants, parameters, deficient: optimum.deficient, reached })
    }
}

fn spring((nodes, measure): &(Vec<usize>, Measure), g: &[f64], x: &[f64], d: usize) -> Spring {
    let dofs: Vec<usize> = nodes.iter().flat_map(|&a| a * d..(a + 1) * d).collect();
    let at: Vec<f64> = dofs.iter().map(|&i| x[i]).collect();
    let hessian = DMatrix::from_vec(dofs.len(), dofs.len(), measure.jet(&at, d).hessian);
    let direction = DVector::from_column_slice(g);
    let size = direction.norm();
    // As where the residual is measured, whose rounding must be the same.
    Spring { measure: measure.value(&at, d), hessian, direction: direction / size, dofs }
}
