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
//! A module uses only those above it. Each names what users need of a package, which has more, and may change it.
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
//! The book in the folder `docs` of the repository derives the methods. The documentation of each item names the page that belongs to it.

#![forbid(unsafe_code)]

pub mod calibration;
pub mod dynamics;
pub mod element;
pub mod engine;
pub mod error;
pub mod fit;
pub mod material;
pub mod mesh;
pub mod model;
pub mod positive;
pub mod prelude;
pub mod quantity;
pub mod scalar;
pub mod solve;
pub mod springs;
pub mod stiffness;
pub mod study;
pub mod symbolic;
pub mod whole;

// The program.
#[cfg(feature = "cli")]
mod commands;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod export;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod program;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod referee;
#[cfg(feature = "cli")]
mod terminal;

// The examples of README and of the book are compiled and run with those of this page.
#[cfg(doctest)]
mod examples {
    #[doc = include_str!("../README.md")]
    struct Readme;
    #[doc = include_str!("../docs/src/reference/library.md")]
    struct Library;
}
