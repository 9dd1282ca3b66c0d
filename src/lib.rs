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
//! A module uses only those above it.
//!
//! | module | what it holds |
//! |---|---|
//! | [`error`] | the error type: kind, file, line, key and problem |
//! | [`scalar`], [`symbolic`] | the numbers of the kernels; expressions, and exact rational functions |
//! | [`random`] | reproducible random numbers, and points that fill a cube evenly |
//! | [`range`], [`quantity`], [`text`] | limits of physical quantities, units, texts made safe to print |
//! | [`element`] | elements read from TOML files: cell, shape functions, quadrature, groups of springs |
//! | [`material`] | elastic moduli, plane states, hyperelastic energies |
//! | [`stiffness`] | the geometry of an element, `R = ∫ Bᵀ D B dV`, and forces at large deformation |
//! | [`springs`] | what springs measure, their forces and tangents, force laws |
//! | [`fit`] | spring constants of elements: norms, divergence, exact networks, sampled forces, published formulas |
//! | [`mesh`] | meshes: read from Gmsh and VTK files, generated, refined, checked |
//! | [`model`] | the finite element model and the network of a mesh; loads, supports, masses |
//! | [`solve`] | linear and nonlinear statics, natural vibrations, stability of a network |
//! | [`positive`] | the nearest network without negative springs to an exact network |
//! | [`dynamics`] | motion in time |
//! | [`whole`] | spring constants from the displacements of the whole body |
//! | [`study`] | scenes, and the studies that are made from them |
//! | `generate` | code that computes the springs of a cell at run time (feature `cli`) |
//! | `report` | tables, JSON, CSV, SVG and VTU files of the results (feature `cli`) |
//! | `export` | networks as files and scripts of other programs (feature `cli`) |
//! | `referee` | whether simulators reproduce the modulus in their input (feature `cli`) |
//! | [`prelude`] | the names that most programs need |
//!
//! Lengths are in m, moduli in Pa, forces in N, masses in kg and times in s. Arrays are row by row; their shapes are
//! given in brackets, as in `[points × dimension]`.
//!
//! # Features
//!
//! - `cli` (default): the program `springfit`, and the module `report`. A library user turns it off with
//!   `default-features = false`, and saves the dependencies for the command line, tables and pictures.
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

// The commands name the library as its users do.
#[cfg(feature = "cli")]
extern crate self as springfit;

#[cfg(feature = "cli")]
mod commands;
#[cfg(feature = "cli")]
pub mod export;
pub mod prelude;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod program;
#[cfg(feature = "cli")]
pub mod referee;
#[cfg(feature = "cli")]
mod terminal;

pub use springfit_bodies::{dynamics, engine, model, solve};
pub use springfit_element::{element, material, springs, stiffness};
pub use springfit_fit::fit;
pub use springfit_foundation::{error, quantity, random, range, scalar, symbolic, text};
#[cfg(feature = "cli")]
pub use springfit_generate::generate;
pub use springfit_identify::{calibration, positive, whole};
pub use springfit_mesh::mesh;
#[cfg(feature = "cli")]
pub use springfit_report::report;
pub use springfit_studies::study;

#[cfg(feature = "cli")]
use springfit_foundation::file;
/// Files that come into a folder together, and replace those of the run before.
///
/// ```
/// let folder = std::env::temp_dir().join(format!("springfit-edition-{}", std::process::id()));
/// let mut edition = springfit::Edition::begin(&folder, &["a.txt"], &[], &[])?;
/// edition.write("a.txt", |path| springfit::write_whole(path, b"one"))?;
/// assert!(!folder.join("a.txt").exists());
/// edition.publish()?;
/// assert_eq!(std::fs::read(folder.join("a.txt")).unwrap(), b"one");
/// # std::fs::remove_dir_all(&folder).unwrap();
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_foundation::file::Edition;
/// A checksum, by which files of a run are known again.
///
/// ```
/// let sum = springfit::Sum::of(b"");
/// assert_eq!(sum.to_string(), "cbf29ce484222325"); // FNV-1a of nothing
/// ```
#[doc(inline)]
pub use springfit_foundation::file::Sum;
/// Takes back what this process has begun to write, before it ends.
///
/// ```no_run
/// springfit::abandon();
/// std::process::exit(130);
/// ```
#[doc(inline)]
pub use springfit_foundation::file::abandon;
/// Refuses an output that is an input, before long work.
///
/// ```
/// let file = std::env::temp_dir().join(format!("springfit-apart-{}", std::process::id()));
/// springfit::write_whole(&file, b"")?;
/// assert!(springfit::check_apart(&[file.clone()], &[file.clone()]).is_err());
/// # std::fs::remove_file(&file).unwrap();
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_foundation::file::check_apart;
/// Refuses a file that could not be written, before long work.
///
/// ```
/// let file = std::env::temp_dir().join("springs.json");
/// assert!(springfit::check_file(&file).is_ok());
/// assert!(springfit::check_file("/".as_ref()).is_err());
/// ```
#[doc(inline)]
pub use springfit_foundation::file::check_file;
/// Refuses a folder that could not be written into, before long work.
///
/// ```
/// let missing = std::env::temp_dir().join("springfit-not-yet-there");
/// assert!(springfit::check_folder(&missing).is_ok());
/// assert!(!missing.exists());
/// ```
#[doc(inline)]
pub use springfit_foundation::file::check_folder;
/// Lists the files of a folder with one ending.
///
/// ```
/// let scenes = springfit::files_in("scenes".as_ref(), "toml")?;
/// assert!(scenes.contains(&"scenes/square_quad.toml".into()));
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_foundation::file::files_in;
/// Ends what a process left that ended while it put files in their places.
///
/// ```
/// springfit::finish_edition(&std::env::temp_dir())?; // nothing was left there
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_foundation::file::finish_edition;
/// Writes a file at once: whoever reads sees the old file or the new one.
///
/// ```
/// let file = std::env::temp_dir().join(format!("springfit-whole-{}", std::process::id()));
/// springfit::write_whole(&file, b"k\n50\n")?;
/// assert_eq!(std::fs::read(&file).unwrap(), b"k\n50\n");
/// # std::fs::remove_file(&file).unwrap();
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_foundation::file::write_whole;
/// Writes a file at once, with content that is made while it is written.
///
/// ```
/// let file = std::env::temp_dir().join(format!("springfit-with-{}", std::process::id()));
/// springfit::write_with(&file, |to| (0..3).try_for_each(|k| writeln!(to, "{k}")))?;
/// assert_eq!(std::fs::read(&file).unwrap(), b"0\n1\n2\n");
/// # std::fs::remove_file(&file).unwrap();
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_foundation::file::write_with;
/// Says which known name was meant.
///
/// ```
/// assert_eq!(springfit::suggestion(["edge", "diagonal"], "egde"), "; did you mean \"edge\"?");
/// assert_eq!(springfit::suggestion(["edge", "diagonal"], "bulk"), "");
/// ```
#[doc(inline)]
pub use springfit_foundation::named::suggestion;
/// Makes the error for a name that is not known.
///
/// ```
/// let error = springfit::unknown("a group", ["edge", "diagonal"], "egde");
/// assert_eq!(error.to_string(), "expected a group, found \"egde\"; did you mean \"edge\"?");
/// ```
#[doc(inline)]
pub use springfit_foundation::named::unknown;
#[cfg(feature = "cli")]
use springfit_networks::network;

// The examples of README and of the book are compiled and run with those of this page.
#[cfg(doctest)]
mod examples {
    #[doc = include_str!("../README.md")]
    struct Readme;
    #[doc = include_str!("../docs/src/reference/library.md")]
    struct Library;
}
