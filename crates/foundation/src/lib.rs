//! The base layer of springfit: errors, files, quantities with units, kinds of numbers, and symbolic expressions.
//!
//! Users of springfit need not name this crate: `springfit` passes on the modules of it that a program meets.
//!
//! | module | what it holds |
//! |---|---|
//! | [`error`] | the one error type, with kind, file, line and key |
//! | [`mod@file`] | reading with named errors, writing a file whole or not at all, TOML |
//! | [`clock`] | processor time |
//! | [`range`], [`bound`], [`memory`] | the limits of quantities, of counts, and of memory |
//! | [`number`] | numbers in JSON |
//! | [`order`] | lists in the order in which their entries first appear |
//! | [`random`] | random numbers, and points that fill a cube evenly |
//! | [`quantity`], [`named`], [`text`] | units, closed lists of names, texts made safe to print, and to write in each grammar |
//! | [`scalar`] | the numbers that kernels compute with: `f64`, SIMD lanes, `f32`, double-double, rationals |
//! | [`symbolic`] | expressions: parsed, differentiated, evaluated, expanded; exact rational functions |

#![forbid(unsafe_code)]

pub mod bound;
pub mod clock;
pub mod error;
pub mod file;
pub mod memory;
pub mod named;
pub mod number;
pub mod order;
pub mod quantity;
pub mod random;
pub mod range;
pub mod scalar;
pub mod symbolic;
pub mod text;
