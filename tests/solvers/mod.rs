//! Truths about the small dense solvers, and about the numbers that they compute with.

mod constrained;
mod dual;
mod extremes;
mod jacobi;
mod normal;
mod norms;
