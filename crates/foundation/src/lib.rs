//! What every layer of springfit needs: errors, files, kinds of numbers, symbolic expressions.

#![forbid(unsafe_code)]

pub mod bound;
pub mod error;
pub mod file;
pub mod memory;
mod named;
pub mod scalar;
pub mod symbolic;
