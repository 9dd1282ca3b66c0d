//! springfit turns a mesh and a material into a mass–spring network that reproduces the response of the finite element
//! model of the same body, and reports the error and the cost.
//!
//! For each element the spring constants k minimise a measure of `R − K(k)`. R is the stiffness of the finite element,
//! and `K(k) = Σ_s k_s g_s g_sᵀ` is that of its springs: each measures one number c of the positions of its nodes, with
//! the gradient `g = ∇c`. The springs of all cells are added to a network on the points of the mesh. Other fits use the
//! forces at large deformation or the displacements of the whole body, and exact networks are equal to the finite
//! element at any deformation.
//!
//! # One element
//!
//! The spring constants of a cube of 2 cm, from its stiffness:
//!
//! ```
//! use springfit::prelude::*;
//!
//! let hex8 = Element::load("hex8")?;
//! let springs = Springs::select(&hex8, None)?;
//! let cube: Vec<f64> = hex8.positions.iter().map(|x| 0.01 * (x + 1.0)).collect(); // m
//! let moduli = Material::new(10e3, 0.3, State::Solid)?.moduli(); // Pa
//! let k = fit_element(&hex8, &springs, &cube, moduli, &Fit::new(Objective::Frobenius(Weight::OffDiagonal)))?;
//! assert_eq!(k.len(), springs.pairs().len()); // N/m, one constant per pair of nodes
//! # Ok::<(), springfit::error::Error>(())
//! ```
//!
//! # A whole scene
//!
//! A scene file names the mesh, the material, the fits, the supports and the loads. Running it is one call:
//!
//! ```
//! use springfit::study::{Scene, run};
//!
//! let scene = Scene::load("scenes/square_quad.toml".as_ref())?;
//! let outcome = run(&scene, &mut |_| ())?;
//! for fit in &outcome.fits {
//!     println!("{}: {} springs, {}", fit.fit.name, fit.network.len(), fit.status());
//! }
//! # assert!(!outcome.fits.is_empty());
//! # Ok::<(), springfit::error::Error>(())
//! ```
//!
//! # Modules
//!
//! A module uses only those above it. Each names what users need of a package of its own, which has more, and may change it.
//!
//! | module | what it holds |
//! |---|---|
//! | [`error`] | the error type: kind, file, line, key and problem |
//! | [`scalar`], [`symbolic`] | kinds of numbers; expressions, and exact rational functions |
//! | [`quantity`] | physical quantities, and their units |
//! | [`element`] | elements read from TOML files: cell, shape functions, quadrature, groups of springs |
//! | [`material`] | elastic moduli, plane states, hyperelastic energies |
//! | [`stiffness`] | the geometry of an element, `R = ∫ Bᵀ D B dV`, and forces at large deformation |
//! | [`springs`] | what springs measure, their forces and tangents, force laws |
//! | [`fit`] | spring constants of elements: norms, divergence, exact networks, sampled forces, published formulas |
//! | [`mesh`] | meshes: read from files of many programs, generated, refined, filled, checked |
//! | [`model`] | the finite element model and the network of a mesh; loads, supports, masses |
//! | [`solve`] | linear and nonlinear statics, natural vibrations, stability of a network |
//! | [`dynamics`] | motion in time |
//! | [`engine`] | what a network answers in an engine that ends its iterations early |
//! | [`positive`] | the nearest network without negative springs to an exact network |
//! | [`whole`] | spring constants from the displacements of the whole body |
//! | [`calibration`] | moduli of a body from measurements, with intervals |
//! | [`study`] | scenes, and the studies that are made from them |
//! | [`prelude`] | the names that most programs need |
//!
//! Lengths are in m, moduli in Pa, forces in N, masses in kg and times in s. Arrays are row by row; their shapes are
//! given in brackets, as in `[points × dimension]`.
//!
//! # Features
//!
//! - `cli` (default): the program `springfit`. A library user turns it off with `default-features = false`, and saves the
//!   dependencies for the command line, tables and pictures.
//!
//! # Errors
//!
//! Functions that depend on input return [`error::Result`]. An [`error::Error`] has a [`kind`](error::Error::kind) for
//! programs, and prints as one line for people: the file, the line, the key, what was expected and what was found. An
//! optimum that a solver does not reach, or a network that is not stable, is not an error but part of the result. No
//! input causes a panic; the few functions that panic for a wrong index or length say so under *Panics*.
//!
//! # Theory
//!
//! The book in the folder `docs` of the repository derives the methods. Each module names the page that belongs to it.

#![forbid(unsafe_code)]

#[cfg(feature = "cli")]
mod commands;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod export;
pub mod prelude;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod program;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod referee;
#[cfg(feature = "cli")]
mod terminal;

/// The error of every function that depends on input: its kind, file, line, key and problem.
pub mod error {
    #[doc(inline)]
    pub use springfit_foundation::error::{Error, ErrorKind, Result};
}

/// Physical quantities, and the units that texts may state them in.
pub mod quantity {
    #[doc(inline)]
    pub use springfit_foundation::quantity::Quantity;
}

/// Kinds of numbers in which elements are integrated and springs fitted.
pub mod scalar {
    #[doc(inline)]
    pub use springfit_foundation::scalar::{DoubleDouble, Dual, Real, Scalar};
}

/// Expressions of text, and exact rational functions.
pub mod symbolic {
    #[doc(inline)]
    pub use springfit_foundation::symbolic::{Expr, Fraction, Polynomial};
}

/// Elements, read from TOML files: cell, shape functions, quadrature, groups of springs. The page *Element files* of the book has the keys.
pub mod element {
    #[doc(inline)]
    pub use springfit_element::element::{
        Cell, Element, JacobianBounds, Kind, Quadrature, SHIPPED, ShapeFunctions, Side, SideTable, SpringGroup,
        SpringKind, Tabulation, coordinate_names, schema,
    };
}

/// Elastic moduli, plane states, anisotropic and hyperelastic materials, and their values by cell.
pub mod material {
    #[doc(inline)]
    pub use springfit_element::material::{
        Anisotropy, BlockValues, CellMap, Energy, EnergyMap, Hooke, LinearMaterial, Material, MaterialMap, Moduli,
        Plane, RegionMaterial, Relaxation, RelaxationTerm, SHIPPED, State, Stiffness, schema, with_moduli,
    };
}

/// The geometry of an element at its quadrature points, `R = ∫ Bᵀ D B dV`, and forces at large deformation.
pub mod stiffness {
    #[doc(inline)]
    pub use springfit_element::stiffness::{EnergyFunction, Geometry, Hyperelastic, StressFunction};
}

/// What springs measure, their forces, and laws of force.
pub mod springs {
    #[doc(inline)]
    pub use springfit_element::springs::{
        AskedForces, Force, ForceFunction, FunctionSpring, Law, Measure, Patch, SpringResponse, Springs,
    };
}

/// Spring constants of elements: norms, divergence, exact networks, sampled forces. The pages of *Theory* in the book derive them.
pub mod fit {
    /// Spring constants by formulas of other authors. The page *Related methods* of the book has their sources.
    pub mod published {
        #[doc(inline)]
        pub use springfit_fit::fit::published::{Method, Unmet, constants_of_cell, fit, unmet};
    }
    #[doc(inline)]
    pub use springfit_fit::fit::{
        Balance, CellFits, CellFunction, CellNumbers, CellStart, Certificate, Choices, ClosedFit, ClosedForm,
        DampingKind, DampingTest, ElementErrors, ExactEnergy, ExactFit, Fit, GivenFit, GivenStiffness, GradientFit,
        Higher, Inputs, ModulusTest, MotionWeight, Norm, Objective, ResidualFunction, ResidualObjective, Rest,
        SampledFit, SampledFits, Sampling, Search, ShapeError, ShearSprings, Solver, Spread, Topology, VolumeSprings,
        Weight, Weights, condense, element_errors, fit_cells, fit_element, fit_exact, fit_sampled, plain,
    };
}

/// Meshes: read from files of many programs, generated, refined, filled, checked.
pub mod mesh {
    /// Grids of VTK.
    pub mod vtk {
        #[doc(inline)]
        pub use springfit_mesh::mesh::vtk::{Array, Grid, write};
    }
    #[doc(inline)]
    pub use springfit_mesh::mesh::{
        BoxMesh, CellBlock, CellIndex, DiscMesh, Field, FillBoundary, FillLayers, FillMesh, FillSpacing, Filled,
        Format, Gate, Group, MESH_FORMATS, Mesh, MeshArrays, MeshFormat, MeshSource, NumberOrigin, Numbering, Quality,
        Scattered, Selection, SourceBlock, VoxelMesh, listed_endings,
    };
}

/// The finite element model and the network of a mesh; loads, supports, masses.
pub mod model {
    #[doc(inline)]
    pub use springfit_bodies::model::{
        Action, BendingSprings, BlockStiffness, Body, CompressedRows, ConsistentMasses, Elastic, Entries, LengthSpring,
        Lumping, MaterialPoints, MeasureSpring, Network, PreparedNetwork, Response, RestTension, Specimen, SpringLaw,
        Support, bending_springs, displaced, edge_springs, exact_network, fibre_springs, finite_elements, is_exact,
        length_shares, lumped_masses, masses, nodal_forces, patch_springs, unheld_bodies,
    };
}

/// Linear and nonlinear statics, natural vibrations, and the stability of a network.
pub mod solve {
    #[doc(inline)]
    pub use springfit_bodies::solve::{
        Applied, Ending, Equilibrium, Factor, Modes, Newton, Solved, Stability, Standing, StaticMethod, StaticSolver,
        System, is_definite, lowest_modes,
    };
}

/// Motion in time: integrators, damping, drives, conservation of energy.
pub mod dynamics {
    #[doc(inline)]
    pub use springfit_bodies::dynamics::{
        BranchForm, BranchTerm, Curve, Damping, Drive, EnergyBalance, Integrator, LinearSolver, Memory, Motion,
        MotionState, Options, Simulation, Step, StepOutcome,
    };
}

/// What a network answers in an engine that ends its iterations early.
pub mod engine {
    #[doc(inline)]
    pub use springfit_bodies::engine::{
        Engine, Frames, Precision, Setting, Sweep, Truncated, TruncatedModel, Vibration,
    };
}

/// The nearest network without negative springs to an exact network.
pub mod positive {
    #[doc(inline)]
    pub use springfit_identify::positive::{PositiveFit, PositiveOutcome, Route, nearest_positive};
}

/// Spring constants fitted to the displacements of the whole body.
pub mod whole {
    #[doc(inline)]
    pub use springfit_identify::whole::{
        BodyRegions, Determination, Displacements, LeastSquares, ModuliSharing, NodalLoad, Object, Stretched, Target,
        Unknowns, Validation, Wanted, Weighing, WholeFit, WholeSettings, fit_whole, made_loads, random_loads,
    };
}

/// Moduli of a body from measurements, with intervals.
pub mod calibration {
    #[doc(inline)]
    pub use springfit_identify::calibration::{
        Asked, Estimate, FieldEstimate, Laws, LoadCase, Observation, Prior, Quantity, Unknown, Unknowns, estimate,
        estimate_field,
    };
}

/// Scenes, and the studies that are made from them. [`Scene`](study::Scene) reads and checks a scene file, and [`run`](study::run()) fits
/// its springs, solves its loads with both models and compares them; the result is an [`Outcome`](study::Outcome).
pub mod study {
    #[doc(inline)]
    pub use springfit_studies::study::{
        BodyLoad, CalibratedLoad, CalibratedRegion, CalibrationOutcome, CaseRecord, CellValues, Comparing,
        ComplexModulus, Controls, Convergence, DampingRecipe, DisplacementError, DraftMaterial, DynamicModuli,
        DynamicModuliOutcome, EffectiveModuli, EngineEntry, EngineOutcome, Event, ExactOutcome, FillEntry, FitEntry,
        FitOutcome, FitTimes, FittedKind, Followed, Forecast, FrequencyOutcome, GaugeResult, HeldOut, InMemory,
        Inspection, Lattice, Level, Limit, LoadKind, LoadOutcome, Materials, MatrixErrors, MeasureOptions, Measured,
        MeasuredNetwork, MeshInput, MeshLength, MethodRecord, ModelMotion, ModelTimes, MotionOutcome, MotionRecipe,
        NamedFit, NetworkMaterial, Outcome, Paper, Part, Progress, PublishedOutcome, Recipe, Reference, SampledOutcome,
        Scene, Setting, StabilityOutcome, StabilityRow, Standard, StiffnessOutcome, Stretches, Study, Sweep,
        TensionOutcome, Times, WholeOutcome, calibrate, compare_element, compare_scene, compare_stretches, converge,
        converge_to, displacement_error, draft, fit_mesh, inspect, learning_curve, matrix_errors, measure,
        moduli_of_body, network_material, run, run_paper, run_with, scene_schema, stability, stability_of_scene,
    };
}

// The examples of README and of the book are compiled and run with those of this page.
#[cfg(doctest)]
mod examples {
    #[doc = include_str!("../README.md")]
    struct Readme;
    #[doc = include_str!("../docs/src/reference/library.md")]
    struct Library;
}
