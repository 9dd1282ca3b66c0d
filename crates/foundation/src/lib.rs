//! What every layer of springfit needs: errors, files, kinds of numbers, symbolic expressions.

#![forbid(unsafe_code)]

pub mod error;
pub mod file;
pub mod named;
pub mod quantity;
pub mod scalar;
pub mod symbolic;
pub mod text;
