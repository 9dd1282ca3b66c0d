//! Spring constants from the stiffness of each element: `min_k ‖R − K(k)‖`, `K(k) = Σ_s k_s g_s g_sᵀ`, and other
//! objectives.
//!
//! [`reference_fit`] is a fit as its formula: read it first. [`fit_cells`] fits all cells of one element type by faster routes;
//! [`fit_exact`] makes networks that are equal to the finite element; [`fit_sampled`] fits to forces at large deformation;
//! [`published`] holds the formulas of other authors.
//!
//! Theory: pages *Least squares*, *The 2-norm*, *The divergence*, *Modal weights*, *Exact networks and patches* and
//! *Sampled fits* of the book.

mod batch;
mod bounded;
mod bounded_divergence;
mod cells;
mod congruence;
mod constrained;
mod damping;
mod delicate;
mod dense;
mod descent;
mod divergence;
mod edge_cell;
mod element_errors;
mod exact;
mod extremes;
mod given_stiffness;
mod gradient;
mod input;
mod jacobi;
mod least_squares;
mod linear_motions;
mod method;
mod node_equations;
mod normal;
mod objective;
mod packed_hooke;
mod packing;
mod precision;
pub mod published;
mod reduction;
pub mod reference_fit;
mod regression;
mod relaxation;
mod rest;
mod rows;
mod sampled;
mod settings;
mod singular;
mod solver;
mod spectral;
mod stiffness_difference;
mod symbolic_fit;
mod symbolic_modulus;
mod tension;
mod vectorized_normal;
mod visit;
mod weight;

// The tests of the small dense solvers are in the one binary of all tests, which reaches public items alone.
#[doc(hidden)]
pub mod solvers {
    pub use super::constrained::solve_nonnegative;
    pub use super::dense::{add_outers, factorize, row_products};
    pub use super::extremes::Extremes;
    pub use super::jacobi::eigenvectors;
    pub use super::normal::Normal;
    pub use super::regression::solve_norm;
}

pub use cells::{CellFits, fit_cells, fit_element};
pub use damping::{DampedSeries, DampingError, DampingKind, DampingTest, FittedDecay, FittedRayleigh, ratio_of_decay};
pub use element_errors::{ElementErrors, Spread, SpreadSum, each_element_errors, element_errors};
pub use exact::{
    DomainSprings, ExactDomains, ExactEnergy, ExactFit, ShearSprings, VolumeSprings, check_flat,
    exact_constants_of_kind, exact_double_double_constants, fit_exact,
};
pub use given_stiffness::{GivenFit, GivenStiffness, condense};
pub use gradient::{CellFunction, CellNumbers, GradientFit, Inputs};
pub use method::Certificate;
pub use normal::Rank;
pub use objective::{Balance, Choices, Objective};
pub use precision::{
    bounded_constants, condition, constants_in, constants_of_kind, distance_from_optimum, double_double_constants,
    single_constants,
};
pub use regression::Norm;
pub use relaxation::{FittedSeries, ModulusTest};
pub use rest::Rest;
pub use sampled::{
    CellStart, DeformationFamily, Design, FamilyErrors, Part, ResidualFunction, ResidualObjective, SampledFit,
    SampledFits, Sampling, ShapeError, Source, StartEnd, Weights, fit_sampled,
};
pub use settings::Fit;
pub use solver::{Search, Solver, Topology};
pub use symbolic_fit::{ClosedFit, ClosedForm, ExactForm, SymmetryClass};
pub use symbolic_modulus::Modulus;
pub use weight::{Higher, MotionWeight, Weight};
