//! What every layer of springfit needs: errors, files, ranges, kinds of numbers, symbolic expressions.

#![forbid(unsafe_code)]

pub mod bound;
pub mod error;
pub mod file;
pub mod memory;
pub mod named;
pub mod quantity;
pub mod range;
pub mod scalar;
pub mod symbolic;
pub mod text;
