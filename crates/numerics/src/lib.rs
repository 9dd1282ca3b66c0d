#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

pub mod convex;
pub mod dense;
pub mod newton;
