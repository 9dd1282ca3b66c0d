//! One cell: its springs as columns of a least-squares problem, and its optimum as constants and rest measures.

use super::bounded::solve_bounded;
use super::problem::Problem;
use super::unknowns::{Sizes, Unknown, unknowns};
use super::view::{View, deformations};
use crate::element::Element;
use crate::fit::rest::Rest;
use crate::fit::settings::Fit;
use crate::fit::weight::Weight;
use crate::material::Hooke;
use crate::springs::{Measure, Springs, norm};
use crate::stiffness::{Fault, Geometry};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// An unknown below this share of the largest of its kind is a rounding error. It becomes zero, so that a spring that
/// does not pull is stored as one.
const ROUNDING: f64 = 1e-13;
/// Tensions below this share of `k c` are rounding errors: tensions are stored as `k c − T`, and what remains of them
/// is not in equilibrium.
const UNSTORED: f64 = 1e-12;

/// What the cells of a block have in common.
pub struct Cells<'a> {
    springs: &'a Springs,
    measures: Vec<(Vec<usize>, Measure)>,
    fit: Fit,
    weight: Weight,
}

/// The springs of one cell.
pub struct CellTension {
    pub constants: Vec<f64>,
    /// `k c₀` of each spring.
    pub parameters: Vec<f64>,
    pub deficient: bool,
    pub reached: bool,
}

/// A spring at rest.
struct Spring {
    /// The indices of the coordinates of its nodes among those of the cell.
    dofs: Vec<usize>,
    measure: f64,
    hessian: DMatrix<f64>,
    /// `‖g‖`.
    gradient: f64,
    /// `g/‖g‖`, `[nodes·dimension]`.
    direction: DVector<f64>,
}

impl<'a> Cells<'a> {
    /// The objective of the fit must be a sum of squares, as [`Rest::check`](crate::fit::Rest::check) asks.
    pub fn new(element: &Arc<Element>, springs: &'a Springs, fit: &Fit) -> Cells<'a> {
        let weight = fit.objective.weight().unwrap_or(Weight::Relative);
        Cells { springs, measures: springs.measures(element), fit: *fit, weight }
    }

    /// The springs of the cell with nodes at `x`, `[nodes × dimension]`, m.
    ///
    /// # Errors
    /// The measure of a spring has no gradient; R is singular and the weight divides by it; or the only springs in
    /// equilibrium are those without a force.
    pub fn fit(&self, x: &[f64], geometry: &Geometry, hooke: &Hooke) -> Result<CellTension, String> {
        let springs = self.springs_at(x, geometry)?;
        let r = geometry.stiffness(hooke);
        let sizes = Sizes {
            stiffness: r.norm(),
            extent: geometry.content().powf(1.0 / geometry.dimension as f64),
            gradients: springs.iter().map(|s| s.gradient).collect(),
            measures: springs.iter().map(|s| s.measure).collect(),
        };
        let basis = deformations(x, geometry.dimension);
        // All that follows is dimensionless: limits hold for any unit and size.
        let r = r / sizes.stiffness;
        let view = View::of(self.weight, x, geometry.dimension, &r, &basis);
        let view = view.ok_or("its stiffness is not positive definite")?;
        let unknowns = unknowns(self.springs, self.fit.rest, self.fit.tied, &sizes);
        let (problem, scales) = equations(&springs, &unknowns, &sizes, &view, &basis, &r);

        let every: Vec<usize> = (0..unknowns.len()).collect();
        let free = problem.solve(&every);
        // Springs of rest length zero alone, for example, always pull and have no balance.
        if free.freedom == 0 {
            let problem = "only springs without force are in equilibrium with these rest measures";
            return Err(format!("{problem}: expected more springs, such as one on the content"));
        }
        let bounded: Vec<usize> = every.iter().copied().filter(|&j| unknowns[j].is_constant).collect();
        let (mut optimum, reached) = match self.fit.nonnegative {
            true => solve_bounded(&problem, &bounded, free),
            false => (free, true),
        };
        // Constants and tensions have each their own scale: the largest of one says nothing of the other.
        for sort in [true, false] {
            let own: Vec<usize> = every.iter().copied().filter(|&j| unknowns[j].is_constant == sort).collect();
            let largest = own.iter().map(|&j| optimum.unknowns[j].abs()).fold(0.0, f64::max);
            let rounding = own.iter().filter(|&&j| optimum.unknowns[j].abs() <= ROUNDING * largest);
            rounding.copied().collect::<Vec<usize>>().iter().for_each(|&j| optimum.unknowns[j] = 0.0);
        }
        let u = optimum.unknowns.component_mul(&scales);
        let (constants, parameters) = self.written(&unknowns, &u, &sizes);
        Ok(CellTension { constants, parameters, deficient: optimum.deficient, reached })
    }

    fn springs_at(&self, x: &[f64], geometry: &Geometry) -> Result<Vec<Spring>, String> {
        let mut rows = Vec::new();
        self.springs.gradients(x, geometry, &mut rows);
        let gradients = rows.chunks_exact(x.len());
        let springs: Vec<Spring> =
            self.measures.iter().zip(gradients).map(|(m, g)| Spring::of(m, g, x, geometry.dimension)).collect();
        if springs.iter().all(Spring::is_measured) { Ok(springs) } else { Err(Fault::Unmeasured.to_string()) }
    }

    /// k and `k c₀ = k c − T` of all springs.
    fn written(&self, unknowns: &[Unknown], u: &DVector<f64>, sizes: &Sizes) -> (Vec<f64>, Vec<f64>) {
        let count = self.springs.len();
        let (mut constants, mut tensions) = (vec![0.0; count], vec![0.0; count]);
        for (unknown, u) in unknowns.iter().zip(u) {
            for term in &unknown.terms {
                constants[term.spring] += term.constant * u;
                tensions[term.spring] += term.tension * u;
            }
        }
        let whole = |s: usize| constants[s] * sizes.measures[s];
        let largest =
            |of: &dyn Fn(usize) -> f64| (0..count).map(|s| of(s).abs() * sizes.gradients[s]).fold(0.0, f64::max);
        let is_unstored = largest(&|s| tensions[s]) <= UNSTORED * largest(&whole);
        let parameter = |s: usize| match self.fit.rest {
            Rest::Zero if s < self.springs.pairs().len() => 0.0,
            Rest::Mesh | Rest::Free | Rest::Zero => whole(s) - if is_unstored { 0.0 } else { tensions[s] },
        };
        let parameters = (0..count).map(parameter).collect();
        (constants, parameters)
    }
}

/// The columns of the unknowns, `‖g‖²/size · k g gᵀ/‖g‖² + ‖g‖/(size L) · T L ∇∇c/‖g‖`, and their forces
/// `T g/(size L)`; and the value of each unknown in the scaling in which its column has norm one.
fn equations(
    springs: &[Spring],
    unknowns: &[Unknown],
    sizes: &Sizes,
    view: &View,
    basis: &DMatrix<f64>,
    r: &DMatrix<f64>,
) -> (Problem, DVector<f64>) {
    let extent = sizes.extent;
    let stretched: Vec<DVector<f64>> = springs.iter().map(|s| view.of_vector(&s.direction)).collect();
    let bent: Vec<DVector<f64>> =
        springs.iter().map(|s| view.of_matrix(&s.dofs, &(&s.hessian * (extent / s.gradient)))).collect();
    let forces: Vec<DVector<f64>> = springs.iter().map(|s| basis.tr_mul(&s.direction)).collect();
    let mut a = DMatrix::zeros(view.rows(), unknowns.len());
    let mut c = DMatrix::zeros(basis.ncols(), unknowns.len());
    let mut scales = DVector::from_element(unknowns.len(), 1.0);
    for (j, unknown) in unknowns.iter().enumerate() {
        for term in &unknown.terms {
            let (s, g) = (term.spring, springs[term.spring].gradient);
            let pull = term.tension * g / (sizes.stiffness * extent);
            a.column_mut(j).axpy(term.constant * g * g / sizes.stiffness, &stretched[s], 1.0);
            a.column_mut(j).axpy(pull, &bent[s], 1.0);
            c.column_mut(j).axpy(pull, &forces[s], 1.0);
        }
        let norm = a.column(j).norm();
        // An unknown without effect has a column of zeros, which stays unscaled and is found dependent.
        if norm > 0.0 {
            scales[j] = 1.0 / norm;
        }
        a.column_mut(j).scale_mut(scales[j]);
        c.column_mut(j).scale_mut(scales[j]);
    }
    let all: Vec<usize> = (0..r.nrows()).collect();
    (Problem { a, b: view.of_matrix(&all, r), c }, scales)
}

impl Spring {
    /// The spring of a cell with nodes at `x`; g is that of [`Springs::gradients`].
    fn of((nodes, measure): &(Vec<usize>, Measure), g: &[f64], x: &[f64], dimension: usize) -> Spring {
        let dofs: Vec<usize> = nodes.iter().flat_map(|&a| a * dimension..(a + 1) * dimension).collect();
        let at: Vec<f64> = dofs.iter().map(|&i| x[i]).collect();
        let hessian = DMatrix::from_vec(dofs.len(), dofs.len(), measure.jet(&at, dimension).hessian);
        let gradient = norm(g);
        let direction = DVector::from_column_slice(g) / gradient;
        // Computed as for the residual, so that the rounding is the same.
        Spring { measure: measure.value(&at, dimension), hessian, gradient, direction, dofs }
    }

    fn is_measured(&self) -> bool {
        self.gradient > 0.0
            && self.gradient.is_finite()
            && self.measure.is_finite()
            && self.hessian.iter().all(|h| h.is_finite())
    }
}
