//! Spring constants of elements: norms, divergence, exact networks, sampled forces. The pages of *Theory* in the book derive them.

/// Spring constants by formulas of other authors. The page *Related methods* of the book has their sources.
pub mod published {
    #[doc(inline)]
    pub use springfit_fit::fit::published::{Method, Unmet, constants_of_cell, fit, unmet};
}

#[doc(inline)]
pub use springfit_fit::fit::{
    Balance, CellFits, CellFunction, CellNumbers, CellStart, Certificate, Choices, ClosedFit, ClosedForm, DampingKind,
    DampingTest, ElementErrors, ExactEnergy, ExactFit, Fit, GivenFit, GivenStiffness, GradientFit, Higher, Inputs,
    ModulusTest, MotionWeight, Norm, Objective, ResidualFunction, ResidualObjective, Rest, SampledFit, SampledFits,
    Sampling, Search, ShapeError, ShearSprings, Solver, Spread, Topology, VolumeSprings, Weight, Weights,
    element_errors, fit_element, reference_fit,
};

/// A stiffness without some of its unknowns: two springs in a row are one of `k₁k₂/(k₁ + k₂)`.
///
/// ```
/// use nalgebra::DMatrix;
///
/// let row = DMatrix::from_row_slice(3, 3, &[2.0, -2.0, 0.0, -2.0, 8.0, -6.0, 0.0, -6.0, 6.0]); // N/m
/// let one = springfit::fit::condense(&row, &[0, 2])?;
/// assert!((one[(0, 0)] - 1.5).abs() < 1e-15);
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_fit::fit::condense;

/// The constants of all cells of one element type.
///
/// ```
/// use springfit::fit::fit_cells;
/// use springfit::prelude::*;
///
/// let triangle = Element::linear_simplex(2)?;
/// let springs = Springs::select(&triangle, None)?;
/// let points = [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0]; // m
/// let moduli = Material::new(10e3, 0.25, State::PlaneStrain { thickness: 1.0 })?.moduli();
/// let fit = Fit::new(Objective::Frobenius(Weight::OffDiagonal));
/// let fits = fit_cells(&triangle, &springs, &points, &[0, 1, 2, 0, 2, 3], moduli, &fit, &mut |_| {})?;
/// assert_eq!(fits.constants.len(), 2 * 3);
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_fit::fit::fit_cells;

/// The springs of exact networks, whose stiffness is that of the finite elements.
///
/// ```
/// use springfit::fit::{ExactFit, element_errors, fit_exact};
/// use springfit::prelude::*;
///
/// let tetrahedron = Element::linear_simplex(3)?;
/// let points = [0.0, 0.0, 0.0, 1.0, 0.1, 0.0, 0.2, 1.0, 0.0, 0.1, 0.2, 1.0]; // m
/// let material = Material::new(10e3, 0.45, State::Solid)?;
/// let fits = fit_exact(&tetrahedron, &points, &[0, 1, 2, 3], material, &ExactFit::default(), &mut |_| {})?;
/// let errors = element_errors(&tetrahedron, &points, &[0, 1, 2, 3], material.moduli(), &fits)?;
/// assert!(errors.frobenius[0] < 1e-14);
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_fit::fit::fit_exact;

/// The parameters of springs, fitted to forces at large deformation.
///
/// ```
/// use springfit::fit::{SampledFit, fit_sampled};
/// use springfit::material::Energy;
/// use springfit::prelude::*;
///
/// let triangle = std::sync::Arc::new(Element::linear_simplex(2)?);
/// let springs = Springs::select(&triangle, None)?;
/// let material = Material::new(10e3, 0.3, State::PlaneStress { thickness: 0.01 })?;
/// let energy = Energy::load("neo-hookean", material)?;
/// let points = [0.0, 0.0, 1.0, 0.0, 0.5, 0.75_f64.sqrt()]; // m
/// let fit = SampledFit::default();
/// let found = fit_sampled(&triangle, &springs, &points, &[0, 1, 2], &energy, material.state(), &fit, &mut |_| {})?;
/// assert!(found.fits.constants.iter().all(|k| *k > 0.0)); // N/m
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_fit::fit::fit_sampled;
